//! What `verify` writes for other tools: read back by a reader of its own here, and by such tools where
//! they are installed.

use crate::support::rng::Rng;
use crate::support::systems::{random, truth};
use chartwright::verify::aig::{Aig, Lit, lanes};
use chartwright::verify::export::{aiger, btor2, smv, witness};
use chartwright::verify::{Choice, Giver, Latch, Limits, Property, System, Verdict, check};
use std::process::Command;

/// An AIGER file, text or binary, to the system that it describes: only what this test needs, and no error is
/// forgiven.
pub fn read_aiger(bytes: &[u8]) -> System {
    let mut at = 0;
    let mut line = || {
        let end = bytes[at..].iter().position(|&b| b == b'\n').expect("a line ends") + at;
        let text = std::str::from_utf8(&bytes[at..end]).expect("it is text").to_owned();
        at = end + 1;
        text
    };
    let head = line();
    let mut words = head.split(' ');
    let binary = words.next() == Some("aig");
    let n: Vec<usize> = words.map(|w| w.parse().expect("a number")).collect();
    let (n, fair) = n.split_at(7.min(n.len()));
    let [most, inputs, latches, 0, gates, bads, constraints] = n[..] else { panic!("{head}") };
    let [justice, fair] = match *fair {
        [] => [0, 0],
        [justice, fair] => [justice, fair],
        _ => panic!("{head}"),
    };
    assert_eq!(most, inputs + latches + gates);
    let numbers = |text: String| -> Vec<usize> { text.split(' ').map(|w| w.parse().expect("a number")).collect() };
    let mut system = System::default();
    let mut lits = vec![Lit::FALSE];
    for i in 0..inputs {
        assert!(binary || numbers(line()) == [2 * (i + 1)]);
        lits.push(system.input("", Giver::Operator));
    }
    let mut nexts = Vec::new();
    for i in 0..latches {
        let own = 2 * (inputs + i + 1);
        let mut words = numbers(line());
        if !binary {
            assert_eq!(words.remove(0), own);
        }
        let initial = match words.get(1) {
            None => Some(false),
            Some(1) => Some(true),
            Some(other) => {
                assert_eq!(*other, own);
                None
            }
        };
        lits.push(system.latch("", initial));
        nexts.push(words[0]);
    }
    let bads: Vec<usize> = (0..bads).map(|_| numbers(line())[0]).collect();
    let constraints: Vec<usize> = (0..constraints).map(|_| numbers(line())[0]).collect();
    for _ in 0..justice {
        assert_eq!(line(), "1", "each has one literal");
    }
    let recurs: Vec<usize> = (0..justice + fair).map(|_| numbers(line())[0]).collect();
    let lit = |lits: &[Lit], n: usize| lits[n / 2].xor(n % 2 == 1);
    for i in 0..gates {
        let own = 2 * (inputs + latches + i + 1);
        let (a, b) = if binary {
            let mut number = || {
                let (mut value, mut shift) = (0, 0);
                loop {
                    let byte = usize::from(bytes[at]);
                    at += 1;
                    value |= (byte & 0x7f) << shift;
                    shift += 7;
                    if byte < 0x80 {
                        return value;
                    }
                }
            };
            let a = own - number();
            (a, a - number())
        } else {
            let end = bytes[at..].iter().position(|&b| b == b'\n').expect("a line ends") + at;
            let words = numbers(std::str::from_utf8(&bytes[at..end]).expect("text").to_owned());
            at = end + 1;
            assert_eq!(words[0], own);
            (words[1], words[2])
        };
        assert!(own > a && a >= b, "{own} {a} {b}");
        let (a, b) = (lit(&lits, a), lit(&lits, b));
        lits.push(system.aig.and(a, b));
    }
    for (latch, next) in system.latches.iter_mut().zip(nexts) {
        latch.next = lit(&lits, next);
    }
    system.constraints = constraints.into_iter().map(|c| lit(&lits, c)).collect();
    for bad in bads {
        system.claim("", Property::Never(lit(&lits, bad)));
    }
    // Justices first: who looks at one takes the others away.
    for recurs in recurs {
        system.fairness("", lit(&lits, recurs));
    }
    system
}

