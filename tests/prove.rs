//! Every model's program is proved to do what the model says, as it is written in each dialect and read
//! back; and what the proof takes for one scan is one scan on the simulators.
//!
//! `CHARTWRIGHT_RANDOM_MODELS=N` makes the tests with random models look at that many, and `FROM..TO` at others.

use crate::support::proof::{Simulated, build, read_back, verdict};
use crate::support::rng::Rng;
use crate::support::{items, models, random, shrink};
use chartwright::bits::aig;
use chartwright::bits::sat::{Answer, Budget, Sat};
use chartwright::pipeline::Dialect;
use chartwright::prove::chart_step::ChartStep;
use chartwright::prove::configuration;
use chartwright::prove::joint::{Joint, Run, Stimulus};
use chartwright::prove::lemmas::{Facts, Lemmas};
use chartwright::prove::matching::{Match, Pair};
use chartwright::prove::parts::Part;
use chartwright::prove::program_step::ProgramStep;
use chartwright::prove::{Correspondence, Doubt, Verdict, chart_filter};
use std::time::Instant;

const DIALECTS: [Dialect; 2] = [Dialect::Beremiz, Dialect::Codesys];

fn seeds() -> std::ops::Range<u64> {
    random::seeds(150)
}

#[test]
fn every_model_is_proved_in_both_dialects() {
    for model in models::all() {
        for dialect in DIALECTS {
            let output = build(&model.source, dialect).unwrap_or_else(|e| panic!("{}: {e}", model.name));
            let start = Instant::now();
            match verdict(&output) {
                Verdict::Proved(s) => {
                    println!("{}: {:?} {s:?}", model.name, start.elapsed());
                    assert_eq!(s.history, 0, "{}: what the compiler writes needs no look back", model.name);
                }
                Verdict::Refuted(trace) => panic!("{}:\n{trace}", model.name),
                Verdict::Unknown(doubt) => panic!("{}: {doubt}", model.name),
            }
        }
    }
}

/// What the proof has against the program of a model, if anything.
fn objection(source: &str, dialect: Dialect) -> Option<String> {
    // A panic on the way is an objection, too, and can be made smaller like any other.
    let verdict = std::panic::catch_unwind(|| Some(verdict(&build(source, dialect).ok()?)));
    let panic = Verdict::Unknown(Box::new(Doubt::Incomparable("panic".into())));
    match verdict.unwrap_or(Some(panic))? {
        Verdict::Proved(_) => None,
        Verdict::Refuted(trace) => Some(trace.to_string()),
        Verdict::Unknown(doubt) => Some(doubt.to_string()),
    }
}

#[test]
fn random_models_are_proved() {
    for seed in seeds() {
        let model = random::model(seed);
        let dialect = DIALECTS[seed as usize % 2];
        if let Some(what) = objection(&items::text(&model), dialect) {
            let small =
                items::text(&shrink::shrink(&model, |source| objection(&items::text(source), dialect).is_some()));
            let why = objection(&small, dialect).unwrap_or_default();
            panic!("model {seed}: {what}\nthe smallest that fails:\n{small}\n{why}");
        }
    }
}

