//! A system to verdicts: which engine answers what.
//!
//! The exact engine comes first: it answers everything at once, or runs into its bound early. What it
//! leaves open is looked for in the first scans, then proved claim by claim. A run is replayed on the
//! system, and an invariant checked by another solver, before either is believed.

use super::aig::Lit;
use super::bounded::Bounded;
use super::certificate;
use super::count::Count;
use super::limits::{Limit, Limits, Stop};
use super::liveness;
use super::pdr::{self, Proof};
use super::symbolic;
use super::system::{Claim, Property, System, Trace};

/// What was found out about a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Whether it holds.
    pub verdict: Verdict,
    /// Who says so.
    pub engine: Engine,
}

/// Whether a claim holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// In all runs.
    Holds,
    /// Not in this one.
    Violated(Trace),
    /// Nobody knows, because of that.
    Unknown(Limit),
}

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// The exact set of reachable states.
    Exact,
    /// The first scans, one by one.
    Bounded,
    /// Property directed reachability.
    Proof,
}

/// Which engines may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// All, as each is needed.
    Automatic,
    /// This one only.
    Only(Engine),
}

/// What was found out about a system.
#[derive(Clone, Debug)]
pub struct Report {
    /// Claim by claim.
    pub findings: Vec<Finding>,
    /// How many states are reachable, if the exact engine came to an end. States are counted over those
    /// latches on which some claim depends.
    pub states: Option<Count>,
    /// After how many scans there were no new states, if the exact engine came to an end.
    pub scans: Option<usize>,
}

/// Where the engines are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Who works.
    pub engine: Engine,
    /// On which claim; nothing if on all at once.
    pub claim: Option<usize>,
    /// How many scans deep.
    pub scans: usize,
}

/// Conflicts for a first attempt to prove a claim.
const GLANCE: u64 = 2_000;

/// Conflicts for one question about the first scans.
const QUESTION: u64 = 20_000;

/// How many times the operations are allowed where there are several kinds of scans.
const PATIENCE: u64 = 20;

/// Answers all claims as far as the limits allow.
pub fn check(
    system: &System,
    limits: &Limits,
    choice: Choice,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Report {
    let mut check = Check {
        system,
        limits,
        stop,
        progress,
        found: vec![None; system.claims.len()],
        gave_up: vec![None; system.claims.len()],
    };
    let mut report = Report { findings: Vec::new(), states: None, scans: None };
    let may = |engine: Engine| choice == Choice::Automatic || choice == Choice::Only(engine);
    let mut limit = Limit::Kind;
    let mut exact = limit;
    let alone = choice == Choice::Only(Engine::Exact);
    if may(Engine::Exact) {
        let explored = check.explore(if alone { u64::MAX } else { patience(system, limits) });
        report.states = explored.0;
        report.scans = report.states.is_some().then_some(explored.1);
        limit = explored.2.unwrap_or(limit);
        exact = limit;
    }
    // What is easily proved needs no search, and what is easily found no long proof.
    if choice == Choice::Automatic {
        check.prove(GLANCE.min(limits.conflicts));
    }
    if may(Engine::Bounded) {
        check.look_ahead(limits.scans);
        limit = Limit::Scans;
    }
    if may(Engine::Proof) {
        check.prove(limits.conflicts);
    }
    check.await_answers(choice);
    for ((claim, found), gave_up) in system.claims.iter().zip(check.found).zip(check.gave_up) {
        let open = || {
            let never = matches!(claim.property, Property::Never(_)) || alone;
            let kind = if never { gave_up.unwrap_or(limit) } else { exact };
            let limit = if stop() { Limit::Stopped } else { kind };
            let engine = if let Choice::Only(engine) = choice { engine } else { Engine::Exact };
            Finding { verdict: Verdict::Unknown(limit), engine }
        };
        report.findings.push(found.unwrap_or_else(open));
    }
    report
}

/// How many operations the exact engine gets. Of several kinds of scans none touches much; then it is seldom in vain.
fn patience(system: &System, limits: &Limits) -> u64 {
    if system.alternatives.is_empty() { limits.steps } else { limits.steps.saturating_mul(PATIENCE) }
}

struct Check<'s, 'a, 'p> {
    system: &'s System,
    limits: &'s Limits,
    stop: Stop<'a>,
    progress: &'p mut dyn FnMut(Progress),
    found: Vec<Option<Finding>>,
    /// Why the last proof of a claim was given up.
    gave_up: Vec<Option<Limit>>,
}

