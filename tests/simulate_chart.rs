//! The chart simulator, rule by rule, on machines whose scans can be followed by hand.

use chartwright::ir::chart::Machine;
use chartwright::pipeline;
use chartwright::simulate::chart::Chart;

/// Two outputs and whatever the test adds.
const HEAD: &str = "machine M cycle 10ms inputs { A1 B1 } outputs { Out1 Out2 } variables { V1 : BOOL V2 : BOOL } \
    actuator Act1 onoff by Out1 actuator Act2 onoff by Out2 ";

fn machine(rest: &str) -> Machine {
    let (machine, diagnostics) = pipeline::check(&format!("{HEAD}{rest}"));
    machine.unwrap_or_else(|| panic!("{rest}: {diagnostics:?}"))
}

/// What is TRUE in a scan: active states, variables, outputs, in order of declaration.
fn seen(machine: &Machine, chart: &Chart) -> String {
    let states = machine.states.iter().filter(|(id, _)| chart.is_active(*id)).map(|(_, s)| s.name.as_str());
    let variables = machine.variables.iter().filter(|(id, _)| chart.variable(*id)).map(|(_, v)| v.name.as_str());
    let outputs = machine.outputs.iter().filter(|(id, _)| chart.output(*id)).map(|(_, o)| o.name.as_str());
    states.chain(variables).chain(outputs).collect::<Vec<_>>().join(" ")
}

/// Runs one scan for each word: the inputs that are TRUE, `-` for none.
fn run(rest: &str, inputs: &str) -> Vec<String> {
    let machine = machine(rest);
    let mut chart = Chart::new(&machine);
    let scans = inputs.split(' ').map(|now| {
        chart.scan(&[now.contains('a'), now.contains('b')]);
        seen(&machine, &chart)
    });
    scans.collect()
}

#[track_caller]
fn assert_run(rest: &str, inputs: &str, wanted: &[&str]) {
    assert_eq!(run(rest, inputs), wanted, "{rest}");
}

#[test]
fn the_first_scan_enters_initial_states_and_takes_no_transition() {
    let chart = "chart C { initial state P { drives Out1 } state Q from P to Q when A1 from Q to P when prev(Out2) }";
    assert_run(chart, "a a", &["P Out1", "Q"]);
}

#[test]
fn what_has_no_past_has_no_edge() {
    let chart = "chart C { initial state P { drives Out1 when rise(A1) drives Out2 when prev(A1) } }";
    assert_run(chart, "a a - a", &["P Out2", "P Out2", "P Out2", "P Out1"]);
}

#[test]
fn the_past_of_an_output_is_what_the_filter_let_through() {
    let chart = "chart C { initial state P { drives Out1 drives Out2 when prev(Out1) } } \
        safety supervisor { S1: never Out1 and A1 }";
    assert_run(chart, "a - - a -", &["P", "P Out1", "P Out1 Out2", "P Out2", "P Out1"]);
}

#[test]
fn guards_read_what_was_before_the_step() {
    // Each chart asks for the other one; both change places at once.
    let charts = "chart C { initial state P state Q from P to Q when in(R) from Q to P when in(S) } \
        chart D { initial state R state S from R to S when in(P) from S to R when in(Q) }";
    assert_run(charts, "- - -", &["P R", "Q S", "P R"]);
    let variable = "chart C { initial state P state Q state R \
        from P to Q then set V1 from Q to R when V1 from R to R when A1 and not V1 } \
        chart D { initial state S state T from S to T when V1 }";
    assert_run(variable, "- - -", &["P S", "Q S V1", "R T V1"]);
}

#[test]
fn an_outer_scope_comes_first() {
    let chart = "chart C { \
        initial state P { initial state Q state R from Q to R when A1 } state S \
        from P to S when B1 from S to P when A1 }";
    assert_run(chart, "- a - b ab ab", &["P Q", "P R", "P R", "S", "P Q", "S"]);
}

