//! The palletizer for a long time: every pallet has exactly three layers, and nothing breaks.
//!
//! `CHARTWRIGHT_CHANCE_SCANS=1200000 cargo test palletizer` makes a long run of it.

use crate::support::models::timed;
use chartwright::ir::chart::Machine;
use chartwright::ir::scenario::{Condition, Doing, Given};
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
