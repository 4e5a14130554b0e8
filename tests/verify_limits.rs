//! What takes long: long ways are gone, what somebody breaks off or has no time for says what is known, and why the rest is not.

#[path = "../benches/counting.rs"]
mod counting;

use crate::support::binary::{Scratch, chartwright, code, command, stderr, stdout};
use crate::support::random::seeds;
use crate::support::small::Small;
use chartwright::pipeline;
use chartwright::pipeline::verify::{Options, Program, Question, Status, Times, Verified, verify};
use chartwright::verify::machine::Subject;
use chartwright::verify::{Limits, parts, symbolic};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Everything that is asked has an answer, and the declared properties are true: `never` and the rest alike.
#[track_caller]
fn answered(text: &str) -> Verified {
    let end = Instant::now() + Duration::from_secs(60);
    let verified = verify(text, &Options::default(), &|| Instant::now() > end, &mut |_| {}).0;
    let verified = verified.unwrap_or_else(|| panic!("the model has errors:\n{text}"));
    for answer in &verified.answers {
        let demand = answer.question.kind().is_none();
        let known = if demand { answer.status == Status::Holds } else { !matches!(answer.status, Status::Unknown(_)) };
        assert!(known, "{:?}: {:?}\n{text}", answer.question, answer.status);
    }
    verified
}

#[test]
fn counters_beside_each_other_are_gone_through_one_by_one() {
    for (counters, top) in [(5, 1_000), (2, 3_000)] {
        let verified = answered(&counting::counters(counters, top));
        let most = verified.answers.iter().filter_map(|a| a.run.as_ref()).map(|r| r.frames.len()).max();
        // A part is a rising edge, so that it takes two scans; then the chart is full, and begins anew.
        assert_eq!(most, Some(2 * top as usize + 2));
        assert!(verified.answers.iter().filter_map(|a| a.run.as_ref()).all(|r| r.replayed == Some(true)));
    }
}

#[test]
fn a_region_of_as_many_states_as_there_may_be_is_gone_through() {
    answered(&counting::region(149));
}

#[test]
fn timers_beside_each_other_are_gone_through_one_by_one() {
    answered(&counting::timers(12));
}

/// More than anybody can go through: each digit goes on when all before it are at their ends.
fn endless() -> String {
    counting::shared(6, 30_000)
}

#[test]
fn what_is_not_known_says_why_and_what_would_help() {
    let directory = Scratch::new("limits_help");
    directory.write("m.chart", endless());
    let output = chartwright(directory.path(), "verify m.chart --time 1 --format json");
    assert_eq!(code(&output), 3);
    let json: serde_json::Value = serde_json::from_str(stdout(&output)).expect("it is JSON");
    let answers = json["answers"].as_array().expect("there are answers");
    let open: Vec<_> = answers.iter().filter(|a| a["verdict"] == "open").collect();
    assert!(!open.is_empty());
    for answer in open {
        assert_eq!(answer["reason"], "the time was up");
        let help = answer["help"].as_str().expect("something helps");
        assert!(help.contains("`--time`") && help.contains("Parts0 (line"), "{help}");
        assert_eq!(
            help.contains("a scenario"),
            ["unreachable", "silent"].contains(&answer["kind"].as_str().unwrap())
                || answer["says"].as_str().unwrap().starts_with("R "),
            "{answer}"
        );
    }
    assert!(answers.iter().filter(|a| a["verdict"] != "open").all(|a| a["help"].is_null()));
    let output = chartwright(directory.path(), "verify m.chart --time 1");
    let helps = stdout(&output).lines().filter(|l| l.starts_with("help  ")).count();
    assert!((1..=2).contains(&helps), "{}", stdout(&output));
}

/// Runs `verify` and interrupts it after a while.
#[cfg(unix)]
fn interrupted(directory: &Scratch, arguments: &str) -> std::process::Output {
    let mut child = command(directory.path(), arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    std::thread::sleep(Duration::from_secs(2));
    assert!(child.try_wait().expect("it can be asked").is_none(), "it takes long");
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.expect("there is kill").success());
    let begun = Instant::now();
    while child.try_wait().expect("it can be asked").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(20), "it does not end");
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("it has ended")
}

