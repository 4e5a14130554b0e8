//! The palletizer for a long time: every pallet has exactly three layers, and nothing breaks, at one speed and at speeds
//! that change by chance.
//!
//! `CHARTWRIGHT_CHANCE_SCANS=1200000 cargo test palletizer` makes long runs of it.

use crate::support::models::{self, timed};
use crate::support::rng::Rng;
use chartwright::ir::chart::Machine;
use chartwright::ir::scenario::{Condition, Doing, Given, PropertyKind};
use chartwright::pipeline;
use chartwright::simulate::run::{Program, Run};

fn machine(source: &str) -> Machine {
    let (machine, found) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{found:#?}"))
}

/// Runs for so many scans; returns how many pallets have left with three layers, or the hazard that ended it.
fn pallets(machine: &Machine, scans: u64) -> Result<usize, String> {
    let watched = machine.scenarios[0].steps.iter().filter_map(|step| match &step.doing {
        Doing::Watch(condition, false) => Some((step.text.as_str(), condition)),
        _ => None,
    });
    let hazards: Vec<(&str, &Condition)> = watched.collect();
    assert!(hazards.len() > 5, "the first scenario says what must not happen");
    let input = |name: &str| machine.inputs.iter().find(|(_, i)| i.name == name).map(|(id, _)| Given::Input(id));
    let (good, _) = machine.plant.bits.iter().find(|(_, b)| b.name == "Good").expect("the plant counts pallets");
    let mut run = Run::new(machine, Program::chart(machine));
    let mut count = 0;
    for scan in 0..scans {
        run.plant().set(input("Start").expect("there is a button"), scan == 40);
        run.scan();
        if let Some((text, condition)) = hazards.iter().find(|(_, condition)| run.holds(condition)) {
            return Err(format!("scan {}: {text}: {:?}", run.scans(), run.values(condition)));
        }
        count += usize::from(run.frame()[run.layout().place(Given::Bit(good))]);
    }
    Ok(count)
}

fn source() -> String {
    timed("palletizer")
}

#[test]
fn every_pallet_has_three_layers() {
    let scans: u64 = std::env::var("CHARTWRIGHT_CHANCE_SCANS").ok().and_then(|n| n.parse().ok()).unwrap_or(60_000);
    let count = pallets(&machine(&source()), scans).unwrap_or_else(|hazard| panic!("{hazard}"));
    println!("{count} pallets in {scans} scans");
    assert!(count as u64 > scans / 700, "{count} pallets in {scans} scans");
}

#[test]
fn without_its_constraint_the_case_lift_moves_under_the_ejector() {
    let source = source();
    let without: Vec<&str> = source.lines().filter(|l| !l.trim_start().starts_with("S1:")).collect();
    assert_eq!(without.len() + 1, source.lines().count());
    let hazard = pallets(&machine(&without.join("\n")), 20_000).expect_err("S1 is needed");
    assert!(hazard.contains("the ejector is in while the case lift moves"), "{hazard}");
}

/// The same with the plant of the model, in which any step may take any time, and with a stop button that is pushed now
/// and then.
fn pallets_by_chance(machine: &Machine, seed: u64, scans: u64) -> Result<usize, String> {
    let scenario = &machine.scenarios[0];
    let watched = scenario.steps.iter().filter_map(|step| match &step.doing {
        Doing::Watch(condition, false) => Some((step.text.as_str(), condition)),
        _ => None,
    });
    let declared = machine.properties.iter().filter(|p| p.kind == PropertyKind::Never);
    let hazards: Vec<(&str, &Condition)> = watched.chain(declared.map(|p| (p.text.as_str(), &p.condition))).collect();
    assert!(hazards.iter().any(|(text, _)| *text == "every pallet has three layers"), "{hazards:?}");
    let input =
        |name: &str| machine.inputs.iter().find(|(_, i)| i.name == name).map(|(id, _)| id).expect("it is there");
    let (start, stop, leaves) = (input("Start"), input("Stop"), input("C8"));
    let mut run = Run::new(machine, Program::chart(machine));
    run.plant().leave_to_chance(machine, seed);
    let mut rng = Rng::new(seed);
    let (mut count, mut left) = (0, false);
    for scan in 0..scans {
        run.plant().set(Given::Input(start), scan % 50 == 40);
        run.plant().set(Given::Input(stop), rng.below(2_000) > 0);
        run.scan();
        if let Some((text, condition)) = hazards.iter().find(|(_, condition)| run.holds(condition)) {
            return Err(format!("seed {seed}, scan {}: {text}: {:?}", run.scans(), run.values(condition)));
        }
        let leaving = run.input(leaves);
        count += usize::from(leaving && !left);
        left = leaving;
    }
    Ok(count)
}

fn model() -> String {
    models::all().into_iter().find(|m| m.name == "palletizer").expect("the model is there").source
}

#[test]
fn every_pallet_has_three_layers_at_speeds_by_chance() {
    let scans: u64 = std::env::var("CHARTWRIGHT_CHANCE_SCANS").ok().and_then(|n| n.parse().ok()).unwrap_or(60_000);
    let machine = machine(&model());
    let each = (0..6).map(|seed| pallets_by_chance(&machine, seed, scans / 6));
    let counts: Vec<usize> = each.map(|count| count.unwrap_or_else(|hazard| panic!("{hazard}"))).collect();
    println!("{counts:?} pallets in {} scans each", scans / 6);
    assert!(counts.iter().all(|&count| count as u64 > scans / 6 / 500), "{counts:?} pallets in {scans} scans");
}

#[test]
fn without_its_layers_it_breaks_at_some_speed() {
    // A fourth layer is refused by this one alone.
    let source = model();
    let without: Vec<&str> = source.lines().filter(|l| !l.trim_start().starts_with("S14:")).collect();
    assert_eq!(without.len() + 1, source.lines().count());
    let machine = machine(&without.join("\n"));
    // The charts ask for it whenever two cases wait.
    let found = (0..6).find_map(|seed| pallets_by_chance(&machine, seed, 10_000).err());
    let hazard = found.expect("S14 is needed");
    assert!(hazard.contains("no fourth layer") || hazard.contains("nothing is damaged"), "{hazard}");
}
