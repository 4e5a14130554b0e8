//! How long a proof takes: reading the XML back, and proving it equal to the machine.
//!
//! `cargo bench --bench prove`.

mod generator;
mod many_constraints;

use chartwright::pipeline::{self, Dialect, Options, Output};
use chartwright::prove::{Correspondence, Verdict, equivalence};
use chartwright::read;
use divan::{Bencher, counter::ItemsCount};

const SIZES: [usize; 3] = [1_000, 3_000, 10_000];

fn main() {
    divan::main();
}

fn built(source: &str) -> Output {
    let options = Options { dialect: Dialect::Beremiz, created: "1970-01-01T00:00:00".into(), prove: false };
    pipeline::build(source, &options).0.expect("the model has no errors")
}

fn indexa() -> Output {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/indexa.chart");
    built(&std::fs::read_to_string(path).expect("the model is in the repository"))
}

fn prove(output: &Output) {
    let program = read::read(&output.xml).0.expect("what is written can be read");
    let names = Correspondence::of(&output.machine, &output.project);
    let verdict = equivalence(&output.machine, &names, &program);
    assert!(matches!(verdict, Verdict::Proved(_)), "a build is proved");
}

#[divan::bench]
fn indexa_read(bencher: Bencher) {
    let output = indexa();
    bencher.bench(|| read::read(&output.xml));
}

#[divan::bench]
fn indexa_read_and_proved(bencher: Bencher) {
    let output = indexa();
    bencher.bench(|| prove(&output));
}

/// 500 outputs and 2,000 constraints, from the text to the proof.
#[divan::bench(sample_count = 2)]
fn constraints_analysed_and_proved(bencher: Bencher) {
    let source = many_constraints::many(500, 2_000);
    let options = Options { dialect: Dialect::Beremiz, created: "1970-01-01T00:00:00".into(), prove: true };
    bencher.bench(|| assert!(pipeline::build(&source, &options).0.is_some(), "a build is proved"));
}

#[divan::bench(args = SIZES, sample_count = 2)]
fn generated_read_and_proved(bencher: Bencher, states: usize) {
    let output = built(&generator::model(states));
    bencher.counter(ItemsCount::new(states)).bench(|| prove(&output));
}
