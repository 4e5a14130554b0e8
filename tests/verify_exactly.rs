//! Times are those of the declared cycle: what verification says is what the simulators show.

use crate::support::explorer::{Explorer, without_times};
use crate::support::random::seeds;
use crate::support::small::Small;
use chartwright::ir::chart::Machine;
use chartwright::ir::expr::Expr;
use chartwright::ir::scenario::PropertyKind;
use chartwright::pipeline;
use chartwright::pipeline::verify::{Answer, Options, Program, Question, Status, Times, Verified, verify};
use chartwright::simulate::frame::Layout;
use chartwright::simulate::run::Program as Runs;
use chartwright::simulate::scenario::{Expectation, play};
use chartwright::verify::machine::Subject;
use chartwright::verify::machine::clocks::{Clock, Counted};
use chartwright::verify::{Choice, Limits, Verdict, check};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

fn ask(text: &str, times: Times) -> Verified {
    let options = Options { times, ..Options::default() };
    let (verified, diagnostics) = verify(text, &options, &|| false, &mut |_| {});
    verified.unwrap_or_else(|| panic!("{diagnostics:?}\n{text}"))
}

/// The verdicts on the declared properties.
fn declared(text: &str, times: Times) -> Vec<Status> {
    let verified = ask(text, times);
    let own = verified.answers.iter().filter(|a| matches!(a.question, Question::Declared(_)));
    own.map(|a| a.status).collect()
}

/// Whether each scenario that shows what is violated, put into the other model, fails there, on the chart and in the PLC.
fn fails(found: &Verified, model: &str) -> Vec<bool> {
    let mut fails = Vec::new();
    for answer in found.answers.iter().filter(|a| a.demand && a.status == Status::Violated) {
        if !matches!(answer.question, Question::Declared(_)) {
            continue;
        }
        let run = answer.run.as_ref().expect("it is shown");
        assert_eq!(run.replayed, Some(true), "{}", run.scenario);
        let (machine, found) = pipeline::check(&format!("{model}\n{}", run.scenario));
        let machine = machine.unwrap_or_else(|| panic!("{found:?}: {}", run.scenario));
        let scenario = machine.scenarios.len() - 1;
        let programs = pipeline::programs(&machine).into_iter();
        let failed: Vec<bool> =
            programs.map(|(_, p)| play(&machine, p, scenario, &mut |_, _| {}).failure.is_some()).collect();
        assert!(failed.iter().all(|&f| f == failed[0]), "chart and PLC differ: {}", run.scenario);
        fails.push(failed[0]);
    }
    fails
}

/// Ovens that are switched on together, each of which rings after its time.
fn ovens(times: &[&str], properties: &str) -> String {
    let each = |f: &dyn Fn(usize) -> String| (0..times.len()).map(f).collect::<String>();
    let outputs = each(&|i| format!(" BELL{i}"));
    let bells = each(&|i| format!("actuator Bell{i} onoff by BELL{i}\n"));
    let regions = each(&|i| {
        format!(
            "    region R{i} {{ initial state Bakes state Rings {{ drives BELL{i} }} from Bakes to Rings when after {} }}\n",
            times[i]
        )
    });
    format!(
        "machine Bakery\ncycle 20ms\ninputs {{ Start Stop }}\noutputs {{{outputs} }}\n{bells}chart Ovens {{\n  initial state Cold\n  \
         parallel state Hot {{\n{regions}  }}\n  from Cold to Hot when Start\n  from Hot to Cold when Stop\n}}\n\
         properties {{\n{properties}\n}}\n"
    )
}

#[test]
fn what_begins_together_ends_in_order_of_its_time() {
    use Status::{Holds, Violated};
    let asked = "  A: never BELL1 and not BELL0\n  B: never BELL2 and not BELL1\n  C: never BELL0 and not BELL2\n  \
                 D: reachable BELL0 and not BELL1\n  E: reachable BELL1 and not BELL0\n  F: always possible not BELL0";
    for times in [["40ms", "400ms", "4s"], ["20ms", "40ms", "600ms"]] {
        let begun = Instant::now();
        let text = ovens(&times, asked);
        assert_eq!(declared(&text, Times::Exact), [Holds, Holds, Violated, Holds, Violated, Holds], "{times:?}");
        assert!(begun.elapsed() < Duration::from_secs(60), "{times:?}: {:?}", begun.elapsed());
        // At any speed of each clock, all of that can be.
        let open = declared(&text, Times::Free);
        assert_eq!(open, [Violated, Violated, Violated, Holds, Holds, Holds], "{times:?}");
    }
}

