//! Models by chance: the chart simulator keeps the rules of its meaning, and the compiled program does
//! what the chart does.
//!
//! `CHARTWRIGHT_RANDOM_MODELS=N` makes these tests look at that many models instead of a few hundred, and
//! `CHARTWRIGHT_RANDOM_MODELS=FROM..TO` at others. A model that fails is made as small as it can be before it is
//! shown. `CHARTWRIGHT_RANDOM_KEEP=FOLDER` puts models, programs and runs there, for others to judge.

use crate::support::items::{self, Item};
use crate::support::runs::{self, Inputs};
use crate::support::{random, shrink};
use chartwright::pipeline::{self, Dialect};
use chartwright::simulate::chart::Chart;
use std::panic::catch_unwind;
use std::path::Path;

/// How many scans each model runs.
const SCANS: usize = 100;

/// The seeds of the models that the tests look at.
fn seeds() -> std::ops::Range<u64> {
    random::seeds(300)
}

/// Looks for a fault in the model of each seed. A panic is a fault, too.
fn assert_none(fault: impl Fn(&str, u64) -> Option<String> + Copy + std::panic::RefUnwindSafe) {
    let fault = |model: &[Item], seed: u64| -> Option<String> {
        let source = items::text(model);
        catch_unwind(|| fault(&source, seed)).unwrap_or_else(|_| Some("a panic".into()))
    };
    for seed in seeds() {
        let model = random::model(seed);
        if let Some(what) = fault(&model, seed) {
            println!("model {seed}: {what}\nlooking for a small one");
            let small = shrink::shrink(&model, |smaller| fault(smaller, seed).is_some());
            let what = fault(&small, seed).expect("the small one fails, too");
            panic!("model {seed}\n{}\n{what}", items::text(&small));
        }
    }
}

#[test]
fn most_are_valid() {
    let mut found = std::collections::BTreeMap::new();
    let wanted = seeds().count();
    let valid = seeds().filter(|&seed| {
        let (machine, diagnostics) = pipeline::check(&items::text(&random::model(seed)));
        for d in diagnostics.iter() {
            *found.entry(d.code.number()).or_insert(0) += 1;
        }
        machine.is_some()
    });
    let valid = valid.count();
    println!("{valid} of {wanted} models are valid; said of all: {found:?}");
    assert!(valid * 10 > wanted * 7, "{valid} of {wanted}: {found:?}");
}

#[test]
fn a_chart_stays_coherent() {
    assert_none(|source, seed| runs::incoherence(source, seed, SCANS));
}

#[test]
fn the_program_does_what_the_chart_does() {
    if let Some(folder) = std::env::var_os("CHARTWRIGHT_RANDOM_KEEP") {
        for seed in seeds() {
            runs::keep(&items::text(&random::model(seed)), seed, Path::new(&folder));
        }
    }
    assert_none(|source, seed| {
        let dialect = if seed % 2 == 0 { Dialect::Beremiz } else { Dialect::Codesys };
        runs::disagreement(source, seed, SCANS, dialect)
    });
}

#[test]
fn all_that_a_model_has_is_exercised() {
    let (mut states, mut entered, mut transitions, mut fired, mut acted, mut rounds) = (0, 0, 0, 0, 0, [0; 5]);
    // Filters that need three rounds are rare.
    for seed in random::seeds(500) {
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
