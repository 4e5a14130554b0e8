//! A claim to an answer with exact times, with as few clocks as it takes.
//!
//! What a run wrongly shows while some clocks do not count, it shows because of how they go against each other. The least set of clocks
//! that keeps it from happening is found by leaving them out one by one; with these the claim is asked again (counterexample-guided
//! abstraction refinement, Clarke et al., 2003, on clocks). What holds with some clocks holds with all; a run has to be one with all.

use super::verify::Options;
use crate::verify::engine::{self, Choice, Engine, Finding, Progress};
use crate::verify::follow::follow;
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::{Clock, Counted};
use crate::verify::symbolic;
use crate::verify::system::{Property, Trace};
use crate::verify::{Limits, Verdict};
use std::collections::BTreeSet;

/// What part of the operations a claim gets with some of the clocks.
const STEPS: u64 = 8;

/// What part of the conflicts it gets.
const CONFLICTS: u64 = 40;

/// A claim of which a run shows the opposite while all times are open.
pub struct Asked<'s, 'm> {
    /// The machine with its times left open.
    pub open: &'s Subject<'m>,
    /// The index of the claim.
    pub claim: usize,
    /// The run.
    pub trace: &'s Trace,
}

/// Sets of clocks with which something has been shown.
pub type Sets = Vec<BTreeSet<Clock>>;

/// The answer, with the system that gives it, of which the claim is the only one. `sets` are tried first.
pub fn answer<'m>(
    asked: &Asked<'_, 'm>,
    sets: &mut Sets,
    options: &Options,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Option<(Subject<'m>, Finding)> {
    let exact = asked.subject(&Counted::All);
    let matter = asked.matter(&exact);
    let mut counted = BTreeSet::new();
    let (mut coarse, mut trace) = (asked.open.counting(&Counted::These(BTreeSet::new())), asked.trace.clone());
    if let Some(set) = sets.iter().find(|set| asked.follows(&coarse, &trace, set, stop).is_none()) {
        counted.clone_from(set);
    }
    while !stop() {
        let more = asked.least(&coarse, &trace, &counted, &matter, stop);
        if more.is_empty() && coarse.clocks.counted == Counted::These(counted.clone()) {
            return None;
        }
        counted.extend(more);
        let all = counted.is_superset(&matter);
        coarse = asked.subject(&if all { Counted::All } else { Counted::These(counted.clone()) });
        let Finding { verdict, engine } = ask(&coarse, options, stop, progress)?;
        match verdict {
            Verdict::Holds => {
                if !sets.contains(&counted) {
                    sets.push(counted);
                }
                return Some((coarse, Finding { verdict: Verdict::Holds, engine }));
            }
            Verdict::Violated(run) if all => {
                return Some((coarse, Finding { verdict: Verdict::Violated(run), engine }));
            }
            Verdict::Violated(run) => trace = run,
            Verdict::Unknown(_) => return None,
        }
        let property = exact.system.claims[0].property;
        if let Some(run) = along(&coarse, &exact, &trace, property, stop) {
            return Some((exact, Finding { verdict: Verdict::Violated(run), engine }));
        }
    }
    None
}

/// Asks the only claim, without much patience: a situation by situation where there are few, else by proof.
fn ask(
    subject: &Subject<'_>,
    options: &Options,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Option<Finding> {
    let (system, limits) = (&subject.system, &options.limits);
    if let Choice::Only(_) = options.choice {
        return engine::check(system, None, limits, options.choice, stop, progress).findings.pop();
    }
    let few = Limits { steps: limits.steps / STEPS, ..*limits };
    let mut explored = symbolic::explore(system, &few, stop, &mut |_| {});
    let verdict = match explored.verdicts.pop()? {
        Some(Ok(())) => Some(Verdict::Holds),
        // Nothing is believed that the system does not do.
        Some(Err(run)) if system.shows(&run, system.claims[0].property) => Some(Verdict::Violated(run)),
        Some(Err(_)) | None => None,
    };
    if let Some(verdict) = verdict {
        return Some(Finding { verdict, engine: Engine::Exact });
    }
    let few = Limits { conflicts: limits.conflicts / CONFLICTS, ..*limits };
    engine::check(system, None, &few, Choice::Only(Engine::Proof), stop, progress).findings.pop()
}

impl<'m> Asked<'_, 'm> {
    /// The machine with these clocks, of which nothing else is asked.
    fn subject(&self, counted: &Counted) -> Subject<'m> {
        self.open.counting(counted).wanting(&[self.claim])
    }

    /// The clocks on which the claim depends.
    fn matter(&self, exact: &Subject<'_>) -> BTreeSet<Clock> {
        let system = &exact.system;
        let roots = system.claims[0].property.literals();
        let (latches, _) = system.cone(&[&roots[..], &system.constraints].concat());
        exact.clocks.among(&latches)
    }

    /// A run with these clocks along one with fewer.
    fn follows(&self, coarse: &Subject<'_>, trace: &Trace, clocks: &BTreeSet<Clock>, stop: Stop<'_>) -> Option<Trace> {
        let fine = self.subject(&Counted::These(clocks.clone()));
        along(coarse, &fine, trace, fine.system.claims[0].property, stop)
    }

    /// Few clocks that, beside those that are `counted`, keep a run from happening.
    fn least(
        &self,
        coarse: &Subject<'_>,
        trace: &Trace,
        counted: &BTreeSet<Clock>,
        matter: &BTreeSet<Clock>,
        stop: Stop<'_>,
    ) -> BTreeSet<Clock> {
        let with = |more: &[Clock]| counted.iter().chain(more).copied().collect::<BTreeSet<Clock>>();
        let mut more: Vec<Clock> = matter.difference(counted).copied().collect();
        if self.follows(coarse, trace, &with(&[]), stop).is_none() {
            return BTreeSet::new();
        }
        // Larger parts first, then single ones.
        let mut part = more.len() / 2;
        while part > 0 && !stop() {
            let mut begin = 0;
            while begin < more.len() && more.len() > 1 {
                let end = (begin + part).min(more.len());
                let rest: Vec<Clock> = more[..begin].iter().chain(&more[end..]).copied().collect();
                if self.follows(coarse, trace, &with(&rest), stop).is_none() {
                    more = rest;
                } else {
                    begin = end;
                }
            }
            part /= 2;
        }
        more.into_iter().collect()
    }
}

/// A run of the finer system along one of the coarser one that shows the same.
fn along(coarse: &Subject<'_>, fine: &Subject<'_>, trace: &Trace, property: Property, stop: Stop<'_>) -> Option<Trace> {
    let bad = property.never()?;
    let found = follow(&coarse.system, &fine.system, trace, &[bad], stop);
    found.into_iter().map(|f| f.trace).find(|run| fine.system.shows(run, property))
}
