//! One snapshot per model and stage: opening `snapshots/<model>/` shows the whole compilation.

use crate::support::models::{self, Model};
use chartwright::base::LineIndex;
use chartwright::emit::{self, Dialect, Header, names};
use chartwright::ir::{outline, source, text};
use chartwright::{check, derive, lower, parse, resolve};
use std::collections::BTreeSet;
use std::path::Path;

/// The stages, each with the ending of its snapshot.
const STAGES: [&str; 7] = ["1-ast", "2-chart", "3-sfc", "4-ladder", "5-beremiz.xml", "6-codesys.xml", "7-names.csv"];

#[test]
fn every_stage_of_every_model() {
    for model in models::all() {
        for (stage, content) in STAGES.iter().zip(stages(&model)) {
            insta::with_settings!({
                snapshot_path => models::repository("snapshots").join(&model.name),
                prepend_module_to_snapshot => false,
                omit_expression => true,
            }, {
                insta::assert_snapshot!(*stage, content);
            });
        }
    }
}

fn stages(model: &Model) -> [String; 7] {
    let (tree, diagnostics) = parse::parse(&model.source);
    assert!(!diagnostics.has_errors(), "{}: {diagnostics:?}", model.name);
    let tree = tree.expect("a model without errors has a tree");
    let mut whole = tree.clone();
    let diagnostics = derive::expand(&mut whole);
    assert!(!diagnostics.has_errors(), "{}: {diagnostics:?}", model.name);
    let (mut machine, diagnostics) = resolve::resolve(&whole);
    assert!(!diagnostics.has_errors(), "{}: {diagnostics:?}", model.name);
    let diagnostics = check::check(&mut machine);
    // What is known of some models, and meant so.
    let known: &[&str] = if model.name == "palletizer" { &["W502", "W503"] } else { &[] };
    assert!(diagnostics.iter().all(|d| known.contains(&d.code.number())), "{}: {diagnostics:?}", model.name);
    let project = lower::lower(&machine);
    let header = Header { created: "1970-01-01T00:00:00".into(), version: "0".into(), remark: None };
    [
        source::source(&tree),
        outline::outline(&machine),
        text::sfc(&project),
        text::ladder(&project),
        emit::plcopen(&project, Dialect::Beremiz, &header),
        emit::plcopen(&project, Dialect::Codesys, &header),
        names::table(&project, &machine, &LineIndex::new(&model.source)),
    ]
}

#[test]
fn a_tree_written_as_text_reads_back_as_the_same_text() {
    for model in models::all() {
        let once = source::source(&parse::parse(&model.source).0.expect("models have no errors"));
        let (again, diagnostics) = parse::parse(&once);
        assert!(diagnostics.is_empty(), "{}: {diagnostics:?}", model.name);
        assert_eq!(source::source(&again.expect("no errors, so a tree")), once, "{}", model.name);
        // And it means the same, not only looks the same.
        let machine = |text: &str| {
            let mut tree = parse::parse(text).0.expect("models have no errors");
            derive::expand(&mut tree);
            outline::outline(&resolve::resolve(&tree).0)
        };
        assert_eq!(machine(&once), machine(&model.source), "{}", model.name);
    }
}

#[test]
fn no_snapshot_is_orphaned() {
    let mut expected: BTreeSet<String> =
        models::all().iter().flat_map(|m| STAGES.map(|s| format!("{}/{s}.snap", m.name))).collect();
    expected.extend(models::invalid().iter().map(|name| format!("invalid/{name}.snap")));
    expected.extend(crate::findings::SNAPSHOTS.map(|name| format!("findings/{name}.snap")));
    let mut found = BTreeSet::new();
    collect(&models::repository("snapshots"), "", &mut found);
    let orphans: Vec<_> = found.difference(&expected).collect();
    assert!(orphans.is_empty(), "snapshots that no test writes: {orphans:?}");
}

fn collect(folder: &Path, prefix: &str, into: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).expect("the folder of snapshots is there") {
        let entry = entry.expect("its entries can be read");
        let name = entry.file_name().into_string().expect("names are UTF-8");
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{prefix}{name}/"), into);
        } else if !name.ends_with(".snap.new") {
            into.insert(format!("{prefix}{name}"));
        }
    }
}
