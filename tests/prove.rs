//! Every model's program is proved to do what the model says.

use crate::support::direct::executable;
use crate::support::models;
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