/// Ovens each of which is switched on and off by itself.
fn bakery(times: &[&str], properties: &str) -> String {
    let each = |f: &dyn Fn(usize) -> String| (0..times.len()).map(f).collect::<String>();
    let inputs = each(&|i| format!(" On{i} Off{i}"));
    let outputs = each(&|i| format!(" BELL{i}"));
    let bells = each(&|i| format!("actuator Bell{i} onoff by BELL{i}\n"));
    let charts = each(&|i| {
        format!(
            "chart Oven{i} {{\n  initial state Cold\n  state Bakes\n  state Rings {{ drives BELL{i} }}\n  \
             from Cold to Bakes when On{i}\n  from Bakes to Rings when after {}\n  from Bakes to Cold when Off{i}\n  \
             from Rings to Cold when Off{i}\n}}\n",
            times[i]
        )
    });
    format!(
        "machine Bakery\ncycle 20ms\ninputs {{{inputs} }}\noutputs {{{outputs} }}\n{bells}{charts}properties {{\n{properties}\n}}\n"
    )
}

#[test]
fn long_times_side_by_side_cost_no_more_than_short_ones() {
    use Status::{Holds, Violated};
    let asked = "  A: reachable BELL0 and BELL1\n  B: never BELL0 and BELL1\n  C: always possible not BELL0\n  D: always possible BELL1\n  \
                 E: never BELL0 and prev(in(Oven0.Cold))\n  F: reachable BELL1 and in(Oven0.Bakes)";
    for times in [&["40ms", "60ms"][..], &["59s", "60s"], &["1s", "60s", "3600s"]] {
        let begun = Instant::now();
        let verified = ask(&bakery(times, asked), Times::Exact);
        let own = |a: &&Answer| matches!(a.question, Question::Declared(_));
        let declared: Vec<Status> = verified.answers.iter().filter(own).map(|a| a.status).collect();
        assert_eq!(declared, [Holds, Violated, Holds, Holds, Holds, Holds], "{times:?}");
        let open = verified.answers.iter().filter(|a| matches!(a.status, Status::Unknown(_)));
        assert_eq!(open.map(|a| a.question).collect::<Vec<Question>>(), [], "{times:?}");
        println!("{times:?}: {:?}", begun.elapsed());
        assert!(begun.elapsed() < Duration::from_secs(60), "{times:?}: {:?}", begun.elapsed());
    }
}

#[test]
fn times_that_are_one_scan_apart_are_told_apart() {
    use Status::{Holds, Violated};
    let asked = "  A: never BELL1 and not BELL0\n  B: reachable BELL0 and not BELL1";
    for (times, expected) in [
        (["300ms", "320ms"], [Holds, Holds]),
        // Both are over in the same scan, which begins at 320 ms.
        (["301ms", "320ms"], [Holds, Violated]),
        (["320ms", "300ms"], [Violated, Violated]),
    ] {
        assert_eq!(declared(&ovens(&times, asked), Times::Exact), expected, "{times:?}");
    }
}

/// A gate that is opened for a while, and an arm that goes through it and back.
fn gate(arm: &str, open: &str, guard: &str) -> String {
    format!(
        "machine Gate\ncycle 10ms\ninputs {{ Call Home Away }}\noutputs {{ OPEN GO }}\nactuator Door onoff by OPEN\n\
         actuator Arm monostable {{ position Near sensor Home position Far output GO sensor Away }}\n\
         chart Lock {{\n  initial state Shut\n  state Free {{ drives OPEN }}\n  from Shut to Free when rise(Call)\n  \
         from Free to Shut when after {open}{guard}\n}}\n\
         chart Hand {{\n  initial state Rest\n  state Reach {{ drives GO }}\n  state Back\n  from Rest to Reach when rise(Call) and in(Lock.Shut)\n  \
         from Reach to Back when Away\n  from Back to Rest when Home\n}}\n\
         plant {{ Arm travels {arm} }}\n\
         properties {{\n  Safe: never not OPEN and not Home\n  Comes: after rise(OPEN) eventually not OPEN\n}}\n"
    )
}

