//! What comes sooner or later: on machines, and in what is written for other tools.

use crate::support::models;
use crate::support::rng::Rng;
use crate::support::systems::{comes, random_fair};
use crate::verify_export::{ask, read_aiger};
use chartwright::pipeline;
use chartwright::pipeline::verify::{Options, Question, Status, Verified, verify};
use chartwright::simulate::scenario::play;
use chartwright::verify::aig::Lit;
use chartwright::verify::export::{aiger, btor2, smv};
use chartwright::verify::liveness::monitor;
use chartwright::verify::{Choice, Engine, Giver, Limits, Property, System, Verdict, check};

fn press() -> String {
    models::all().into_iter().find(|m| m.name == "eventually").expect("the model is there").source
}

fn look(text: &str, open: bool, choice: Choice) -> Verified {
    let limits = Limits { scans: 20, ..Limits::default() };
    let options = Options { open, choice, limits, ..Options::default() };
    let (verified, diagnostics) = verify(text, &options, &|| false, &mut |_| {});
    verified.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

fn status(verified: &Verified, question: Question) -> Status {
    verified.answers.iter().find(|a| a.question == question).expect("it is asked").status
}

fn declared(verified: &Verified) -> Vec<Status> {
    (0..3).map(|i| status(verified, Question::Declared(i))).collect()
}

#[test]
fn plant_and_clocks_do_what_they_owe() {
    for choice in [Choice::Automatic, Choice::Only(Engine::Exact), Choice::Only(Engine::Proof)] {
        let verified = look(&press(), false, choice);
        assert_eq!(declared(&verified), [Status::Holds; 3], "{choice:?}");
        assert!((0..3).all(|i| status(&verified, Question::Arises(i)) == Status::Holds), "{choice:?}");
        // Without a plant nobody says that the ram arrives.
        let verified = look(&press(), true, choice);
        assert_eq!(declared(&verified)[..2], [Status::Violated; 2], "{choice:?}");
    }
}

#[test]
fn each_fairness_is_needed() {
    let text = press();
    // Who gives parts while nobody waits gives none.
    let other = text.replace("(Part and not Stop or not in(Waiting))", "Part");
    assert_eq!(declared(&look(&other, false, Choice::Automatic))[2], Status::Violated);
    let none = text.replace("  assume F1", "  // assume F1");
    assert_eq!(declared(&look(&none, false, Choice::Automatic))[2], Status::Violated);
    // Of a time that is not waited for nothing is owed.
    let never = text.replace("when after 300ms", "when after 300ms and Stop");
    assert_eq!(declared(&look(&never, false, Choice::Automatic))[1], Status::Violated);
}

#[test]
fn what_speaks_of_nothing_is_said_to() {
    let text = press().replace("P1: after in(Down)", "P1: after Up and Low");
    let verified = look(&text, false, Choice::Automatic);
    assert_eq!(status(&verified, Question::Declared(0)), Status::Holds);
    assert_eq!(status(&verified, Question::Arises(0)), Status::Violated);
    // So is a fairness that no run can keep.
    let text = press().replace("(Part and not Stop or not in(Waiting))", "(Up and Low)");
    let verified = look(&text, false, Choice::Automatic);
    assert!((0..3).all(|i| status(&verified, Question::Arises(i)) == Status::Violated));
}

#[test]
fn a_loop_is_replayed_and_its_scenario_fails_until_the_model_is_mended() {
    let text = press().replace("(Part and not Stop or not in(Waiting))", "Part");
    for choice in [Choice::Automatic, Choice::Only(Engine::Exact), Choice::Only(Engine::Bounded)] {
        let verified = look(&text, false, choice);
        let answer = verified.answers.iter().find(|a| a.question == Question::Declared(2)).expect("it is asked");
        let run = answer.run.as_ref().expect("there is a run");
        assert_eq!(run.replayed, Some(true));
        assert!(run.repeats.is_some_and(|scan| (1..=run.frames.len()).contains(&scan)));
        let plays = |text: &str| {
            let (machine, diagnostics) = pipeline::check(&format!("{text}\n{}", run.scenario));
            let machine = machine.unwrap_or_else(|| panic!("{}: {diagnostics:?}", run.scenario));
            let last = machine.scenarios.len() - 1;
            let programs = pipeline::programs(&machine);
            let passes = |program| play(&machine, program, last, &mut |_, _| {}).failure.is_none();
            programs.into_iter().map(|(_, program)| passes(program)).collect::<Vec<_>>()
        };
        assert_eq!(plays(&text), [false, false], "{}", run.scenario);
        // The scenario holds the sensors as they were found, so what is mended must not wait for the ram.
        let mended = text
            .replace(
                "move from Waiting to Pressing as Down when Part and not Stop",
                "from Waiting to Pressing when Part",
            )
            .replace("in(Down)", "in(Pressing)");
        assert_eq!(plays(&mended), [true, true], "{}", run.scenario);
    }
}

/// A BTOR2 file to the system that it describes, with its justices first among what makes a run fair.
fn read_btor2(text: &str) -> System {
    let mut system = System::default();
    let mut lits = vec![Lit::FALSE];
    let (mut justice, mut fair) = (Vec::new(), Vec::new());
    let mut latch_of = std::collections::BTreeMap::new();
    for line in text.lines().filter(|l| !l.starts_with(';')) {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |i: usize| words[i].parse::<usize>().expect("a number");
        assert_eq!(number(0), lits.len(), "{line}");
        let lit = match words[1] {
            "sort" | "zero" => Lit::FALSE,
            "input" => system.input(words[3], Giver::Operator),
            "state" => {
                latch_of.insert(lits.len(), system.latches.len());
                system.latch(words[3], None)
            }
            "init" => {
                system.latches[latch_of[&number(3)]].initial = lits[number(4)].constant();
                Lit::FALSE
            }
            "next" => {
                system.latches[latch_of[&number(3)]].next = lits[number(4)];
                Lit::FALSE
            }
            "not" => !lits[number(3)],
            "and" => {
                let (a, b) = (lits[number(3)], lits[number(4)]);
                system.aig.and(a, b)
            }
            "constraint" => {
                system.constraints.push(lits[number(2)]);
                Lit::FALSE
            }
            "fair" => {
                fair.push(lits[number(2)]);
                Lit::FALSE
            }
            "justice" => {
                assert_eq!(number(2), 1);
                justice.push(lits[number(3)]);
                Lit::FALSE
            }
            other => panic!("{other}"),
        };
        lits.push(lit);
    }
    justice.into_iter().chain(fair).for_each(|l| system.fairness("", l));
    system
}

#[test]
fn aiger_and_btor2_say_the_same_of_what_comes_eventually() {
    let (mut held, mut violated) = (0, 0);
    for seed in 0..150 {
        let mut system = random_fair(&mut Rng::new(seed));
        system.claims.truncate(1);
        let Property::Eventually { after, then } = system.claims[0].property else { panic!("it claims nothing else") };
        let expected = comes(&system, after, then);
        held += usize::from(expected);
        violated += usize::from(!expected);
        let files = [
            read_aiger(aiger::ascii(&system).as_bytes()),
            read_aiger(&aiger::binary(&system)),
            read_btor2(&btor2::write(&system)),
        ];
        for mut file in files {
            assert_eq!(file.fair.len(), system.fair.len() + 1);
            // A run in which all of it comes again and again refutes the claim.
            file.claims.clear();
            file.claim("no such run", Property::Eventually { after: Lit::TRUE, then: Lit::FALSE });
            let report = check(&file, None, &Limits::default(), Choice::Only(Engine::Exact), &|| false, &mut |_| {});
            assert_eq!(report.findings[0].verdict == Verdict::Holds, expected, "{seed}");
        }
        let text = smv::write(&system);
        assert_eq!(text.lines().filter(|l| l.starts_with("LTLSPEC ")).count(), 1, "{text}");
    }
    assert!(held > 30 && violated > 30, "{held} hold, {violated} do not");
}

#[test]
fn abc_agrees_on_what_comes_eventually() {
    let Some(abc) = ["berkeley-abc", "abc", "yosys-abc"].into_iter().find(|tool| ask(tool, &["-h"]).is_some()) else {
        println!("SKIPPED: neither berkeley-abc, abc nor yosys-abc is on PATH");
        return;
    };
    let folder = std::env::temp_dir().join(format!("chartwright-abc-eventually-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let (mut held, mut violated) = (0, 0);
    for seed in 0..60 {
        let mut system = random_fair(&mut Rng::new(seed));
        // ABC knows no latch without an initial value in this flow.
        system.latches.iter_mut().for_each(|l| l.initial = Some(l.initial.unwrap_or(false)));
        let Property::Eventually { after, then } = system.claims[0].property else { panic!("it claims nothing else") };
        // No state comes back, said as what never is: that ABC can prove by its own means.
        let lasso = monitor::lasso(&system, after, then);
        let mut file = lasso.system;
        file.fair.clear();
        file.claim("comes back", Property::Never(lasso.bad));
        let path = folder.join(format!("{seed}.aig"));
        std::fs::write(&path, aiger::binary(&file)).expect("a file can be written");
        let said = ask(abc, &["-c", &format!("read_aiger {}; fold; strash; pdr", path.display())]).expect("it runs");
        let verdict = match () {
            () if said.contains("Property proved") => true,
            () if said.contains("was asserted in frame") => false,
            () => panic!("{seed}: {said}"),
        };
        assert_eq!(verdict, comes(&system, after, then), "{seed}: {said}");
        held += usize::from(verdict);
        violated += usize::from(!verdict);
    }
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    println!("ABC agrees on {held} claims that hold and {violated} that do not");
    assert!(held > 10 && violated > 10, "{held} hold, {violated} do not");
}
