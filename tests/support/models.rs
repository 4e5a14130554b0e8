//! The models of the repository.

use std::path::{Path, PathBuf};

/// A model that has no errors.
pub struct Model {
    /// The file's name without its ending.
    pub name: String,
    /// What it says.
    pub source: String,
}

/// The repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Every model directly in `models/`, by name.
pub fn all() -> Vec<Model> {
    let files = charts(&root().join("models"));
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
    charts(&root().join("models/invalid")).iter().map(|p| stem(p)).collect()
}

fn charts(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("entries can be read").path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "chart"));
    files.sort();
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().and_then(|s| s.to_str()).expect("names of models are UTF-8").to_owned()
}
