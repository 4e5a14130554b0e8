//! One snapshot per model and stage: opening `snapshots/<model>/` shows the whole compilation, but for XML that is too
//! long to be read.

use crate::support::models::{self, Model};
use chartwright::emit::{self, Dialect, Header};
use chartwright::ir::{outline, source};
use chartwright::pipeline::show::{Stage, show};
use chartwright::{derive, parse, pipeline, resolve};
use std::collections::{BTreeMap, BTreeSet};
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
    let (machine, diagnostics) = pipeline::check(&model.source);
    // What is meant so is accepted, with its reason.
    assert!(diagnostics.is_empty(), "{}: {diagnostics:?}", model.name);
    let project = pipeline::lower(&machine.expect("a model without errors has a machine"));
    let header = Header { created: "1970-01-01T00:00:00".into(), version: "0".into(), remark: None };
    let [tree, chart, sfc, ladder, names] =
        Stage::ALL.map(|stage| show(&model.source, stage).0.expect("a model without errors has every stage"));
    let [beremiz, codesys] =
        [Dialect::Beremiz, Dialect::Codesys].map(|d| readable(emit::plcopen(&project, d, &header)));
    [tree, chart, sfc, ladder, beremiz, codesys, names]
}

/// The longest XML that a person reads through, in bytes.
const WHOLE: usize = 100 * 1024;

/// An XML, or of a long one how long it is, a hash of it, and how often each element stands in it: the other stages
/// say what is in it.
fn readable(xml: String) -> String {
    if xml.len() <= WHOLE {
        return xml;
    }
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for tag in xml.split('<').skip(1).filter(|tag| tag.starts_with(|c: char| c.is_ascii_alphabetic())) {
        let name = tag.split(|c: char| c.is_whitespace() || c == '>' || c == '/').next().unwrap_or(tag);
        *counts.entry(name).or_default() += 1;
    }
    // FNV-1a, as its authors publish it.
    let hash = xml
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    let counts: String = counts.iter().map(|(name, count)| format!("{count:>8} {name}\n")).collect();
    format!("{:>8} bytes\n{hash:016x} FNV-1a\n{counts}", xml.len())
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