/// Where a scan of the proof is no scan of the simulators.
fn divergence(source: &str, seed: u64) -> Option<String> {
    let output = build(source, DIALECTS[seed as usize % 2]).ok()?;
    let (machine, program) = (&output.machine, read_back(&output));
    let names = Correspondence::of(machine, &output.project);
    let rounds = chart_filter::rounds(machine, &mut Sat::new()).expect("the filter comes to rest");
    let (chart, step) = (ChartStep::new(machine, rounds), ProgramStep::new(&program).expect("it can be encoded"));
    let pair = Pair { machine, chart: &chart, program: &step };
    let matched = Match::of(pair, &names, &program).expect("all names are there");
    let joint = Joint::new(pair, &matched);
    let mut run = Run::new(&joint);
    let mut simulated = Simulated::new(machine, &names, &program);
    let mut rng = Rng::new(seed);
    let percent = rng.between(3, 50);
    let mut inputs: Vec<bool> = machine.inputs.ids().map(|_| rng.chance(50)).collect();
    for scan in 1..=100 {
        inputs.iter_mut().for_each(|value| *value ^= rng.chance(percent));
        let words: Vec<u64> = inputs.iter().map(|&b| u64::from(b)).collect();
        run.scan(&words, joint.cycle);
        simulated.scan(&Stimulus { pause: joint.cycle, inputs: inputs.clone() });
        let half = run.half();
        for (i, &(part, _)) in matched.parts.iter().enumerate() {
            let value = |l| Some(run.word(l) & 1 == 1);
            if simulated.chart(part).is_some_and(|v| Some(v) != value(half.chart[i])) {
                return Some(format!("scan {scan}: {} in the chart", simulated.describe(part)));
            }
            if simulated.program(part).is_some_and(|v| Some(v) != value(half.program[i])) {
                return Some(format!("scan {scan}: {} in the program", simulated.describe(part)));
            }
        }
    }
    None
}

#[test]
fn a_scan_of_the_proof_is_a_scan_of_the_simulators() {
    for model in models::all() {
        assert_eq!(divergence(&model.source, 5), None, "{}", model.name);
    }
    for seed in seeds() {
        let model = random::model(seed);
        if let Some(what) = divergence(&items::text(&model), seed) {
            let small = shrink::shrink(&model, |source| divergence(&items::text(source), seed).is_some());
            panic!("model {seed}: {what}\nthe smallest that fails:\n{}", items::text(&small));
        }
    }
}

#[test]
fn all_configurations_and_no_others_are_decoded() {
    let source = "machine M\ncycle 10ms\ninputs { I }\noutputs { O }\nactuator A onoff by O\nchart C {\n\
        initial state A { initial state B state C state D from B to C when I from C to D when I }\n\
        parallel state P { region X { initial state E state F from E to F when I } \
        region Y { initial state G { drives O } } }\n\
        from A to P when I\nfrom P to history of A when not I\n}\n";
    let machine = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}")).machine;
    let mut graph = aig::Aig::new();
    let state = configuration::any(&mut graph, &machine, &ChartStep::new(&machine, 1));
    let regions = machine.regions.ids();
    let mut wrong = Vec::new();
    for region in regions {
        wrong.push(configuration::broken(&mut graph, &machine, region, &state.active));
        wrong.push(configuration::confused(&mut graph, &machine, region, &state));
    }
    let wrong = graph.any(&wrong);
    assert!(matches!(Sat::new().ask(&graph, &[wrong], Budget::PROOF), Answer::Never));
    let remembered: Vec<aig::Lit> = state.active.iter().chain(state.last.iter().flatten()).copied().collect();
    let seen = assignments(&graph, &remembered);
    // A with three states inside, of which the active one is the last; or P with two beside one, when A was
    // left in one of the three or has never been active.
    assert_eq!(seen.len(), 3 + 2 * 4);
}

/// All values that these literals have together, over all those of the leaves.
fn assignments(graph: &aig::Aig, literals: &[aig::Lit]) -> std::collections::BTreeSet<Vec<u64>> {
    let count = graph.leaves().len();
    let assignment = |code: u64| {
        let leaves: Vec<u64> = (0..count).map(|i| code >> i & 1).collect();
        let mut values = Vec::new();
        graph.simulate(&leaves, &mut values);
        literals.iter().map(|&l| aig::lanes(&values, l) & 1).collect()
    };
    (0..1u64 << count).map(assignment).collect()
}

#[test]
fn a_time_has_passed_only_where_a_state_was_not_just_entered() {
    let source = "machine M\ncycle 10ms\ninputs { I }\noutputs { O }\nactuator A onoff by O\n\
        chart C { initial state A\nstate B { drives O }\nfrom A to B when I\nfrom B to A when after 50ms and I }\n";
    let machine = build(source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}")).machine;
    let mut graph = aig::Aig::new();
    let state = configuration::any(&mut graph, &machine, &ChartStep::new(&machine, 1));
    let seen = assignments(&graph, &[state.fresh[0], state.past[0]]);
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [[0, 0], [0, 1], [1, 0]]);
}

