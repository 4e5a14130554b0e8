//! The layers of the house: who may import whom.

use crate::support::models::repository;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// For each folder of `src`, the folders that its files may import. Nouns (`base`, `ir`) in one
/// place, verbs in folders of their own that do not know each other, the order in `pipeline`, files
/// and terminal in `cli`.
const ALLOWED: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("bits", &["base", "ir"]),
    ("ir", &["base"]),
    ("parse", &["base", "ir"]),
    ("derive", &["base", "ir"]),
    ("resolve", &["base", "ir"]),
    ("constraints", &["base", "bits", "ir"]),
    ("check", &["base", "bits", "constraints", "ir"]),
    ("lower", &["base", "ir"]),
    ("layout", &["base", "ir"]),
    ("emit", &["base", "ir", "layout"]),
    ("read", &["base", "ir"]),
    ("simulate", &["base", "ir"]),
    ("prove", &["base", "bits", "ir"]),
    ("stats", &["base", "ir"]),
    // What is verified is the scan that programs are proved equal to.
    ("verify", &["base", "bits", "ir", "prove"]),
    (
        "pipeline",
        &[
            "base",
            "constraints",
            "derive",
            "ir",
            "parse",
            "resolve",
            "check",
            "lower",
            "emit",
            "read",
            "prove",
            "simulate",
            "verify",
        ],
    ),
    ("cli", &["base", "constraints", "derive", "ir", "parse", "pipeline", "simulate", "stats", "verify"]),
];

#[test]
fn folders_import_only_what_the_table_allows() {
    let table: BTreeMap<&str, BTreeSet<&str>> =
        ALLOWED.iter().map(|(folder, may)| (*folder, may.iter().copied().collect())).collect();
    let mut wrong = Vec::new();
    let mut folders = BTreeSet::new();
    for file in sources(&repository("src")) {
        let relative = file.strip_prefix(repository("src")).expect("a file of src").to_owned();
        let Some(folder) = relative.parent().and_then(|p| p.iter().next()).and_then(|p| p.to_str()) else {
            continue; // lib.rs and main.rs
        };
        folders.insert(folder.to_owned());
        let Some(may) = table.get(folder) else {
            wrong.push(format!("{}: `{folder}` is not in the table", relative.display()));
            continue;
        };
        let text = std::fs::read_to_string(&file).expect("sources can be read");
        for import in imports(&text) {
            if import != folder && !may.contains(import.as_str()) {
                wrong.push(format!("{}: imports `{import}`", relative.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let listed: BTreeSet<String> = table.keys().map(|s| (*s).to_owned()).collect();
    assert_eq!(folders, listed, "the table lists the folders that there are");
}

/// The folders that a source names by `crate::…`, in code and not in comments.
fn imports(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let code: String = text.lines().map(|l| l.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        if let Some(list) = rest.strip_prefix('{') {
            // The folders of `use crate::{a::x, b}` stand at depth one.
            let mut depth = 1;
            let mut word = String::new();
            for c in list.chars() {
                match c {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    _ => {}
                }
                if depth == 1 && (c.is_alphanumeric() || c == '_') {
                    word.push(c);
                } else if !word.is_empty() {
                    if depth <= 1 && (c == ':' || c == ',' || c == '}') {
                        found.insert(word.clone());
                    }
                    // What follows `::` is not a folder.
                    if c == ':' {
                        depth += 100;
                    }
                    word.clear();
                }
                if depth > 50 && c == ',' {
                    depth -= 100;
                }
                if depth <= 0 {
                    break;
                }
            }
        } else {
            found.insert(rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
        }
    }
    found
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("src is there") {
        let path = entry.expect("its entries can be read").path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

#[test]
fn the_reader_of_imports_sees_what_stands_there() {
    let seen =
        imports("use crate::{base::Span, ir::{ast, chart}, parse};\n// crate::cli\nlet x = crate::emit::names::f();");
    let seen: Vec<&str> = seen.iter().map(String::as_str).collect();
    assert_eq!(seen, ["base", "emit", "ir", "parse"]);
}

#[test]
fn only_the_command_line_prints_or_touches_files() {
    let words = ["println!", "eprintln!", "print!(", "std::fs", "std::env", "std::process", "std::io"];
    let mut wrong = Vec::new();
    for file in sources(&repository("src")) {
        let relative = file.strip_prefix(repository("src")).expect("a file of src").display().to_string();
        if relative.starts_with("cli") || relative == "main.rs" {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("sources can be read");
        for word in words {
            if text.lines().any(|l| l.split("//").next().unwrap_or("").contains(word)) {
                wrong.push(format!("{relative}: {word}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_source_file_is_long_and_each_says_what_it_does() {
    for file in sources(&repository("src")) {
        let text = std::fs::read_to_string(&file).expect("sources can be read");
        assert!(text.lines().count() <= 600, "{} is longer than 600 lines", file.display());
        assert!(text.starts_with("//! "), "{} does not begin with what it does", file.display());
    }
}
