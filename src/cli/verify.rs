//! A model to what is true of all its runs.

use super::args::{Deny, Format, TimeModel, Verify as Args, VerifyEngine, VerifyProgram};
use super::counterexample::{self, Between};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::watch::Watch;
use super::{Outcome, finish, needed, read, say, tell, usage};
use crate::base::{Code, LineIndex, figure};
use crate::ir::chart::Machine;
use crate::ir::scenario::Acceptance;
use crate::pipeline::findings::{Findings, Place, once};
use crate::pipeline::verify::{self, Answer, Kind, Options, Program, Question, Status, Times, Verified};
use crate::simulate::{tree, vcd};
use crate::verify::{Choice, Engine, Limits};
use serde::Serialize;
use std::fmt::Write;
use std::time::Duration;

/// What a node of a diagram takes in memory, in bytes: itself, its place in the tables, and what is
/// remembered about it.
const NODE: usize = 40;

/// The JSON document's part.
#[derive(Serialize)]
struct Result {
    answers: Vec<JsonAnswer>,
    /// What has become of accepted findings.
    accepted: Vec<JsonAcceptance>,
    latches: usize,
    inputs: usize,
    /// A number that may be larger than a JSON reader takes.
    situations: Option<String>,
    scans: Option<usize>,
}

#[derive(Serialize)]
struct JsonAnswer {
    /// What it is about.
    kind: &'static str,
    verdict: &'static str,
    /// What is so, in words.
    says: String,
    /// What it speaks of.
    places: Vec<JsonPlace>,
    engine: &'static str,
    /// Whether the machine is wrong if it is violated.
    demand: bool,
    reason: Option<String>,
    /// The hint for an open answer.
    help: Option<String>,
    /// How many scans the run takes that shows it.
    scans: Option<usize>,
    /// What happens between scans on the way, in order; left out where there is nothing of the kind.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    between: Vec<Between>,
    shortest: Option<bool>,
    /// The scan from which on it can repeat itself for ever, if that is what it shows.
    repeats: Option<usize>,
    replayed: Option<bool>,
    /// The active states in the last scan, a line each.
    tree: Option<String>,
    /// The rungs that drove the outputs in question in the last scan.
    rungs: Option<String>,
    scenario: Option<String>,
}

/// A finding that the model accepts.
#[derive(Serialize)]
struct JsonAcceptance {
    accept: String,
    reason: String,
    fate: Fate,
    line: usize,
    column: usize,
}

/// Something of the model: where it begins, from 1, the column in characters.
#[derive(Serialize)]
pub struct JsonPlace {
    name: String,
    line: usize,
    column: usize,
}

/// Things of a model for JSON.
pub fn places(source: &str, places: Vec<Place>) -> Vec<JsonPlace> {
    let lines = LineIndex::new(source);
    let place = |Place { name, span }| {
        let (line, column) = lines.character(source, span.range().start);
        JsonPlace { name, line, column }
    };
    places.into_iter().map(place).collect()
}

