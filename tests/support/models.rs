//! Models of the repository and what the compiler says about them.

use chartwright::base::{Code, Diagnostic, Diagnostics, Severity, limits};
use chartwright::{parse, pipeline};
use std::fs;
use std::path::{Path, PathBuf};

/// A path in the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The names of what is in a directory of the repository, sorted.
pub fn listing(directory: &str) -> Vec<String> {
    let entries = fs::read_dir(repository(directory)).unwrap_or_else(|e| panic!("{directory}: {e}"));
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The model with which PLC projects are compared.
pub const COMPARED: &str = "models/onoff.chart";

/// The text of a model with the plant and the scenarios of its fixture, in which what moves needs a stated time:
/// what a test needs that gives each part its speed.
pub fn timed(name: &str) -> String {
    let read = |path: String| fs::read_to_string(repository(&path)).unwrap_or_else(|e| panic!("{path}: {e}"));
    let model = read(format!("models/{name}.chart"));
    let controller = &model[..model.find("\nplant").expect("the model has a plant")];
    format!("{controller}\n{}", read(format!("tests/fixtures/{name}.timed")))
}

/// What the compiler has to say about the bytes of a model, or of a PLC project.
pub fn diagnose(bytes: &[u8]) -> Diagnostics {
    match parse::decode(bytes.to_vec(), limits::SOURCE_BYTES) {
        Ok(program) if program.starts_with("<?xml") => {
            let model = fs::read_to_string(repository(COMPARED)).expect("the model is there");
            pipeline::prove(&model, &program).2
        }
        Ok(source) => pipeline::check(&source).1,
        Err(diagnostic) => {
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(diagnostic);
            diagnostics
        }
    }
}

/// Asserts that `diagnostics` are one statement with `code`; beside an error, warnings may stand.
#[track_caller]
pub fn assert_only(code: Code, diagnostics: &Diagnostics, what: &str) {
    let matters = |d: &&Diagnostic| d.severity() == Severity::Error || code.severity() == Severity::Warning;
    let found: Vec<_> = diagnostics.iter().filter(matters).map(|d| (d.code.number(), &d.message)).collect();
    assert!(found.len() == 1 && found[0].0 == code.number(), "{what}: {code} alone expected, found {found:?}");
}

/// A model that has no errors.
pub struct Model {
    /// The file's name without its ending.
    pub name: String,
    /// What it says.
    pub source: String,
}

/// Every model directly in `models/`, by name.
pub fn all() -> Vec<Model> {
    let files = charts(&repository("models"));
    assert!(!files.is_empty(), "there are models");
    files
        .iter()
        .map(|path| Model {
            name: stem(path),
            source: std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())),
        })
        .collect()
}

/// The names, without endings, of what is in `models/invalid/`.
pub fn invalid() -> Vec<String> {
    charts(&repository("models/invalid")).iter().map(|p| stem(p)).collect()
}

fn charts(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("entries can be read").path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "chart" || e == "xml"));
    files.sort();
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().and_then(|s| s.to_str()).expect("names of models are UTF-8").to_owned()
}
