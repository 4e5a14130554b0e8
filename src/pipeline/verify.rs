//! A machine to answers about all its runs, each with the run that shows it.

use super::{rungs, without};
use crate::base::Diagnostics;
use crate::ir::chart::{Atom, InputId, Machine, OutputId};
use crate::ir::number::Range;
use crate::ir::scenario::{Condition, Doing, Given, PropertyKind, Scenario, Seen, Step};
use crate::simulate::frame::{Frame, Layout};
use crate::simulate::run::Program as Runs;
use crate::simulate::scenario::play;
use crate::verify::aig::lanes;
use crate::verify::engine::{self, Choice, Coarser, Engine, Progress};
use crate::verify::machine::Subject;
use crate::verify::system::Trace;
use crate::verify::{Limit, Limits, Verdict};
use std::collections::BTreeSet;
use std::fmt::Write;

pub use crate::verify::machine::questions::{Kind, Question, transition};
pub use crate::verify::machine::{Program, Refusal};

/// What [`verify`] is told.
#[derive(Clone, Debug)]
pub struct Options {
    /// What runs in front of the filter.
    pub program: Program,
    /// Whether the plant is left out, and all inputs are free.
    pub open: bool,
    /// The names of constraints without which the model is verified, as if they had not been written.
    pub without: Vec<String>,
    /// What is not left to people to judge: it makes the machine wrong.
    pub deny: Vec<Kind>,
    /// Which engines may be used.
    pub choice: Choice,
    /// What they may spend.
    pub limits: Limits,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            program: Program::Chart,
            open: false,
            without: Vec::new(),
            deny: Vec::new(),
            choice: Choice::Automatic,
            limits: Limits::default(),
        }
    }
}

impl Options {
    /// Whether the machine is wrong if the answer is no.
    pub fn demands(&self, question: Question) -> bool {
        question.kind().is_none_or(|kind| self.deny.contains(&kind))
    }
}

/// What is true of a machine.
#[derive(Clone, Debug)]
pub struct Verified {
    /// The machine.
    pub machine: Machine,
    /// Why nothing was asked, if so.
    pub refusal: Option<Refusal>,
    /// Question by question.
    pub answers: Vec<Answer>,
    /// How many bits are remembered from scan to scan.
    pub latches: usize,
    /// How many bits come in.
    pub inputs: usize,
    /// How many states are reachable, if all of them were found.
    pub states: Option<String>,
    /// After how many scans there was no new one.
    pub scans: Option<usize>,
}

/// The answer to one question.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The question.
    pub question: Question,
    /// Whether the machine is wrong if it is violated; else that is for people to judge.
    pub demand: bool,
    /// What is so.
    pub status: Status,
    /// Who says so.
    pub engine: Engine,
    /// The run that shows it, if there is one.
    pub run: Option<Run>,
}

/// What is so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// What was hoped for.
    Holds,
    /// The opposite.
    Violated,
    /// Nobody knows.
    Unknown(Limit),
}

/// A run from power-up.
#[derive(Clone, Debug)]
pub struct Run {
    /// What there is to see after each scan.
    pub frames: Vec<Frame>,
    /// Whether no shorter run shows the same.
    pub shortest: bool,
    /// The scan, counted from 1, from which on it can repeat itself for ever, if that is what it shows.
    pub repeats: Option<usize>,
    /// The run as a scenario, in the words of the language.
    pub scenario: String,
    /// Whether the chart does the same in the simulator. It does unless times are needed that a fixed cycle
    /// does not give; nothing if it is no run of the chart.
    pub replayed: Option<bool>,
    /// The rungs that drove the outputs in question in the last scan, with what every contact was; nothing if no
    /// output is in question, or the program does something else because of times.
    pub rungs: Option<String>,
}

