//! A machine to answers about all its runs, each with the run that shows it.

use super::witnesses::Witnesses;
use super::{exactly, without};
use crate::base::Diagnostics;
use crate::ir::chart::Machine;
use crate::ir::scenario::{Acceptance, Accepted};
use crate::verify::engine::{self, Choice, Coarser, Engine, Known, Progress};
use crate::verify::machine::Subject;
use crate::verify::{Limit, Limits, Verdict};

pub use super::run::{Between, Run};
pub use crate::verify::machine::clocks::Times;
pub use crate::verify::machine::questions::{Kind, Question};
pub use crate::verify::machine::{Program, Refusal};

/// What [`verify`] is told.
#[derive(Clone, Debug)]
pub struct Options {
    /// What runs in front of the filter.
    pub program: Program,
    /// Whether the plant is left out, and all inputs are free.
    pub open: bool,
    /// How times are taken.
    pub times: Times,
    /// The names of constraints without which the model is verified, as if they had not been written.
    pub without: Vec<String>,
    /// What makes the machine wrong if it is found, and is not left to people to judge.
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
            times: Times::Exact,
            without: Vec::new(),
            deny: Vec::new(),
            choice: Choice::Automatic,
            limits: Limits::default(),
        }
    }
}

/// Conflicts for a first proof of all that is asked behind any program.
const AT_FIRST: u64 = 2_000;

impl Options {
    /// What the engines may spend. What holds behind any program does so because of the filter mostly, and is soon proved.
    pub(super) fn limits(&self) -> Limits {
        let at_first = if self.program == Program::Any { AT_FIRST.min(self.limits.conflicts) } else { 0 };
        Limits { at_first, ..self.limits }
    }

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
    /// In how many situations it can be, if all of them were found.
    pub situations: Option<String>,
    /// After how many transitions there was no new one: scans, and with a plant by steps what happens between them.
    pub scans: Option<usize>,
}

impl Verified {
    /// Says of what nobody has had the time for that somebody broke it off. Whether there is anything of the kind.
    pub fn interrupt(&mut self) -> bool {
        let mut some = false;
        for answer in &mut self.answers {
            if answer.status == Status::Unknown(Limit::Stopped) {
                answer.status = Status::Unknown(Limit::Interrupted);
                some = true;
            }
        }
        some
    }
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
        Verified { machine, refusal: None, answers: Vec::new(), latches: 0, inputs: 0, situations: None, scans: None };
    let subject = match Subject::new(&verified.machine, options.program, options.open, Times::Free) {
        Ok(subject) => subject,
        Err(refusal) => {
            verified.refusal = Some(refusal);
            return (Some(verified), diagnostics);
        }
    };
    let any = behind_any(&verified.machine, options);
    let coarser = any.as_ref().map(|any| {
        let there = |q: &Question| any.questions.iter().position(|asked| asked == q);
        let claims = subject.questions.iter().map(there).collect();
        Coarser { system: &any.system, claims }
    });
    let witnesses = Witnesses::play(&verified.machine, &subject.questions, options, stop, progress);
    let witness = |question: usize| witnesses.as_ref().and_then(|w| w.answer(question, options, stop));
    let known = Known { coarser, shown: witnesses.as_ref().map(Witnesses::shown).unwrap_or_default() };
    let limits = options.limits();
    let report = engine::check(&subject.system, Some(&known), &limits, options.choice, stop, progress);
    let exact = exactly::judge(&subject, &report.findings, &witness, options, stop, progress);
    let found = exact.unwrap_or_else(|| {
        let questions = subject.questions.iter().zip(report.findings).enumerate();
        let found = questions.map(|(i, (&question, finding))| {
            let open = matches!(finding.verdict, Verdict::Unknown(_));
            let witness = if open { witness(i) } else { None };
            witness.unwrap_or_else(|| exactly::shown(&subject, question, finding, options, stop))
        });
        found.collect()
    });
    let mut answers = Vec::new();
    for (&question, (finding, run)) in subject.questions.iter().zip(found) {
        let hopes = question.hopes_for_a_run(subject.machine);
        let status = match finding.verdict {
            Verdict::Unknown(limit) => Status::Unknown(limit),
            Verdict::Holds => {
                if hopes {
                    Status::Violated
                } else {
                    Status::Holds
                }
            }
            Verdict::Violated(_) => {
                if hopes {
                    Status::Holds
                } else {
                    Status::Violated
                }
            }
        };
        let demand = options.demands(question) && accepted(subject.machine, question).is_none();
        answers.push(Answer { question, demand, status, engine: finding.engine, run });
    }
    verified.latches = subject.system.latches.len();
    verified.inputs = subject.system.inputs.len();
    verified.situations = report.states.map(|s| s.to_string());
    verified.scans = report.scans;
    verified.answers = answers;
    (Some(verified), diagnostics)
}

/// Where a model accepts what a question may find.
pub fn accepted(machine: &Machine, question: Question) -> Option<&Acceptance> {
    machine.accepted.iter().find(|a| about(a) == question)
}

/// The question that finds what is accepted.
pub fn about(acceptance: &Acceptance) -> Question {
    match acceptance.finding {
        Accepted::Unreachable(s) => Question::Active(s),
        Accepted::Silent(t) => Question::Fires(t),
        Accepted::Overlap(a, b) => Question::Together(a, b),
        Accepted::Saturates(i) => Question::Beyond(i),
        Accepted::Acts(c) => Question::Acts(c),
        Accepted::Void(i) => Question::Arises(i),
    }
}

/// The machine behind any program, if that is not what is asked for anyway: what holds there holds behind the charts.
pub(super) fn behind_any<'m>(machine: &'m Machine, options: &Options) -> Option<Subject<'m>> {
    match (options.program, options.choice) {
        (Program::Chart, Choice::Automatic) => Subject::new(machine, Program::Any, options.open, Times::Free).ok(),
        (Program::Chart, Choice::Only(_)) | (Program::Any, _) => None,
    }
}

/// The system of a machine with its times left open, for other tools.
pub fn system(machine: &Machine, program: Program, open: bool) -> Result<Subject<'_>, Refusal> {
    Subject::new(machine, program, open, Times::Free)
}

/// A text as the language writes it.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
