//! A model to what happens without each of its constraints.
//!
//! One constraint after the other is left out, and the machine that the compiler makes of the rest is asked for those
//! declared properties that it keeps with all of them. The first scans come first: what a constraint prevents mostly
//! shows early, and then nothing else has to be found out.

use super::verify::{Options, Question, Refusal, Run, show};
use super::without;
use crate::base::{Diagnostic, Diagnostics, Severity};
use crate::constraints::redundancy::{self, Redundant};
use crate::ir::chart::{ConstraintId, Machine};
use crate::verify::aig::{Lit, lanes};
use crate::verify::bounded::Bounded;
use crate::verify::engine;
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::system::{Property, System, Trace};
use crate::verify::{Choice, Limit, Verdict};

/// How many of the first scans are searched before all that can be reached is.
const SCANS: usize = 24;

/// Conflicts for one question about the first scans.
const CONFLICTS: u64 = 5_000;

/// What is known about the constraints of a machine.
#[derive(Clone, Debug)]
pub struct Needed {
    /// The machine with all constraints.
    pub machine: Machine,
    /// Property by property, what is so with all constraints; only of those that are asked.
    pub properties: Vec<(usize, Kept)>,
    /// Constraint by constraint, what happens without it.
    pub without: Vec<(ConstraintId, Without)>,
}

/// Whether a property is kept with all constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is.
    Yes,
    /// It is not, and so tells nothing about any of them.
    No,
    /// Nobody knows.
    Unknown(Limit),
}

/// What happens without a constraint.
#[derive(Clone, Debug)]
pub enum Without {
    /// A property is violated.
    Violated(Box<Loss>),
    /// The compiler refuses what is left, because of that.
    Refused(Box<Diagnostic>),
    /// All properties that hold with it hold without it. Where others imply it, these.
    Kept(Vec<ConstraintId>),
    /// Nobody knows: of that property, because of that.
    Unknown(usize, Limit),
    /// What is left cannot be verified.
    Unverified(Refusal),
}

/// A property that is lost without a constraint.
#[derive(Clone, Debug)]
pub struct Loss {
    /// Its index in the whole machine.
    pub property: usize,
    /// Whether it is certain that the constraint keeps it: that it holds with all of them is known.
    pub certain: bool,
    /// The machine without the constraint.
    pub machine: Machine,
    /// What the run answers, in that machine.
    pub question: Question,
    /// The run, if there is one that shows it.
    pub run: Option<Run>,
}

/// Text to what each constraint is good for. Nothing if the model has errors, or cannot be verified. `begin` is told
/// before each part of the work how many there still are, this one included; the first one is about the whole machine.
pub fn needed(
    source: &str,
    options: &Options,
    stop: Stop<'_>,
    begin: &mut dyn FnMut(usize),
) -> (Option<Result<Needed, Refusal>>, Diagnostics) {
    let (machine, diagnostics) = without::check(source, &options.without);
    let Some(machine) = machine else { return (None, diagnostics) };
    let ids: Vec<ConstraintId> = machine.safety.constraints.ids().collect();
    begin(ids.len() + 1);
    let properties = match properties(&machine, options, stop) {
        Ok(properties) => properties,
        Err(refusal) => return (Some(Err(refusal)), diagnostics),
    };
    let redundant = redundancy::redundant(&machine);
    let mut without = Vec::new();
    for (i, &id) in ids.iter().enumerate() {
        begin(ids.len() - i);
        without.push((id, leave_out(source, &machine, id, &properties, &redundant, options, stop)));
    }
    (Some(Ok(Needed { machine, properties, without })), diagnostics)
}

/// The declared properties among the questions, each with its claim.
fn declared<'s>(subject: &'s Subject<'_>) -> impl Iterator<Item = (usize, Property)> + 's {
    let claims = subject.system.claims.iter().map(|c| c.property);
    let declared = |(question, property)| match question {
        Question::Declared(i) => Some((i, property)),
        _ => None,
    };
    subject.questions.iter().copied().zip(claims).filter_map(declared)
}

