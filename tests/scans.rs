//! The PLC simulator on files that the compiler wrote, against what a referee saw and across dialects.

use crate::support::models;
use chartwright::emit::Dialect;
use chartwright::ir::iec::{Kind, Project, Scope};
use chartwright::simulate::plc::Plc;
use chartwright::simulate::trace::{Inputs, Row, Trace};
use chartwright::{pipeline, read};

const DIALECTS: [Dialect; 2] = [Dialect::Beremiz, Dialect::Codesys];

fn build(name: &str, dialect: Dialect) -> Project {
    let model = models::all().into_iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no model {name}"));
    let options = pipeline::Options { dialect, created: "1970-01-01T00:00:00".to_owned(), prove: false };
    let xml = pipeline::build(&model.source, &options).0.expect("a model builds").xml;
    let (project, diagnostics) = read::read(&xml);
    project.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"))
}

/// Plays inputs and sees all global variables, sorted by name.
fn play(project: &Project, inputs: &Inputs, scans: u64) -> Trace {
    let mut seen: Vec<_> = project.variables.iter().filter(|(_, v)| v.scope == Scope::Global).collect();
    seen.sort_by(|a, b| a.1.name.cmp(&b.1.name));
    let find = |name: &String| project.global(name).unwrap_or_else(|| panic!("there is no variable {name}"));
    let ids: Vec<_> = inputs.names.iter().map(find).collect();
    let tick = project.tick().expect("there is a task");
    let mut plc = Plc::new(project);
    let mut trace = Trace { names: seen.iter().map(|(_, v)| v.name.clone()).collect(), rows: Vec::new() };
    for scan in 1..=scans {
        for &(name, value) in inputs.before(scan) {
            plc.write(ids[name], value);
        }
        let now = (scan as i64 - 1) * tick;
        plc.scan(now);
        let value = |id, kind| if kind == Kind::Time { plc.read(id) / 1000 } else { plc.read(id) };
        let values = seen.iter().map(|(id, v)| value(*id, v.kind)).collect();
        trace.rows.push(Row { scan, time: now / 1000, values });
    }
    trace
}

/// All inputs of a project, changed at random.
fn random_inputs(project: &Project, scans: u64, seed: u64) -> Inputs {
    let mut state = seed;
    let mut random = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let is_input = |a: &Option<String>| a.as_deref().is_some_and(|a| a.starts_with("%I"));
    let names = project.variables.values().filter(|v| is_input(&v.address)).map(|v| v.name.clone()).collect();
    let mut inputs = Inputs { names, ..Inputs::default() };
    for scan in 1..=scans {
        let count = inputs.names.len();
        let mut changes = Vec::new();
        for i in 0..count {
            if random(6) == 0 {
                changes.push((i, random(2) as i64));
            }
        }
        inputs.changes.insert(scan, changes);
    }
    inputs
}

#[test]
fn indexa_does_what_the_referee_saw() {
    let fixture = |name: &str| std::fs::read_to_string(models::repository("tests/fixtures").join(name));
    let inputs = Inputs::parse(&fixture("indexa_cycle.inputs.csv").expect("the inputs are there")).unwrap();
    let expected = Trace::parse(&fixture("indexa_cycle.expected.csv").expect("the outputs are there")).unwrap();
    for dialect in DIALECTS {
        let project = build("indexa", dialect);
        let trace = play(&project, &inputs, expected.rows.len() as u64);
        let missing: Vec<_> = expected.names.iter().filter(|n| !trace.names.contains(n)).collect();
        assert!(missing.is_empty(), "{missing:?}");
        if let Some(difference) = expected.difference(&trace) {
            panic!("{dialect:?}: {difference}");
        }
    }
}

#[test]
fn both_dialects_do_the_same() {
    for model in models::all() {
        let [one, two] = DIALECTS.map(|d| build(&model.name, d));
        for seed in 1..4 {
            let inputs = random_inputs(&one, 300, seed);
            let (one, two) = (play(&one, &inputs, 300), play(&two, &inputs, 300));
            assert_eq!(one.names, two.names, "{}", model.name);
            if let Some(difference) = one.difference(&two) {
                panic!("{}: {difference}", model.name);
            }
        }
    }
}

#[test]
fn traces_are_read_as_they_are_written() {
    let project = build("bistable", Dialect::Beremiz);
    let trace = play(&project, &random_inputs(&project, 20, 1), 20);
    assert_eq!(Trace::parse(&trace.to_string()).unwrap(), trace);
    let mut other = trace.clone();
    other.rows[7].values[2] ^= 1;
    let difference = trace.difference(&other).unwrap();
    assert_eq!((difference.scan, &difference.name), (8, &trace.names[2]));
    other.rows.truncate(5);
    let difference = trace.difference(&other).unwrap();
    assert_eq!((difference.scan, difference.right), (6, None));
    for (wrong, part) in [
        ("", "empty"),
        ("ms,A\n", "first column"),
        ("scan,A\n1\n", "line 2 has 1"),
        ("scan,A\n1,x\n", "`x`"),
        ("scan,A\n0,1\n", "no scan 0"),
    ] {
        assert!(Inputs::parse(wrong).unwrap_err().contains(part), "{wrong}");
    }
}