/// Runs `chartwright verify`.
pub fn run(args: &Args) -> Outcome {
    let needless = |deny: &Deny| matches!(deny, Deny::Needless | Deny::All);
    if args.deny.contains(&Deny::Needless) && !args.needed {
        return usage("verify", "which constraints are needless is asked with `--needed` only");
    }
    if args.needed && !args.deny.iter().all(needless) {
        return usage("verify", "`--needed` asks for nothing that could be denied but what is needless");
    }
    let outs: Vec<_> = [&args.vcd, &args.scenario].into_iter().flatten().collect();
    if outs.iter().any(|out| !files::is_standard(out) && files::same(out, &args.file)) {
        return usage("verify", "writing the run would overwrite the model");
    }
    if args.needed {
        return needed::run(args);
    }
    let mut report = Report::default();
    let watch = Watch::new("verify", Some(args.time), args.output.format == Format::Human).listen();
    let options = options(args, VerifyProgram::Chart);
    let ask = |source: &str| verify::verify(source, &options, &|| watch.stop(), &mut |p| watch.follow(p));
    let verified = read(&args.file, &mut report, ask).flatten();
    let (interrupted, time) = (watch.interrupted(), watch.elapsed());
    drop(watch);
    let Some(mut verified) = verified else {
        return finish("verify", args.output.format, &report, &Option::<Result>::None);
    };
    let broken_off = interrupted && verified.interrupt();
    let mut written = true;
    for failed in write(args, &verified) {
        report.files.push(failed);
        written = false;
    }
    let source = report.files.first().map_or("", |file| &file.source);
    let findings = Findings::new(&verified.machine, source);
    let mut given = finish("verify", args.output.format, &report, &result(&verified, &findings, source));
    if args.output.format == Format::Human && verified.refusal.is_none() {
        // A step of the plant, and a writing, takes the system on as a scan does.
        let transition = if verified.machine.plant.by_steps && !args.open { "transition" } else { "scan" };
        given = given.and(tell(&human(&verified, &findings, transition, time)));
    } else if let (Format::Human, Some(refusal)) = (args.output.format, verified.refusal) {
        say(&format!("error: {refusal}\n"));
    }
    let demanded = || verified.answers.iter().filter(|a| a.demand);
    let violated = demanded().any(|a| a.status == Status::Violated);
    let warned = |code: Code| report.files.iter().flat_map(|f| f.diagnostics.iter()).any(|d| d.code == code);
    let stale = args.deny.iter().any(|deny| matches!(deny, Deny::Stale | Deny::All))
        && (warned(Code::StaleAcceptance) || fates(&verified).any(|(_, fate, _)| fate == Fate::Stale));
    // Who declares a property or denies something wants to know; what all machines are asked may stay open.
    let asked = |a: &&Answer| !matches!(a.question, Question::Assumable | Question::Moves);
    let open = demanded().filter(asked).any(|a| matches!(a.status, Status::Unknown(_)));
    given.and(if violated || stale || !written || verified.refusal.is_some() {
        Outcome::Wrong
    } else if open || broken_off {
        Outcome::Open
    } else {
        Outcome::Fine
    })
}

/// What the pipeline is told, with what runs in front of the filter if nothing is said about that.
pub fn options(args: &Args, otherwise: VerifyProgram) -> Options {
    Options {
        program: program(args.program.unwrap_or(otherwise)),
        open: args.open,
        times: match args.time_model {
            TimeModel::Exact => Times::Exact,
            TimeModel::Free => Times::Free,
        },
        without: args.without.clone(),
        deny: denied(&args.deny),
        choice: match args.engine {
            VerifyEngine::Auto => Choice::Automatic,
            VerifyEngine::Exact => Choice::Only(Engine::Exact),
            VerifyEngine::Bounded => Choice::Only(Engine::Bounded),
            VerifyEngine::Proof => Choice::Only(Engine::Proof),
        },
        limits: Limits {
            nodes: (args.memory as usize).saturating_mul(1 << 20) / NODE,
            scans: args.scans as usize,
            ..Limits::default()
        },
    }
}

/// What makes the machine wrong if it is found.
fn denied(deny: &[Deny]) -> Vec<Kind> {
    let kinds = |deny: &Deny| match deny {
        Deny::Void => vec![Kind::Void],
        Deny::Unreachable => vec![Kind::Unreachable],
        Deny::Silent => vec![Kind::Silent],
        Deny::Overlap => vec![Kind::Overlap],
        Deny::Saturates => vec![Kind::Saturates],
        Deny::Acts => vec![Kind::Acts],
        // These are no questions about the whole machine.
        Deny::Needless | Deny::Stale => Vec::new(),
        Deny::All => Kind::ALL.to_vec(),
    };
    deny.iter().flat_map(kinds).collect()
}

/// What runs in front of the filter.
pub fn program(program: VerifyProgram) -> Program {
    match program {
        VerifyProgram::Chart => Program::Chart,
        VerifyProgram::Any => Program::Any,
    }
}

/// Whether it shows that the machine is wrong.
fn is_counterexample(answer: &Answer) -> bool {
    answer.demand && answer.status == Status::Violated && answer.run.is_some()
}

/// Writes what was asked for: all counterexamples as scenarios, the first one as a value change dump.
fn write(args: &Args, verified: &Verified) -> Vec<FileReport> {
    let wrong = verified.answers.iter().filter(|a| is_counterexample(a));
    let runs: Vec<&verify::Run> = wrong.filter_map(|a| a.run.as_ref()).collect();
    let Some(first) = runs.first() else { return Vec::new() };
    let mut failed = Vec::new();
    let mut put = |path: &Option<std::path::PathBuf>, text: String| {
        let Some(path) = path else { return };
        if let Err(diagnostic) = Pending::prepare(path, text).and_then(Pending::commit) {
            failed.push(FileReport::failed(files::show(path), diagnostic));
        }
    };
    let scenarios: Vec<&str> = runs.iter().map(|run| &*run.scenario).collect();
    put(&args.scenario, scenarios.join("\n"));
    put(&args.vcd, vcd::write(&verified.machine, &counterexample::recording(first)));
    failed
}

