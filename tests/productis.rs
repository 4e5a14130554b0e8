//! Productis, and learners who get it wrong: for every constraint of the system filter there is a sequence by which
//! they are stopped, with its explanation and no other. Most are scenarios of the model. The four of `K14` come in pairs:
//! whoever violates one violates the other, or one of `K15`, in the same scan.

use crate::support::models::repository;
use chartwright::ir::chart::{Machine, Mark};
use chartwright::pipeline;
use chartwright::simulate::frame::Layout;
use chartwright::simulate::scenario::play;
use std::collections::BTreeSet;

fn source() -> String {
    std::fs::read_to_string(repository("models/productis.chart")).expect("the model is in the repository")
}

fn machine(source: &str) -> Machine {
    let (machine, found) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{found:#?}"))
}

/// A program that knows no functions: each output by a switch of its own.
fn switches(source: &str) -> String {
    let outputs: Vec<String> = machine(source).outputs.values().map(|o| o.name.clone()).collect();
    let switches: Vec<String> = outputs.iter().map(|o| format!("Wrong{o}")).collect();
    let drives: Vec<String> = outputs.iter().map(|o| format!("drives {o} when Wrong{o}")).collect();
    format!(
        "{source}\ninputs {{ {} }}\nchart Wrong {{ initial state By {{ {} }} state Rest from By to Rest when Ack and Steps and Loaded }}",
        switches.join(" "),
        drives.join(" ")
    )
}

/// What no order of functions can do, with switches: the constraint, why functions cannot, and the steps. `#` is
/// the station.
const SWITCHED: &[(&str, &str, &str)] = &[
    ("K7_#", "F23 and F43 end when the arm is up", "place Vertical# at Down wait 1 scan set WrongGoUp# wait 1s"),
    ("K8_#", "F24 and F44 end when it is down", "set WrongGoDown# wait 1s"),
    ("K9_#", "F22 and F42 end when it is in", "place Horizontal# at Out wait 1 scan set WrongGoIn# wait 1s"),
    ("K10_#", "F21 and F41 end when it is out", "set WrongGoOut# wait 1s"),
    (
        "K15c_#",
        "F24 and F44 go on until the arm is down, and then K11 is first; the sensor still says that it is up",
        "place Horizontal# at Out force Up# wait 1 scan set WrongGoDown# wait 1 scan
         reset WrongGoDown# set WrongGoIn# wait 1 scan",
    ),
    (
        "K15d_#",
        "likewise, with K12",
        "force Up# wait 1 scan set WrongGoDown# wait 1 scan reset WrongGoDown# set WrongGoOut# wait 1 scan",
    ),
    ("K16_#", "F252 and F452 wait until the vacuum is off", "set WrongAspire#, WrongEject# wait 1 scan"),
    ("T1", "F11 turns one way at a time", "force Pallet1 set WrongTurn1P, WrongTurn1M wait 1 scan"),
    ("T3", "F31 turns one way at a time", "force Pallet3 set WrongTurn3P, WrongTurn3M wait 1 scan"),
];

/// Plays the scenarios whose names begin with what stops the machine and a colon, and holds against each what the
/// filter says: that the machine is stopped, and which constraints were first. Returns all of these.
fn stopped_as_said(machine: &Machine) -> BTreeSet<String> {
    let constraints: Vec<&str> = machine.safety.constraints.values().map(|c| c.name.as_str()).collect();
    let mut said = BTreeSet::new();
    for (index, s) in machine.scenarios.iter().enumerate() {
        let Some((names, _)) = s.name.split_once(':') else { continue };
        let names: Vec<&str> = names.split(", ").collect();
        if !constraints.contains(&names[0]) {
            continue;
        }
        for (program, run) in pipeline::programs(machine) {
            let mut last = Vec::new();
            let verdict = play(machine, run, index, &mut |_, frame| last.clone_from(frame));
            assert!(verdict.failure.is_none(), "{} ({program}): {:?}", s.name, verdict.failure);
            let layout = Layout::of(machine);
            let marked = |mark| last[layout.mark(mark)];
            let first = machine.safety.constraints.iter().filter(|(id, _)| marked(Mark::First(*id)));
            let first: Vec<&str> = first.map(|(_, c)| c.name.as_str()).collect();
            assert!(marked(Mark::Noted), "{} ({program}): not stopped", s.name);
            assert_eq!(first, names, "{} ({program})", s.name);
        }
        said.extend(names.into_iter().map(str::to_owned));
    }
    said
}

#[test]
fn every_constraint_has_a_wrong_sequence_that_is_stopped_with_its_explanation() {
    let by_functions = machine(&source());
    let named = stopped_as_said(&by_functions);
    let mut text = switches(&source());
    for (constraint, _, steps) in SWITCHED {
        let stations: &[&str] = if constraint.contains('#') { &["2", "4"] } else { &[""] };
        for station in stations {
            let (constraint, steps) = (constraint.replace('#', station), steps.replace('#', station));
            assert!(!named.contains(&constraint), "functions can violate {constraint}");
            text += &format!("\nscenario \"{constraint}: by switches\" {{ {steps} }}");
        }
    }
    let mut all = stopped_as_said(&machine(&text));
    // The second machine plays the scenarios of the first one, too: nobody touches the switches there.
    all.extend(named.iter().cloned());
    let constraints = || by_functions.safety.constraints.values();
    assert_eq!(all, constraints().map(|c| c.name.clone()).collect());
    assert_eq!(named.len(), 43, "by functions: {named:?}");
    assert!(constraints().all(|c| !c.text.is_empty()), "each has an explanation");
}