#[test]
fn in_a_scope_the_outermost_source_comes_first_then_priority_then_the_text() {
    let chart = "chart C { \
        initial state P { initial state Q state R from Q to R when B1 and not A1 } \
        state S state T state U \
        from Q to S priority 1 when A1 \
        from P to T when A1 and B1 \
        from R to S when A1 \
        from R to U priority 2 when A1 \
        from S to T when A1 from S to U when A1 or B1 from T to P when B1 from U to P when B1 }";
    assert_run(chart, "- ab", &["P Q", "T"]);
    assert_run(chart, "- a", &["P Q", "S"]);
    assert_run(chart, "- b a", &["P Q", "P R", "U"]);
    assert_run(chart, "- a a", &["P Q", "S", "T"]);
}

#[test]
fn regions_side_by_side_each_take_a_step() {
    let chart = "chart C { initial parallel state P { \
        region X { initial state Q state R from Q to R when A1 then set V1 } \
        region Y { initial state S state T from S to T when A1 then set V2 } } }";
    assert_run(chart, "- a", &["P Q S", "P R T V1 V2"]);
}

#[test]
fn entering_takes_initial_states_but_on_the_way_to_the_target() {
    let chart = "chart C { initial state I parallel state P { \
        region X { initial state Q state R { initial state R1 state R2 from R1 to R2 when A1 and B1 from R2 to R1 when V1 } from Q to R when A1 and B1 } \
        region Y { initial state S state T from S to T when A1 and B1 } } \
        from I to P when B1 from I to R2 when A1 from P to I when not A1 and not B1 \
        from P to R when prev(Out1) }";
    assert_run(chart, "- a ab - b ab", &["I", "P R R2 S", "P R R2 T", "I", "P Q S", "P R R1 T"]);
}

#[test]
fn source_and_target_in_one_state_leave_and_enter_it() {
    let chart = "chart C { initial parallel state P { drives Out1 \
        region X { initial state Q state R from Q to R when A1 } \
        region Y { initial state S state T from S to T when A1 } } \
        from P to R when B1 }";
    // R is named, so it is entered; Y is not, so it starts anew.
    assert_run(chart, "- a b", &["P Q S Out1", "P R T Out1", "P R S Out1"]);
}

#[test]
fn effects_come_before_sets_and_sets_before_resets() {
    let chart = "chart C { initial state P { sets V1 when A1 resets V1 when B1 } state Q { sets V2 when V1 resets V1 } \
        from P to Q when A1 and B1 then set V1 from Q to P when B1 }";
    // In Q, the effect's V1 is seen by the condition of `sets V2`; the reset comes last.
    assert_run(chart, "- a b a ab", &["P", "P V1", "P", "P V1", "Q V2"]);
}

#[test]
fn conditions_of_actions_do_not_see_other_actions_but_drives_do() {
    let chart =
        "chart C { initial state P { sets V1 when A1 sets V2 when V1 drives Out1 when V1 drives Out2 when V2 } }";
    assert_run(chart, "- a a", &["P", "P V1 Out1", "P V1 V2 Out1 Out2"]);
}

#[test]
fn done_asks_for_a_final_state_in_each_region() {
    let chart = "chart C { initial parallel state P { \
        region X { initial state Q final state R from Q to R when A1 } \
        region Y { initial state S final state T from S to T when B1 } } \
        state U { drives Out1 } from P to U }";
    assert_run(chart, "- a - b -", &["P Q S", "P R S", "P R S", "P R T", "U Out1"]);
}

#[test]
fn time_counts_from_the_first_scan_that_began_in_the_state() {
    // Entered in the first scan: TRUE from the fourth on.
    let chart = "chart C { initial state P state Q from P to Q when after 20ms from Q to P when A1 }";
    assert_run(chart, "- - - -", &["P", "P", "P", "Q"]);
    // Not a whole number of cycles: rounded up.
    let chart = "chart C { initial state P state Q from P to Q when after 11ms from Q to P when A1 }";
    assert_run(chart, "- - - -", &["P", "P", "P", "Q"]);
    // Entering again starts anew, even in one scan.
    let chart =
        "chart C { initial state P state Q from P to P when A1 from P to Q when after 10ms from Q to P when A1 }";
    assert_run(chart, "- - a - -", &["P", "P", "P", "P", "Q"]);
}

