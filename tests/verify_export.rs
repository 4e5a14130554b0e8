//! What `verify` writes for other tools: read back by a reader of its own here, and by such tools where
//! they are installed.

use crate::support::models;
use crate::support::rng::Rng;
use crate::support::systems::{random, truth};
use chartwright::pipeline;
use chartwright::pipeline::verify::Program;
use chartwright::verify::aig::{Aig, Lit, lanes};
use chartwright::verify::export::{aiger, btor2, claim_named, smv, witness};
use chartwright::verify::{Choice, Giver, Latch, Limits, Property, System, Verdict, check};
use std::collections::BTreeMap;
use std::io::Write;
use std::process::Command;
use std::time::{Duration, Instant};

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
    // In the first version outputs say what never is.
    let n = if let [most, inputs, latches, outputs, gates] = n[..] {
        vec![most, inputs, latches, 0, gates, outputs, 0]
    } else {
        n
    };
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
fn the_first_version_of_aiger_says_the_same_without_constraints_and_open_beginnings() {
    let (mut bound, mut open) = (0, 0);
    for seed in 0..120 {
        let system = sayable(seed);
        let expected = truth(&system).0;
        bound += usize::from(!system.constraints.is_empty());
        open += usize::from(system.latches.iter().any(|l| l.initial.is_none()));
        for bytes in [aiger::first_ascii(&system).into_bytes(), aiger::first_binary(&system)] {
            assert_eq!(bytes.split(|&b| b == b'\n').next().expect("a head").split(|&b| b == b' ').count(), 6);
            let read = read_aiger(&bytes);
            assert!(read.constraints.is_empty() && read.latches.iter().all(|l| l.initial.is_some()));
            // A run that refutes is as long, scan by scan.
            assert_eq!(truth(&read).0, expected, "{seed}");
        }
    }
    assert!(bound > 25 && open > 25, "{bound} with constraints, {open} with an open beginning");
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
        "aag 3 1 1 0 1 1 0\n2\n4 7 1\n4\n6 5 3\ni0 Go_now\nl0 Line.On\nb0 P1:_on\nc\nmade by chartwright\n\
         left out, since AIGER cannot say it: off_again\n"
    );
    // The first version has outputs for what never is, and no more numbers in its head.
    let text = aiger::first_ascii(&system);
    assert_eq!(
        text,
        "aag 3 1 1 1 1\n2\n4 7 1\n4\n6 5 3\ni0 Go_now\nl0 Line.On\no0 P1:_on\nc\nmade by chartwright\n\
         left out, since AIGER cannot say it: off_again\n"
    );
    let text = btor2::write(&system);
    assert!(text.contains("input 1 Go_now\n") && text.contains("state 1 Line.On\n"), "{text}");
    assert!(text.lines().last().is_some_and(|l| l.ends_with("P1:_on")), "{text}");
    let text = smv::write(&system);
    assert!(text.contains("  init(m_Line_On) := TRUE;\n"), "{text}");
    assert!(text.contains("SPEC AG !m_Line_On; -- P1: on\n"), "{text}");
    assert!(text.contains("SPEC AG EF !m_Line_On; -- off again\n"), "{text}");
    // A name that comes twice is numbered, whatever it names: some readers refuse it otherwise.
    system.input("Go now", Giver::Operator);
    system.input("Line.On", Giver::Operator);
    system.input("Tür; zu", Giver::Operator);
    system.claim("Go now", Property::Never(on));
    let text = aiger::ascii(&system);
    for line in ["b1 Go_now", "i0 Go_now_2", "i1 Go_now_3", "i2 Line.On", "i3 T_r__zu", "l0 Line.On_2"] {
        assert!(text.contains(&format!("\n{line}\n")), "{line}: {text}");
    }
    assert!(text.is_ascii() && aiger::first_ascii(&system).is_ascii() && btor2::write(&system).is_ascii());
    assert!(btor2::write(&system).contains("input 1 Go_now_2\n"));
    assert_eq!(claim_named(&system, "P1: on"), Some(0));
    assert_eq!(claim_named(&system, "P1:_on"), Some(0));
    assert_eq!(claim_named(&system, "Go_now"), Some(2));
    assert_eq!(claim_named(&system, "Go_now_2"), None, "that is an input");
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

/// What ABC says of each output of a file, by its name: whether it is ever TRUE, nothing where time was up.
fn abc_says(abc: &str, file: &std::path::Path, seconds: u64) -> BTreeMap<String, Option<bool>> {
    let bytes = std::fs::read(file).expect("it has been written");
    let text = String::from_utf8_lossy(&bytes);
    let outputs: Vec<&str> = text.lines().filter_map(output_name).collect();
    let head: Vec<&str> = text.lines().next().expect("a head").split(' ').collect();
    assert_eq!(outputs.len().to_string(), head[4], "each output has a name");
    let said = ask(abc, &["-c", &format!("read {}; scleanup; lcorr; scorr; dc2; pdr -a -T {seconds}", file.display())])
        .expect("it runs");
    let decided = said.contains("Undecided = 0.");
    assert!(said.contains(&format!("Properties:  All = {}.", outputs.len())), "{said}");
    let mut verdicts: BTreeMap<String, Option<bool>> =
        outputs.iter().map(|name| ((*name).to_owned(), decided.then_some(false))).collect();
    assert_eq!(verdicts.len(), outputs.len(), "names are distinct");
    for line in said.lines() {
        let Some(rest) = line.strip_prefix("Output ") else { continue };
        // What simplifying has decided is asserted "trivially".
        let Some((index, _)) = rest.split_once(" was ").filter(|(_, how)| how.contains("asserted in frame")) else {
            continue;
        };
        let index: usize = index.trim().parse().expect("a number");
        verdicts.insert(outputs[index].to_owned(), Some(true));
    }
    verdicts
}