impl Check<'_, '_, '_> {
    fn settle(&mut self, claim: usize, engine: Engine, verdict: Result<(), Trace>) {
        let verdict = match verdict {
            Ok(()) => Verdict::Holds,
            Err(trace) => {
                let property = self.system.claims[claim].property;
                if self.system.shows(&trace, property) {
                    Verdict::Violated(trace)
                } else {
                    Verdict::Unknown(Limit::Replay)
                }
            }
        };
        self.found[claim] = Some(Finding { verdict, engine });
    }

    /// The claims of the form never that are open, each with its literal.
    fn open(&self) -> Vec<(usize, Lit)> {
        let claims = self.system.claims.iter().map(|c: &Claim| c.property).enumerate();
        let open = claims.filter(|&(i, _)| self.found[i].is_none());
        open.filter_map(|(i, p)| if let Property::Never(bad) = p { Some((i, bad)) } else { None }).collect()
    }

    fn explore(&mut self, steps: u64) -> (Option<Count>, usize, Option<Limit>) {
        let progress = &mut *self.progress;
        let mut told = |scans: usize| progress(Progress { engine: Engine::Exact, claim: None, scans });
        let explored = symbolic::explore(self.system, &Limits { steps, ..*self.limits }, self.stop, &mut told);
        for (claim, verdict) in explored.verdicts.into_iter().enumerate() {
            if let Some(verdict) = verdict {
                self.settle(claim, Engine::Exact, verdict);
            }
        }
        (explored.states, explored.scans, explored.limit)
    }

    /// What is claimed to come sooner or later, claim by claim.
    fn await_answers(&mut self, choice: Choice) {
        for (claim, Claim { property, .. }) in self.system.claims.iter().enumerate() {
            let Property::Eventually { after, then } = *property else { continue };
            let mut told = |engine, scans| (self.progress)(Progress { engine, claim: Some(claim), scans });
            let found = liveness::answer(self.system, after, then, self.limits, choice, self.stop, &mut told);
            match found {
                Ok((engine, verdict)) => self.settle(claim, engine, verdict),
                Err(limit) => {
                    let engine = if let Choice::Only(engine) = choice { engine } else { Engine::Exact };
                    self.found[claim] = Some(Finding { verdict: Verdict::Unknown(limit), engine });
                }
            }
        }
    }

    /// Looks for runs of up to that many scans.
    fn look_ahead(&mut self, scans: usize) {
        let open = self.open();
        let bads: Vec<Lit> = open.iter().map(|&(_, bad)| bad).collect();
        let mut bounded = Bounded::new(self.system, &bads, self.stop);
        // Whether nothing was found in all scans so far, rather than given up.
        let mut sure = vec![true; open.len()];
        for scan in 1..=scans {
            if (self.stop)() || self.open().is_empty() {
                return;
            }
            (self.progress)(Progress { engine: Engine::Bounded, claim: None, scans: scan });
            bounded.scan();
            for (i, &(claim, _)) in open.iter().enumerate() {
                if self.found[claim].is_some() {
                    continue;
                }
                match bounded.find(i, &mut { QUESTION.min(self.limits.conflicts) }) {
                    Ok(None) => {}
                    Ok(Some(trace)) => {
                        self.settle(claim, Engine::Bounded, Err(Trace { shortest: sure[i], ..trace }));
                    }
                    Err(_) => sure[i] = false,
                }
            }
        }
    }

    /// Tries to prove or refute what is open, with so many conflicts for each claim.
    fn prove(&mut self, conflicts: u64) {
        for (claim, bad) in self.open() {
            let limits = Limits { conflicts, ..*self.limits };
            let progress = &mut *self.progress;
            let mut told = |scans: usize| progress(Progress { engine: Engine::Proof, claim: Some(claim), scans });
            match pdr::prove(self.system, bad, &limits, self.stop, &mut told) {
                Ok(Proof::Never(cubes)) => {
                    if certificate::holds(self.system, bad, &cubes) {
                        self.settle(claim, Engine::Proof, Ok(()));
                    } else {
                        let verdict = Verdict::Unknown(Limit::Certificate);
                        self.found[claim] = Some(Finding { verdict, engine: Engine::Proof });
                    }
                }
                Ok(Proof::Run(trace)) => {
                    let trace = self.shorter(bad, trace);
                    self.settle(claim, Engine::Proof, Err(trace));
                }
                Err(limit) => self.gave_up[claim] = Some(limit),
            }
        }
    }

    /// A shortest run that shows the same, if the solver finds one.
    fn shorter(&mut self, bad: Lit, trace: Trace) -> Trace {
        let mut bounded = Bounded::new(self.system, &[bad], self.stop);
        let mut sure = true;
        for _ in 1..trace.inputs.len() {
            bounded.scan();
            match bounded.find(0, &mut { QUESTION }) {
                Ok(None) => {}
                Ok(Some(shorter)) => return Trace { shortest: sure, ..shorter },
                Err(_) => sure = false,
            }
        }
        Trace { shortest: sure, ..trace }
    }
}
