//! Productis, and learners who get it wrong: for every constraint of the system filter there is something that
//! they can do to be stopped by it.

use crate::support::models::repository;
use crate::support::rng::Rng;
use chartwright::ir::chart::{ConstraintId, Machine, Mark};
use chartwright::ir::scenario::Given;
use chartwright::pipeline;
use chartwright::simulate::run::{Program, Run};
use std::collections::BTreeSet;

fn source() -> String {
    std::fs::read_to_string(repository("models/productis.chart")).expect("the model is in the repository")
}

fn machine(source: &str) -> Machine {
    let (machine, found) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{found:#?}"))
}

/// Pushes buttons by chance, and acknowledges each stop; the constraints that were first at one of them.
fn stopped_by(machine: &Machine, buttons: &str, seed: u64) -> BTreeSet<ConstraintId> {
    let mut rng = Rng::new(seed);
    let named = |i: &str| machine.inputs.iter().find(|(_, input)| input.name == i).map(|(id, _)| id);
    let all: Vec<_> = machine.inputs.iter().filter(|(_, i)| i.name.starts_with(buttons)).map(|(id, _)| id).collect();
    // Few at a time and neighbours, or the same constraints would always be first.
    let from = rng.below(all.len());
    let few: Vec<_> = (0..rng.between(1, 4)).map(|_| all[(from + rng.below(6)) % all.len()]).collect();
    let mut run = Run::new(machine, Program::chart(machine));
    run.plant().set(Given::Input(named("Steps").expect("Productis has it")), true);
    let pallets = ["Pallet1", "Pallet2", "Pallet3", "Pallet4"].map(|p| named(p).expect("Productis has it"));
    let percent = rng.between(2, 15);
    for pallet in pallets {
        run.plant().force(pallet, Some(rng.chance(50)));
    }
    let ack = named("Ack").expect("Productis has it");
    let mut found = BTreeSet::new();
    for _ in 0..600 {
        for &button in &few {
            if rng.chance(percent) {
                let now = run.given()[button.index()];
                run.plant().set(Given::Input(button), !now);
            }
        }
        if rng.chance(2) {
            let there = rng.chance(50);
            run.plant().force(*rng.pick(&pallets), Some(there));
        }
        run.scan();
        let marked = |mark| run.frame()[run.layout().mark(mark)];
        found.extend(machine.safety.constraints.ids().filter(|&c| marked(Mark::First(c))));
        let stopped = marked(Mark::Noted);
        run.plant().set(Given::Input(ack), stopped && rng.chance(10));
    }
    found
}

/// The constraints that stop the machine first in one of so many attempts.
fn stops(machine: &Machine, buttons: &str, attempts: u64) -> BTreeSet<String> {
    let first = (0..attempts).flat_map(|seed| stopped_by(machine, buttons, seed));
    first.map(|c| machine.safety.constraints[c].name.clone()).collect()
}

#[test]
fn every_constraint_stops_a_learner_who_commands_outputs_himself() {
    // A program that knows no functions: each output by a switch of its own.
    let source = source();
    let outputs: Vec<String> = machine(&source).outputs.values().map(|o| o.name.clone()).collect();
    let switches: Vec<String> = outputs.iter().map(|o| format!("Wrong{o}")).collect();
    let drives: Vec<String> = outputs.iter().map(|o| format!("drives {o} when Wrong{o}")).collect();
    let wrong = format!(
        "{source}\ninputs {{ {} }}\nchart Wrong {{ initial state By {{ {} }} state Rest from By to Rest when Ack and Steps and Loaded }}",
        switches.join(" "),
        drives.join(" ")
    );
    let machine = machine(&wrong);
    let stops = stops(&machine, "Wrong", 2000);
    let missed: Vec<&str> =
        machine.safety.constraints.values().map(|c| c.name.as_str()).filter(|c| !stops.contains(*c)).collect();
    assert!(missed.is_empty(), "nothing was stopped by {missed:?}");
    assert!(machine.safety.constraints.values().all(|c| !c.text.is_empty()), "each has an explanation");
}

#[test]
fn wrong_orders_of_functions_are_stopped() {
    let stops = stops(&machine(&source()), "Ask", 1500);
    println!("{} constraints stop wrong orders of functions: {stops:?}", stops.len());
    for name in ["K3_2", "K4_2", "K5_2", "K6_2", "K11_2", "K12_2", "K17_2", "K3_4", "K11_4", "K12_4", "K17_4", "T1P"] {
        assert!(stops.contains(name), "nothing was stopped by `{name}`: {stops:?}");
    }
}
