//! A model to what happens without each of its constraints.
//!
//! One constraint after the other is left out, and the machine that the compiler makes of the rest is asked for those
//! declared properties that it keeps with all of them. The first scans come first: what a constraint prevents mostly
//! shows early, and then nothing else has to be found out.

use super::run::{Run, show};
use super::verify::{Options, Question, Refusal, behind_any};
use super::without;
use crate::base::{Diagnostic, Diagnostics, Severity};
use crate::constraints::redundancy;
use crate::ir::chart::{ConstraintId, Machine};
use crate::verify::aig::{Lit, lanes};
use crate::verify::bounded::Bounded;
use crate::verify::engine::{self, Coarser, Known};
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::Times;
use crate::verify::symbolic;
use crate::verify::system::{Claim, Property, System, Trace};
use crate::verify::{Choice, Limit, Limits, Verdict};

/// Operations on decision diagrams for a first attempt: what is small is known at once.
const GLANCE: u64 = 200_000;

/// How many of the first scans a first attempt looks at.
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
    /// Constraint by constraint, what happens without it. Nothing is said where no property is kept.
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
    /// All properties that hold with it hold without it. If others imply it together with the assumptions, these; none
    /// of them if the assumptions do alone.
    Kept(Option<Vec<ConstraintId>>),
    /// Nobody knows: of that property, because of that.
    Unknown(usize, Limit),
    /// What is left cannot be verified.
    Unverified(Refusal),
}

impl Needed {
    /// Says of what nobody has had the time for that somebody broke it off.
    pub fn interrupt(&mut self) {
        let kept = self.properties.iter_mut().filter_map(|(_, kept)| match kept {
            Kept::Unknown(limit) => Some(limit),
            Kept::Yes | Kept::No => None,
        });
        let without = self.without.iter_mut().filter_map(|(_, without)| match without {
            Without::Unknown(_, limit) => Some(limit),
            _ => None,
        });
        kept.chain(without).filter(|limit| **limit == Limit::Stopped).for_each(|limit| *limit = Limit::Interrupted);
    }
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
/// before each part of the work how many there still may be, this one included; the first one is about the whole machine.
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
    // Where nothing is kept, nothing can be needed for it.
    let ids = if properties.iter().all(|(_, kept)| *kept == Kept::No) { Vec::new() } else { ids };
    let left = |id: ConstraintId| {
        let mut options = options.clone();
        options.without.push(machine.safety.constraints[id].name.clone());
        options
    };
    // What is found at once is found first, and leaves its time to the others.
    let mut without: Vec<Option<Without>> = Vec::new();
    for (i, &id) in ids.iter().enumerate() {
        begin(ids.len() - i);
        if stop() {
            without.push(None);
            continue;
        }
        without.push(compare(&machine, &properties, source, &left(id), Effort::Glance, stop));
    }
    let mut open = without.iter().filter(|w| w.is_none()).count();
    begin(open.max(1));
    let redundant = if stop() { Vec::new() } else { redundancy::redundant(&machine) };
    // What is asked of a constraint for which there is no time.
    let first = properties.iter().find(|(_, kept)| *kept != Kept::No).map(|&(property, _)| property);
    let mut found = Vec::new();
    for (id, known) in ids.into_iter().zip(without) {
        let mut answer = known.unwrap_or_else(|| {
            begin(open);
            open -= 1;
            if let (true, Some(first)) = (stop(), first) {
                return Without::Unknown(first, Limit::Stopped);
            }
            let all = compare(&machine, &properties, source, &left(id), Effort::All, stop);
            all.expect("with all effort there is an answer")
        });
        if let (Without::Kept(implied), Some(r)) = (&mut answer, redundant.iter().find(|r| r.constraint == id)) {
            *implied = Some(r.implied_by.clone());
        }
        found.push((id, answer));
    }
    (Some(Ok(Needed { machine, properties, without: found })), diagnostics)
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

/// A system of which nothing is known but that it does all that another one does, with what it claims of groups of
/// properties, each claimed as one: nothing where it claims something else.
fn coarser(any: &Subject<'_>, groups: &[Vec<usize>]) -> (System, Vec<Option<usize>>) {
    let there: Vec<(usize, Property)> = declared(any).collect();
    let mut system = any.system.clone();
    let mut claims = Vec::new();
    let places = groups.iter().map(|group| {
        let bad = |i: &usize| match there.iter().find(|(there, _)| there == i)?.1 {
            Property::Never(bad) => Some(bad),
            Property::AlwaysPossible(_) | Property::NeverStuck | Property::Eventually { .. } => None,
        };
        let bads: Vec<Lit> = group.iter().map(bad).collect::<Option<_>>()?;
        claims.push(Property::Never(system.aig.any(&bads)));
        Some(claims.len() - 1)
    });
    let places = places.collect();
    (claiming(&system, &claims), places)
}

/// Which properties a machine keeps, of those that are asked.
pub fn properties(machine: &Machine, options: &Options, stop: Stop<'_>) -> Result<Vec<(usize, Kept)>, Refusal> {
    let subject = Subject::new(machine, options.program, options.open, Times::Free)?;
    let any = behind_any(machine, options);
    let hopes = |i: usize| Question::Declared(i).hopes_for_a_run(machine);
    let asked: Vec<(usize, Property)> = declared(&subject).collect();
    let answer = |system: &System, claims: &[Property], groups: &[Vec<usize>]| {
        let system = claiming(system, claims);
        let any = any.as_ref().map(|any| coarser(any, groups));
        let coarser = any.as_ref().map(|(system, claims)| Coarser { system, claims: claims.clone() });
        let known = Known { coarser, shown: Vec::new() };
        engine::check(&system, Some(&known), &options.limits(), options.choice, stop, &mut |_| {}).findings
    };
    // All that never must be is proved as one mostly, and at less cost than each for itself.
    let is_bad = |&(i, claim): &(usize, Property)| match claim {
        Property::Never(bad) if !hopes(i) => Some(bad),
        _ => None,
    };
    let (group, bads): (Vec<usize>, Vec<Lit>) = asked.iter().filter_map(|a| Some((a.0, is_bad(a)?))).unzip();
    let mut system = subject.system.clone();
    let bad = system.aig.any(&bads);
    let together = bads.len() > 1 && answer(&system, &[Property::Never(bad)], &[group])[0].verdict == Verdict::Holds;
    let (proved, rest): (Vec<_>, Vec<_>) = asked.into_iter().partition(|a| together && is_bad(a).is_some());
    let claims: Vec<Property> = rest.iter().map(|&(_, claim)| claim).collect();
    let groups: Vec<Vec<usize>> = rest.iter().map(|&(i, _)| vec![i]).collect();
    let kept = rest.iter().zip(answer(&system, &claims, &groups)).map(|(&(i, _), finding)| {
        let kept = match finding.verdict {
            Verdict::Unknown(limit) => Kept::Unknown(limit),
            Verdict::Holds if !hopes(i) => Kept::Yes,
            Verdict::Violated(_) if hopes(i) => Kept::Yes,
            Verdict::Holds | Verdict::Violated(_) => Kept::No,
        };
        (i, kept)
    });
    let mut kept: Vec<(usize, Kept)> = proved.iter().map(|&(i, _)| (i, Kept::Yes)).chain(kept).collect();
    kept.sort_by_key(|&(i, _)| i);
    Ok(kept)
}

/// How much an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What shows at once.
    Glance,
    /// All that the options allow.
    All,
}