/// The name in a line `o3 NAME` of a symbol table.
fn output_name(line: &str) -> Option<&str> {
    let (index, name) = line.strip_prefix('o')?.split_once(' ')?;
    index.bytes().all(|b| b.is_ascii_digit()).then_some(name)
}

/// Compares ABC's verdicts on what is exported of a model with ours, name by name; returns how many are the same, and how
/// many one of the two leaves open.
fn compare(abc: &str, name: &str, seconds: u64) -> (usize, usize) {
    let model = models::all().into_iter().find(|m| m.name == name).expect("the model is there");
    let (machine, _) = pipeline::check(&model.source);
    let machine = machine.expect("the model is right");
    let mut subject = pipeline::verify::system(&machine, Program::Chart, false).expect("it can be verified");
    let file = std::env::temp_dir().join(format!("chartwright-abc-{}-{name}.aig", std::process::id()));
    std::fs::write(&file, aiger::first_binary(&subject.system)).expect("a file can be written");
    let theirs = abc_says(abc, &file, seconds);
    std::fs::remove_file(&file).expect("it can be removed");
    subject.system.claims.retain(|c| matches!(c.property, Property::Never(_)));
    let begun = Instant::now();
    let stop = || begun.elapsed() > Duration::from_secs(4 * seconds);
    let report = check(&subject.system, None, &Limits::default(), Choice::Automatic, &stop, &mut |_| {});
    let (mut same, mut open) = (0, 0);
    assert_eq!(theirs.len(), report.findings.len(), "{name}");
    for (written, violated) in theirs {
        let claim = claim_named(&subject.system, &written).unwrap_or_else(|| panic!("{name}: no claim `{written}`"));
        let ours = match report.findings[claim].verdict {
            Verdict::Holds => Some(false),
            Verdict::Violated(_) => Some(true),
            Verdict::Unknown(_) => None,
        };
        match (ours, violated) {
            (Some(ours), Some(theirs)) => {
                assert_eq!(ours, theirs, "{name}: {written}: who is right?");
                same += 1;
            }
            _ => open += 1,
        }
    }
    (same, open)
}

/// Says something even where the test passes.
fn aloud(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// With `CHARTWRIGHT_ABC_SECONDS=60`, say, all six machines get as long; without it the small ones are compared, in seconds.
#[test]
fn abc_comes_to_the_same_verdicts_on_machines_name_by_name() {
    let Some(abc) = ["berkeley-abc", "abc", "yosys-abc"].into_iter().find(|tool| ask(tool, &["-h"]).is_some()) else {
        aloud("SKIPPED: the verdicts on machines are not compared: neither berkeley-abc, abc nor yosys-abc is on PATH");
        return;
    };
    let seconds = std::env::var("CHARTWRIGHT_ABC_SECONDS").ok().map(|s| s.parse().expect("a number of seconds"));
    let machines: &[&str] = match seconds {
        Some(_) => &["prehensor", "carts", "four_cylinders", "palletizer", "indexa", "productis"],
        None => {
            aloud(
                "SKIPPED: of the six machines only the prehensor is compared with ABC: set CHARTWRIGHT_ABC_SECONDS=60",
            );
            &["prehensor", "properties"]
        }
    };
    for name in machines {
        let begun = Instant::now();
        let (same, open) = compare(abc, name, seconds.unwrap_or(10));
        if seconds.is_some() {
            aloud(&format!("{name}: {same} verdicts are the same, {open} open, {:?}", begun.elapsed()));
        }
        assert!(same > 0, "{name}: nothing could be compared");
    }
}

/// Other readers than ABC, where they are installed.
#[test]
fn yosys_reads_what_is_exported() {
    if ask("yosys", &["-V"]).is_none() {
        aloud("SKIPPED: that yosys reads exports is not tried: it is not on PATH");
        return;
    }
    for name in ["prehensor", "four_cylinders", "eventually"] {
        let model = models::all().into_iter().find(|m| m.name == name).expect("the model is there");
        let (machine, _) = pipeline::check(&model.source);
        let machine = machine.expect("the model is right");
        let subject = pipeline::verify::system(&machine, Program::Chart, false).expect("it can be verified");
        let files =
            [("aig", aiger::first_binary(&subject.system)), ("aag", aiger::first_ascii(&subject.system).into_bytes())];
        for (ending, bytes) in files {
            let file = std::env::temp_dir().join(format!("chartwright-yosys-{}-{name}.{ending}", std::process::id()));
            let head = bytes.split(|&b| b == b'\n').next().expect("a head").to_vec();
            let head = String::from_utf8(head).expect("text");
            let outputs = head.split(' ').nth(4).expect("a number of outputs").to_owned();
            std::fs::write(&file, bytes).expect("a file can be written");
            let script = format!("read_aiger {}; select -count o:*", file.display());
            let said = ask("yosys", &["-p", &script]).expect("it runs");
            std::fs::remove_file(&file).expect("it can be removed");
            assert!(!said.contains("ERROR") && said.contains(&format!("{outputs} objects.")), "{name}: {head}: {said}");
        }
    }
}