/// The same system with other claims.
fn claiming(system: &System, claims: &[Property]) -> System {
    let mut system = System { claims: Vec::new(), ..system.clone() };
    claims.iter().for_each(|&property| system.claim("", property));
    system
}

/// Which properties are kept with all constraints.
fn properties(machine: &Machine, options: &Options, stop: Stop<'_>) -> Result<Vec<(usize, Kept)>, Refusal> {
    let subject = Subject::new(machine, options.program, options.open)?;
    let (indices, claims): (Vec<usize>, Vec<Property>) = declared(&subject).unzip();
    let system = claiming(&subject.system, &claims);
    let report = engine::check(&system, &options.limits, options.choice, stop, &mut |_| {});
    let kept = indices.into_iter().zip(report.findings).map(|(i, finding)| {
        let hopes = Question::Declared(i).hopes_for_a_run(machine);
        let kept = match finding.verdict {
            Verdict::Unknown(limit) => Kept::Unknown(limit),
            Verdict::Holds if !hopes => Kept::Yes,
            Verdict::Violated(_) if hopes => Kept::Yes,
            Verdict::Holds | Verdict::Violated(_) => Kept::No,
        };
        (i, kept)
    });
    Ok(kept.collect())
}

/// What happens without one constraint.
fn leave_out(
    source: &str,
    whole: &Machine,
    constraint: ConstraintId,
    properties: &[(usize, Kept)],
    redundant: &[Redundant],
    options: &Options,
    stop: Stop<'_>,
) -> Without {
    let mut options = options.clone();
    options.without.push(whole.safety.constraints[constraint].name.clone());
    let (machine, diagnostics) = without::check(source, &options.without);
    let Some(machine) = machine else {
        let mut errors = diagnostics.iter().filter(|d| d.severity() == Severity::Error);
        return Without::Refused(Box::new(errors.next().expect("there is no machine because of an error").clone()));
    };
    let subject = match Subject::new(&machine, options.program, options.open) {
        Ok(subject) => subject,
        Err(refusal) => return Without::Unverified(refusal),
    };
    // A property may have another index without its neighbours that ask for what is gone.
    let name = |i: usize| &machine.properties[i].name;
    let asked = declared(&subject).filter_map(|(i, claim)| {
        let (index, kept) = properties.iter().find(|(index, _)| whole.properties[*index].name == *name(i))?;
        let certain = match kept {
            Kept::Yes => true,
            Kept::Unknown(_) => false,
            Kept::No => return None,
        };
        Some(Asked { index: *index, here: i, certain, claim })
    });
    let asked: Vec<Asked> = asked.collect();
    let search = Search { subject: &subject, asked: &asked, options: &options, stop };
    match search.run() {
        Ok(None) => {
            let implied = redundant.iter().find(|r| r.constraint == constraint);
            Without::Kept(implied.map_or_else(Vec::new, |r| r.implied_by.clone()))
        }
        Ok(Some((lost, trace))) => {
            let Asked { index, here, certain, .. } = asked[lost];
            let question = Question::Declared(here);
            let run = trace.map(|trace| show(&subject, question, &trace, &options));
            Without::Violated(Box::new(Loss { property: index, certain, question, run, machine: machine.clone() }))
        }
        Err((open, limit)) => Without::Unknown(asked[open].index, limit),
    }
}

/// A property that is asked of what is left.
#[derive(Clone, Copy)]
struct Asked {
    /// Its index in the whole machine.
    index: usize,
    /// Its index in what is left.
    here: usize,
    /// Whether it is known to hold with all constraints.
    certain: bool,
    /// What is claimed.
    claim: Property,
}

struct Search<'s, 'm> {
    subject: &'s Subject<'m>,
    asked: &'s [Asked],
    options: &'s Options,
    stop: Stop<'s>,
}

/// Which of those that are asked is violated, with the run that shows it; none if all hold; or one that stays open.
type Found = Result<Option<(usize, Option<Trace>)>, (usize, Limit)>;