/// The system with those claims only that AIGER can say.
fn sayable(seed: u64) -> System {
    let mut system = random(&mut Rng::new(seed));
    system.claims.retain(|c| matches!(c.property, Property::Never(_)));
    system
}

#[test]
fn both_forms_of_aiger_say_the_same_as_the_system() {
    for seed in 0..300 {
        let system = sayable(seed);
        let expected = truth(&system);
        for bytes in [aiger::ascii(&system).into_bytes(), aiger::binary(&system)] {
            let read = read_aiger(&bytes);
            let same = |a: &[Latch], b: &[Latch]| a.iter().zip(b).all(|(a, b)| a.initial == b.initial);
            assert!(same(&read.latches, &system.latches));
            assert_eq!(truth(&read), expected, "{seed}");
        }
    }
}

#[test]
fn a_run_goes_out_and_comes_back() {
    let mut runs = 0;
    for seed in 0..100 {
        let system = sayable(seed);
        let report = check(&system, None, &Limits::default(), Choice::Automatic, &|| false, &mut |_| {});
        for (i, finding) in report.findings.iter().enumerate() {
            let Verdict::Violated(trace) = &finding.verdict else { continue };
            let text = witness::write(i, trace);
            let read = witness::read(&system, &format!("c a remark\n{text}"), None).expect("it can be read");
            assert_eq!((read.claim, &read.trace.initial, &read.trace.inputs), (i, &trace.initial, &trace.inputs));
            assert!(system.shows(&read.trace, system.claims[i].property));
            assert!(witness::read(&system, text.trim_end_matches(".\n"), None).is_err());
            runs += 1;
        }
    }
    assert!(runs > 50, "{runs} runs");
}

#[test]
fn names_are_kept() {
    let mut system = System::default();
    let go = system.input("Go now", Giver::Operator);
    let on = system.latch("Line.On", Some(true));
    system.latches[0].next = system.aig.or(go, on);
    system.claim("P1: on", Property::Never(on));
    system.claim("off again", Property::AlwaysPossible(!on));
    let text = aiger::ascii(&system);
    assert_eq!(
        text,
        "aag 3 1 1 0 1 1 0\n2\n4 7 1\n4\n6 5 3\ni0 Go now\nl0 Line.On\nb0 P1: on\nc\nmade by chartwright\n\
         left out, since AIGER cannot say it: off again\n"
    );
    let text = btor2::write(&system);
    assert!(text.contains("input 1 Go_now\n") && text.contains("state 1 Line.On\n"), "{text}");
    assert!(text.lines().last().is_some_and(|l| l.ends_with("P1:_on")), "{text}");
    let text = smv::write(&system);
    assert!(text.contains("  init(m_Line_On) := TRUE;\n"), "{text}");
    assert!(text.contains("SPEC AG !m_Line_On; -- P1: on\n"), "{text}");
    assert!(text.contains("SPEC AG EF !m_Line_On; -- off again\n"), "{text}");
    // A name that comes twice is numbered: some readers refuse it otherwise.
    system.input("Go now", Giver::Operator);
    assert!(aiger::ascii(&system).contains("i1 Go now #2\n"));
    assert!(btor2::write(&system).contains("input 1 Go_now_#2\n"));
    let order = smv::order(&system);
    assert!(order.contains("m_Line_On\n") && order.contains("i_Go_now\n"), "{order}");
}

