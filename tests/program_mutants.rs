//! Programs with one thing wrong are refuted, and what is proved of one is true.
//!
//! Of each mutant either a run is shown in which it does not do what the chart says, and the simulators
//! confirm that run; or it is proved to be equal after all, and random runs on the simulators do not say
//! otherwise, though its filter may no longer hold for commands that the chart never gives. `CHARTWRIGHT_MUTANTS=N` makes the test look at that many.
//!
//! About one in five is proved equal. Those of a run of 300, and of longer runs a sample of each kind of
//! damage, have been looked at by hand. They are of these kinds:
//!
//! - a priority is taken away or exchanged: the conditions exclude each other anyway;
//! - rungs or programs change places that do not depend on each other;
//! - a variable is written in addition, or begins with another value, and is written again before
//!   anybody reads it;
//! - an SFC begins in another step than its idle step: its parent is not active in the first scan, so
//!   it goes to the idle step before anybody has seen it elsewhere;
//! - a contact repeats what the rest of the condition or the active step says anyway;
//! - a transition of a step to itself is changed or left out, when all its conditions do is to tell the
//!   steps of another SFC;
//! - an abort transition is left out of a step that is never active when its parent is left;
//! - a round of the filter is changed, and the next round makes up for it;
//! - a rung computes what never happens in a run, or what another rung does anyway.

use crate::support::damage::{Mutant, mutant};
use crate::support::models;
use crate::support::numbers;
use crate::support::proof::{agree_by_chance as run, build, confirm, read_back};
use crate::support::rng::Rng;
use chartwright::pipeline::Dialect;
use chartwright::prove::{Correspondence, Doubt, Verdict, equivalence};

#[test]
fn damaged_programs_are_refuted() {
    let wanted: usize = std::env::var("CHARTWRIGHT_MUTANTS").ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    let models: Vec<_> = models::all()
        .into_iter()
        .map(|model| {
            let output = build(&model.source, Dialect::Beremiz).expect("the models are right");
            let names = Correspondence::of(&output.machine, &output.project);
            let program = read_back(&output);
            (model.name, output.machine, names, program)
        })
        .collect();
    let named = |name: &str| models.iter().position(|m| m.0 == name).expect("it is a model");
    let (indexa, productis) = (named("indexa"), named("productis"));
    let mut rng = Rng::new(11);
    let (mut made, mut refuted, mut weakened, mut proved, mut unknown) = (0, 0, 0, 0, Vec::new());
    while made < wanted {
        // The largest ones get most of them.
        let k = match rng.below(100) {
            0..40 => indexa,
            40..55 => productis,
            _ => rng.below(models.len()),
        };
        let (name, machine, names, program) = &models[k];
        let Some(Mutant { project, what }) = mutant(program, &mut rng) else { continue };
        made += 1;
        let start = std::time::Instant::now();
        let verdict = equivalence(machine, names, &project);
        let took = start.elapsed();
        match verdict {
            Verdict::Refuted(trace) => {
                refuted += 1;
                println!("refuted {took:?} in {} scans: {name}: {what}", trace.scans.len());
                confirm(machine, names, &project, &trace, &what);
            }
            Verdict::Proved(s) => {
                proved += 1;
                println!("proved {took:?} looking {} back: {name}: {what}", s.history);
                run(machine, names, &project, &what, made as u64);
            }
            Verdict::Unknown(doubt) => match *doubt {
                // Equal after all, but its filter has been weakened where the chart never asks for anything.
                Doubt::Unsafe(_) => {
                    weakened += 1;
                    println!("weakened {took:?} {name}: {what}: {doubt}");
                    run(machine, names, &project, &what, made as u64);
                }
                // Of a program that is left out the states have nothing to be compared with: that is refused.
                Doubt::Incomparable(_) if what.ends_with(": is left out") => refuted += 1,
                Doubt::Incomparable(_) | Doubt::NotInductive { .. } | Doubt::GaveUp { .. } => {
                    println!("unknown {took:?} {name}: {what}: {doubt}");
                    unknown.push(format!("{name}: {what}: {doubt}"));
                }
            },
        }
    }
    println!(
        "{made} made, {refuted} refuted, {weakened} with a weaker filter, {proved} proved, {} unknown",
        unknown.len()
    );
    assert!(unknown.is_empty(), "{}", unknown.join("\n"));
}

#[test]
fn programs_that_count_wrong_are_refuted() {
    for (name, least) in [("counter", 60), ("lots", 70)] {
        let model = models::all().into_iter().find(|m| m.name == name).expect("it is a model");
        let output = build(&model.source, Dialect::Beremiz).expect("the models are right");
        let names = Correspondence::of(&output.machine, &output.project);
        let (mut refuted, mut weakened, mut proved, mut unknown) = (0, 0, Vec::new(), Vec::new());
        for (seed, Mutant { project, what }) in numbers::mutants(&read_back(&output)).into_iter().enumerate() {
            match equivalence(&output.machine, &names, &project) {
                Verdict::Refuted(trace) => {
                    refuted += 1;
                    confirm(&output.machine, &names, &project, &trace, &what);
                }
                Verdict::Proved(_) => {
                    run(&output.machine, &names, &project, &what, seed as u64);
                    proved.push(what);
                }
                // The filter has been weakened where the chart never asks for anything.
                Verdict::Unknown(doubt) if matches!(*doubt, Doubt::Unsafe(_)) => {
                    run(&output.machine, &names, &project, &what, seed as u64);
                    weakened += 1;
                }
                // What only an unreachable value would show; the simulators do not see a difference either.
                Verdict::Unknown(doubt) => {
                    run(&output.machine, &names, &project, &what, seed as u64);
                    unknown.push(format!("{what}: {doubt}"));
                }
            }
        }
        println!("{name}: {refuted} refuted, {weakened} with a weaker filter, {} proved: {proved:#?}", proved.len());
        assert!(unknown.len() <= 4, "{name}: {unknown:#?}");
        assert!(refuted >= least, "{name}: {refuted} refuted, {proved:#?} proved");
    }
}