/// What becomes of the `properties` of a `whole` machine in another one, which the options may make of the `source` of
/// the whole one. Nothing if it takes more effort.
pub fn compare(
    whole: &Machine,
    properties: &[(usize, Kept)],
    source: &str,
    options: &Options,
    effort: Effort,
    stop: Stop<'_>,
) -> Option<Without> {
    let (machine, diagnostics) = without::check(source, &options.without);
    let Some(machine) = machine else {
        let mut errors = diagnostics.iter().filter(|d| d.severity() == Severity::Error);
        let error = errors.next().expect("there is no machine because of an error").clone();
        return Some(Without::Refused(Box::new(error)));
    };
    let subject = match Subject::new(&machine, options.program, options.open, Times::Free) {
        Ok(subject) => subject,
        Err(refusal) => return Some(Without::Unverified(refusal)),
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
    let any = behind_any(&machine, options);
    let search = Search { subject: &subject, any: any.as_ref(), asked: &asked, options, effort, stop };
    Some(match search.run()? {
        Ok(None) => Without::Kept(None),
        Ok(Some((lost, trace))) => {
            let Asked { index, here, certain, .. } = asked[lost];
            let question = Question::Declared(here);
            let options = Options { times: Times::Free, ..options.clone() };
            let run = trace.map(|trace| show(&subject, question, &trace, &options, stop));
            Without::Violated(Box::new(Loss { property: index, certain, question, run, machine: machine.clone() }))
        }
        Err((open, limit)) => Without::Unknown(asked[open].index, limit),
    })
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
    /// The same behind any program, if that is something else.
    any: Option<&'s Subject<'m>>,
    asked: &'s [Asked],
    options: &'s Options,
    effort: Effort,
    stop: Stop<'s>,
}

/// Which of those that are asked is violated, with the run that shows it; none if all hold; or one that stays open.
type Found = Result<Option<(usize, Option<Trace>)>, (usize, Limit)>;

impl Search<'_, '_> {
    /// Nothing if it takes more effort.
    fn run(&self) -> Option<Found> {
        let found = self.search(&self.of(true));
        let uncertain = self.of(false);
        if uncertain.is_empty() || matches!(found, Some(Ok(Some(_)))) {
            return found;
        }
        // What is violated here tells something, even if nobody knows whether it is with all constraints; but first it
        // is to be known that there is nothing better.
        match (found?, self.search(&uncertain)?) {
            (_, lost @ Ok(Some(_))) => Some(lost),
            (Err(open), _) | (_, Err(open)) => Some(Err(open)),
            (Ok(_), Ok(None)) => Some(Ok(None)),
        }
    }

    fn of(&self, certain: bool) -> Vec<usize> {
        (0..self.asked.len()).filter(|&i| self.asked[i].certain == certain).collect()
    }

    fn search(&self, asked: &[usize]) -> Option<Found> {
        // All that never must be is one claim.
        let (never, rest): (Vec<usize>, Vec<usize>) = asked.iter().partition(|&&i| self.bad(i).is_some());
        let rest = rest.into_iter().map(|i| vec![i]);
        let groups: Vec<Vec<usize>> = Some(never).filter(|n| !n.is_empty()).into_iter().chain(rest).collect();
        let mut system = self.subject.system.clone();
        let claim = |group: &Vec<usize>| match group[..] {
            [one] => self.asked[one].claim,
            _ => Property::Never(system.aig.any(&group.iter().filter_map(|&i| self.bad(i)).collect::<Vec<_>>())),
        };
        let claims: Vec<Property> = groups.iter().map(claim).collect();
        let system = claiming(&system, &claims);
        let verdicts = match self.effort {
            Effort::Glance => self.glance(&system)?,
            Effort::All => self.check(&system, &groups),
        };
        let mut open = None;
        for (group, verdict) in groups.iter().zip(verdicts) {
            match (verdict, self.hopes(group[0])) {
                (Verdict::Violated(trace), false) => {
                    return Some(Ok(Some((self.which(group, &trace), Some(trace)))));
                }
                (Verdict::Holds, true) => return Some(Ok(Some((group[0], None)))),
                (Verdict::Holds, false) | (Verdict::Violated(_), true) => {}
                (Verdict::Unknown(limit), _) => open = open.or(Some((group[0], limit))),
            }
        }
        match self.effort {
            Effort::Glance if open.is_some() => None,
            Effort::Glance | Effort::All => Some(open.map_or(Ok(None), Err)),
        }
    }

    /// The verdicts with all effort.
    fn check(&self, system: &System, groups: &[Vec<usize>]) -> Vec<Verdict> {
        let here = |group: &Vec<usize>| group.iter().map(|&i| self.asked[i].here).collect();
        let any = self.any.map(|any| coarser(any, &groups.iter().map(here).collect::<Vec<_>>()));
        let coarser = any.as_ref().map(|(system, claims)| Coarser { system, claims: claims.clone() });
        let known = Known { coarser, shown: Vec::new() };
        let Options { limits, choice, .. } = self.options;
        let report = engine::check(system, Some(&known), limits, *choice, self.stop, &mut |_| {});
        report.findings.into_iter().map(|f| f.verdict).collect()
    }

    /// The verdicts that show at once: all of them, or one that something is violated.
    fn glance(&self, system: &System) -> Option<Vec<Verdict>> {
        let limits = Limits { steps: GLANCE, ..self.options.limits };
        if matches!(self.options.choice, Choice::Only(_)) || system.claims.is_empty() {
            return None;
        }
        let explored = symbolic::explore(system, &limits, self.stop, &mut |_| {});
        if explored.verdicts.iter().all(Option::is_some) {
            let claims = system.claims.iter().zip(explored.verdicts);
            // Nothing is believed that the system does not do.
            let verdict = |(claim, verdict): (&Claim, Option<Result<(), Trace>>)| match verdict? {
                Ok(()) => Some(Verdict::Holds),
                Err(trace) => system.shows(&trace, claim.property).then_some(Verdict::Violated(trace)),
            };
            return claims.map(verdict).collect();
        }
        let Property::Never(bad) = system.claims[0].property else { return None };
        let trace = self.look_ahead(system, bad)?;
        let rest = system.claims.iter().skip(1).map(|_| Verdict::Unknown(Limit::Steps));
        Some([Verdict::Violated(trace)].into_iter().chain(rest).collect())
    }

    /// Which of those that are claimed as one a run shows.
    fn which(&self, group: &[usize], trace: &Trace) -> usize {
        let [first, _, ..] = group[..] else { return group[0] };
        let mut shown = None;
        let replayed = self.subject.system.replay(trace, &mut |values| {
            let is = |&i: &usize| self.bad(i).is_some_and(|bad| lanes(values, bad) & 1 == 1);
            shown = group.iter().copied().find(is);
        });
        replayed.expect("the engines replay what they return");
        shown.unwrap_or(first)
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