/// One word for an answer. What is for people to judge is found or absent: that it holds would say the opposite of its kind.
fn verdict(machine: &Machine, answer: &Answer) -> &'static str {
    match (answer.status, answer.question.kind(), answer.demand) {
        (Status::Holds, None, _) => "holds",
        (Status::Violated, None, _) => "violated",
        (Status::Holds, Some(_), _) => "absent",
        (Status::Violated, Some(_), _) if verify::accepted(machine, answer.question).is_some() => "accepted",
        (Status::Violated, Some(_), false) => "found",
        (Status::Violated, Some(_), true) => "denied",
        (Status::Unknown(_), ..) => "open",
    }
}

fn engine(engine: Engine) -> &'static str {
    match engine {
        Engine::Exact => "exact",
        Engine::Bounded => "bounded",
        Engine::Proof => "proof",
        Engine::Chance => "chance",
        Engine::Scenario => "scenario",
    }
}

fn result(verified: &Verified, findings: &Findings<'_>, source: &str) -> Result {
    let answers = verified.answers.iter().map(|a| JsonAnswer {
        kind: a.question.word(),
        verdict: verdict(&verified.machine, a),
        says: findings.sentence(a),
        places: places(source, findings.places(a.question)),
        engine: engine(a.engine),
        demand: a.demand,
        reason: if let Status::Unknown(limit) = a.status { Some(limit.to_string()) } else { None },
        help: findings.help(a),
        scans: a.run.as_ref().map(|r| r.frames.len()),
        between: a.run.as_ref().map(counterexample::between).unwrap_or_default(),
        shortest: a.run.as_ref().map(|r| r.shortest),
        repeats: a.run.as_ref().and_then(|r| r.repeats),
        replayed: a.run.as_ref().and_then(|r| r.replayed),
        tree: a.run.as_ref().filter(|r| r.replayed.is_some()).and_then(|r| last(&verified.machine, r)),
        rungs: a.run.as_ref().and_then(|r| r.rungs.clone()),
        scenario: a.run.as_ref().filter(|_| a.demand).map(|r| r.scenario.clone()),
    });
    let lines = LineIndex::new(source);
    let accepted = fates(verified).map(|(acceptance, fate, _)| {
        let (line, column) = lines.character(source, acceptance.span.range().start);
        let (accept, reason) = (acceptance.written.clone(), acceptance.reason.clone());
        JsonAcceptance { accept, reason, fate, line, column }
    });
    Result {
        accepted: accepted.collect(),
        answers: answers.collect(),
        latches: verified.latches,
        inputs: verified.inputs,
        situations: verified.situations.clone(),
        scans: verified.scans,
    }
}

fn last(machine: &Machine, run: &verify::Run) -> Option<String> {
    run.frames.last().map(|frame| tree::show(machine, frame))
}

/// What is counted, kind by kind: the word of the kind, whether those that hold are counted or the others, what they are, and what is said
/// of one of them and of several.
const COUNTED: [(&str, bool, &str, [&str; 2]); 7] = [
    ("constraint", true, "constraint", ["is kept", "are kept"]),
    ("unreachable", true, "state", ["is active in some run", "are active in some run"]),
    ("silent", true, "transition", ["fires in some run", "fire in some run"]),
    (
        "overlap",
        false,
        "pair",
        [
            "of transitions is enabled together, so that their order decides",
            "of transitions are enabled together, so that their order decides",
        ],
    ),
    ("saturates", false, "integer", ["stops at a bound", "stop at a bound"]),
    ("acts", false, "constraint", ["makes the filter act", "make the filter act"]),
    ("void", false, "property", ["says nothing", "say nothing"]),
];

/// What has become of a finding that is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Fate {
    /// It is found.
    Accepted,
    /// It is not found any more.
    Stale,
    /// Nobody knows.
    Unknown,
    /// That is not asked here.
    Unasked,
}

