//! Filters behind a program of which nothing is known.

use crate::support::models;
use crate::support::rng::Rng;
use crate::support::{items, random};
use chartwright::ir::chart::Machine;
use chartwright::pipeline::verify::{Options, Program, Question, Status, system, verify};
use chartwright::verify::aig::{Lit, lanes};
use chartwright::verify::machine::Subject;
use std::collections::HashMap;

/// What the system sees in a scan, and does next.
struct Runner<'s, 'm> {
    subject: &'s Subject<'m>,
    latches: Vec<bool>,
    values: Vec<u64>,
}

impl<'s, 'm> Runner<'s, 'm> {
    fn new(subject: &'s Subject<'m>) -> Self {
        let latches = subject.system.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
        Runner { subject, latches, values: Vec::new() }
    }

    /// One scan; `give` knows the inputs by name.
    fn scan(&mut self, give: &mut impl FnMut(&str) -> bool) {
        let system = &self.subject.system;
        let inputs: Vec<bool> = system.inputs.iter().map(|i| give(system.name(i.leaf))).collect();
        self.values = system.evaluate(&self.latches, &inputs);
        self.latches = system.latches.iter().map(|l| self.value(l.next)).collect();
    }

    fn value(&self, lit: Lit) -> bool {
        lanes(&self.values, lit) & 1 == 1
    }

    fn values(&self, lits: &[Lit]) -> Vec<bool> {
        lits.iter().map(|&l| self.value(l)).collect()
    }
}

/// Plays the charts of a machine, and hands what they decide to the filter as what an unknown program does.
fn play(machine: &Machine, seed: u64) -> usize {
    let charts = system(machine, Program::Chart, true).expect("it can be verified");
    let any = system(machine, Program::Any, true).expect("it can be verified");
    let (mut known, mut unknown) = (Runner::new(&charts), Runner::new(&any));
    let mut rng = Rng::new(seed + 1);
    let mut acted = 0;
    for scan in 0..40 {
        let mut given: HashMap<String, bool> = HashMap::new();
        known.scan(&mut |name| *given.entry(name.to_owned()).or_insert_with(|| rng.chance(40)));
        let now = &charts.view.scan;
        let mut put = |name: String, lit: Lit| given.insert(name, known.value(lit));
        for (id, output) in machine.outputs.iter() {
            put(format!("command {}", output.name), now.commands[id.index()]);
        }
        for (id, variable) in machine.variables.iter() {
            put(variable.name.clone(), now.after.variables[id.index()]);
        }
        for (id, event) in machine.events.iter() {
            put(format!("raise {}", event.name), now.after.raised[id.index()]);
        }
        for (id, integer) in machine.integers.iter() {
            for (i, &bit) in now.after.integers[id.index()].iter().enumerate() {
                put(format!("{}[{i}]", integer.name), bit);
            }
        }
        unknown.scan(&mut |name| given[name]);
        let then = &any.view.scan;
        let what = format!("{} {seed}, scan {scan}", machine.name);
        assert_eq!(known.values(&now.after.outputs), unknown.values(&then.after.outputs), "{what}");
        assert_eq!(known.values(&now.acted), unknown.values(&then.acted), "{what}");
        assert_eq!(known.values(&now.broken), unknown.values(&then.broken), "{what}");
        assert_eq!(known.values(&now.after.marks), unknown.values(&then.after.marks), "{what}");
        assert_eq!(known.values(&now.after.variables), unknown.values(&then.after.variables), "{what}");
        assert_eq!(known.values(&now.events), unknown.values(&then.events), "{what}");
        for (a, b) in now.after.integers.iter().zip(&then.after.integers) {
            assert_eq!(known.values(a), unknown.values(b), "{what}");
        }
        for s in machine.states.ids().filter(|&s| machine.observes(s)) {
            let (a, b) = (now.after.active[s.index()], then.after.active[s.index()]);
            assert_eq!(known.value(a), unknown.value(b), "{what}: {}", machine.state_path(s));
        }
        let states = machine.states.ids().filter(|&s| !machine.observes(s));
        assert!(states.into_iter().all(|s| !unknown.value(then.after.active[s.index()])), "{what}");
        acted += known.values(&now.acted).iter().filter(|a| **a).count();
    }
    acted
}

#[test]
fn what_a_chart_does_an_unknown_program_can_do() {
    let (mut acted, mut observers) = (0, 0);
    let random = (0..60).map(|seed| (seed, items::text(&random::model(seed))));
    let written = models::all().into_iter().filter(|m| m.name != "indexa").map(|m| (0, m.source));
    for (seed, text) in random.chain(written) {
        let Some(machine) = chartwright::pipeline::check(&text).0 else { continue };
        observers += usize::from(machine.states.ids().any(|s| machine.observes(s)));
        acted += play(&machine, seed);
    }
    assert!(acted > 500 && observers > 10, "filters acted {acted} times, {observers} machines with observers");
}

#[test]
fn what_holds_behind_any_program_holds_behind_the_charts() {
    let options = |program| Options { program, ..Options::default() };
    let mut held = 0;
    for model in models::all().into_iter().filter(|m| !["indexa", "palletizer", "productis"].contains(&&*m.name)) {
        let ask =
            |program| verify(&model.source, &options(program), &|| false, &mut |_| {}).0.expect("it has no errors");
        let (any, charts) = (ask(Program::Any), ask(Program::Chart));
        for answer in &any.answers {
            let kept = matches!(answer.question, Question::Violated(_));
            assert!(!kept || answer.status == Status::Holds, "{}: {:?}", model.name, answer.question);
            if kept || (matches!(answer.question, Question::Declared(_)) && answer.status == Status::Holds) {
                let same = charts.answers.iter().find(|a| a.question == answer.question).expect("it is asked, too");
                assert_eq!(same.status, Status::Holds, "{}: {:?}", model.name, answer.question);
                held += 1;
            }
        }
    }
    assert!(held > 100, "{held} answers");
}

#[test]
fn a_late_observer_lets_something_happen_that_the_filter_should_prevent() {
    let text = r#"
        machine Push
        inputs { Part  Out }
        outputs { PUSH }
        actuator Pusher onoff by PUSH
        observer Way {
          initial state Free
          state Carried
          from Carried to Free when Out
          after filter { from Free to Carried when rise(PUSH) and Part }
        }
        chart C { initial state A { drives PUSH } }
        safety controller { S1: never rise(PUSH) and in(Carried) }
        plant {
          hidden Moving
          Moving rises when rise(PUSH) and prev(Part)
          Moving falls when Out
        }
        properties { P1: never rise(PUSH) and Moving }
    "#;
    let any = Options { program: Program::Any, ..Options::default() };
    let ask = |text: &str| verify(text, &any, &|| false, &mut |_| {}).0.expect("it has no errors").answers[0].status;
    let late = text.replace(
        "after filter { from Free to Carried when rise(PUSH) and Part }",
        "from Free to Carried when prev(PUSH) and Part",
    );
    assert_eq!((ask(text), ask(&late)), (Status::Holds, Status::Violated));
}
