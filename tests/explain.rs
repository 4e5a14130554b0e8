//! `docs/errors`: the pages hold what they say.

use crate::support::binary::{chartwright, code, stderr, stdout};
use crate::support::models::{assert_only, diagnose, listing, repository};
use chartwright::base::Code;
use std::fs;

/// Pages without a wrong example, and why.
const WITHOUT_EXAMPLE: &[(Code, &str)] = &[
    (Code::Unreadable, "there is no text to show"),
    (Code::NotUtf8, "the page is UTF-8 itself"),
    (Code::Empty, "nothing cannot be shown"),
    (Code::TooLarge, "it would have 16 MiB"),
    (Code::TooDeep, "64 parentheses in a row say less than a sentence"),
    (Code::TooManyStates, "it would have 150 states"),
    (Code::UnsafeFilter, "it takes an edited program"),
];

/// Whether the code is about PLC projects, whose files are too long for a page.
fn about_projects(code: Code) -> bool {
    code.number().starts_with("E6") || code.number().starts_with("E8")
}

/// The fenced blocks of a page that are marked with `info`.
fn blocks<'a>(page: &'a str, info: &str) -> Vec<&'a str> {
    let fence = format!("```{info}\n");
    page.split(&fence).skip(1).map(|rest| rest.split_once("```").expect("a fence is closed").0).collect()
}

#[test]
fn every_page_belongs_to_a_code_and_has_its_title() {
    let pages: Vec<_> = Code::ALL.iter().map(|c| format!("{c}.md")).collect();
    assert_eq!(listing("docs/errors"), pages);
    for code in Code::ALL {
        let title = format!("# {code}: {}\n\n", code.title());
        assert!(code.page().starts_with(&title), "{code}: the page begins with {title:?}");
        assert!(code.page().ends_with('\n') && !code.page().ends_with("\n\n"), "{code}: the page ends in one line end");
    }
}

#[test]
fn wrong_examples_yield_their_code_alone() {
    for &code in Code::ALL.iter().filter(|c| !about_projects(**c)) {
        let wrong = blocks(code.page(), "chart wrong");
        let reason = WITHOUT_EXAMPLE.iter().find(|(c, _)| *c == code);
        assert_eq!(wrong.len(), usize::from(reason.is_none()), "{code}: wrong examples; {reason:?}");
        for example in wrong {
            assert_only(code, &diagnose(example.as_bytes()), &format!("wrong example of {code}"));
        }
    }
}

#[test]
fn right_examples_are_right() {
    for &code in Code::ALL.iter().filter(|c| !about_projects(**c)) {
        let right = blocks(code.page(), "chart right");
        assert!(right.len() == 1 || WITHOUT_EXAMPLE.iter().any(|(c, _)| *c == code), "{code}: one right example");
        for example in right {
            let diagnostics = diagnose(example.as_bytes());
            assert!(diagnostics.is_empty(), "right example of {code}: {diagnostics:?}");
        }
    }
}

/// So that the page, the model and its snapshot speak of the same text.
#[test]
fn wrong_examples_are_the_invalid_models() {
    for file in listing("models/invalid") {
        let code = Code::find(file.split('_').next().unwrap()).unwrap();
        if let [example] = blocks(code.page(), "chart wrong")[..] {
            let model = fs::read_to_string(repository("models/invalid").join(&file)).unwrap();
            assert_eq!(example, model, "{code}: the page and models/invalid/{file} differ");
        }
    }
}

#[test]
fn explain_prints_the_page() {
    for number in ["E101", "e101", "W503"] {
        let output = chartwright(&repository("."), &format!("explain {number}"));
        assert_eq!(code(&output), 0);
        assert_eq!(stdout(&output), Code::find(number).unwrap().page());
    }
}

#[test]
fn explain_lists_the_codes() {
    let output = chartwright(&repository("."), "explain");
    assert_eq!(code(&output), 0);
    let lines: Vec<_> = stdout(&output).lines().map(str::to_owned).collect();
    let expected: Vec<_> = Code::ALL.iter().map(|c| format!("{c}  {}", c.title())).collect();
    assert_eq!(lines, expected);
}

#[test]
fn explain_helps_with_an_unknown_code() {
    let output = chartwright(&repository("."), "explain E501");
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("there is no code `E501`"), "{}", stderr(&output));
    assert!(stderr(&output).contains("W501  an output is never driven"), "{}", stderr(&output));
    let output = chartwright(&repository("."), "explain banana");
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("lists all codes"), "{}", stderr(&output));
}
