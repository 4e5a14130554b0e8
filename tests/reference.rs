//! `models/reference`: what the sentences of the reference say, as scenarios. Each model is proved, and its
//! scenarios go as expected on the chart and on the PLC program.

use crate::support::models::{listing, repository};
use chartwright::pipeline::{self, Dialect, Options};
use chartwright::simulate::scenario;

#[test]
fn what_the_reference_says_is_so() {
    let mut played = 0;
    for file in listing("models/reference") {
        let source = std::fs::read_to_string(repository("models/reference").join(&file)).expect("models can be read");
        let dialect = if played % 2 == 0 { Dialect::Beremiz } else { Dialect::Codesys };
        let options = Options { dialect, created: "1970-01-01T00:00:00".into(), prove: true };
        let (output, diagnostics) = pipeline::build(&source, &options);
        assert!(output.is_some() && diagnostics.is_empty(), "{file}: {diagnostics:#?}");
        let machine = pipeline::check(&source).0.expect("it has been built");
        for (i, s) in machine.scenarios.iter().enumerate() {
            for (program, run) in pipeline::programs(&machine) {
                let verdict = scenario::play(&machine, run, i, &mut |_, _| {});
                assert!(verdict.failure.is_none(), "{file}: {} ({program}): {:?}", s.name, verdict.failure);
            }
            played += 1;
        }
    }
    assert!(played > 60, "{played} scenarios");
}
