//! `models/invalid`: one wrong model for each code, and what the user reads about it.

use crate::support::binary::{chartwright, code, stderr, stdout};
use crate::support::models::{COMPARED, assert_only, diagnose, listing, repository};
use chartwright::base::Code;
use std::fs;

const MODELS: &str = "models/invalid";
const SNAPSHOTS: &str = "snapshots/invalid";

/// Codes whose model is not in the repository. `tests/cli.rs` makes the large one.
const ELSEWHERE: &[(Code, &str)] = &[
    (Code::TooLarge, "it has 16 MiB"),
    (Code::BadWitness, "it takes a run of another tool; `tests/replay.rs` damages some"),
    (Code::NotShown, "so does this"),
    (
        Code::UnsafeFilter,
        "it takes an edited program; `tests/program_mutants.rs` makes some, and `tests/filters.rs` goes behind the checks",
    ),
];

/// The code that a file is named after.
fn code_of(file: &str) -> Code {
    let number = file.split('_').next().unwrap_or_default();
    Code::find(number).unwrap_or_else(|| panic!("{MODELS}/{file} is named after no code"))
}

#[test]
fn every_code_has_one_model() {
    let mut models: Vec<_> = listing(MODELS).iter().map(|f| code_of(f)).collect();
    models.extend(ELSEWHERE.iter().map(|(code, _)| code));
    models.sort();
    assert_eq!(models, Code::ALL);
}

#[test]
fn every_model_yields_its_code_alone() {
    for file in listing(MODELS) {
        let code = code_of(&file);
        let path = repository(MODELS).join(&file);
        // A directory: only the command line can fail to read it.
        if code != Code::Unreadable {
            assert_only(code, &diagnose(&fs::read(path).unwrap()), &file);
        }
    }
}

#[test]
fn what_the_user_reads() {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(repository(SNAPSHOTS));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    for file in listing(MODELS) {
        let command =
            if file.ends_with(".xml") { format!("prove ../../{COMPARED} {file}") } else { format!("check {file}") };
        let output = chartwright(&repository(MODELS), &command);
        assert_eq!(code(&output), i32::from(file.starts_with('E')), "{file}");
        let name = file.trim_end_matches(".chart").trim_end_matches(".xml");
        // Messages, then what is asked for: the table of a run.
        let read = format!("{}\n{}", stderr(&output), stdout(&output));
        settings.bind(|| insta::assert_snapshot!(name, read));
    }
}
