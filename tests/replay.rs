//! Runs of other tools on models: they come back, and what is damaged is refused.

use crate::support::binary::{Scratch, chartwright, code, stderr, stdout};
use crate::support::models;
use crate::support::rng::Rng;
use chartwright::base::Code;
use chartwright::pipeline;
use chartwright::pipeline::replay::replay;
use chartwright::pipeline::verify::{Options, Program, Question, Times};
use chartwright::verify::export::witness;
use chartwright::verify::machine::Subject;
use chartwright::verify::{Choice, Limits, Property, Trace, Verdict, check};

fn options(open: bool) -> Options {
    Options { open, ..Options::default() }
}

fn model(name: &str) -> String {
    models::all().into_iter().find(|m| m.name == name).expect("the model is there").source
}

fn gate() -> String {
    model("properties").replace("P1: never LAMP and Shut", "P1: never LAMP and Near and Far")
}

/// A run that refutes the property of that name, for what is exported, with how it is named there.
fn refuted(subject: &Subject<'_>, name: &str) -> (Trace, String) {
    let report = check(&subject.system, None, &Limits::default(), Choice::Automatic, &|| false, &mut |_| {});
    let claims = &subject.system.claims;
    let claim = claims.iter().position(|c| c.name == name).expect("it is claimed");
    let Verdict::Violated(trace) = &report.findings[claim].verdict else { panic!("{name} holds") };
    let eventually = |p: Property| matches!(p, Property::Eventually { .. });
    let never = |p: Property| matches!(p, Property::Never(_));
    let before = |of: &dyn Fn(Property) -> bool| claims[..claim].iter().filter(|c| of(c.property)).count();
    let named = if eventually(claims[claim].property) {
        format!("j{}", before(&eventually))
    } else {
        format!("b{}", before(&never))
    };
    // For each claim of what comes eventually the file has an input and three latches more.
    let more = claims.iter().filter(|c| eventually(c.property)).count();
    let mut trace = trace.clone();
    trace.initial.extend(vec![false; 3 * more]);
    trace.inputs.iter_mut().for_each(|scan| scan.extend(vec![false; more]));
    (trace, named)
}

fn aiger(trace: &Trace, named: &str) -> String {
    witness::write(0, trace).replacen("b0", named, 1)
}

fn btor2(trace: &Trace, named: &str) -> String {
    let frame = |values: &[bool]| -> String {
        values.iter().enumerate().map(|(i, v)| format!("{i} {} v{i}\n", u8::from(*v))).collect()
    };
    let mut text = format!("sat\n{named}\n#0\n{}", frame(&trace.initial));
    for (i, scan) in trace.inputs.iter().enumerate() {
        text += &format!("@{i}\n{}", frame(scan));
    }
    text + ".\n"
}

fn found(source: &str, text: &str, claim: Option<&str>) -> Result<(Question, usize), Code> {
    let (replayed, about_source, about_run) = replay(source, text, claim, &options(false));
    assert!(!about_source.has_errors(), "{about_source:?}");
    match replayed {
        Some(r) => {
            assert!(!about_run.has_errors());
            assert!(r.run.replayed.is_some());
            Ok((r.question, r.run.frames.len()))
        }
        None => Err(about_run.iter().next().expect("it says why").code),
    }
}

