//! A size to a model of that many states: a line of equal cells, for benchmarks and for tests that
//! need something large.
//!
//! A cell has an emergency stop, four actuators that work side by side (two bistable, one
//! monostable, one on/off), a few simple and combined constraints. Cells stand in areas of 25 that
//! run side by side, so the hierarchy is five levels deep whatever the size.

use std::fmt::Write;

/// States of one cell, all kinds counted.
pub const CELL_STATES: usize = 22;

/// Cells of one area.
const AREA: usize = 25;

/// The source of a model with at least `states` states.
pub fn model(states: usize) -> String {
    let cells = states.div_ceil(CELL_STATES).max(2);
    let mut out = String::from("machine Line \"a generated line of cells\"\ncycle 10ms\n");
    out.push_str("inputs {\n  Safe at %IX0.0 \"nobody is near\"\n  Power at %IX0.1 \"power button\"\n");
    for k in 0..cells {
        writeln!(out, "  Go{k}  A{k}in  A{k}out  B{k}in  B{k}out  C{k}in  C{k}out  Part{k}").unwrap();
    }
    out.push_str("}\noutputs {\n");
    for k in 0..cells {
        writeln!(out, "  A{k}back  A{k}go  B{k}back  B{k}go  C{k}go  D{k}on").unwrap();
    }
    out.push_str("}\n");
    for k in 0..cells {
        writeln!(
            out,
            "actuator A{k} bistable {{ position In output A{k}back sensor A{k}in position Out output A{k}go sensor A{k}out }}
actuator B{k} bistable {{ position In output B{k}back sensor B{k}in position Out output B{k}go sensor B{k}out }}
actuator C{k} monostable {{ position In sensor C{k}in position Out output C{k}go sensor C{k}out }}
actuator D{k} onoff by D{k}on"
        )
        .unwrap();
    }
    out.push_str("chart Line {\n  initial parallel state Areas {\n");
    for (area, first) in (0..cells).step_by(AREA).enumerate() {
        let last = (first + AREA).min(cells);
        writeln!(out, "    region Area{area} {{\n      initial parallel state Cells {{").unwrap();
        (first..last).for_each(|k| cell(&mut out, k));
        if last - first == 1 {
            out.push_str("        region Beside { initial state Idle }\n");
        }
        out.push_str("      }\n    }\n");
    }
    if cells <= AREA {
        out.push_str("    region Beside { initial state Idle }\n");
    }
    out.push_str("  }\n}\nsafety supervisor {\n");
    for k in 0..cells {
        writeln!(
            out,
            "  Gate{k}: never A{k}go and not B{k}in \"A{k} leaves only when B{k} is in\"
  Apart{k}: never rise(A{k}go) and B{k}go yields A{k}go \"A{k} and B{k} do not start together\"
  Held{k}: never rise(C{k}go) and D{k}on yields C{k}go"
        )
        .unwrap();
    }
    out.push_str("}\n");
    out
}

fn cell(out: &mut String, k: usize) {
    writeln!(
        out,
        "        region Cell{k} {{
          from any to Off when not Safe
          initial state Off
          state On {{
            initial state Ready
            from Ready to Work when rise(Go{k})
            from Work to Ready
            parallel state Work {{
              region A controls A{k} {{
                initial state In
                state Out
                final state Back at In
                move from In to Out when B{k}in
                move from Out to Back when done(Work) or C{k}out
              }}
              region B controls B{k} {{
                initial state In
                state Out
                final state Back at In
                move from In to Out when in(Work.A.Back)
                move from Out to Back
              }}
              region C controls C{k} {{
                initial state In
                state Out
                final state Back at In
                move from In to Out when in(Work.A.Out)
                move from Out to Back when in(Work.B.Back)
              }}
              region D controls D{k} {{
                initial state Off
                state On
                final state Empty at Off
                from Off to On when Part{k}
                from On to Empty when fall(Part{k})
              }}
            }}
          }}
          from Off to On when Safe and rise(Power)
        }}"
    )
    .unwrap();
}
