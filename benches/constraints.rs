//! How long constraints take to be checked and analysed: INDEXA, and a generated set.
//!
//! `cargo bench --bench constraints`.

mod many_constraints;

use chartwright::pipeline;
use divan::Bencher;

const SIZES: [(usize, usize); 3] = [(50, 200), (200, 800), (500, 2_000)];

fn main() {
    divan::main();
}

#[divan::bench]
fn indexa_analyse(bencher: Bencher) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/indexa.chart");
    let source = std::fs::read_to_string(path).expect("the model is in the repository");
    bencher.bench(|| pipeline::constraints(&source));
}

#[divan::bench(args = SIZES, sample_count = 10)]
fn generated_check(bencher: Bencher, (outputs, constraints): (usize, usize)) {
    let source = many_constraints::many(outputs, constraints);
    bencher.bench(|| pipeline::check(&source));
}

#[divan::bench(args = SIZES, sample_count = 3)]
fn generated_analyse(bencher: Bencher, (outputs, constraints): (usize, usize)) {
    let source = many_constraints::many(outputs, constraints);
    bencher.bench(|| pipeline::constraints(&source));
}
