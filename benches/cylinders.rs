//! A row of double-acting cylinders, generated: each may move only while the next one is in.

use std::fmt::Write;

/// The text of a machine with that many double-acting cylinders, their valves with two coils, at any speed: what has to be
/// safe is derived from what the cylinders are.
pub fn row(cylinders: usize) -> String {
    let mut m = String::from("machine Row \"double-acting cylinders in a row\"\ncycle 10ms\ninputs {\n");
    let mut say = |text: String| writeln!(m, "{text}").expect("a string takes it");
    let all = 0..cylinders;
    all.clone().for_each(|k| say(format!("  In{k}  Out{k}  Want{k}")));
    say("}\noutputs {".to_owned());
    all.clone().for_each(|k| say(format!("  Back{k}  Go{k}")));
    say("}".to_owned());
    for k in all.clone() {
        say(format!(
            "actuator Cyl{k} bistable valve memory {{ position Home output Back{k} sensor In{k} position End output Go{k} sensor Out{k} }}"
        ));
    }
    say("chart Row {\n  initial state On {".to_owned());
    all.clone().for_each(|k| say(format!("    drives Go{k} when Want{k}  drives Back{k} when not Want{k}")));
    say("  }\n}\nsafety controller {".to_owned());
    let pairs = all.clone().zip(1..cylinders);
    for (k, next) in pairs.clone() {
        say(format!(
            "  F{k}: forbid Cyl{k} between unless Cyl{next} at Home \"cylinder {k} moves while the next one is in\""
        ));
    }
    say("  derive all\n}\nplant {".to_owned());
    all.for_each(|k| say(format!("  Cyl{k} travels 300ms")));
    say("}\nproperties {".to_owned());
    for (k, next) in pairs {
        say(format!("  HZ{k}: never not In{k} and not Out{k} and not In{next} \"nothing is hit\""));
    }
    say("}".to_owned());
    m
}