#[test]
fn every_part_of_a_machine_is_compared() {
    let model = models::all().into_iter().find(|m| m.name == "indexa").expect("INDEXA is a model");
    let output = build(&model.source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{e}"));
    let (machine, program) = (&output.machine, read_back(&output));
    let names = Correspondence::of(machine, &output.project);
    let (chart, step) = (ChartStep::new(machine, 1), ProgramStep::new(&program).expect("it can be encoded"));
    let pair = Pair { machine, chart: &chart, program: &step };
    let parts = Match::of(pair, &names, &program).expect("all names are there").parts;
    let count = |of: fn(&Part) -> bool| parts.iter().filter(|(part, _)| of(part)).count();
    assert_eq!(count(|p| matches!(p, Part::Flag(_))), machine.states.len());
    // Observers are rungs and have no steps.
    let charted = machine.states.ids().filter(|&s| !machine.observes(s)).count();
    assert_eq!(count(|p| matches!(p, Part::Step(_))), charted);
    assert_eq!(count(|p| matches!(p, Part::Input(_))), machine.inputs.len());
    assert_eq!(count(|p| matches!(p, Part::Output(_))), machine.outputs.len());
    assert_eq!(count(|p| matches!(p, Part::Variable(_))), machine.variables.len());
    assert_eq!(count(|p| matches!(p, Part::Command(_))), machine.outputs.len());
    assert_eq!(count(|p| matches!(p, Part::Acted(_))), machine.safety.constraints.len());
    assert_eq!(count(|p| matches!(p, Part::Broken(_))), machine.safety.assumptions.len());
}

#[test]
fn what_lemmas_exclude_never_happens() {
    let mut found = 0;
    for model in models::all() {
        let output = build(&model.source, Dialect::Beremiz).unwrap_or_else(|e| panic!("{}: {e}", model.name));
        let (machine, program) = (&output.machine, read_back(&output));
        let names = Correspondence::of(machine, &output.project);
        let rounds = chart_filter::rounds(machine, &mut Sat::new()).expect("the filter comes to rest");
        let (chart, step) = (ChartStep::new(machine, rounds), ProgramStep::new(&program).expect("it can be encoded"));
        let pair = Pair { machine, chart: &chart, program: &step };
        let joint = Joint::new(pair, &Match::of(pair, &names, &program).expect("all names are there"));

        // Any configurations, most of which cannot be reached.
        let mut graph = aig::Aig::new();
        let any = configuration::any(&mut graph, machine, &chart).bits();
        let mut rng = Rng::new(3);
        let leaves: Vec<u64> = graph.leaves().map(|_| rng.next()).collect();
        let mut values = Vec::new();
        graph.simulate(&leaves, &mut values);
        let mut lemmas = Lemmas::new(pair);
        for lane in 0..12 {
            let memory: Vec<bool> = any.iter().map(|&l| aig::lanes(&values, l) >> lane & 1 == 1).collect();
            if lemmas.exclude(&memory) {
                let hits = |facts: &Facts| facts.iter().all(|&(i, value)| memory[i] == value);
                assert!(lemmas.never().iter().any(hits), "{}: it is excluded by none", model.name);
            }
        }
        found += lemmas.never().len();

        let mut run = Run::new(&joint);
        let mut inputs: Vec<u64> = (0..joint.inputs).map(|_| rng.next()).collect();
        for _ in 0..400 {
            inputs.iter_mut().for_each(|word| *word ^= rng.next() & rng.next() & rng.next());
            run.scan(&inputs, joint.cycle);
            for lane in 0..64 {
                let memory = run.memory(lane).bits;
                for facts in lemmas.never() {
                    let happens = facts.iter().all(|&(i, value)| memory[i] == value);
                    assert!(!happens, "{}: {facts:?} was excluded", model.name);
                }
            }
        }
    }
    assert!(found > 20, "only {found} lemmas");
}
