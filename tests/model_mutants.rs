//! A wrong model is found wrong: the papers' machines with a constraint left out, a literal negated, or an observer that
//! is late.
//!
//! Of each such model one of these has to be found, and all are counted:
//!
//! - the compiler refuses it;
//! - a declared property is violated; where a constraint or an observer is wrong, behind any program;
//! - a scenario of the model fails: a machine that never moves violates nothing that is never to be;
//! - it is the same machine: its outputs are those of the right one in every scan of every run, whatever the program commands,
//!   or with the model's own charts;
//! - it is listed in [`HARMLESS`] with the reason, and all properties are proved all the same;
//! - it is listed in [`UNASKED`] with the reason: what is wrong with it is nothing that properties or scenarios speak of.
//!
//! In the suite some are looked at, as far as the answer shows at once; most of them have to be found wrong.
//! `CHARTWRIGHT_MODEL_MUTANTS=200 cargo test --test main model_mutants -- --nocapture` looks at that many until each is
//! settled, and says what became of them.

use crate::support::model_damage::{Kind, Mutant, mutants};
use crate::support::models::{self, repository};
use crate::support::rng::Rng;
use chartwright::ir::chart::Machine;
use chartwright::ir::{scenario::PropertyKind, source};
use chartwright::pipeline::needed::{Effort, Kept, Without, compare};
use chartwright::pipeline::verify::{Options, Program, system};
use chartwright::pipeline::{self};
use chartwright::simulate::run::Program as Runs;
use chartwright::simulate::scenario::play;
use chartwright::verify::aig::{Aig, Lit, Node};
use chartwright::verify::limits::Limits;
use chartwright::verify::machine::Subject;
use chartwright::verify::solver::{Outcome, Solver};
use chartwright::verify::system::{Property, System};
use chartwright::verify::{Choice, Verdict, engine};
use std::collections::BTreeMap;

/// What is wrong, by words of its description, without harm: all properties are proved without it. Model by model, with the
/// reason.
const HARMLESS: &[(&str, &[&str], &str)] = &[
    (
        "four_cylinders",
        &["CS1 is left out", "CS7 is left out", "CS13 is left out", "CS19 is left out"],
        "mechanical: a rod does not set out again from half way",
    ),
    (
        "four_cylinders",
        &["H1 is seen late", "H2 is seen late", "H3 is seen late", "H4 is seen late"],
        "a pallet counts as carried for a scan more: the filter forbids more, and only delays",
    ),
    ("carts", &["SSC1 is left out", "SSC2 is left out"], "mechanical: with both orders the cart stands"),
    (
        "carts",
        &["E1 is left out", "E2 is left out", "E3 is left out", "E4 is left out"],
        "mechanical: a cart is not driven against the end of its rails",
    ),
    (
        "prehensor",
        &["in Both_", "Both_Go_up_Go_down is", "Both_Go_down_Go_up is", "Both_Go_in_Go_out is", "Both_Go_out_Go_in is"],
        "mechanical: a valve with both orders stays where it is",
    ),
    (
        "prehensor",
        &["End_Go_up is left out", "End_Go_down is left out", "End_Go_in is left out", "End_Go_out is left out"],
        "mechanical: a cylinder is not driven against its end",
    ),
    (
        "prehensor",
        &["F1_Go_down is left out", "_with_Go_", "_after_Go_"],
        "an order of a valve that remembers is held until its end (Hold_), so that each case is forbidden twice",
    ),
    (
        "palletizer",
        &["S8 is left out", "S23 is left out", "K1 is left out", "K4 is left out", "K5 is left out"],
        "mechanical, or of the rollers that carry pallets away, of which no hazard speaks",
    ),
    (
        "indexa",
        &["seen late in VerticalValve", "seen late in HorizontalValve"],
        "an order is held until its end (S8 to S10b): a scan later it is still there",
    ),
    (
        "indexa",
        &["S4 is", "S5 is", "S14 is", "in S14", "S16 is", "S22 is", "S23 is"],
        "a scan of rest between two movements, which sensors and M1 to M4 keep as well",
    ),
    (
        "indexa",
        &["S10b is left out", "S19 is left out", "S20 is left out", "in S20"],
        "a movement that is broken off leaves the machine where nothing else may move",
    ),
    (
        "indexa",
        &["S24 is left out", "in S24", "S26 is left out", "in S26", "C8 is left out", "C9 is left out"],
        "of the lid Z6 says only that it is not dropped",
    ),
    (
        "indexa",
        &["C1a is left out", "C1b is left out", "C2a is left out", "C2b is left out"],
        "mechanical: a valve with both orders stays where it is",
    ),
    ("indexa", &["C7 is left out"], "S21 stops the conveyor as soon as the table has left its place"),
    (
        "productis",
        &["K7_2 is", "K8_2 is", "K9_2 is", "K10_2 is", "K7_4 is", "K8_4 is", "K9_4 is", "K10_4 is", "T1 is", "T3 is"],
        "mechanical: a cylinder is not driven against its end, a distributor not both ways",
    ),
    (
        "productis",
        &["K15c_2 is", "K15d_2 is", "K15c_4 is", "K15d_4 is"],
        "its plant goes by scans: that a cylinder also moves between reading and writing is shown with the prehensor",
    ),
    ("productis", &["K16_2 is left out", "K16_4 is left out"], "of stoppers no property speaks"),
    (
        "palletizer",
        &["C4 is seen late in Pair", "C4 is seen late in Feed"],
        "of two cases the first one has been at the bar for longer than a scan",
    ),
    ("palletizer", &["is negated in Requests: drives O3"], "K4 and K5 hold O3 to what is asked of O2"),
    (
        "carts",
        &[
            "in(WasUp) is negated in Zone2: from Inside2",
            "in(WasDown) is negated in Zone2: from Inside2",
            "in(WasRight) is negated in Zone1: from Inside1",
            "in(WasLeft) is negated in Zone1: from Inside1",
            "prev(GO_UP) is negated in Zone2: from Inside2",
            "prev(GO_DOWN) is negated in Zone2: from Inside2",
            "prev(GO_RIGHT) is negated in Zone1: from Inside1",
            "prev(GO_LEFT) is negated in Zone1: from Inside1",
        ],
        "the zone counts as taken for longer: the filter forbids more, and only delays",
    ),
];