/// Text to answers. Nothing if the model has errors. `stop` is asked now and then whether to end.
pub fn verify(
    source: &str,
    options: &Options,
    stop: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(Progress),
) -> (Option<Verified>, Diagnostics) {
    let (machine, diagnostics) = without::check(source, &options.without);
    let Some(machine) = machine else { return (None, diagnostics) };
    let mut verified =
        Verified { machine, refusal: None, answers: Vec::new(), latches: 0, inputs: 0, states: None, scans: None };
    let subject = match Subject::new(&verified.machine, options.program, options.open) {
        Ok(subject) => subject,
        Err(refusal) => {
            verified.refusal = Some(refusal);
            return (Some(verified), diagnostics);
        }
    };
    // What holds behind any program holds behind the charts.
    let any = match options.program {
        Program::Chart => Subject::new(&verified.machine, Program::Any, options.open).ok(),
        Program::Any => None,
    };
    let coarser = any.as_ref().map(|any| {
        let there = |q: &Question| any.questions.iter().position(|asked| asked == q);
        let claims = subject.questions.iter().map(there).collect();
        Coarser { system: &any.system, claims }
    });
    let report = engine::check(&subject.system, coarser.as_ref(), &options.limits, options.choice, stop, progress);
    let mut answers = Vec::new();
    for (&question, finding) in subject.questions.iter().zip(report.findings) {
        let hopes = question.hopes_for_a_run(subject.machine);
        let (status, run) = match finding.verdict {
            Verdict::Unknown(limit) => (Status::Unknown(limit), None),
            Verdict::Holds => (if hopes { Status::Violated } else { Status::Holds }, None),
            Verdict::Violated(trace) => {
                let status = if hopes { Status::Holds } else { Status::Violated };
                (status, Some(show(&subject, question, &trace, options)))
            }
        };
        let demand = options.demands(question);
        answers.push(Answer { question, demand, status, engine: finding.engine, run });
    }
    verified.latches = subject.system.latches.len();
    verified.inputs = subject.system.inputs.len();
    verified.states = report.states.map(|s| s.to_string());
    verified.scans = report.scans;
    verified.answers = answers;
    (Some(verified), diagnostics)
}

/// The system of a machine, for other tools.
pub fn system(machine: &Machine, program: Program, open: bool) -> Result<Subject<'_>, Refusal> {
    Subject::new(machine, program, open)
}

/// What a question asks, in words.
pub fn words(machine: &Machine, question: Question) -> String {
    match question {
        Question::Declared(i) => property(machine, i),
        Question::Arises(i) => {
            format!("{}: what it speaks of happens in a fair run", machine.properties[i].name)
        }
        Question::Violated(c) => {
            let c = &machine.safety.constraints[c];
            format!("{}: the outputs never violate it", c.name)
        }
        Question::Assumable => "the assumptions leave inputs in every scan".to_owned(),
        Question::Moves => "it is always possible that a transition fires".to_owned(),
        Question::Active(s) => format!("{} is reachable", machine.state_path(s)),
        Question::Fires(t) => format!("{} can fire", transition(machine, t)),
        Question::Together(a, b) => {
            format!("{} and {} are never enabled together", transition(machine, a), transition(machine, b))
        }
        Question::Beyond(i) => {
            let integer = &machine.integers[i];
            let Range { lowest, highest } = integer.range;
            format!("{}: nothing beyond {lowest}..{highest} is assigned to it", integer.name)
        }
        Question::Acts(c) => format!("{}: the filter never has to act", machine.safety.constraints[c].name),
    }
}

/// A property by its name, and what it says.
pub fn property(machine: &Machine, property: usize) -> String {
    format!("{}: {}", machine.properties[property].name, says(machine, property))
}

/// What a property says, in the words of the language.
fn says(machine: &Machine, property: usize) -> String {
    let p = &machine.properties[property];
    match &p.after {
        Some(after) => format!("after {} eventually {}", text(machine, after), text(machine, &p.condition)),
        None => format!("{} {}", p.kind.words(), text(machine, &p.condition)),
    }
}

fn condition(machine: &Machine, property: usize) -> String {
    text(machine, &machine.properties[property].condition)
}

fn text(machine: &Machine, condition: &Condition) -> String {
    let mut out = String::new();
    let written = condition.write(&mut out, &crate::ir::expr::CHART, &mut |a, f| f.write_str(&machine.seen(*a)));
    written.expect("writing to a string succeeds");
    out
}

