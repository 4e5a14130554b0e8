//! The examples of the documentation mean what they should.

use crate::support::models::repository;
use chartwright::{parse, pipeline};
use std::path::{Path, PathBuf};

/// The fenced blocks of a page with the words behind the fence and the line where each begins.
fn fences(page: &str) -> Vec<(String, String, usize)> {
    let mut found = Vec::new();
    let mut open: Option<(String, String, usize)> = None;
    for (i, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(words), None) => open = Some((words.trim().to_owned(), String::new(), i + 1)),
            (Some(_), Some(_)) => found.extend(open.take()),
            (None, Some((_, text, _))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a fence is not closed");
    found
}

#[test]
fn complete_examples_of_the_language_reference_have_no_errors() {
    for name in ["docs/language.md", "docs/functions.md"] {
        let page = std::fs::read_to_string(repository(name)).expect("the reference is there");
        let mut complete = 0;
        for (words, text, line) in fences(&page) {
            match words.as_str() {
                "chart" => {
                    let (machine, diagnostics) = pipeline::check(&text);
                    assert!(machine.is_some(), "{name}:{line}: {diagnostics:#?}");
                    complete += 1;
                }
                "chart partial" | "text" | "pest" | "" => {}
                other => panic!("{name}:{line}: what is `{other}`?"),
            }
        }
        assert!(complete > 0, "{name} has a complete example");
    }
}

/// What the parts of a model that an example shows may stand in.
const AROUND: [[&str; 2]; 4] = [
    ["machine M", ""],
    ["machine M chart C {", "}"],
    ["machine M chart C { state S {", "} }"],
    ["machine M plant {", "}"],
];

#[test]
fn partial_examples_are_written_in_the_language() {
    let mut partial = 0;
    for name in ["docs/language.md", "docs/functions.md"] {
        let page = std::fs::read_to_string(repository(name)).expect("the reference is there");
        for (_, text, line) in fences(&page).iter().filter(|(words, ..)| words == "chart partial") {
            let reads =
                |[before, after]: [&str; 2]| !parse::parse(&format!("{before}\n{text}\n{after}")).1.has_errors();
            assert!(AROUND.into_iter().any(reads), "{name}:{line}");
            partial += 1;
        }
    }
    assert!(partial > 20, "there are examples");
    assert!(parse::parse("machine M chart C { from A when B to C }").1.has_errors());
}

#[test]
fn readme_shows_the_real_indexa() {
    let readme = std::fs::read_to_string(repository("README.md")).expect("README is there");
    let indexa = std::fs::read_to_string(repository("models/indexa.chart")).expect("INDEXA is there");
    let squeezed = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let model = squeezed(&indexa);
    let shown =
        fences(&readme).into_iter().find(|(_, t, _)| t.contains("actuator Vertical")).expect("README shows INDEXA");
    for block in shown.1.split("\n\n") {
        assert!(model.contains(&squeezed(block)), "README shows what the model does not say:\n{block}");
    }
}

/// The pages that a reader of the repository meets.
fn pages(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("its entries can be read").path();
        if path.is_dir() {
            pages(&path, into);
        } else if path.extension().is_some_and(|e| e == "md") {
            into.push(path);
        }
    }
}

#[test]
fn links_lead_somewhere() {
    let mut all: Vec<PathBuf> = ["README.md", "CHANGELOG.md"].map(repository).into();
    pages(&repository("docs"), &mut all);
    let mut followed = 0;
    for page in all {
        let text = std::fs::read_to_string(&page).expect("pages can be read");
        for link in text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next()) {
            let target = link.split('#').next().unwrap_or(link);
            if target.is_empty() || target.contains("://") {
                continue;
            }
            let target = page.parent().expect("a page is in a folder").join(target);
            assert!(target.exists(), "{}: {link} leads nowhere", page.display());
            followed += 1;
        }
    }
    assert!(followed > 20, "only {followed} links were found");
}