impl Search<'_, '_> {
    fn run(&self) -> Found {
        let certain = self.of(true);
        let found = self.search(&certain);
        let uncertain = self.of(false);
        if uncertain.is_empty() || matches!(found, Ok(Some(_))) {
            return found;
        }
        // What is violated here tells something, even if nobody knows whether it is with all constraints.
        match (self.search(&uncertain), found) {
            (lost @ Ok(Some(_)), _) => lost,
            (_, Err(open)) | (Err(open), _) => Err(open),
            (Ok(None), Ok(_)) => Ok(None),
        }
    }

    fn of(&self, certain: bool) -> Vec<usize> {
        (0..self.asked.len()).filter(|&i| self.asked[i].certain == certain).collect()
    }

    fn search(&self, asked: &[usize]) -> Found {
        let never = asked.iter().filter_map(|&i| self.bad(i).map(|bad| (i, bad)));
        let never: Vec<(usize, Lit)> = never.collect();
        let mut system = self.subject.system.clone();
        let bad = system.aig.any(&never.iter().map(|&(_, bad)| bad).collect::<Vec<_>>());
        let rest: Vec<usize> = asked.iter().copied().filter(|&i| self.bad(i).is_none()).collect();
        let which = |trace: &Trace| {
            let replay = self.subject.system.replay(trace).expect("the engines replay what they return");
            let last = replay.values.last().expect("it has a scan");
            never.iter().find(|&&(_, bad)| lanes(last, bad) & 1 == 1).expect("it shows one of them").0
        };
        let claims: Vec<Property> = rest.iter().map(|&i| self.asked[i].claim).collect();
        let claims = if never.is_empty() { claims } else { [vec![Property::Never(bad)], claims].concat() };
        let system = claiming(&system, &claims);
        if !never.is_empty()
            && self.options.choice == Choice::Automatic
            && let Some(trace) = self.look_ahead(&system, bad)
        {
            return Ok(Some((which(&trace), Some(trace))));
        }
        let report = engine::check(&system, &self.options.limits, self.options.choice, self.stop, &mut |_| {});
        let mut open = None;
        for (k, finding) in report.findings.into_iter().enumerate() {
            // The first one is about all that never must be; which one stays open it cannot say.
            let one = if never.is_empty() { Some(rest[k]) } else { k.checked_sub(1).map(|k| rest[k]) };
            let hopes = one.is_some_and(|i| self.hopes(i));
            match finding.verdict {
                Verdict::Violated(trace) if !hopes => {
                    return Ok(Some((one.unwrap_or_else(|| which(&trace)), Some(trace))));
                }
                Verdict::Holds if hopes => return Ok(Some((one.expect("it is one that hopes"), None))),
                Verdict::Holds | Verdict::Violated(_) => {}
                Verdict::Unknown(limit) => open = open.or(Some((one.unwrap_or_else(|| never[0].0), limit))),
            }
        }
        open.map_or(Ok(None), Err)
    }

    /// Whether a run that shows it is what one hopes for.
    fn hopes(&self, asked: usize) -> bool {
        Question::Declared(self.asked[asked].here).hopes_for_a_run(self.subject.machine)
    }

    /// What never must be, if that is what it says.
    fn bad(&self, asked: usize) -> Option<Lit> {
        match self.asked[asked].claim {
            Property::Never(bad) if !self.hopes(asked) => Some(bad),
            _ => None,
        }
    }

    /// A run of a few scans that shows the bad.
    fn look_ahead(&self, system: &System, bad: Lit) -> Option<Trace> {
        let mut bounded = Bounded::new(system, &[bad], self.stop);
        let mut sure = true;
        for _ in 0..SCANS.min(self.options.limits.scans) {
            if (self.stop)() {
                return None;
            }
            bounded.scan();
            match bounded.find(0, &mut { CONFLICTS }) {
                Ok(None) => {}
                Ok(Some(trace)) => {
                    let trace = Trace { shortest: sure, ..trace };
                    // Nothing is believed that the system does not do.
                    return system.shows(&trace, Property::Never(bad)).then_some(trace);
                }
                Err(_) => sure = false,
            }
        }
        None
    }
}