/// BTOR2 to values: one scan of the text is one scan of the system.
#[test]
fn btor2_means_one_scan_of_the_system() {
    for seed in 0..200 {
        let system = sayable(seed);
        let text = btor2::write(&system);
        let mut aig = Aig::new();
        let mut lits = vec![Lit::FALSE];
        let (mut nexts, mut bads, mut constraints) = (Vec::new(), Vec::new(), Vec::new());
        for line in text.lines().filter(|l| !l.starts_with(';')) {
            let words: Vec<&str> = line.split(' ').collect();
            assert_eq!(words[0], lits.len().to_string(), "{line}");
            let operand = |i: usize| lits[words[i].parse::<usize>().expect("a number")];
            let lit = match words[1] {
                "sort" | "zero" | "init" => Lit::FALSE,
                "input" | "state" => aig.leaf(words[3]),
                "not" => !operand(3),
                "and" => aig.and(operand(3), operand(4)),
                "next" => {
                    nexts.push(operand(4));
                    Lit::FALSE
                }
                "constraint" => {
                    constraints.push(operand(2));
                    Lit::FALSE
                }
                "bad" => {
                    bads.push(operand(2));
                    Lit::FALSE
                }
                other => panic!("{other}"),
            };
            lits.push(lit);
        }
        let mut rng = Rng::new(seed);
        let words: Vec<u64> = aig.leaves().map(|_| rng.next()).collect();
        let mut theirs = Vec::new();
        aig.simulate(&words, &mut theirs);
        // Leaves of the text: inputs, then latches. Leaves of the system: latches, then inputs.
        let (inputs, latches) = words.split_at(system.inputs.len());
        let mut ours = Vec::new();
        system.aig.simulate(&[latches, inputs].concat(), &mut ours);
        let expected: Vec<u64> = system
            .latches
            .iter()
            .map(|l| l.next)
            .chain(system.constraints.iter().copied())
            .chain(system.claims.iter().map(|c| match c.property {
                Property::Never(l) | Property::AlwaysPossible(l) => l,
                Property::NeverStuck | Property::Eventually { .. } => unreachable!("it is not among them"),
            }))
            .map(|l| lanes(&ours, l))
            .collect();
        let found: Vec<u64> = nexts.iter().chain(&constraints).chain(&bads).map(|&l| lanes(&theirs, l)).collect();
        assert_eq!(found, expected, "{seed}");
    }
}

/// What a tool on the path says, if it is there.
pub fn ask(tool: &str, args: &[&str]) -> Option<String> {
    let output = Command::new(tool).args(args).output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr))
}

#[test]
fn abc_comes_to_the_same_verdicts() {
    let Some(abc) = ["berkeley-abc", "abc", "yosys-abc"].into_iter().find(|tool| ask(tool, &["-h"]).is_some()) else {
        println!("SKIPPED: neither berkeley-abc, abc nor yosys-abc is on PATH");
        return;
    };
    let folder = std::env::temp_dir().join(format!("chartwright-abc-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let (mut held, mut violated) = (0, 0);
    for seed in 0..60 {
        let mut system = sayable(seed);
        // One claim a file; ABC knows no latch without an initial value in this flow.
        system.claims.truncate(1);
        system.latches.iter_mut().for_each(|l| l.initial = Some(l.initial.unwrap_or(false)));
        let (expected, _) = truth(&system);
        let file = folder.join(format!("{seed}.aig"));
        std::fs::write(&file, aiger::binary(&system)).expect("a file can be written");
        let script = format!("read_aiger {}; fold; strash; pdr", file.display());
        let said = ask(abc, &["-c", &script]).expect("it runs");
        let verdict = if said.contains("Property proved") {
            held += 1;
            true
        } else if said.contains("was asserted in frame") {
            violated += 1;
            false
        } else {
            panic!("{seed}: {said}")
        };
        assert_eq!(verdict, expected[0].is_ok(), "{seed}: {said}");
    }
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    assert!(held > 10 && violated > 10, "{held} hold, {violated} do not");
}

#[test]
fn nusmv_comes_to_the_same_verdicts() {
    let Some(tool) = ["NuSMV", "nuXmv"].into_iter().find(|tool| ask(tool, &["-h"]).is_some()) else {
        println!("SKIPPED: neither NuSMV nor nuXmv is on PATH");
        return;
    };
    let folder = std::env::temp_dir().join(format!("chartwright-smv-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    for seed in 0..100 {
        let system = random(&mut Rng::new(seed));
        let (expected, _) = truth(&system);
        if expected[4].is_err() {
            continue; // SMV has no meaning for runs that end.
        }
        let file = folder.join(format!("{seed}.smv"));
        std::fs::write(&file, smv::write(&system)).expect("a file can be written");
        let said = ask(tool, &["-dcx", &file.display().to_string()]).expect("it runs");
        let verdicts: Vec<bool> =
            said.lines().filter(|l| l.starts_with("-- specification")).map(|l| l.ends_with("is true")).collect();
        let expected: Vec<bool> = expected[..4].iter().map(Result::is_ok).collect();
        assert_eq!(verdicts, expected, "{seed}: {said}");
    }
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
}
