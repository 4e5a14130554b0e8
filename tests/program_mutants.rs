//! Programs with one thing wrong are refuted, and what is proved of one is true.

use crate::support::damage::{Mutant, mutant};
use crate::prove::{build, read_back};
use crate::support::models;
use chartwright::pipeline::Dialect;
use chartwright::prove::random::Random;
use chartwright::prove::{Correspondence, Verdict, equivalence};

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
    let mut random = Random::new(11);
    let (mut made, mut refuted, mut proved, mut unknown) = (0, 0, 0, 0);
    while made < wanted {
        // INDEXA, the largest by far, gets half of them.
        let indexa = random.below(2) == 0;
        let k = random.below(models.len());
        let k = if indexa { models.iter().position(|m| m.0 == "indexa").unwrap() } else { k };
        let (name, machine, names, program) = &models[k];
        let Some(Mutant { project, what }) = mutant(program, &mut random) else { continue };
        made += 1;
        let start = std::time::Instant::now();
        match equivalence(machine, names, &project) {
            Verdict::Refuted(trace) => {
                refuted += 1;
                assert!(!trace.differences().is_empty());
                println!("REFUTED {:?} {} {name}: {what}", start.elapsed(), trace.scans.len());
            }
            Verdict::Proved(_) => {
                proved += 1;
                println!("PROVED {:?} {name}: {what}", start.elapsed());
            }
            Verdict::Unknown(doubt) => {
                unknown += 1;
                println!("UNKNOWN {:?} {name}: {what}: {doubt}", start.elapsed());
            }
        }
    }
    println!("{made} made, {refuted} refuted, {proved} proved, {unknown} unknown");
}
