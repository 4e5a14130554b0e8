//! How long it takes to prove that double-acting cylinders with interlocks hit nothing, whatever the program does.
//!
//! `cargo bench --bench verify`. Every constraint that is derived is proved to be kept, and no two neighbours to meet.

mod cylinders;

use chartwright::pipeline::verify::{Options, Program, Question, Status, verify};
use divan::Bencher;

const SIZES: [usize; 4] = [5, 10, 20, 40];

fn main() {
    divan::main();
}

#[divan::bench(args = SIZES, sample_count = 1)]
fn cylinders_behind_any_program(bencher: Bencher, cylinders: usize) {
    let source = cylinders::row(cylinders);
    let options = Options { program: Program::Any, ..Options::default() };
    bencher.bench(|| {
        let verified = verify(&source, &options, &|| false, &mut |_| {}).0.expect("the model has no errors");
        let demands = verified.answers.iter().filter(|a| a.question.kind().is_none());
        let wrong = demands.filter(|a| a.status != Status::Holds).map(|a| (a.question, a.status));
        let wrong: Vec<(Question, Status)> = wrong.collect();
        assert!(wrong.is_empty(), "{wrong:?}");
    });
}