#[test]
fn runs_come_back_in_both_forms() {
    let press = model("eventually").replace("(Part and not Stop or not in(Waiting))", "Part");
    for (source, name, question) in [(gate(), "P1", Question::Declared(0)), (press, "P3", Question::Declared(2))] {
        let (machine, _) = pipeline::check(&source);
        let machine = machine.expect("the model is right");
        let subject = Subject::new(&machine, Program::Chart, false, Times::Free).expect("it can be verified");
        let (trace, named) = refuted(&subject, name);
        let scans = trace.inputs.len();
        for text in [aiger(&trace, &named), btor2(&trace, &named)] {
            assert_eq!(found(&source, &text, None), Ok((question, scans)), "{text}");
            // A tool that is given one claim alone counts from it.
            let alone = text.replacen(&named, &format!("{}0", &named[..1]), 1);
            assert_eq!(found(&source, &alone, Some(name)), Ok((question, scans)), "{text}");
            assert_eq!(found(&source, &text, Some("P9")), Err(Code::BadWitness));
            let other = text.replacen(&named, "b999", 1);
            assert_eq!(found(&source, &other, None), Err(Code::BadWitness));
            // Of the machine without its plant it says nothing.
            let (replayed, _, about_run) = replay(&source, &text, None, &options(true));
            assert!(replayed.is_none() && about_run.has_errors());
        }
        if named.starts_with('b') {
            // ABC writes rows alone, and memory that it has not left out; it does not say what they are about.
            let row = |scan: &Vec<bool>| -> String {
                scan[..subject.system.inputs.len()].iter().map(|&v| if v { '1' } else { '0' }).collect()
            };
            let rows: Vec<String> = trace.inputs.iter().map(row).collect();
            let text = format!("0000\n{}# DONE\n", rows.join("\n"));
            assert_eq!(found(&source, &text, Some(name)), Ok((question, scans)), "{text}");
            assert_eq!(found(&source, &text, None), Err(Code::BadWitness));
            for damaged in
                [text.replace("# DONE", ""), text.replace("# DONE", "0# DONE"), format!("0000\n1{}", &text[5..])]
            {
                assert_eq!(found(&source, &damaged, Some(name)), Err(Code::BadWitness), "{damaged}");
            }
            let short = format!("0000\n{}# DONE\n", rows[..rows.len() - 1].join("\n"));
            assert_eq!(found(&source, &short, Some(name)), Err(Code::NotShown), "{short}");
        }
        // A scan less shows nothing.
        let mut short = trace.clone();
        short.inputs.pop();
        for text in [aiger(&short, &named), btor2(&short, &named)] {
            assert_eq!(found(&source, &text, None), Err(Code::NotShown), "{text}");
        }
        // Nor does what cannot be: another beginning.
        let mut other = trace.clone();
        other.initial[0] = !other.initial[0];
        assert_eq!(found(&source, &aiger(&other, &named), None), Err(Code::NotShown));
    }
}

#[test]
fn what_is_damaged_is_refused_or_still_a_run() {
    let source = gate();
    let (machine, _) = pipeline::check(&source);
    let machine = machine.expect("the model is right");
    let subject = Subject::new(&machine, Program::Chart, false, Times::Free).expect("it can be verified");
    let (trace, named) = refuted(&subject, "P1");
    let mut rng = Rng::new(7);
    let mut refused = 0;
    for text in [aiger(&trace, &named), btor2(&trace, &named)] {
        for end in 0..text.len() - 2 {
            assert!(witness::read(&subject.system, &text[..end], None).is_err(), "{}", &text[..end]);
        }
        for _ in 0..400 {
            let mut bytes = text.clone().into_bytes();
            let at = rng.below(bytes.len());
            bytes[at] = *rng.pick(b"01x.b#@ \n9-");
            if rng.chance(30) {
                bytes.remove(at);
            }
            let damaged = String::from_utf8(bytes).expect("it is ASCII");
            match witness::read(&subject.system, &damaged, None) {
                Ok(read) => match witness::judge(&subject.system, &read) {
                    Ok(run) => assert!(subject.system.shows(&run, subject.system.claims[read.claim].property)),
                    Err(_) => refused += 1,
                },
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 300, "{refused} of 800 are refused");
}

#[test]
fn the_command_shows_a_run_or_says_what_is_wrong() {
    let d = Scratch::new("replay");
    let source = gate();
    d.write("gate.chart", &source);
    let (machine, _) = pipeline::check(&source);
    let machine = machine.expect("the model is right");
    let subject = Subject::new(&machine, Program::Chart, false, Times::Free).expect("it can be verified");
    let (trace, named) = refuted(&subject, "P1");
    d.write("found", aiger(&trace, &named));
    let output = chartwright(d.path(), "replay gate.chart found --scenario again.chart --vcd run.vcd");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    for says in [
        "never LAMP and Near and Far; the condition is TRUE in scan 4",
        "Active in scan 4:\nGate\n  Passing",
        "[ Cmd_LAMP=1 ]",
    ] {
        assert!(stdout(&output).contains(says), "{says}: {}", stdout(&output));
    }
    assert!(d.path().join("again.chart").exists() && d.path().join("run.vcd").exists());
    for (text, says) in [
        ("", "E803"),
        ("1\nb0\n", "does not end with `.`"),
        ("unsat\n", "says that there is no run"),
        ("1\nb0\n01\n.\n", "these are not the"),
        ("sat\nb0\n#0\n99999 1\n.\n", "the system has no state 99999"),
    ] {
        d.write("wrong", text);
        let output = chartwright(d.path(), "replay gate.chart wrong");
        assert_eq!(code(&output), 1, "{text:?}");
        assert!(stderr(&output).contains(says), "{text:?}: {}", stderr(&output));
    }
    let output = chartwright(d.path(), "replay gate.chart found --vcd found");
    assert_eq!(code(&output), 2, "{}", stderr(&output));
}
