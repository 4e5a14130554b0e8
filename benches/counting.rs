//! Machines that count, that wait and that have many states, generated: what takes long to reach.

use std::fmt::Write;

/// So many charts, each of which counts parts from 0 to `top`, says that it is full, and begins anew when it is cleared.
pub fn counters(counters: usize, top: u32) -> String {
    let each = |text: &dyn Fn(usize) -> String| (0..counters).map(text).collect::<String>();
    let mut m = String::from("machine Counters \"charts that count parts\"\ncycle 10ms\n");
    let mut say = |text: String| writeln!(m, "{text}").expect("a string takes it");
    say(format!("inputs {{{} }}", each(&|i| format!(" Part{i} Clear{i}"))));
    say(format!("outputs {{{} }}", each(&|i| format!(" FULL{i}"))));
    say(format!("variables {{{} }}", each(&|i| format!(" Parts{i} : 0..{top}"))));
    say(each(&|i| format!("actuator Lamp{i} onoff by FULL{i}\n")));
    for i in 0..counters {
        say(format!(
            "chart C{i} {{
  initial state Count {{ internal when rise(Part{i}) then set Parts{i} := Parts{i} + 1 }}
  state Full {{ drives FULL{i} }}
  from Count to Full when Parts{i} >= {top}
  from Full to Count when rise(Clear{i}) then set Parts{i} := 0
}}"
        ));
    }
    let property = |i: usize| {
        format!(
            "  R{i}: reachable FULL{i}\n  P{i}: always possible FULL{i}\n  N{i}: never FULL{i} and Parts{i} < {top}\n"
        )
    };
    say(format!("properties {{\n{}}}", each(&property)));
    m
}

/// One chart in whose only working state so many parts are counted, each kind to `top`; it is done when all are there.
pub fn shared(counters: usize, top: u32) -> String {
    let each = |text: &dyn Fn(usize) -> String| (0..counters).map(text).collect::<String>();
    let all = (0..counters).map(|i| format!("Parts{i} >= {top}")).collect::<Vec<_>>().join(" and ");
    let reset = (0..counters).map(|i| format!("set Parts{i} := 0")).collect::<Vec<_>>().join(", ");
    format!(
        "machine Shared \"a chart that counts several kinds of parts\"\ncycle 10ms
inputs {{{} Clear }}\noutputs {{ DONE }}\nvariables {{{} }}\nactuator Lamp onoff by DONE
chart C {{
  initial state Count {{\n{}  }}
  state Full {{ drives DONE }}
  from Count to Full when {all}
  from Full to Count when rise(Clear) then {reset}
}}
properties {{\n  R: reachable DONE\n  P: always possible DONE\n{}}}\n",
        each(&|i| format!(" Part{i}")),
        each(&|i| format!(" Parts{i} : 0..{top}")),
        each(&|i| format!("    internal when rise(Part{i}) then set Parts{i} := Parts{i} + 1\n")),
        each(&|i| format!("  N{i}: never DONE and Parts{i} < {top}\n")),
    )
}

/// So many charts that each wait for a time of their own: 100 ms, 200 ms and so on.
pub fn timers(timers: usize) -> String {
    let each = |text: &dyn Fn(usize) -> String| (0..timers).map(text).collect::<String>();
    let mut m = String::from("machine Timers \"charts that wait\"\ncycle 10ms\n");
    let mut say = |text: String| writeln!(m, "{text}").expect("a string takes it");
    say(format!("inputs {{{} }}", each(&|i| format!(" Go{i}"))));
    say(format!("outputs {{{} }}", each(&|i| format!(" Q{i}"))));
    say(each(&|i| format!("actuator Lamp{i} onoff by Q{i}\n")));
    for i in 0..timers {
        let time = 100 * (i + 1);
        say(format!(
            "chart T{i} {{
  initial state Off
  state Wait
  state On {{ drives Q{i} }}
  from Off to Wait when Go{i}
  from Wait to Off when not Go{i}
  from Wait to On when after {time}ms
  from On to Off when not Go{i}
}}"
        ));
    }
    let property =
        |i: usize| format!("  R{i}: reachable Q{i}\n  P{i}: always possible Q{i}\n  N{i}: never Q{i} and not Go{i}\n");
    say(format!("properties {{\n{}}}", each(&property)));
    m
}

/// One region with so many states in a row, with a step on, a step back and a way to the first one.
pub fn region(states: usize) -> String {
    let last = states - 1;
    let each = |from: usize, text: &dyn Fn(usize) -> String| (from..states).map(text).collect::<String>();
    let state = |i: usize| match i {
        0 => "  initial state S0\n".to_owned(),
        i if i == last => format!("  state S{i} {{ drives LAST }}\n"),
        i => format!("  state S{i}\n"),
    };
    format!(
        "machine Row \"states in a row\"\ncycle 10ms\ninputs {{ Next Back Reset }}\noutputs {{ LAST }}
actuator Lamp onoff by LAST\nchart C {{\n{}{}{}{}}}
properties {{\n  R: reachable LAST\n  P: always possible LAST\n  N: never LAST and rise(Next) and in(S0)\n}}\n",
        each(0, &state),
        each(1, &|i| format!("  from S{} to S{i} when rise(Next)\n", i - 1)),
        each(1, &|i| format!("  from S{i} to S{} when rise(Back)\n", i - 1)),
        each(1, &|i| format!("  from S{i} to S0 when Reset\n")),
    )
}