/// What is wrong, by words of its description, in a way of which the model says nothing.
const UNASKED: &[(&str, &[&str], &str)] = &[];

/// What became of a wrong model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    Refused,
    Violates,
    FailsScenario,
    Same,
    Harmless,
    Unasked,
    /// Takes more effort than the suite makes.
    Later,
    Open,
}

/// A model, and what can be wrong with it.
struct Case {
    name: String,
    machine: Machine,
    /// The properties that are asked, taken to hold: other tests say so of the models as they are.
    properties: Vec<(usize, Kept)>,
    mutants: Vec<Mutant>,
}

/// The machines of the papers; of the prehensor with its derived constraints written out.
fn cases() -> Vec<Case> {
    let papers = ["four_cylinders", "carts", "prehensor", "palletizer", "indexa", "productis"];
    let written = models::all().into_iter().filter(|m| papers.contains(&&*m.name));
    let cases = written.map(|model| {
        let text = spelled_out(&model.source);
        let (machine, diagnostics) = pipeline::check(&text);
        let machine = machine.unwrap_or_else(|| panic!("{}: {diagnostics:?}", model.name));
        let asked = |(i, p): (usize, &chartwright::ir::scenario::Property)| {
            matches!(p.kind, PropertyKind::Never | PropertyKind::Always).then_some((i, Kept::Yes))
        };
        let properties = machine.properties.iter().enumerate().filter_map(asked).collect();
        Case { name: model.name, machine, properties, mutants: mutants(&text) }
    });
    let cases: Vec<Case> = cases.collect();
    assert_eq!(cases.len(), papers.len());
    cases
}

/// With derived constraints in place of what they are derived from.
fn spelled_out(text: &str) -> String {
    if !text.contains("derive all") {
        return text.to_owned();
    }
    let (derived, _) = pipeline::derivable(text);
    let derived: Vec<String> = derived.iter().map(|d| format!("  {}", source::constraint(&d.constraint))).collect();
    let kept = text.lines().filter(|l| !l.contains(": forbid "));
    kept.map(|l| if l.trim() == "derive all" { derived.join("\n") } else { l.to_owned() })
        .collect::<Vec<_>>()
        .join("\n")
}