#[test]
fn a_guard_and_an_actuator_go_by_the_same_clock() {
    use Status::{Holds, Violated};
    // There and back takes twice its way, and some scans to see and to order.
    for (arm, open, expected) in [
        ("200ms", "500ms", [Holds, Holds]),
        ("200ms back 300ms", "500ms", [Holds, Holds]),
        ("200ms", "300ms", [Violated, Holds]),
    ] {
        assert_eq!(declared(&gate(arm, open, ""), Times::Exact), expected, "{arm}, {open}");
    }
    assert_eq!(declared(&gate("200ms", "500ms", ""), Times::Free)[0], Violated);
}

#[test]
fn the_scenario_of_a_counterexample_fails_until_the_model_is_mended() {
    // Mended by a guard that looks, and by a time that is long enough.
    let wrong = gate("200ms", "300ms", "");
    let found = ask(&wrong, Times::Exact);
    assert_eq!(fails(&found, &wrong), [true]);
    assert_eq!(fails(&found, &gate("200ms", "300ms", " and Home and in(Hand.Rest)")), [false]);
    assert_eq!(fails(&found, &gate("200ms", "500ms", "")), [false]);
}

#[test]
fn a_scenario_says_how_a_plant_begins_that_goes_its_own_way() {
    // The arm goes only if there is air to begin with, of which nobody says whether there is.
    let text = "machine Arm\ncycle 10ms\ninputs { Go Home Away }\noutputs { OUT }\n\
                actuator Arm monostable { position Near sensor Home position Far output OUT sensor Away }\n\
                chart C { initial state Rest state Reach { drives OUT } from Rest to Reach when Go }\n\
                plant { hidden Air  initially { any Air }  Arm travels 100ms when Air }\n\
                properties {\n  Stays: never Away\n  Dry: never Air\n}\n";
    let found = ask(text, Times::Exact);
    assert_eq!(fails(&found, text), [true, true]);
}

#[test]
fn a_rule_of_the_plant_takes_the_time_that_it_says() {
    use Status::{Holds, Violated};
    let text = |delay: &str, patience: &str| {
        format!(
            "machine Tank\ncycle 10ms\ninputs {{ Go Full }}\noutputs {{ FILL }}\nactuator Valve onoff by FILL\n\
             variables {{ Late : BOOL }}\n\
             chart C {{\n  initial state Idle\n  state Filling {{ drives FILL }}\n  state Alarm\n  from Idle to Filling when Go\n  \
             from Filling to Idle when Full\n  from Filling to Alarm when after {patience}\n}}\n\
             plant {{\n  Full rises when FILL after {delay}\n  Full falls when not FILL after 30ms\n}}\n\
             properties {{ Quiet: never in(C.Alarm) }}\n"
        )
    };
    for (delay, patience, expected) in
        [("300ms", "310ms", Holds), ("300ms", "290ms", Violated), ("60s", "20ms", Violated)]
    {
        assert_eq!(declared(&text(delay, patience), Times::Exact), [expected], "{delay}, {patience}");
    }
}

/// Whether a property holds with exact times.
fn holds(machine: &Machine, property: usize) -> bool {
    let Ok(subject) = Subject::new(machine, Program::Chart, false, Times::Exact) else { return false };
    let claim = subject.questions.iter().position(|q| *q == Question::Declared(property)).expect("it is asked");
    let subject = subject.wanting(&[claim]);
    let report = check(&subject.system, None, &Limits::default(), Choice::Automatic, &|| false, &mut |_| {});
    report.findings[0].verdict == Verdict::Holds
}

/// The outputs of which a condition of a small machine speaks.
fn outputs_in(condition: &str) -> Vec<&str> {
    let words = condition.split(|c: char| !c.is_alphanumeric());
    words.filter(|w| w.starts_with("Out")).collect::<BTreeSet<&str>>().into_iter().collect()
}