/// A run of the system as people see it, played once more by the simulator.
pub(super) fn show(subject: &Subject<'_>, question: Question, trace: &Trace, options: &Options) -> Run {
    // What people look at is worth the time to make it calm.
    let claim = subject.questions.iter().position(|q| *q == question).expect("it was asked");
    let property = subject.system.claims[claim].property;
    let calm = options.demands(question).then(|| subject.system.calm(trace, property));
    let trace = calm.as_ref().unwrap_or(trace);
    let repeats = subject.system.repeats(trace, property);
    let scans = trace.inputs.len();
    // What repeats itself is played twice.
    let mut longer = trace.clone();
    longer.inputs.extend_from_slice(&trace.inputs[repeats.unwrap_or(scans)..]);
    let replay = subject.system.replay(&longer).expect("the engines replay what they return");
    let view = subject.view.frame();
    let frame = |values: &Vec<u64>| view.iter().map(|&l| lanes(values, l) & 1 == 1).collect();
    let mut frames: Vec<Frame> = replay.values.iter().map(frame).collect();
    let machine = subject.machine;
    let gives = if options.open { vec![true; machine.inputs.len()] } else { machine.plant.gives(machine.inputs.len()) };
    let steps = steps(machine, &gives, &frames);
    let without = match options.without.as_slice() {
        [] => String::new(),
        names => format!(" without {}", names.join(", ")),
    };
    let name = format!("found by verification{without}: {}", words(machine, question));
    let watch = match question {
        Question::Declared(i) => match machine.properties[i].kind {
            PropertyKind::Never => format!("  never {}\n", condition(machine, i)),
            PropertyKind::Always => format!("  always {}\n", condition(machine, i)),
            PropertyKind::Reachable | PropertyKind::AlwaysPossible | PropertyKind::Eventually | PropertyKind::Fair => {
                String::new()
            }
        },
        Question::Acts(c) => format!("  never acts({})\n", machine.safety.constraints[c].name),
        _ => String::new(),
    };
    let mut scenario = format!("scenario {} {{\n{watch}", quoted(&name));
    steps.iter().for_each(|s| write_step(machine, s, &mut scenario));
    if let Question::Declared(i) = question {
        match machine.properties[i].kind {
            PropertyKind::Reachable => {
                let _ = writeln!(scenario, "  expect {}", condition(machine, i));
            }
            PropertyKind::Eventually => {
                // Where nothing comes in anew, the answer does not come however long one waits.
                let loops = &frames[repeats.unwrap_or(scans)..];
                let given = Layout::of(machine).inputs();
                let still = loops.windows(2).all(|pair| pair[0][given.clone()] == pair[1][given.clone()]);
                let answer = condition(machine, i);
                let _ = if still {
                    writeln!(scenario, "  wait until {answer} within {} scans", scans.max(100))
                } else {
                    writeln!(scenario, "  expect {answer}")
                };
            }
            PropertyKind::Never | PropertyKind::Always | PropertyKind::AlwaysPossible | PropertyKind::Fair => {}
        }
    }
    scenario += "}\n";
    let replayed = (options.program == Program::Chart).then(|| is_replayed(machine, &steps, &frames));
    frames.truncate(scans);
    let outputs = if replayed == Some(true) { outputs(machine, question) } else { Vec::new() };
    let rungs = if outputs.is_empty() { None } else { rungs::show(machine, &frames, &outputs) };
    Run { frames, shortest: trace.shortest, repeats: repeats.map(|scan| scan + 1), scenario, replayed, rungs }
}

/// The outputs of which a demand speaks.
fn outputs(machine: &Machine, question: Question) -> Vec<OutputId> {
    let mut outputs = BTreeSet::new();
    let mut note = |atom: &Atom| {
        if let Atom::Output(o) | Atom::PrevOutput(o) = atom {
            outputs.insert(*o);
        }
    };
    match question {
        Question::Declared(i) => {
            let p = &machine.properties[i];
            for condition in p.after.iter().chain([&p.condition]) {
                condition.for_each_atom(&mut |seen| {
                    if let Seen::Machine(atom) = seen {
                        note(atom);
                    }
                });
            }
        }
        Question::Violated(c) => machine.safety.constraints[c].never.for_each_atom(&mut note),
        _ => {}
    }
    outputs.into_iter().collect()
}