#[test]
fn forcings_beat_commands_and_are_reported() {
    let machine = machine(
        "chart C { initial state P { drives Out1 when A1 } } \
        safety supervisor { S1: never Out1 and B1 S2: never not Out2 and B1 assume X1: never A1 and B1 }",
    );
    let mut chart = Chart::new(&machine);
    let [s1, s2] = machine.safety.constraints.ids().collect::<Vec<_>>()[..] else { panic!() };
    chart.scan(&[true, false]);
    assert_eq!(seen(&machine, &chart), "P Out1");
    assert!(!chart.acted(s1) && !chart.acted(s2) && !chart.broken(0));
    chart.scan(&[false, true]);
    assert_eq!(seen(&machine, &chart), "P Out2");
    assert!(!chart.acted(s1) && chart.acted(s2), "only what changes a command acts");
    chart.scan(&[true, true]);
    assert_eq!(seen(&machine, &chart), "P Out2");
    assert!(chart.acted(s1) && chart.acted(s2) && chart.broken(0) && !chart.filter_failed());
}

#[test]
fn reliefs_stay_once_they_have_worked() {
    // Method 4, defect 2: the published loop swings here for ever.
    let machine = machine(
        "inputs { C1 } outputs { Out3 } actuator Act3 onoff by Out3 \
        chart C { initial state P { drives Out1 drives Out2 drives Out3 } } \
        safety supervisor { K1: never Out1 and Out2 yields Out2 K2: never not Out2 and Out3 yields Out3 }",
    );
    let mut chart = Chart::new(&machine);
    chart.scan(&[false, false, false]);
    assert_eq!(seen(&machine, &chart), "P Out1");
    assert_eq!(chart.filter_rounds(), 3);
    assert!(!chart.filter_failed());
}

#[test]
fn a_filter_without_a_way_says_so() {
    let machine = machine(
        "chart C { initial state P } \
        safety supervisor { S1: never Out1 and A1 S2: never not Out1 and B1 assume X1: never A1 and B1 }",
    );
    let mut chart = Chart::new(&machine);
    chart.scan(&[true, true]);
    assert!(chart.filter_failed() && chart.broken(0));
    chart.scan(&[true, false]);
    assert!(!chart.filter_failed() && !chart.broken(0));
}

#[test]
fn a_machine_may_have_more_signals_than_fit_into_a_word() {
    let list = |name: &str, n: usize| (0..n).map(|i| format!("{name}{i} ")).collect::<String>();
    let actuators: String = (0..70).map(|i| format!("actuator Act{i} onoff by Out{i} ")).collect();
    let drives: String = (0..70).map(|i| format!("drives Out{i} when In{i} ")).collect();
    let states: String = (0..130).map(|i| format!("state S{i} from P to S{i} priority {i} when In69 ")).collect();
    let source = format!(
        "machine M inputs {{ {} }} outputs {{ {} }} {actuators} chart C {{ initial state P {{ {drives} }} {states} }}",
        list("In", 70),
        list("Out", 70)
    );
    let machine = pipeline::check(&source).0.expect("it is valid");
    let mut chart = Chart::new(&machine);
    for i in 0..69 {
        let inputs: Vec<bool> = (0..70).map(|k| k == i).collect();
        chart.scan(&inputs);
        let on: Vec<usize> = machine.outputs.ids().filter(|&o| chart.output(o)).map(|o| o.index()).collect();
        assert_eq!(on, [i]);
    }
    chart.scan(&[true; 70]);
    let active: Vec<&str> = chart.active().map(|s| machine.states[s].name.as_str()).collect();
    assert_eq!(active, ["S0"]);
}