/// A model in which the filter keeps what a property forbids, where the compiler accepts that: the property as a constraint, which gives
/// way as it can.
fn constrained(source: &str, machine: &Machine, property: usize, scenario: &str) -> Vec<Machine> {
    let written = &machine.properties[property].written;
    let always = machine.properties[property].kind == PropertyKind::Always;
    let never = if always { format!("not ({written})") } else { written.clone() };
    let ways = outputs_in(written).into_iter().map(|o| format!(" yields {o}")).chain([String::new()]);
    let model = |way: String| {
        let line = format!("  Mend: never {never}{way}\n");
        let text = match source.find("safety ") {
            Some(at) => {
                let (before, rest) = source.split_at(at + source[at..].find("{\n").expect("it has a body") + 2);
                format!("{before}{line}{rest}")
            }
            None => format!("{source}\nsafety supervisor {{\n{line}}}\n"),
        };
        pipeline::check(&format!("{text}\n{scenario}")).0
    };
    ways.filter_map(model).collect()
}

/// Models in which less happens: a transition does not fire, an output is not driven, or none of either.
fn weakened(machine: &Machine) -> Vec<Machine> {
    let transitions: Vec<_> = machine.transitions.ids().collect();
    let states = machine.states.ids();
    let drives: Vec<_> = states.flat_map(|s| (0..machine.states[s].drives.len()).map(move |d| (s, d))).collect();
    let change = |transitions: &[_], drives: &[(_, usize)]| {
        let mut machine = machine.clone();
        transitions.iter().for_each(|&t| machine.transitions[t].guard = Expr::FALSE);
        drives.iter().for_each(|&(s, d)| machine.states[s].drives[d].condition = Expr::FALSE);
        machine
    };
    let one = transitions.iter().map(|&t| change(&[t], &[]));
    let another = drives.iter().map(|&d| change(&[], &[d]));
    let all = [change(&transitions, &[]), change(&[], &drives), change(&transitions, &drives)];
    one.chain(another).chain(all).collect()
}

/// What becomes of a scenario in a model, its last one: whether it fails; nothing if it cannot be played there, because the plant cannot
/// do what it tells, or inputs break what is assumed.
fn played(machine: &Machine) -> Option<bool> {
    let layout = Layout::of(machine);
    let mut broken = false;
    let verdict = play(machine, Runs::chart(machine), machine.scenarios.len() - 1, &mut |_, frame| {
        broken |= (0..machine.safety.assumptions.len()).any(|i| frame[layout.broken(i)]);
    });
    match verdict.failure.map(|f| f.kind) {
        Some(Expectation::Happens | Expectation::BeforeWriting) => None,
        failure => (!broken).then_some(failure.is_some()),
    }
}

/// Plays the scenario of a counterexample: it fails, and in each model that is mended it passes, by a constraint or by guards that let less
/// happen. Says in how many models of each kind, until there are some, and how many there are in which it cannot be played.
fn mends(source: &str, property: usize, scenario: &str) -> [[usize; 2]; 2] {
    let (machine, found) = pipeline::check(&format!("{source}\n{scenario}"));
    let machine = machine.unwrap_or_else(|| panic!("{found:?}: {scenario}"));
    assert_eq!(played(&machine), Some(true), "{source}\n{scenario} passes");
    let kinds = [constrained(source, &machine, property, scenario), weakened(&machine)];
    kinds.map(|models| {
        let (mut mended, mut others) = (0, 0);
        for model in models {
            if mended < 2 && holds(&model, property) {
                match played(&model) {
                    Some(failed) => {
                        assert!(
                            !failed,
                            "{source}\n{scenario} fails where it is mended: {:?}",
                            model.safety.constraints
                        );
                        mended += 1;
                    }
                    None => others += 1,
                }
            }
        }
        [mended, others]
    })
}

