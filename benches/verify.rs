//! How long it takes to prove that double-acting cylinders with interlocks hit nothing, whatever the program does.
//!
//! Every constraint that is derived is proved to be kept, and no two neighbours to meet. Then how long it takes to answer all that is
//! asked of the papers' machines. `cargo bench --bench verify`.

mod cylinders;

use chartwright::pipeline::verify::{Options, Program, Question, Status, Times, verify};
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

/// The papers' machines behind their charts, with times as they are and with open ones; nothing stays open.
#[divan::bench(args = ["indexa", "palletizer", "productis"], consts = [false, true], sample_count = 1)]
fn papers_machines<const EXACT: bool>(bencher: Bencher, name: &str) {
    let path = format!("{}/models/{name}.chart", env!("CARGO_MANIFEST_DIR"));
    let source = std::fs::read_to_string(path).expect("the model is there");
    let times = if EXACT { Times::Exact } else { Times::Free };
    let options = Options { times, ..Options::default() };
    bencher.bench(|| {
        let verified = verify(&source, &options, &|| false, &mut |_| {}).0.expect("the model has no errors");
        let open = verified.answers.iter().filter(|a| matches!(a.status, Status::Unknown(_)));
        let open: Vec<Question> = open.map(|a| a.question).collect();
        assert!(open.is_empty(), "{open:?}");
    });
}
