//! Small machines by chance in plants of all kinds: every verdict is what going through all runs tells.
//!
//! `CHARTWRIGHT_RANDOM_MODELS=N` or `FROM..TO` looks at others. `CHARTWRIGHT_RANDOM_KEEP=FOLDER` puts the machines there,
//! for other tools.

use crate::support::explorer::graph::Truth;
use crate::support::explorer::{Explorer, without_times};
use crate::support::random::seeds;
use crate::support::small::{Plant, Small};
use chartwright::ir::chart::{Atom, Drive, Machine};
use chartwright::ir::expr::Expr;
use chartwright::pipeline;
use chartwright::pipeline::verify::{Program, Question, system};
use chartwright::verify::{Choice, Engine, Limits, Property, Verdict, check};
use std::collections::BTreeMap;

/// What the charts of [`Small::any`] drive: what more inputs tell them.
fn drive_anything(machine: &mut Machine) {
    let go = machine.states.ids().find(|&s| machine.states[s].name == "Go").expect("it has that state");
    for output in machine.outputs.ids() {
        let name = format!("Free{}", machine.outputs[output].name);
        let (input, free) = machine.inputs.iter().find(|(_, i)| i.name == name).expect("it has that input");
        let (condition, span) = (Expr::Atom(Atom::Input(input)), free.span);
        machine.states[go].drives.push(Drive { output, condition, technology: false, span });
    }
}

/// The questions about one machine as the other one asks them, whose properties have the same names.
fn translated(questions: &[Question], from: &Machine, to: &Machine) -> Vec<Question> {
    let property = |i: usize| {
        let name = &from.properties[i].name;
        to.properties.iter().position(|p| p.name == *name).expect("it has that property")
    };
    let each = |q: &Question| match *q {
        Question::Declared(i) => Question::Declared(property(i)),
        Question::Arises(i) => Question::Arises(property(i)),
        other => other,
    };
    questions.iter().map(each).collect()
}

/// What has been compared: for each kind of claim, how many hold and how many do not.
#[derive(Default)]
struct Tally {
    machines: usize,
    states: usize,
    kinds: BTreeMap<String, [usize; 2]>,
}

/// Compares what the engines say of a machine with the truths.
fn compare(seed: u64, small: &Small, program: Program, open: bool, tally: &mut Tally) {
    let (machine, _) = pipeline::check(&small.source());
    let Some(machine) = machine else { return };
    let subject = system(&machine, program, open).expect("it can be verified");
    let judged = match program {
        Program::Chart => machine.clone(),
        Program::Any => {
            let (judged, found) = pipeline::check(&small.any());
            let mut judged = judged.unwrap_or_else(|| panic!("{seed}: {found:#?}\n{}", small.any()));
            drive_anything(&mut judged);
            judged
        }
    };
    let questions = translated(&subject.questions, &machine, &judged);
    let (judged, timers) = without_times(&judged);
    let Some(graph) = Explorer::new(&judged, &timers, open, &questions).explore() else { return };
    let truths = graph.truths();
    tally.machines += 1;
    tally.states += graph.edges.len();
    for choice in
        [Choice::Automatic, Choice::Only(Engine::Exact), Choice::Only(Engine::Proof), Choice::Only(Engine::Bounded)]
    {
        let limits = Limits { scans: 12, ..Limits::default() };
        let report = check(&subject.system, None, &limits, choice, &|| false, &mut |_| {});
        for (i, (finding, &truth)) in report.findings.iter().zip(&truths).enumerate() {
            if matches!(subject.questions[i], Question::Beyond(_)) {
                continue;
            }
            let claim = &subject.system.claims[i];
            let what = || {
                let words = &claim.name;
                let text = small.source();
                format!("seed {seed}, {program:?}, open {open}, {choice:?}: {words}: not {truth:?}\n{text}")
            };
            match (&finding.verdict, truth) {
                (Verdict::Holds, Ok(())) => {}
                (Verdict::Violated(trace), Err(steps)) => {
                    let sure = trace.shortest && steps.is_some();
                    assert!(!sure || steps == Some(trace.inputs.len()), "{} steps: {}", trace.inputs.len(), what());
                }
                (Verdict::Unknown(_), _) => {
                    let may = match (choice, claim.property) {
                        (Choice::Automatic | Choice::Only(Engine::Exact), _) => false,
                        (Choice::Only(Engine::Proof), property) => {
                            matches!(property, Property::AlwaysPossible(_) | Property::NeverStuck)
                        }
                        (Choice::Only(Engine::Bounded | Engine::Chance | Engine::Scenario), _) => true,
                    };
                    assert!(may, "{:?}: {}", finding.verdict, what());
                }
                (Verdict::Holds | Verdict::Violated(_), _) => panic!("{:?}: {}", finding.verdict, what()),
            }
            if choice == Choice::Automatic {
                count(tally, claim.property, truth);
            }
        }
    }
}

fn count(tally: &mut Tally, property: Property, truth: Truth) {
    let kind = match property {
        Property::Never(_) => "never",
        Property::AlwaysPossible(_) => "always possible",
        Property::NeverStuck => "never stuck",
        Property::Eventually { .. } => "eventually",
    };
    tally.kinds.entry(kind.to_owned()).or_default()[usize::from(truth.is_err())] += 1;
}

#[test]
fn every_verdict_on_small_machines_is_what_going_through_all_runs_tells() {
    let mut kinds: BTreeMap<String, Tally> = BTreeMap::new();
    for seed in seeds(60) {
        let small = Small::new(seed);
        if let Some(folder) = std::env::var_os("CHARTWRIGHT_RANDOM_KEEP") {
            let path = std::path::Path::new(&folder).join(format!("small{seed}.chart"));
            std::fs::write(path, small.source()).expect("the folder is there");
        }
        for (program, open) in [(Program::Chart, false), (Program::Any, false), (Program::Chart, true)] {
            if open && (small.kind() == Plant::None || seed % 4 != 0) {
                continue;
            }
            let tally = kinds.entry(format!("{:?}, {program:?}, open {open}", small.kind())).or_default();
            compare(seed, &small, program, open, tally);
        }
    }
    let mut all = 0;
    for (kind, Tally { machines, states, kinds }) in &kinds {
        println!("{kind}: {machines} machines, {states} states; of each claim how many hold and do not: {kinds:?}");
        all += machines;
    }
    if seeds(60) == (0..60) {
        assert!(all > 80, "{all} machines");
        for plant in ["ByScans", "BySteps"] {
            for claim in ["never", "always possible", "eventually"] {
                let [held, not] = kinds[&format!("{plant}, Chart, open false")].kinds[claim];
                assert!(held > 5 && not > 5, "{plant}, {claim}: {held} hold, {not} do not");
            }
        }
    }
}
