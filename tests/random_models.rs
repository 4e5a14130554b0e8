//! Models by chance.
//!
//! `CHARTWRIGHT_RANDOM_MODELS=N` makes these tests look at that many instead of a few hundred.

use crate::support::rng::Rng;
use crate::support::{items, random, shrink};
use chartwright::ir::chart::{Atom, Machine};
use chartwright::pipeline;
use chartwright::simulate::chart::Chart;

/// How many scans each model runs.
const SCANS: usize = 100;

/// How many models the tests look at.
fn models() -> usize {
    std::env::var("CHARTWRIGHT_RANDOM_MODELS").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

/// Inputs that change rarely or often, the same for the same seed.
struct Inputs {
    rng: Rng,
    percent: usize,
    now: Vec<bool>,
}

impl Inputs {
    fn new(machine: &Machine, seed: u64) -> Inputs {
        let mut rng = Rng::new(seed);
        let now = machine.inputs.ids().map(|_| rng.chance(50)).collect();
        Inputs { percent: rng.between(3, 50), rng, now }
    }

    fn next(&mut self) -> &[bool] {
        for value in &mut self.now {
            *value ^= self.rng.chance(self.percent);
        }
        &self.now
    }
}

#[test]
fn most_are_valid() {
    let mut found = std::collections::BTreeMap::new();
    let wanted = models();
    let valid = (0..wanted as u64).filter(|&seed| {
        let (machine, diagnostics) = pipeline::check(&items::text(&random::model(seed)));
        for d in diagnostics.iter() {
            *found.entry(d.code.number()).or_insert(0) += 1;
        }
        machine.is_some()
    });
    let valid = valid.count();
    println!("{valid} of {wanted} models are valid; said of all: {found:?}");
    assert!(valid * 2 > wanted, "{valid} of {wanted}: {found:?}");
}

/// What is wrong with a run of the chart simulator, if anything is.
fn incoherence(source: &str, seed: u64) -> Option<String> {
    let machine = pipeline::check(source).0?;
    let (mut chart, mut again) = (Chart::new(&machine), Chart::new(&machine));
    let mut inputs = Inputs::new(&machine, seed);
    let mut before: Option<Vec<bool>> = None;
    let mut past = vec![false; machine.outputs.len()];
    for scan in 1..=SCANS {
        let now = inputs.next().to_vec();
        chart.scan(&now);
        again.scan(&now);
        let wrong = |what: String| Some(format!("scan {scan}: {what}"));
        for (id, region) in machine.regions.iter() {
            let active = region.states.iter().filter(|&&s| chart.is_active(s)).count();
            let wanted = region.parent.is_none_or(|p| chart.is_active(p)) as usize;
            if active != wanted {
                return wrong(format!("{active} active states in `{}`, not {wanted}", machine.region_path(id)));
            }
        }
        let value = |atom: &Atom| match *atom {
            Atom::Input(i) => now[i.index()],
            Atom::PrevInput(i) => before.as_ref().unwrap_or(&now)[i.index()],
            Atom::Output(o) => chart.output(o),
            Atom::PrevOutput(o) => past[o.index()],
            Atom::Variable(v) => chart.variable(v),
            Atom::In(_) | Atom::Done(_) | Atom::After(..) => unreachable!("constraints do not know of states"),
        };
        let mut assumed = true;
        for (i, assumption) in machine.safety.assumptions.iter().enumerate() {
            let broken = assumption.never.eval(&mut |a| value(a));
            assumed &= !broken;
            if broken != chart.broken(i) {
                return wrong(format!("`{}` is broken: {broken}", assumption.name));
            }
        }
        if assumed && chart.filter_failed() {
            return wrong("the filter found no way".into());
        }
        let mut acted = false;
        for (id, constraint) in machine.safety.constraints.iter() {
            acted |= chart.acted(id);
            if constraint.never.eval(&mut |a| value(a)) && !chart.filter_failed() {
                return wrong(format!("the outputs violate `{}`", constraint.name));
            }
        }
        if !acted && machine.outputs.ids().any(|o| chart.output(o) != chart.command(o)) {
            return wrong("an output is not as commanded, and nothing has acted".into());
        }
        let same = chart.active().eq(again.active())
            && chart.fired() == again.fired()
            && machine.variables.ids().all(|v| chart.variable(v) == again.variable(v))
            && machine
                .outputs
                .ids()
                .all(|o| chart.output(o) == again.output(o) && chart.command(o) == again.command(o));
        if !same {
            return wrong("the second run differs".into());
        }
        past = machine.outputs.ids().map(|o| chart.output(o)).collect();
        before = Some(now);
    }
    None
}

#[test]
fn a_chart_stays_coherent() {
    for seed in 0..models() as u64 {
        let model = random::model(seed);
        if let Some(what) = incoherence(&items::text(&model), seed) {
            let small = shrink::shrink(&model, |source| incoherence(source, seed).is_some());
            panic!("model {seed}: {what}\nthe smallest that fails:\n{}", items::text(&small));
        }
    }
}

#[test]
fn all_that_a_model_has_is_exercised() {
    let (mut states, mut entered, mut transitions, mut fired, mut acted, mut rounds) = (0, 0, 0, 0, 0, [0; 5]);
    for seed in 0..models() as u64 {
        let Some(machine) = pipeline::check(&items::text(&random::model(seed))).0 else { continue };
        let mut chart = Chart::new(&machine);
        let mut inputs = Inputs::new(&machine, seed);
        let (mut been, mut taken) = (vec![false; machine.states.len()], vec![false; machine.transitions.len()]);
        for _ in 0..SCANS {
            chart.scan(inputs.next());
            chart.active().for_each(|s| been[s.index()] = true);
            chart.fired().iter().for_each(|t| taken[t.index()] = true);
            acted += machine.safety.constraints.ids().filter(|&c| chart.acted(c)).count();
            rounds[chart.filter_rounds().min(5) - 1] += 1;
        }
        states += been.len();
        transitions += taken.len();
        entered += been.iter().filter(|&&b| b).count();
        fired += taken.iter().filter(|&&t| t).count();
    }
    println!("{entered} of {states} states entered, {fired} of {transitions} transitions fired");
    println!("constraints acted {acted} times; scans by rounds of the filter: {rounds:?}");
    assert!(entered * 5 > states * 2 && fired * 4 > transitions, "{entered} of {states}, {fired} of {transitions}");
    assert!(acted > 0 && rounds[1] > 0 && rounds[2] > 0, "{acted}, {rounds:?}");
}
