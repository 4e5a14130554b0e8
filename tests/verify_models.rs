//! Machines to what is true of all their runs, held against the simulators.

use crate::support::models::{self, Model};
use crate::support::rng::Rng;
use crate::support::{items, random};
use chartwright::ir::chart::Mark;
use chartwright::pipeline::findings::Findings;
use chartwright::pipeline::verify::{Options, Program, Question, Status, Times, Verified, verify};
use chartwright::pipeline::{self};
use chartwright::simulate::frame::Layout;
use chartwright::simulate::run::Program as Runs;
use chartwright::simulate::scenario::play;
use chartwright::verify::Limits;

fn options(open: bool) -> Options {
    Options { open, ..Options::default() }
}

fn ask(text: &str, options: &Options) -> Verified {
    let (verified, diagnostics) = verify(text, options, &|| false, &mut |_| {});
    verified.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

fn model(name: &str) -> Model {
    models::all().into_iter().find(|m| m.name == name).expect("the model is there")
}

fn status(verified: &Verified, question: Question) -> Status {
    verified.answers.iter().find(|a| a.question == question).expect("it is asked").status
}

/// Questions with their verdicts, without those of which nothing is to be said.
fn remarks(verified: &Verified) -> Vec<String> {
    let remarks = verified.answers.iter().filter(|a| a.status != Status::Holds);
    remarks.map(|a| format!("{:?}: {}", a.status, Findings::new(&verified.machine, "").sentence(a))).collect()
}

#[test]
fn the_gate_keeps_its_properties() {
    let verified = ask(&model("properties").source, &options(false));
    let declared = (0..4).map(|i| status(&verified, Question::Declared(i)));
    assert_eq!(declared.collect::<Vec<_>>(), [Status::Holds; 4], "{:?}", remarks(&verified));
    assert!(verified.situations.is_some());
    // Without the plant nobody says that the gate shuts, but P1 holds all the same: it is the filter's.
    let open = ask(&model("properties").source, &options(true));
    assert_eq!(status(&open, Question::Declared(0)), Status::Holds);
}

#[test]
fn a_broken_property_is_shown_by_a_scenario_that_fails() {
    let text = model("properties").source.replace("P1: never LAMP and Shut", "P1: never LAMP and Near and Far");
    let verified = ask(&text, &options(false));
    let answer = &verified.answers[0];
    assert_eq!((answer.question, answer.status), (Question::Declared(0), Status::Violated));
    let run = answer.run.as_ref().expect("there is a run");
    assert!(run.shortest && run.replayed == Some(true));
    let with = format!("{text}\n{}", run.scenario);
    let (machine, diagnostics) = pipeline::check(&with);
    let machine = machine.unwrap_or_else(|| panic!("{}: {diagnostics:?}", run.scenario));
    for (name, program) in pipeline::programs(&machine) {
        let verdict = play(&machine, program, machine.scenarios.len() - 1, &mut |_, _| {});
        let failure = verdict.failure.unwrap_or_else(|| panic!("{name} passes {}", run.scenario));
        assert_eq!(failure.scan, run.frames.len() as u64, "{name}");
    }
}

#[test]
fn what_never_is_reachable_is_said() {
    let text = model("properties").source.replace("P3: reachable LAMP and Open", "P3: reachable LAMP and Guard");
    let verified = ask(&text, &options(false));
    assert_eq!(status(&verified, Question::Declared(2)), Status::Violated);
    assert!(verified.answers.iter().all(|a| a.question != Question::Declared(2) || a.run.is_none()));
}

#[test]
fn a_filter_keeps_its_constraints_behind_any_program() {
    for name in ["filter_simple", "filter_combined", "filter_controller", "properties"] {
        let text = model(name).source;
        let any = Options { program: Program::Any, ..options(true) };
        let verified = ask(&text, &any);
        assert!(!verified.answers.is_empty(), "{name}");
        for answer in &verified.answers {
            if matches!(answer.question, Question::Violated(_)) {
                assert_eq!(answer.status, Status::Holds, "{name}: {:?}", answer.question);
            }
        }
    }
}

#[test]
fn a_run_says_in_which_scan_a_blocking_filter_stopped_the_machine() {
    // The simulator, which numbers the scans itself, repeats it.
    let asked = "properties { P1: never first(S2) and prev(Ack) and Ack and Turn }";
    let text = format!("{}\n{asked}\n", model("filter_blocking").source);
    let verified = ask(&text, &options(true));
    let answer = &verified.answers[0];
    assert_eq!((answer.question, answer.status), (Question::Declared(0), Status::Violated));
    let run = answer.run.as_ref().expect("there is a run");
    assert_eq!(run.replayed, Some(true), "{}", run.scenario);
    let layout = Layout::of(&verified.machine);
    let numbers: Vec<Option<u32>> = run.frames.iter().map(|frame| layout.first_scan(frame)).collect();
    let last = numbers.last().copied().flatten().expect("it is numbered");
    let place = layout.mark(Mark::Noted);
    let begins = (0..run.frames.len()).rev().find(|&i| i == 0 || !run.frames[i - 1][place]).expect("it begins");
    assert_eq!(last as usize, begins + 1, "{numbers:?}");
}

/// The last of some scans in a row, ordered down and not there, that are possible with such a travel.
fn latest(plant: &str, travels: &str, times: Times) -> usize {
    let states: Vec<String> = (1..=8).map(|i| format!("state S{i}")).collect();
    let steps: Vec<String> = (1..8).map(|i| format!("from S{i} to S{} when not Down", i + 1)).collect();
    let asked: Vec<String> = (1..=8).map(|i| format!("P{i}: never in(S{i}) and not Down")).collect();
    let text = format!(
        "machine M\ncycle 10ms\ninputs {{ Go Up Down }}\noutputs {{ RAM }}\n\
         actuator Ram monostable {{ position Top sensor Up position Bottom output RAM sensor Down }}\n\
         chart C {{ initial state Off state On {{ drives RAM initial {} {} }} from Off to On when Go }}\n\
         {plant} {{ Ram travels {travels} }}\nproperties {{ {} }}\n",
        states.join(" "),
        steps.join(" "),
        asked.join(" ")
    );
    let verified = ask(&text, &Options { times, ..options(false) });
    (0..8).filter(|&i| status(&verified, Question::Declared(i)) == Status::Violated).count()
}

#[test]
fn what_travels_at_most_so_long_is_there_in_time() {
    // In the scan that orders it, it is not there, and then for a scan less than it may take.
    for (scans, time) in [(1, "10ms"), (2, "20ms"), (3, "30ms"), (5, "50ms"), (6, "60ms")] {
        for times in [Times::Exact, Times::Free] {
            assert_eq!(latest("plant", &format!("at most {time}"), times), scans, "{time}");
        }
        // Outputs may be written late in the scan.
        assert_eq!(latest("plant by steps", &format!("at most {time}"), Times::Free), scans + 1, "{time}");
        // What travels so long is there then, too.
        assert_eq!(latest("plant", time, Times::Exact), scans, "{time}");
    }
    assert_eq!(latest("plant", "20ms", Times::Free), 8);
    assert_eq!(latest("plant by steps", "20ms", Times::Free), 8);
}

#[test]
fn every_run_of_small_models_is_one_of_the_simulator() {
    let mut runs = 0;
    for model in models::all().into_iter().filter(|m| m.name != "indexa") {
        for open in [false, true] {
            let verified = ask(&model.source, &options(open));
            for answer in &verified.answers {
                let Some(run) = &answer.run else { continue };
                assert_eq!(run.replayed, Some(true), "{} {open}: {:?}", model.name, answer.question);
                runs += 1;
            }
        }
    }
    assert!(runs > 100, "{runs} runs");
}

#[test]
fn every_run_of_random_models_is_one_of_the_simulator() {
    let (mut runs, mut states) = (0, 0);
    let limits = Limits { steps: 100_000, scans: 6, conflicts: 300, ..Limits::default() };
    for seed in 0..20 {
        let text = items::text(&random::model(seed));
        if pipeline::check(&text).0.is_none() {
            continue;
        }
        let verified = ask(&text, &Options { limits, ..options(true) });
        for answer in &verified.answers {
            let Some(run) = &answer.run else { continue };
            assert_eq!(run.replayed, Some(true), "{seed}: {:?}\n{text}", answer.question);
            runs += 1;
        }
        // What the simulator reaches by chance is reachable.
        let (machine, _) = pipeline::check(&text);
        let machine = machine.expect("random models have no errors");
        let mut run = chartwright::simulate::run::Run::new(&machine, Runs::chart(&machine));
        let mut rng = Rng::new(seed + 1);
        for _ in 0..40 {
            for id in machine.inputs.ids() {
                run.plant().force(id, Some(rng.chance(50)));
            }
            run.scan();
            let broken = (0..machine.safety.assumptions.len()).any(|i| run.frame()[run.layout().broken(i)]);
            if broken {
                break;
            }
            for s in machine.states.ids().filter(|&s| run.frame()[run.layout().state(s)]) {
                assert_ne!(status(&verified, Question::Active(s)), Status::Violated, "{seed} {s:?}\n{text}");
                states += 1;
            }
        }
    }
    assert!(runs > 100 && states > 500, "{runs} runs, {states} states");
}
