//! `models/regressions`: small models that something once got wrong. Each says what.

use crate::support::models::{listing, repository};
use chartwright::pipeline::{self, Dialect, Options};

#[test]
fn what_was_wrong_once_is_right() {
    let files = listing("models/regressions");
    assert!(!files.is_empty(), "there are models");
    for file in files {
        let source = std::fs::read_to_string(repository("models/regressions").join(&file)).expect("models can be read");
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let options = Options { dialect, created: "1970-01-01T00:00:00".into(), prove: true };
            let (output, diagnostics) = pipeline::build(&source, &options);
            assert!(output.is_some(), "{file}: {diagnostics:#?}");
        }
    }
}
