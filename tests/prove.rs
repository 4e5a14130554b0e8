//! Every model's program is proved to do what the model says.

use crate::support::direct::executable;
use crate::support::{generate, models};
use chartwright::pipeline;
use chartwright::prove::{Correspondence, Verdict, equivalence};

#[test]
fn every_model_is_proved() {
    for model in models::all() {
        let (machine, diagnostics) = pipeline::check(&model.source);
        let machine = machine.unwrap_or_else(|| panic!("{}: {diagnostics:?}", model.name));
        let project = pipeline::lower(&machine);
        let names = Correspondence::of(&machine, &project);
        let start = std::time::Instant::now();
        match equivalence(&machine, &names, &executable(&project)) {
            Verdict::Proved(s) => println!("{}: {:?} {s:?}", model.name, start.elapsed()),
            Verdict::Refuted(trace) => panic!("{}:\n{trace}", model.name),
            Verdict::Unknown(doubt) => panic!("{}: {doubt}", model.name),
        }
    }
}

#[test]
fn random_models_are_proved() {
    let wanted: usize = std::env::var("CHARTWRIGHT_MODELS").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    let (mut proved, mut seed) = (0, 0);
    let mut refused = std::collections::BTreeMap::<String, usize>::new();
    while proved < wanted {
        seed += 1;
        let source = generate::random(seed);
        let (machine, diagnostics) = pipeline::check(&source);
        let Some(machine) = machine else {
            let code = diagnostics.iter().next().map(|d| d.code.number().to_string()).unwrap_or_default();
            *refused.entry(code).or_default() += 1;
            continue;
        };
        let project = pipeline::lower(&machine);
        let names = Correspondence::of(&machine, &project);
        match equivalence(&machine, &names, &executable(&project)) {
            Verdict::Proved(_) => proved += 1,
            Verdict::Refuted(trace) => panic!("seed {seed}:\n{source}\n{trace}"),
            Verdict::Unknown(doubt) => panic!("seed {seed}: {doubt}\n{source}"),
        }
    }
    println!("{proved} proved, {seed} made, refused: {refused:?}");
}

#[test]
#[ignore = "a measurement"]
fn large_models_are_proved_in_time() {
    for (modes, regions, phases, steps) in [(4, 5, 5, 9), (20, 10, 5, 10), (100, 2, 5, 9), (2, 4, 50, 24), (140, 7, 1, 9)] {
        let shape = generate::Shape { modes, regions, phases, steps };
        let source = generate::large(shape);
        let start = std::time::Instant::now();
        let (machine, diagnostics) = pipeline::check(&source);
        let machine = machine.unwrap_or_else(|| panic!("{diagnostics:?}"));
        println!("{} states: checked {:?}", shape.states(), start.elapsed());
        let start = std::time::Instant::now();
        let project = pipeline::lower(&machine);
        println!("lowered {:?}", start.elapsed());
        let program = executable(&project);
        let names = Correspondence::of(&machine, &project);
        let start = std::time::Instant::now();
        match equivalence(&machine, &names, &program) {
            Verdict::Proved(s) => println!("proved {:?} {s:?}", start.elapsed()),
            Verdict::Refuted(trace) => panic!("{trace}"),
            Verdict::Unknown(doubt) => panic!("{doubt}"),
        }
    }
}
