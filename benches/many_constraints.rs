//! A machine with many outputs and constraints, generated: half of the constraints simple, half combined.

use std::fmt::Write;

/// The text of a machine with that many outputs and constraints. Every output is only ever forced off, so the
/// constraints are coherent; reliefs set each other off in long chains.
pub fn many(outputs: usize, constraints: usize) -> String {
    let mut m = String::from("machine Many\ncycle 10ms\ninputs {");
    let inputs = outputs / 2;
    (0..inputs).for_each(|i| write!(m, " I{i}").expect("a string takes it"));
    m.push_str(" }\noutputs {");
    (0..outputs).for_each(|o| write!(m, " O{o}").expect("a string takes it"));
    m.push_str(" }\n");
    (0..outputs).for_each(|o| writeln!(m, "actuator A{o} onoff by O{o}").expect("a string takes it"));
    m.push_str("chart Many {\n  initial state On {\n");
    (0..outputs).for_each(|o| writeln!(m, "    drives O{o} when I{}", o % inputs).expect("a string takes it"));
    m.push_str("  }\n}\nsafety supervisor {\n");
    // A fixed sequence that looks like chance (Knuth, MMIX).
    let mut state = 1u64;
    let mut pick = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for c in 0..constraints {
        let (a, x) = (pick(outputs), pick(inputs));
        let y = (x + 1 + pick(inputs - 1)) % inputs;
        let not = if pick(2) == 0 { "not " } else { "" };
        // The one that yields comes later than the other, so that no cycle arises.
        let later = a + 1 + pick(20);
        let text = match pick(4) {
            0 => format!("never O{a} and {not}I{x}"),
            1 => format!("never rise(O{a}) and {not}I{x} and prev(O{})", pick(outputs)),
            2 if later < outputs => format!("never {not}O{a} and O{later} and I{x} yields O{later}"),
            _ if later < outputs => format!("never O{a} and O{later} and rise(I{x}) and not I{y} yields O{later}"),
            _ => format!("never O{a} and I{x} and {not}I{y}"),
        };
        writeln!(m, "  C{c}: {text}").expect("a string takes it");
    }
    m.push_str("}\n");
    m
}
