//! How long the compiler takes: INDEXA, and generated models of growing size, stage by stage.
//!
//! `cargo bench --bench compile`. Cost per state has to stay the same from the smallest to the
//! largest.

mod generator;

use chartwright::pipeline::{self, Dialect, Options};
use divan::{Bencher, counter::ItemsCount};

const SIZES: [usize; 4] = [1_000, 2_000, 5_000, 10_000];

fn main() {
    divan::main();
}

fn indexa() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/indexa.chart");
    std::fs::read_to_string(path).expect("the model is in the repository")
}

fn options(dialect: Dialect) -> Options {
    Options { dialect, created: "1970-01-01T00:00:00".into(), prove: false }
}

#[divan::bench]
fn indexa_check(bencher: Bencher) {
    let source = indexa();
    bencher.bench(|| pipeline::check(&source));
}

#[divan::bench]
fn indexa_build_beremiz(bencher: Bencher) {
    let source = indexa();
    bencher.bench(|| pipeline::build(&source, &options(Dialect::Beremiz)));
}

#[divan::bench]
fn indexa_build_codesys(bencher: Bencher) {
    let source = indexa();
    bencher.bench(|| pipeline::build(&source, &options(Dialect::Codesys)));
}

#[divan::bench(args = SIZES, sample_count = 10)]
fn generated_check(bencher: Bencher, states: usize) {
    let source = generator::model(states);
    bencher.counter(ItemsCount::new(states)).bench(|| pipeline::check(&source));
}

#[divan::bench(args = SIZES, sample_count = 10)]
fn generated_build(bencher: Bencher, states: usize) {
    let source = generator::model(states);
    bencher.counter(ItemsCount::new(states)).bench(|| pipeline::build(&source, &options(Dialect::Beremiz)));
}
