//! What scenarios of a model show: it is known without a search, and nothing else is.

use crate::support::models;
use chartwright::pipeline;
use chartwright::pipeline::verify::{Options, Verified, verify};
use chartwright::verify::{Engine, Limits};

/// What is found without any time for a search, by scenarios alone.
fn asked(text: &str, options: Options) -> Verified {
    let stop = || false;
    let few = Limits { nodes: 10, steps: 10, scans: 1, conflicts: 0, at_first: 0 };
    let (verified, found) = verify(text, &Options { limits: few, ..options }, &stop, &mut |_| {});
    verified.unwrap_or_else(|| panic!("{found:?}\n{text}"))
}

#[test]
fn scenarios_of_the_models_are_runs_of_them() {
    let (mut witnesses, mut machines) = (0, 0);
    for models::Model { name, source: text, .. } in models::all() {
        let Some(machine) = pipeline::check(&text).0 else { continue };
        if machine.scenarios.is_empty() || machine.states.len() > 60 {
            continue;
        }
        let verified = asked(&text, Options::default());
        for answer in verified.answers.iter().filter(|a| a.engine == Engine::Scenario) {
            let run = answer.run.as_ref().expect("a scenario is a run");
            assert_eq!(run.replayed, Some(true), "{name}: {}", run.scenario);
            witnesses += 1;
        }
        machines += 1;
    }
    assert!(machines > 5 && witnesses > 50, "{machines}, {witnesses}");
}