fn fate(case: &Case, mutant: &Mutant, thorough: bool) -> (Fate, String) {
    let (machine, diagnostics) = pipeline::check(&mutant.source);
    let Some(machine) = machine else {
        let codes: Vec<String> = diagnostics.iter().map(|d| d.code.to_string()).collect();
        return (Fate::Refused, codes.join(", "));
    };
    let program = if mutant.kind == Kind::Misguided { Program::Chart } else { Program::Any };
    let limits = Limits { steps: 4_000_000, scans: 60, conflicts: 20_000, ..Limits::default() };
    let options = Options { program, limits, ..Options::default() };
    let asked = |effort| compare(&case.machine, &case.properties, &mutant.source, &options, effort, &|| false);
    let lost = |answer: &Option<Without>| match answer {
        Some(Without::Violated(loss)) => Some(case.machine.properties[loss.property].name.clone()),
        _ => None,
    };
    let glance = if case.properties.is_empty() { None } else { asked(Effort::Glance) };
    if let Some(name) = lost(&glance) {
        return (Fate::Violates, name);
    }
    let runs = Runs::chart(&machine);
    for (i, scenario) in machine.scenarios.iter().enumerate() {
        if play(&machine, runs.clone(), i, &mut |_, _| {}).failure.is_some() {
            return (Fate::FailsScenario, scenario.name.clone());
        }
    }
    if same(&case.machine, &machine, program, thorough.then_some(&limits)) {
        return (Fate::Same, String::new());
    }
    let listed = |list: &[(&str, &[&str], &'static str)]| {
        let is_it = |(model, words, _): &&(&str, &[&str], &'static str)| {
            *model == case.name && words.iter().any(|w| mutant.what.contains(w))
        };
        list.iter().find(is_it).map(|&(.., reason)| reason)
    };
    if let Some(reason) = listed(UNASKED) {
        return (Fate::Unasked, reason.to_owned());
    }
    if !thorough && !matches!(glance, Some(Without::Kept(_))) {
        return (Fate::Later, String::new());
    }
    let all = glance.or_else(|| (!case.properties.is_empty()).then(|| asked(Effort::All)).flatten());
    if let Some(name) = lost(&all) {
        return (Fate::Violates, name);
    }
    match (listed(HARMLESS), all) {
        (Some(reason), Some(Without::Kept(_))) => (Fate::Harmless, reason.to_owned()),
        (_, Some(Without::Kept(_))) => (Fate::Open, "all properties hold".to_owned()),
        (_, Some(Without::Unknown(i, limit))) => (Fate::Open, format!("{}: {limit}", case.machine.properties[i].name)),
        (_, other) => (Fate::Open, if other.is_none() { "no scenario fails".to_owned() } else { String::new() }),
    }
}

/// Whether the outputs of two machines are the same in every scan of every run in which the same comes in; without limits
/// only if that shows in a single scan.
fn same(right: &Machine, wrong: &Machine, program: Program, limits: Option<&Limits>) -> bool {
    let (Ok(a), Ok(b)) = (system(right, program, false), system(wrong, program, false)) else { return false };
    let mut both = System::default();
    let differ = {
        let mut shared = BTreeMap::new();
        let one = import(&mut both, &a, &mut shared);
        let other = import(&mut both, &b, &mut shared);
        let differ: Vec<Lit> = one.iter().zip(&other).map(|(&x, &y)| both.aig.xor(x, y)).collect();
        both.aig.any(&differ)
    };
    if differ == Lit::FALSE || inductive(&both, a.system.latches.len(), differ) {
        return true;
    }
    let Some(limits) = limits else { return false };
    both.claim("the outputs differ", Property::Never(differ));
    let limits = Limits { steps: 1_000_000, scans: 12, conflicts: 5_000, ..*limits };
    let report = engine::check(&both, None, &limits, Choice::Automatic, &|| false, &mut |_| {});
    report.findings[0].verdict == Verdict::Holds
}

/// A system inside another one, with the inputs of the same name shared; what comes back are its outputs.
fn import(both: &mut System, subject: &Subject<'_>, shared: &mut BTreeMap<String, Lit>) -> Vec<Lit> {
    let system = &subject.system;
    let number = |l: Lit| match system.aig.node(l.node()) {
        Node::Leaf(number) => number as usize,
        Node::False | Node::And(..) => unreachable!("latches and inputs are leaves"),
    };
    let mut leaf = vec![Lit::FALSE; system.aig.leaves().len()];
    let first = both.latches.len();
    for latch in &system.latches {
        leaf[number(latch.leaf)] = both.latch(system.name(latch.leaf), latch.initial);
    }
    for input in &system.inputs {
        let name = system.name(input.leaf).to_owned();
        let here = *shared.entry(name.clone()).or_insert_with(|| both.input(name, input.giver));
        leaf[number(input.leaf)] = here;
    }
    let nexts: Vec<Lit> = system.latches.iter().map(|l| l.next).collect();
    let outputs = &subject.view.scan.after.outputs;
    let roots: Vec<Lit> = nexts.iter().chain(&system.constraints).chain(outputs).copied().collect();
    let image = both.aig.import(&system.aig, &roots, &mut |_: &mut Aig, n| leaf[n as usize]);
    for (i, &next) in image[..nexts.len()].iter().enumerate() {
        both.latches[first + i].next = next;
    }
    let constraints = nexts.len() + system.constraints.len();
    both.constraints.extend(&image[nexts.len()..constraints]);
    image[constraints..].to_vec()
}

/// Whether two systems with the same memory that remember the same decide the same, and remember the same again.
fn inductive(both: &System, half: usize, differ: Lit) -> bool {
    let (one, other) = both.latches.split_at(half);
    let names = |latches: &[chartwright::verify::Latch]| -> Vec<(String, Option<bool>)> {
        latches.iter().map(|l| (both.name(l.leaf).to_owned(), l.initial)).collect()
    };
    if names(one) != names(other) {
        return false;
    }
    let mut aig = Aig::new();
    // The second half reads the memory of the first one.
    let mut to = BTreeMap::new();
    for (a, b) in one.iter().zip(other) {
        to.insert(b.leaf.node(), a.leaf.node());
    }
    let nodes: BTreeMap<u32, usize> = (0..both.aig.len())
        .filter_map(|n| if let Node::Leaf(number) = both.aig.node(n) { Some((number, n)) } else { None })
        .collect();
    let nexts = both.latches.iter().map(|l| l.next);
    let roots: Vec<Lit> = nexts.chain(both.constraints.iter().copied()).chain([differ]).collect();
    let mut leaves: BTreeMap<usize, Lit> = BTreeMap::new();
    let image = aig.import(&both.aig, &roots, &mut |aig: &mut Aig, number| {
        let node = nodes[&number];
        let node = to.get(&node).copied().unwrap_or(node);
        *leaves.entry(node).or_insert_with(|| aig.leaf(""))
    });
    let (nexts, rest) = image.split_at(both.latches.len());
    let (constraints, differ) = rest.split_at(both.constraints.len());
    let (one, other) = nexts.split_at(half);
    let mut goal: Vec<Lit> = one.iter().zip(other).map(|(&x, &y)| aig.xor(x, y)).collect();
    goal.extend(differ);
    let goal = aig.any(&goal);
    let mut solver = Solver::new(&|| false);
    constraints.iter().for_each(|&c| solver.demand(&aig, c));
    solver.demand(&aig, goal);
    solver.solve(&[], &mut { 20_000 }) == Outcome::Never
}

#[test]
fn a_wrong_model_is_found_wrong() {
    let asked: Option<usize> = std::env::var("CHARTWRIGHT_MODEL_MUTANTS").ok().and_then(|n| n.parse().ok());
    let (wanted, thorough) = (asked.unwrap_or(16), asked.is_some());
    let mut cases = cases();
    if !thorough {
        // Of the palletizer little shows at once.
        cases.retain(|case| case.name != "palletizer");
    }
    let mut rng = Rng::new(7);
    cases.iter_mut().for_each(|case| rng.shuffle(&mut case.mutants));
    let mut counts: BTreeMap<(Kind, Fate), usize> = BTreeMap::new();
    let mut open = Vec::new();
    let (mut made, mut round) = (0, 0);
    while made < wanted && cases.iter().any(|c| round < c.mutants.len()) {
        for case in cases.iter().filter(|c| round < c.mutants.len()) {
            if made == wanted {
                break;
            }
            let mutant = &case.mutants[round];
            let start = std::time::Instant::now();
            let (fate, why) = fate(case, mutant, thorough);
            println!("{:?} {}: {} ({why}; {:?})", fate, case.name, mutant.what, start.elapsed());
            *counts.entry((mutant.kind, fate)).or_default() += 1;
            if fate == Fate::Open {
                open.push(format!("{}: {} ({why})", case.name, mutant.what));
            }
            made += 1;
        }
        round += 1;
    }
    println!("{made} wrong models: {counts:#?}");
    assert!(open.is_empty(), "nobody finds anything wrong with {} of {made}:\n{}", open.len(), open.join("\n"));
    let of = |fate: Fate| counts.iter().filter(|((_, f), _)| *f == fate).map(|(_, n)| n).sum::<usize>();
    let wrong = of(Fate::Violates) + of(Fate::FailsScenario) + of(Fate::Refused);
    assert!(wrong * 2 > made && of(Fate::Violates) * 5 > made, "{wrong} are found wrong: {counts:?}");
    assert!(of(Fate::Later) * 3 <= made, "{} take more effort", of(Fate::Later));
}

#[test]
fn damage_is_one_thing() {
    for case in cases() {
        let text = std::fs::read_to_string(repository(&format!("models/{}.chart", case.name))).expect("it is there");
        let text = spelled_out(&text);
        assert!(case.mutants.len() > 5, "{}: {}", case.name, case.mutants.len());
        for mutant in &case.mutants {
            let changed = text.lines().filter(|l| !mutant.source.lines().any(|m| m == *l)).count();
            assert!(changed <= 1, "{}: {}", case.name, mutant.what);
            assert_ne!(text.trim_end(), mutant.source.trim_end(), "{}: {}", case.name, mutant.what);
        }
    }
}