#[cfg(unix)]
#[test]
fn who_interrupts_is_told_what_is_known() {
    let directory = Scratch::new("limits_interrupted");
    directory.write("m.chart", endless());
    let output = interrupted(&directory, "verify m.chart --time 600");
    let said = stdout(&output);
    assert_eq!(code(&output), 3, "{said}{}", stderr(&output));
    assert!(said.contains("\nat least 1 of 2 states is active in some run; of 1 nobody knows\n"), "{said}");
    assert!(said.contains(": reachable DONE; is that so? (interrupted)"), "{said}");
    assert!(said.contains("\nhelp      what was interrupted"), "{said}");
    assert!(!said.contains("the time was up"), "{said}");

    // What is violated is so however little else is known.
    directory.write("m.chart", endless().replace("  R: ", "  X: never Part0\n  R: "));
    let output = interrupted(&directory, "verify m.chart --time 600 --format json");
    assert_eq!(code(&output), 1);
    let json: serde_json::Value = serde_json::from_str(stdout(&output)).expect("it is whole");
    let reasons: Vec<_> = json["answers"].as_array().unwrap().iter().filter(|a| a["verdict"] == "open").collect();
    // A run that was found but not rebuilt in time is known to be there.
    let known = ["interrupted", "there is a run, but the search ended before it could be shown"];
    assert!(reasons.iter().any(|a| a["reason"] == known[0]), "{reasons:?}");
    assert!(reasons.iter().all(|a| known.contains(&a["reason"].as_str().unwrap())), "{reasons:?}");
}

#[cfg(unix)]
#[test]
fn whoever_asks_what_is_needed_may_interrupt_as_well() {
    let directory = Scratch::new("limits_needed");
    let safety = "safety supervisor {\n  S1: never DONE and Part0\n  S2: never DONE and Part1\n}\nproperties {\n";
    directory.write("m.chart", endless().replace("properties {\n", safety));
    let output = interrupted(&directory, "verify m.chart --needed --program chart --time 600");
    let said = stdout(&output);
    assert!(said.contains("(interrupted)") && said.contains("\nhelp "), "{said}");
}

#[test]
fn what_is_so_of_a_part_is_so_of_the_whole() {
    let (mut agree, mut shorter) = ([0, 0], 0);
    for seed in seeds(60) {
        let source = Small::new(seed).source();
        let Some(machine) = pipeline::check(&source).0 else { continue };
        for times in [Times::Free, Times::Exact] {
            let subject = Subject::new(&machine, Program::Chart, false, times).expect("it can be verified");
            let all: Vec<usize> = (0..subject.questions.len()).collect();
            let subject = if times == Times::Exact { subject.wanting(&all) } else { subject };
            let system = &subject.system;
            let parts = parts::explore(system, &vec![true; all.len()], &Limits::default(), &|| false, &mut |_| {});
            let limits = Limits { steps: u64::MAX, ..Limits::default() };
            let whole = symbolic::explore(system, &limits, &|| false, &mut |_| {}).verdicts;
            for ((claim, part), whole) in system.claims.iter().zip(parts).zip(whole) {
                let (Some(part), Some(whole)) = (part, whole) else { continue };
                assert_eq!(part.is_ok(), whole.is_ok(), "seed {seed}, {times:?}: {}\n{source}", claim.name);
                agree[usize::from(part.is_err())] += 1;
                let (Err(part), Err(whole)) = (part, whole) else { continue };
                // An assumption elsewhere may ask for something to come in.
                if system.shows(&part, claim.property) && times == Times::Free {
                    assert_eq!(part.inputs.len(), whole.inputs.len(), "seed {seed}: {}\n{source}", claim.name);
                    shorter += 1;
                }
            }
        }
    }
    println!("{agree:?} claims hold and do not in parts as in the whole, {shorter} runs are as short");
    if seeds(60) == (0..60) {
        assert!(agree.iter().all(|&n| n > 300) && shorter > 100, "{agree:?}, {shorter}");
    }
}

#[test]
fn a_number_that_is_counted_in_the_same_state_as_another_comes_to_its_end() {
    let verified = {
        let end = Instant::now() + Duration::from_secs(20);
        verify(&counting::shared(2, 400), &Options::default(), &|| Instant::now() > end, &mut |_| {}).0.unwrap()
    };
    let open = verified.answers.iter().filter(|a| matches!(a.status, Status::Unknown(_))).map(|a| a.question);
    let open: Vec<Question> = open.collect();
    // That it stays possible is another matter.
    assert!(open.iter().all(|q| matches!(q, Question::Declared(1) | Question::Moves)), "{open:?}");
}
