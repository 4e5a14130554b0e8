//! INDEXA with an operator who pushes anything at any time, and guards that open when they like.
//!
//! `CHARTWRIGHT_CHANCE_SCANS=1000000 cargo test indexa_by_chance` makes a long run of it.

use crate::support::models::repository;
use crate::support::rng::Rng;
use chartwright::ir::chart::{InputId, Machine};
use chartwright::ir::expr::Expr;
use chartwright::ir::scenario::{Condition, Doing, Given, Seen};
use chartwright::pipeline;
use chartwright::simulate::run::{Program, Run};

/// What must not happen to the machine, whoever commands it.
const HAZARDS: &str = r#"
scenario "hazards" {
  never not V0 and not H0 and not H1 "the head moves sideways and is not up"
  never not TI and not V0 and not H0 "the head is in the way of the table"
  never not TI and not F0 "the jar is held while the table turns"
  never CMR and not TI "the conveyor runs while the table turns"
  never fall(ASON) and not V1 and ENP and prev(ENP) "a lid is dropped while there is energy"
  never (not ES or not PG) and (OHC or IHC or OVC or IVC or ROT or ASP or OFC or PMR or CMR or KEN) "an output is on without permission"
  never not ENP and (OHC or IHC or OVC or IVC or ROT or ASP or OFC or PMR or CMR) "an output is on without energy"
}
"#;

fn indexa() -> Machine {
    let source = std::fs::read_to_string(repository("models/indexa.chart")).expect("the model is in the repository");
    let (machine, found) = pipeline::check(&format!("{source}{HAZARDS}"));
    machine.unwrap_or_else(|| panic!("{found:#?}"))
}

/// The hazards, and that a constraint does not hold, each with its text.
fn forbidden(machine: &Machine) -> Vec<(String, Condition)> {
    let scenario = machine.scenarios.last().expect("the hazards are a scenario");
    let hazards = scenario.steps.iter().map(|step| match &step.doing {
        Doing::Watch(condition, false) => (step.text.clone(), condition.clone()),
        other => panic!("{other:?}"),
    });
    let constraints = machine
        .safety
        .constraints
        .values()
        .map(|c| (c.name.clone(), c.never.map(&mut |a| Expr::Atom(Seen::Machine(*a)))));
    hazards.chain(constraints).collect()
}

/// Who pushes what: every so many scans each of these changes.
struct Operator {
    rng: Rng,
    habits: Vec<(InputId, usize, usize)>,
}

impl Operator {
    fn new(machine: &Machine, seed: u64) -> Operator {
        let mut habits = Vec::new();
        // Each name with the chance in a thousand that it comes, and that it goes.
        let rates = [
            (&["MH", "MV", "MR", "MA", "MF", "MT", "MC"][..], 30, 200),
            (&["PBE", "PBI", "START"][..], 20, 200),
            (&["SAUTO", "STOP"][..], 2, 10),
            (&["CW"][..], 100, 10),
            (&["ES", "PG"][..], 50, 1),
        ];
        for (names, comes, goes) in rates {
            for name in names {
                let (id, _) = machine.inputs.iter().find(|(_, i)| i.name == *name).expect("INDEXA has it");
                habits.push((id, comes, goes));
            }
        }
        Operator { rng: Rng::new(seed), habits }
    }

    fn act(&mut self, run: &mut Run<'_>) {
        for &(input, comes, goes) in &self.habits {
            let now = run.given()[input.index()];
            if self.rng.below(1000) < if now { goes } else { comes } {
                run.plant().set(Given::Input(input), !now);
            }
        }
    }
}

/// Runs the machine for so many scans in all; the first thing that is forbidden and happens ends it.
fn chance(machine: &Machine, forbidden: &[(String, Condition)], scans: u64) -> Result<Course, String> {
    let mut found = Course { seen: vec![false; machine.states.len()], corrected: 0 };
    for seed in 0..4 {
        let mut operator = Operator::new(machine, seed);
        let mut run = Run::new(machine, Program::chart(machine));
        for _ in 0..scans / 4 {
            operator.act(&mut run);
            run.scan();
            if let Some((text, condition)) = forbidden.iter().find(|(_, condition)| run.holds(condition)) {
                return Err(format!("seed {seed}, scan {}: {text}: {:?}", run.scans(), run.values(condition)));
            }
            let frame = run.frame();
            machine.states.ids().for_each(|s| found.seen[s.index()] |= frame[run.layout().state(s)]);
            found.corrected += u64::from(machine.safety.constraints.ids().any(|c| frame[run.layout().acted(c)]));
        }
    }
    Ok(found)
}

/// What a run without hazards has come across.
struct Course {
    /// For each state, whether it was active.
    seen: Vec<bool>,
    /// In how many scans the filter had to act.
    corrected: u64,
}

#[test]
fn no_hazard_whatever_the_operator_does() {
    let scans: u64 = std::env::var("CHARTWRIGHT_CHANCE_SCANS").ok().and_then(|n| n.parse().ok()).unwrap_or(40_000);
    let machine = indexa();
    let course = chance(&machine, &forbidden(&machine), scans).unwrap_or_else(|hazard| panic!("{hazard}"));
    // It has been everywhere, and the filter has had to do something.
    let missed: Vec<String> =
        machine.states.ids().filter(|s| !course.seen[s.index()]).map(|s| machine.state_path(s)).collect();
    assert!(missed.is_empty(), "never in {missed:?}");
    assert!(course.corrected > scans / 100, "the filter acted in {} scans only", course.corrected);
    println!("{scans} scans, corrected in {}", course.corrected);
}

#[test]
fn without_its_filter_the_machine_would_break() {
    let mut machine = indexa();
    let hazards: Vec<_> = forbidden(&machine).into_iter().take(6).collect();
    machine.safety.constraints = Default::default();
    assert!(chance(&machine, &hazards, 40_000).is_err());
}

#[test]
fn without_what_holds_the_vacuum_a_lid_is_dropped() {
    let source = std::fs::read_to_string(repository("models/indexa.chart")).expect("the model is in the repository");
    let holds = |l: &&str| l.contains(": never fall(ASP)");
    assert!(source.lines().filter(holds).count() > 2, "several constraints hold the vacuum");
    let without: Vec<&str> = source.lines().filter(|l| !holds(l)).collect();
    let (machine, found) = pipeline::check(&format!("{}{HAZARDS}", without.join("\n")));
    let machine = machine.unwrap_or_else(|| panic!("{found:#?}"));
    let hazards: Vec<_> = forbidden(&machine).into_iter().filter(|(text, _)| text.starts_with("a lid")).collect();
    assert_eq!(hazards.len(), 1);
    assert!(chance(&machine, &hazards, 40_000).is_err());
}
