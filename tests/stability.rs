//! Same input, same bytes; and an edit moves only what it touches.

use crate::support::models::{self, Model};
use chartwright::ir::plc::{Body, Project};
use chartwright::ir::text;
use chartwright::pipeline::{self, Dialect, Options, Output};
use std::collections::BTreeMap;

fn build(source: &str, dialect: Dialect) -> Output {
    let (output, diagnostics) =
        pipeline::build(source, &Options { dialect, created: "1970-01-01T00:00:00".into(), prove: false });
    output.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

fn model(name: &str) -> Model {
    models::all().into_iter().find(|m| m.name == name).expect("the model is there")
}

#[test]
fn a_second_run_gives_the_same_bytes() {
    for model in models::all() {
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let (a, b) = (build(&model.source, dialect), build(&model.source, dialect));
            assert!(a.xml == b.xml && a.names == b.names, "{}", model.name);
        }
    }
}

#[test]
fn comments_and_white_space_change_no_byte() {
    let model = model("indexa");
    let spaced = format!("// A comment.\n\n{}\n// The end.\n", model.source.replace('\n', "\n  "));
    assert!(build(&model.source, Dialect::Beremiz).xml == build(&spaced, Dialect::Beremiz).xml);
}

/// The text of each program's body, by name.
fn bodies(project: &Project) -> BTreeMap<String, String> {
    let alone = |i: usize| {
        let one = Project { programs: vec![project.programs[i].clone()], ..project.clone() };
        match one.programs[0].body {
            Body::Sfc(_) => text::sfc(&one),
            Body::Ladder(_) => text::ladder(&one),
        }
    };
    (0..project.programs.len()).map(|i| (project.programs[i].name.clone(), alone(i))).collect()
}

#[test]
fn a_new_state_in_one_region_leaves_the_other_programs_alone() {
    let model = model("indexa");
    let edited = model
        .source
        .replacen("final state Fed at Off", "state Waiting at Off\n          final state Fed at Off", 1)
        .replacen("from Running to Fed when PE", "from Running to Waiting when PE", 1)
        .replacen(
            "from Stopped to Running when TI",
            "from Stopped to Running when TI\n          from Waiting to Fed when CW",
            1,
        );
    assert_ne!(edited, model.source, "the edit fits the model");
    let before = build(&model.source, Dialect::Beremiz).project;
    let after = build(&edited, Dialect::Beremiz).project;
    let (before_bodies, after_bodies) = (bodies(&before), bodies(&after));
    let changed: Vec<&str> = after_bodies
        .iter()
        .filter(|(name, body)| before_bodies.get(*name) != Some(body))
        .map(|(name, _)| name.as_str())
        .collect();
    assert_eq!(changed, ["Prg_InProduction_Automatic_Operations_C"]);
    // Every name of before is there after, with one more flag.
    let names = |p: &Project| p.globals.values().map(|g| g.name.clone()).collect::<Vec<_>>();
    let new: Vec<String> = names(&after).into_iter().filter(|n| !names(&before).contains(n)).collect();
    assert_eq!(new, ["X_InProduction_Automatic_Operations_C_Waiting"]);
}
