//! What a proof takes the latches of a program for, and what it calls them.

use crate::support::models;
use crate::support::proof::build;
use chartwright::bits::aig::Aig;
use chartwright::emit::Dialect::Beremiz;
use chartwright::ir::chart::ScanNumber;
use chartwright::prove::chart_step::ChartStep;
use chartwright::prove::configuration;
use chartwright::prove::parts::{Meaning, Part, said};
use std::collections::BTreeSet;

#[test]
fn the_opposite_of_a_meaning_is_its_opposite() {
    let (mut kinds, mut count) = (BTreeSet::new(), 0);
    for model in models::all() {
        let machine = build(&model.source, Beremiz).unwrap_or_else(|e| panic!("{}: {e}", model.name)).machine;
        let chart = ChartStep::new(&machine, 1);
        let mut graph = Aig::new();
        let state = configuration::any(&mut graph, &machine, &chart);
        let mut meanings = Meaning::all(&machine);
        meanings.extend([Meaning::Constant(true), Meaning::Constant(false)]);
        meanings.extend(machine.states.ids().filter(|&s| chart.remembers(s)).map(|s| Meaning::Last(s, true)));
        let mut names = BTreeSet::new();
        for meaning in meanings {
            let opposite = meaning.opposite();
            assert_ne!(meaning, opposite);
            assert_eq!(opposite.opposite(), meaning);
            assert_eq!(opposite.of(&state), !meaning.of(&state), "{}: {}", model.name, meaning.describe(&machine));
            let name = meaning.describe(&machine);
            assert!(!name.is_empty() && names.insert(name.clone()), "{}: {name}", model.name);
            match meaning {
                Meaning::Constant(value) => assert_eq!(name, if value { "TRUE" } else { "FALSE" }),
                _ => assert_eq!(opposite.describe(&machine), format!("not {name}")),
            }
            kinds.insert(format!("{meaning:?}").split('(').next().unwrap_or_default().to_owned());
            count += 1;
        }
    }
    let expected = ["Active", "Bit", "Constant", "Input", "Last", "Mark", "Output", "Raised", "Scan", "Variable"];
    assert_eq!(kinds.iter().collect::<Vec<_>>(), expected);
    assert!(count > 1000, "only {count}");
}

#[test]
fn what_is_compared_has_the_names_of_the_model() {
    let source = "machine M\ncycle 10ms\ninputs { I }\noutputs { O }\nvariables { V : BOOL V2 : 0..3 }\n\
        actuator A onoff by O\nchart C { initial state X { drives O } state Y\n\
        from X to Y when I and V2 < 3 then set V2 := V2 + 1\nfrom Y to X when not I then set V }\n";
    let machine = build(source, Beremiz).unwrap_or_else(|e| panic!("{e}")).machine;
    let state = machine.states.ids().next().expect("a state");
    let input = machine.inputs.ids().next().expect("an input");
    let output = machine.outputs.ids().next().expect("an output");
    let variable = machine.variables.ids().next().expect("a variable");
    let integer = machine.integers.ids().next().expect("an integer");
    for (part, name, remembered) in [
        (Part::Flag(state), "state X", Some(Meaning::Active(state, true))),
        (Part::Step(state), "state X", Some(Meaning::Active(state, true))),
        (Part::Input(input), "input I", Some(Meaning::Input(input, true))),
        (Part::Output(output), "output O", Some(Meaning::Output(output, true))),
        (Part::Command(output), "command of O", None),
        (Part::Variable(variable), "variable V", Some(Meaning::Variable(variable, true))),
        (Part::Bit(integer, 1), "bit 1 of integer V2", Some(Meaning::Bit(integer, 1, true))),
    ] {
        assert_eq!(part.describe(&machine), name);
        assert_eq!(part.remembered(), remembered);
    }
    assert_eq!(said(ScanNumber::This), "the number of the scan");
    assert_eq!(said(ScanNumber::First), "the number of the first scan that is noted");
    let part = Part::Scan(ScanNumber::This, 4);
    assert_eq!(part.describe(&machine), "bit 4 of the number of the scan");
}
