//! States that only a transition leads to that can never fire: refused, because the program would have
//! no way to their steps.

use chartwright::base::Code;
use chartwright::pipeline;

/// The codes that are given for a chart of these lines, over a bistable cylinder.
fn codes(head: &str, lines: &str) -> Vec<&'static str> {
    let source = format!(
        "machine M inputs {{ Back Front Start }} outputs {{ GOBACK GO }}
         actuator Cylinder bistable {{ position Rear output GOBACK sensor Back position Ahead output GO sensor Front }}
         chart C {head} {{ {lines} }}"
    );
    let (machine, diagnostics) = pipeline::check(&source);
    assert!(machine.is_none(), "{source}");
    diagnostics.iter().map(|d| d.code.number()).filter(|n| n.starts_with('E')).collect()
}

#[test]
fn by_the_second_of_two_movements_without_a_condition() {
    let found = codes(
        "controls Cylinder",
        "initial state A at Rear  state B at Ahead  state D at Ahead  move from A to B  move from A to D",
    );
    assert!(found.contains(&Code::NeverEntered.number()), "{found:?}");
    assert!(found.contains(&Code::NeverFires.number()), "{found:?}");
}

#[test]
fn by_any_behind_what_always_fires() {
    let found = codes("", "initial state A { drives GO when Start }  state D  from A to A  from any to D when true");
    assert!(found.contains(&Code::NeverEntered.number()), "{found:?}");
}