/// What has become of each accepted finding, with what is found now.
fn fates<'v>(verified: &'v Verified) -> impl Iterator<Item = (&'v Acceptance, Fate, Option<&'v Answer>)> + 'v {
    verified.machine.accepted.iter().map(|acceptance| {
        let question = verify::about(acceptance);
        let answer = verified.answers.iter().find(|a| a.question == question);
        let fate = match answer.map(|a| a.status) {
            Some(Status::Violated) => Fate::Accepted,
            Some(Status::Holds) => Fate::Stale,
            Some(Status::Unknown(_)) => Fate::Unknown,
            // What cannot be found is not asked.
            None if verified.answers.iter().any(|a| matches!(a.question, Question::Active(_))) => Fate::Stale,
            None => Fate::Unasked,
        };
        (acceptance, fate, answer)
    })
}

/// How many findings are accepted, and which acceptances have nothing to accept any more.
fn acceptances(verified: &Verified, findings: &Findings<'_>) -> String {
    let mut text = String::new();
    let count = fates(verified).filter(|(_, fate, _)| *fate == Fate::Accepted).count();
    if count > 0 {
        let _ = writeln!(text, "{count} accepted");
    }
    for (acceptance, _, answer) in fates(verified).filter(|(_, fate, _)| *fate == Fate::Stale) {
        let now = answer.map_or_else(|| "nothing of the kind can be found".to_owned(), |a| findings.sentence(a));
        let _ = writeln!(text, "stale     {}: {now}", findings.acceptance(acceptance));
    }
    text
}

/// How many answers of each kind there are.
fn counts(verified: &Verified) -> String {
    let mut text = String::new();
    for (kind, holds, thing, [one, several]) in COUNTED {
        let asked: Vec<&Answer> = verified.answers.iter().filter(|a| a.question.word() == kind).collect();
        let wanted = if holds { Status::Holds } else { Status::Violated };
        let count = asked.iter().filter(|a| a.status == wanted).count();
        let unknown = asked.iter().filter(|a| matches!(a.status, Status::Unknown(_))).count();
        if asked.is_empty() || !holds && count + unknown == 0 {
            continue;
        }
        let (all, says) = (figure(asked.len(), thing), if count == 1 { one } else { several });
        let _ = match unknown {
            0 => writeln!(text, "{count} of {all} {says}"),
            _ => writeln!(text, "at least {count} of {all} {says}; of {unknown} nobody knows"),
        };
    }
    text
}

/// The hints for all open answers, a line each.
fn helps(verified: &Verified, findings: &Findings<'_>) -> String {
    let hints = once(verified.answers.iter().filter_map(|a| findings.help(a)));
    hints.iter().fold(String::new(), |text, help| text + &format!("help      {help}\n"))
}

fn human(verified: &Verified, findings: &Findings<'_>, transition: &str, time: Duration) -> String {
    let machine = &verified.machine;
    let mut text = String::new();
    for a in &verified.answers {
        // What all machines are asked is worth a line only where there is something to say.
        let own = matches!(a.question, Question::Declared(_) | Question::Assumable | Question::Moves);
        if a.status != Status::Holds || own {
            let word = verdict(machine, a);
            if word != "accepted" {
                let _ = writeln!(text, "{word:<8}  {}", findings.sentence(a));
            }
        }
    }
    text += &helps(verified, findings);
    text += &counts(verified);
    text += &acceptances(verified, findings);
    for a in verified.answers.iter().filter(|a| is_counterexample(a)) {
        let run = a.run.as_ref().expect("a counterexample has a run");
        if !run.is_empty() {
            let _ = write!(text, "\n{}", counterexample::human(machine, &findings.sentence(a), run));
        }
    }
    let open = verified.answers.iter().any(|a| matches!(a.status, Status::Unknown(_)));
    let _ = match (&verified.situations, verified.scans) {
        (Some(situations), Some(scans)) => {
            let noun = if situations == "1" { "situation" } else { "situations" };
            let within = if scans == 0 {
                "from the beginning on".to_owned()
            } else {
                format!("all within {}", figure(scans, transition))
            };
            writeln!(text, "\n{situations} {noun}, {within}")
        }
        _ if open => writeln!(text, "\nnot all situations were explored"),
        _ => writeln!(text, "\nall of that was found without counting the situations"),
    };
    let (memory, inputs) = (figure(verified.latches, "bit"), figure(verified.inputs, "bit"));
    let come = if verified.inputs == 1 { "comes" } else { "come" };
    let (seconds, thousandths) = (time.as_secs(), time.subsec_millis());
    let _ = writeln!(text, "{memory} of memory, {inputs} that {come} in; {seconds}.{thousandths:03} s");
    text
}