/// What to do, so that the program samples in each scan what stands in the frames. What the plant gives is
/// forced.
fn steps(machine: &Machine, gives: &[bool], frames: &[Frame]) -> Vec<Doing> {
    let layout = Layout::of(machine);
    let mut now: Vec<Option<bool>> = vec![Some(false); machine.inputs.len()];
    for &(given, value) in &machine.plant.initially {
        if let Given::Input(i) = given {
            now[i.index()] = Some(value);
        }
    }
    for (now, gives) in now.iter_mut().zip(gives) {
        if *gives {
            *now = None;
        }
    }
    let mut steps: Vec<Doing> = Vec::new();
    for frame in frames {
        let ids: Vec<InputId> = machine.inputs.ids().collect();
        let changed: Vec<InputId> =
            ids.into_iter().filter(|&i| now[i.index()] != Some(frame[layout.input(i)])).collect();
        let value = |i: InputId| frame[layout.input(i)];
        for wanted in [true, false] {
            let set: Vec<(Given, bool)> = changed
                .iter()
                .filter(|&&i| !gives[i.index()] && value(i) == wanted)
                .map(|&i| (Given::Input(i), wanted))
                .collect();
            if !set.is_empty() {
                steps.push(Doing::Set(set));
            }
        }
        let forced: Vec<(InputId, bool)> =
            changed.iter().filter(|i| gives[i.index()]).map(|&i| (i, value(i))).collect();
        if !forced.is_empty() {
            steps.push(Doing::Force(forced));
        }
        changed.iter().for_each(|&i| now[i.index()] = Some(value(i)));
        match steps.last_mut() {
            Some(Doing::Wait(scans)) => *scans += 1,
            _ => steps.push(Doing::Wait(1)),
        }
    }
    steps
}

fn write_step(machine: &Machine, doing: &Doing, out: &mut String) {
    let _ = match doing {
        Doing::Set(given) => {
            let names: Vec<&str> = given.iter().map(|&(g, _)| machine.given(g)).collect();
            let word = if given[0].1 { "set" } else { "reset" };
            writeln!(out, "  {word} {}", names.join(", "))
        }
        Doing::Force(forced) => {
            let name = |&(i, value): &(InputId, bool)| {
                format!("{}{}", if value { "" } else { "not " }, machine.inputs[i].name)
            };
            let names: Vec<String> = forced.iter().map(name).collect();
            writeln!(out, "  force {}", names.join(", "))
        }
        Doing::Wait(1) => writeln!(out, "  wait 1 scan"),
        Doing::Wait(n) => writeln!(out, "  wait {n} scans"),
        other => unreachable!("{other:?} is not among what a run needs"),
    };
}

/// Whether the simulator, which shares nothing with the system, sees the same in every scan. What the plant hides is
/// left out: it goes its own way while inputs are forced.
fn is_replayed(machine: &Machine, steps: &[Doing], frames: &[Frame]) -> bool {
    let mut machine = machine.clone();
    let span = crate::base::Span::default();
    let steps = steps.iter().map(|d| Step { doing: d.clone(), text: String::new(), span });
    machine.scenarios.push(Scenario { name: String::new(), after: None, steps: steps.collect(), span });
    let layout = Layout::of(&machine);
    let mut seen: Vec<Frame> = Vec::new();
    let program = Runs::chart(&machine);
    play(&machine, program, machine.scenarios.len() - 1, &mut |_, frame| seen.push(frame.clone()));
    let visible = |frame: &Frame| -> Frame {
        let hidden = layout.inputs().end..layout.given().end;
        frame.iter().enumerate().filter(|(i, _)| !hidden.contains(i)).map(|(_, &v)| v).collect()
    };
    seen.iter().map(visible).eq(frames.iter().map(visible))
}

/// A text as the language writes it.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
