//! Every model's program is proved to do what the model says: as it is written to XML in each dialect
//! and read back.

use crate::support::{generate, models};
use chartwright::ir::iec;
use chartwright::pipeline::{self, Dialect, Options, Output};
use chartwright::prove::{Correspondence, Verdict, equivalence};
use chartwright::read;

/// The program that a reader finds in what the compiler writes.
pub fn read_back(output: &Output) -> iec::Project {
    let (program, diagnostics) = read::read(&output.xml);
    program.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

pub fn build(source: &str, dialect: Dialect) -> Result<Output, String> {
    let options = Options { dialect, created: "1970-01-01T00:00:00".to_owned() };
    let (output, diagnostics) = pipeline::build(source, &options);
    output.ok_or_else(|| diagnostics.iter().map(|d| format!("{} {}\n", d.code.number(), d.message)).collect())
}

fn verdict(output: &Output) -> Verdict {
    let names = Correspondence::of(&output.machine, &output.project);
    equivalence(&output.machine, &names, &read_back(output))
}

#[test]
fn every_model_is_proved_in_both_dialects() {
    for model in models::all() {
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let output = build(&model.source, dialect).unwrap_or_else(|e| panic!("{}: {e}", model.name));
            let start = std::time::Instant::now();
            match verdict(&output) {
                Verdict::Proved(s) => println!("{}: {:?} {s:?}", model.name, start.elapsed()),
                Verdict::Refuted(trace) => panic!("{}:\n{trace}", model.name),
                Verdict::Unknown(doubt) => panic!("{}: {doubt}", model.name),
            }
        }
    }
}

#[test]
fn random_models_are_proved() {
    let wanted: usize = std::env::var("CHARTWRIGHT_MODELS").ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    let (mut proved, mut seed) = (0, 0);
    let mut refused = std::collections::BTreeMap::<String, usize>::new();
    while proved < wanted {
        seed += 1;
        let source = generate::random(seed);
        let dialect = [Dialect::Beremiz, Dialect::Codesys][seed as usize % 2];
        let output = match build(&source, dialect) {
            Ok(output) => output,
            Err(errors) => {
                *refused.entry(errors.chars().take(4).collect()).or_default() += 1;
                continue;
            }
        };
        match verdict(&output) {
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
    for (modes, regions, phases, steps) in
        [(4, 5, 5, 9), (20, 10, 5, 10), (100, 2, 5, 9), (2, 4, 50, 24), (140, 7, 1, 9)]
    {
        let shape = generate::Shape { modes, regions, phases, steps };
        let source = generate::large(shape);
        let start = std::time::Instant::now();
        let output = build(&source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
        println!("{} states: built in {:?}", shape.states(), start.elapsed());
        let start = std::time::Instant::now();
        let program = read_back(&output);
        println!("read {:?}", start.elapsed());
        let names = Correspondence::of(&output.machine, &output.project);
        let start = std::time::Instant::now();
        match equivalence(&output.machine, &names, &program) {
            Verdict::Proved(s) => println!("proved {:?} {s:?}", start.elapsed()),
            Verdict::Refuted(trace) => panic!("{trace}"),
            Verdict::Unknown(doubt) => panic!("{doubt}"),
        }
    }
}