/// What never is while one of several clocks counts never is while all do. Says how many claims hold so that do not with open times.
fn with_one_clock(open: &Subject<'_>, truths: &[bool], seed: u64) -> usize {
    if open.all.len() < 2 {
        return 0;
    }
    let never = |i: &usize| open.system.claims[*i].property.never().is_some();
    let claims: Vec<usize> = (0..open.questions.len()).filter(never).collect();
    let holds = |counted: BTreeSet<Clock>| -> Vec<bool> {
        let subject = open.counting(&Counted::These(counted)).wanting(&claims);
        let limits = Limits { conflicts: 2_000, ..Limits::default() };
        let report = check(&subject.system, None, &limits, Choice::Automatic, &|| false, &mut |_| {});
        report.findings.iter().map(|f| f.verdict == Verdict::Holds).collect()
    };
    let none = holds(BTreeSet::new());
    let mut more = 0;
    for &clock in &open.all {
        for (i, held) in holds(BTreeSet::from([clock])).into_iter().enumerate() {
            let (claim, held_anyway) = (claims[i], none[i]);
            assert!(!held || truths[claim], "seed {seed}: {:?} with {clock:?}", open.questions[claim]);
            assert!(held || !held_anyway, "seed {seed}: {:?} with {clock:?}", open.questions[claim]);
            more += usize::from(held && !held_anyway);
        }
    }
    more
}

#[test]
fn every_verdict_is_what_going_through_all_runs_by_the_clock_tells() {
    let (mut machines, mut timed, mut partly, mut differ, mut answers) = (0, 0, 0, 0, [0, 0]);
    let (mut shown, mut mended, mut helpless, mut kinds) = (0, 0, 0, [0, 0]);
    for seed in seeds(40) {
        let source = Small::new(seed).source();
        let (machine, _) = pipeline::check(&source);
        let Some(machine) = machine else { continue };
        let subject = Subject::new(&machine, Program::Chart, false, Times::Free).expect("it can be verified");
        let (judged, timers) = without_times(&machine);
        let explorer = Explorer::new(&judged, &timers, false, &subject.questions).exactly();
        let Some(graph) = explorer.explore() else { continue };
        let verified = ask(&source, Times::Exact);
        machines += 1;
        timed += usize::from(subject.timed);
        let truths: Vec<bool> = graph.truths().iter().map(Result::is_ok).collect();
        partly += with_one_clock(&subject, &truths, seed);
        let open = if subject.timed { Some(ask(&source, Times::Free)) } else { None };
        for (i, (answer, truth)) in verified.answers.iter().zip(graph.truths()).enumerate() {
            if matches!(answer.question, Question::Beyond(_)) {
                continue;
            }
            let is = truth.is_ok() != answer.question.hopes_for_a_run(&machine);
            let expected = if is { Status::Holds } else { Status::Violated };
            let asked = format!("{:?}", answer.question);
            assert_eq!(answer.status, expected, "seed {seed}: {asked}\n{source}");
            answers[usize::from(truth.is_err())] += 1;
            differ += usize::from(open.as_ref().is_some_and(|o| o.answers[i].status != answer.status));
            if let (Question::Declared(p), Some(run)) = (answer.question, &answer.run)
                && matches!(machine.properties[p].kind, PropertyKind::Never | PropertyKind::Always)
            {
                assert_eq!(run.replayed, Some(true), "seed {seed}: {asked}\n{source}");
                shown += 1;
                let ways = mends(&source, p, &run.scenario);
                mended += usize::from(ways.iter().any(|w| w[0] > 0));
                helpless += usize::from(ways == [[0; 2]; 2]);
                kinds = [kinds[0] + ways[0][0], kinds[1] + ways[1][0]];
            }
        }
    }
    println!(
        "{machines} machines, {timed} of them with times; {answers:?} claims hold and do not, {differ} are another with open \
         times, {partly} hold with one clock already; {shown} counterexamples, {mended} of which pass in models that are mended, {kinds:?} of them by a constraint and by guards; \
         {helpless} that nothing of that mends"
    );
    if seeds(40) == (0..40) {
        assert!(timed > 15 && differ > 5 && shown > 10, "{timed}, {differ}, {shown}");
        // What is so of inputs alone, or to begin with, nothing mends; and in some mended models the plant cannot do what it did.
        assert!(5 * mended > 4 * (shown - helpless) && kinds[0] > 0 && kinds[1] > 0, "{mended} of {shown}: {kinds:?}");
    }
}
