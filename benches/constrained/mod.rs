//! A number of outputs to a model with four times as many constraints, for benchmarks.

use std::fmt::Write;

/// Outputs of one group.
const GROUP: usize = 10;

/// The source of a model with that many outputs, a multiple of ten, and four constraints for each: it is
/// forbidden, it is held, it needs its neighbour, it keeps away from another one. What an output needs sets
/// off a chain through its group.
pub fn model(outputs: usize) -> String {
    let mut out = String::from("machine Plant \"a generated set of constraints\"\ncycle 10ms\ninputs {\n");
    for k in 0..outputs {
        writeln!(out, "  Ask{k}  Free{k}  Busy{k}").unwrap();
    }
    (0..outputs / GROUP).for_each(|g| writeln!(out, "  Door{g}  Zone{g}").unwrap());
    out.push_str("}\noutputs {\n");
    (0..outputs).for_each(|k| writeln!(out, "  O{k}").unwrap());
    out.push_str("}\n");
    (0..outputs).for_each(|k| writeln!(out, "actuator A{k} onoff by O{k}").unwrap());
    out.push_str("chart Plant {\n  initial state On {\n");
    (0..outputs).for_each(|k| writeln!(out, "    drives O{k} when Ask{k}").unwrap());
    out.push_str("  }\n}\nsafety supervisor {\n");
    for k in 0..outputs {
        let (group, place) = (k / GROUP, k % GROUP);
        let need = match place + 1 < GROUP {
            true => format!("not O{} yields O{k}", k + 1),
            false => format!("not Door{group}"),
        };
        let apart = match place + 2 < GROUP {
            true => format!("O{} and Zone{group} yields O{k}", k + 2),
            false => format!("Zone{group}"),
        };
        writeln!(
            out,
            "  Ban{k}: never O{k} and not Free{k}
  Hold{k}: never fall(O{k}) and Busy{k} and Free{k}
  Need{k}: never rise(O{k}) and {need}
  Apart{k}: never rise(O{k}) and {apart}"
        )
        .unwrap();
    }
    out.push_str("}\n");
    out
}
