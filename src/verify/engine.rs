//! A system to verdicts: which engine answers what.
//!
//! The exact engine comes first: it answers everything at once, or runs into its bound early. What it
//! leaves open is looked for in the first scans, then proved claim by claim. A run is replayed on the
//! system, and an invariant checked by another solver, before either is believed.

mod proofs;

use super::aig::Lit;
use super::bounded::Bounded;
use super::count::Count;
use super::limits::{Limit, Limits, Stop};
use super::liveness;
use super::parts;
use super::pdr::Cube;
use super::possible;
use super::symbolic;
use super::system::{Claim, Property, System, Trace};
use super::wander;

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
    /// Runs by chance.
    Chance,
    /// What a model's scenarios do. Whoever knows them plays them.
    Scenario,
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
    /// How many claims are open.
    pub open: usize,
}

/// Conflicts for a first attempt to prove a claim.
const GLANCE: u64 = 1_000;

/// Gates that runs by chance evaluate, for 64 runs at once.
const GATES: u64 = 4_000_000_000;

/// Conflicts for a first look ahead.
const AHEAD: u64 = 30_000;

/// Cubes of proofs that are kept for the next one.
const KNOWN: usize = 2_000;

/// So many claims that are hard one by one are tried one by one all the same.
const FEW: usize = 8;

/// Runs that an attempt to prove all claims together may find.
const ASIDE: usize = 8;

/// Conflicts for one question about the first scans.
const QUESTION: u64 = 20_000;

/// Scans up to which a shorter run is looked for where one is known.
const SHORTER: usize = 200;

/// What part of the operations a first attempt to explore everything gets.
const FIRST: u64 = 16;

/// How many times the operations are allowed where there are several kinds of scans.
const PATIENCE: u64 = 20;

/// What is known of a system before it is asked.
#[derive(Default)]
pub struct Known<'s> {
    /// A system that does all that this one does, and more. What never is there is not asked again.
    pub coarser: Option<Coarser<'s>>,
    /// For each claim, whether a run is at hand that shows that it does not hold. A shorter one is worth a first look, and no more;
    /// nothing if there is none.
    pub shown: Vec<bool>,
}

/// A system that does all that another one does, and more.
pub struct Coarser<'s> {
    /// The system.
    pub system: &'s System,
    /// For each claim of the other one, the claim of this one that is TRUE of it only if that is; if there is one.
    pub claims: Vec<Option<usize>>,
}

/// Answers all claims as far as the limits allow.
pub fn check(
    system: &System,
    known: Option<&Known<'_>>,
    limits: &Limits,
    choice: Choice,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Report {
    let none = Known::default();
    let given = known.unwrap_or(&none);
    let mut check = Check {
        system,
        limits,
        stop,
        progress,
        found: vec![None; system.claims.len()],
        gave_up: vec![None; system.claims.len()],
        unshown: vec![false; system.claims.len()],
        aside: vec![false; system.claims.len()],
        known: Vec::new(),
        states: None,
        scans: None,
        exact: Limit::Kind,
    };
    let limit = match choice {
        Choice::Automatic => check.automatic(given),
        Choice::Only(Engine::Exact) => {
            check.explore(u64::MAX);
            check.exact
        }
        Choice::Only(Engine::Bounded) => {
            check.look_ahead(limits.scans, u64::MAX);
            Limit::Scans
        }
        Choice::Only(Engine::Proof) => {
            check.prove(limits.conflicts);
            check.plan(&[], possible::SHORT, (5 * GLANCE).min(limits.conflicts));
            check.plan(&[], possible::LONG, limits.conflicts);
            Limit::Kind
        }
        Choice::Only(Engine::Chance) => {
            check.wander();
            Limit::Kind
        }
        // Whoever has scenarios has played them.
        Choice::Only(Engine::Scenario) => Limit::Kind,
    };
    check.aside.fill(false);
    check.await_answers(choice);
    check.report(choice, limit)
}

struct Check<'s, 'a, 'p> {
    system: &'s System,
    limits: &'s Limits,
    stop: Stop<'a>,
    progress: &'p mut dyn FnMut(Progress),
    found: Vec<Option<Finding>>,
    /// Why the last proof of a claim was given up.
    gave_up: Vec<Option<Limit>>,
    /// Whether it is known that a claim does not hold, though no run is at hand.
    unshown: Vec<bool>,
    /// Whether a claim is not asked any more, although nothing has been found.
    aside: Vec<bool>,
    /// Cubes in which no reachable state is, as proofs have shown. The next proof may use them.
    known: Vec<Cube>,
    /// How many states there are, and after how many scans there was no new one.
    states: Option<Count>,
    scans: Option<usize>,
    /// Why the exact engine did not come to an end.
    exact: Limit,
}

impl Check<'_, '_, '_> {
    /// Each engine where it is best. Returns why it gave up in the end.
    fn automatic(&mut self, given: &Known<'_>) -> Limit {
        let (system, limits) = (self.system, self.limits);
        if limits.at_first > 0 {
            self.prove_at_first(limits.at_first);
            self.plan(&[], possible::SHORT, limits.at_first);
        }
        // What is easily found needs no proof, and what is easily proved no search.
        if self.count() > 0 {
            self.explore(limits.steps / FIRST);
        }
        if self.count() > 0 {
            self.explore_parts();
        }
        // What a scenario shows is found as easily as what chance does.
        let open = self.count();
        if !given.shown.is_empty() {
            self.aside.clone_from(&given.shown);
        }
        let states = if self.count() > 0 { self.wander() } else { Vec::new() };
        // Where chance finds little, the system is one that has to be searched through, if it can be.
        let late = self.count() < open / 2;
        self.prove(GLANCE.min(limits.conflicts));
        if system.alternatives.is_empty() && self.count() > FEW {
            self.prove_together(limits.conflicts);
        }
        let more = limits.steps.saturating_mul(if system.alternatives.is_empty() { 1 } else { PATIENCE });
        if !late && self.count() > 0 && self.exact == Limit::Steps {
            self.explore(more);
        }
        if self.count() > 0 {
            self.plan(&states, possible::SHORT, (5 * GLANCE).min(limits.conflicts));
            self.ask(given.coarser.as_ref());
            self.prove_together((30 * GLANCE).min(limits.conflicts));
            if late {
                self.look_ahead(limits.scans, AHEAD);
            }
            self.prove((30 * GLANCE).min(limits.conflicts));
        }
        if late && self.count() > 0 && self.exact == Limit::Steps {
            self.explore(more);
        }
        if self.count() == 0 {
            return Limit::Kind;
        }
        self.look_ahead(limits.scans, u64::MAX);
        self.prove(limits.conflicts);
        self.plan(&states, possible::LONG, limits.conflicts);
        Limit::Scans
    }

    /// What has been found out, and why the rest has not: because of `limit` where nothing better is known.
    fn report(self, choice: Choice, limit: Limit) -> Report {
        let alone = choice == Choice::Only(Engine::Exact);
        let stopped = (self.stop)();
        let mut findings = Vec::new();
        for (i, (claim, found)) in self.system.claims.iter().zip(self.found).enumerate() {
            let never = matches!(claim.property, Property::Never(_)) || alone;
            let limit = match (stopped, self.unshown[i]) {
                (true, true) => Limit::Unshown,
                (true, false) => Limit::Stopped,
                (false, _) if never => self.gave_up[i].unwrap_or(limit),
                (false, _) => self.exact,
            };
            let engine = if let Choice::Only(engine) = choice { engine } else { Engine::Exact };
            findings.push(found.unwrap_or(Finding { verdict: Verdict::Unknown(limit), engine }));
        }
        Report { findings, states: self.states, scans: self.scans }
    }

    /// Says where it is.
    fn tell(&mut self, engine: Engine, claim: Option<usize>, scans: usize) {
        let open = self.open_count();
        (self.progress)(Progress { engine, claim, scans, open });
    }

    /// Whether a claim is still to be asked.
    fn is_open(&self, claim: usize) -> bool {
        self.found[claim].is_none() && !self.aside[claim]
    }

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
        let open = claims.filter(|&(i, _)| self.is_open(i));
        open.filter_map(|(i, p)| Some((i, p.never()?))).collect()
    }

    /// Asks the exact engine what is open, as far as so many operations go.
    fn explore(&mut self, steps: u64) {
        let count = self.open_count();
        let progress = &mut *self.progress;
        let mut told = |scans| progress(Progress { engine: Engine::Exact, claim: None, scans, open: count });
        let explored = symbolic::explore(self.system, &Limits { steps, ..*self.limits }, self.stop, &mut told);
        for (claim, verdict) in explored.verdicts.into_iter().enumerate() {
            if let Some(verdict) = verdict {
                self.settle(claim, Engine::Exact, verdict);
            }
        }
        for (unshown, more) in self.unshown.iter_mut().zip(explored.unshown) {
            *unshown |= more;
        }
        self.states = explored.states;
        self.scans = self.states.is_some().then_some(explored.scans);
        self.exact = explored.limit.unwrap_or(Limit::Kind);
    }

    /// Visits the states of small parts, for what is open.
    fn explore_parts(&mut self) {
        let wanted: Vec<bool> = (0..self.found.len()).map(|i| self.is_open(i)).collect();
        let open = self.open_count();
        let progress = &mut *self.progress;
        let mut told = |_| progress(Progress { engine: Engine::Exact, claim: None, scans: 0, open });
        let verdicts = parts::explore(self.system, &wanted, self.limits, self.stop, &mut told);
        for (claim, verdict) in verdicts.into_iter().enumerate() {
            match verdict {
                Some(Ok(())) => self.settle(claim, Engine::Exact, Ok(())),
                // Elsewhere something else may have to come in than nothing; then nobody knows yet.
                Some(Err(trace)) if self.system.shows(&trace, self.system.claims[claim].property) => {
                    let verdict = Verdict::Violated(trace);
                    self.found[claim] = Some(Finding { verdict, engine: Engine::Exact });
                }
                Some(Err(_)) | None => {}
            }
        }
    }

    /// How many claims nobody has answered.
    fn open_count(&self) -> usize {
        self.found.iter().filter(|f| f.is_none()).count()
    }

    /// Asks a coarser system about what is open.
    fn ask(&mut self, coarser: Option<&Coarser<'_>>) {
        let Some(Coarser { system, claims }) = coarser else { return };
        let open = self.open().into_iter().filter_map(|(claim, _)| Some((claim, claims[claim]?)));
        let (open, there): (Vec<usize>, Vec<usize>) = open.unzip();
        if open.is_empty() || (self.stop)() {
            return;
        }
        let claims = there.iter().map(|&i| system.claims[i].clone()).collect();
        let system = System { claims, ..(*system).clone() };
        let count = self.open_count();
        let progress = &mut *self.progress;
        let mut told = |scans| progress(Progress { engine: Engine::Exact, claim: None, scans, open: count });
        let limits = Limits { steps: self.limits.steps.saturating_mul(PATIENCE), ..*self.limits };
        let explored = symbolic::explore(&system, &limits, self.stop, &mut told);
        for (claim, verdict) in open.into_iter().zip(explored.verdicts) {
            if verdict == Some(Ok(())) {
                self.settle(claim, Engine::Exact, Ok(()));
            }
        }
    }

    /// What is claimed to come sooner or later, claim by claim.
    fn await_answers(&mut self, choice: Choice) {
        for (claim, Claim { property, .. }) in self.system.claims.iter().enumerate() {
            let Property::Eventually { after, then } = *property else { continue };
            let open = self.open_count();
            let mut told = |engine, scans| (self.progress)(Progress { engine, claim: Some(claim), scans, open });
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

    /// How many claims are open, those aside that say what comes eventually.
    fn count(&self) -> usize {
        let claims = self.system.claims.iter().enumerate();
        claims.filter(|(i, c)| self.is_open(*i) && !matches!(c.property, Property::Eventually { .. })).count()
    }

    /// Looks at runs by chance. Returns some states that are reachable.
    fn wander(&mut self) -> Vec<Vec<bool>> {
        self.tell(Engine::Chance, None, 0);
        let wanted: Vec<bool> = (0..self.found.len()).map(|i| self.is_open(i)).collect();
        let walk = wander::wander(self.system, &wanted, GATES, self.stop);
        for (claim, run) in walk.runs.into_iter().enumerate() {
            if let Some(run) = run {
                self.settle(claim, Engine::Chance, Err(run));
            }
        }
        walk.states
    }

    /// Tries to prove what is claimed to stay possible, by plans of so many scans at most and from some reachable states on.
    fn plan(&mut self, states: &[Vec<bool>], longest: usize, conflicts: u64) {
        let limits = Limits { conflicts, scans: longest.min(self.limits.scans), ..*self.limits };
        // What is asked of every machine stands behind what a model declares, and mostly takes less.
        for (claim, Claim { property, .. }) in self.system.claims.iter().enumerate().rev() {
            let goal = match *property {
                Property::AlwaysPossible(goal) => goal,
                Property::NeverStuck => Lit::TRUE,
                Property::Never(_) | Property::Eventually { .. } => continue,
            };
            if !self.is_open(claim) {
                continue;
            }
            if (self.stop)() {
                return;
            }
            let open = self.open_count();
            let progress = &mut *self.progress;
            let mut told = |scans| progress(Progress { engine: Engine::Proof, claim: Some(claim), scans, open });
            match possible::prove(self.system, goal, states, &self.known, &limits, self.stop, &mut told) {
                Ok(()) => self.settle(claim, Engine::Proof, Ok(())),
                Err(limit) => self.gave_up[claim] = Some(limit),
            }
        }
    }

    /// Looks for runs of up to that many scans, until it has met so many conflicts.
    fn look_ahead(&mut self, scans: usize, mut conflicts: u64) {
        let open = self.open();
        let bads: Vec<Lit> = open.iter().map(|&(_, bad)| bad).collect();
        let mut bounded = Bounded::new(self.system, &bads, self.stop);
        // Whether nothing was found in all scans so far, rather than given up.
        let mut sure = vec![true; open.len()];
        for scan in 1..=scans {
            if (self.stop)() || conflicts == 0 || self.open().is_empty() {
                return;
            }
            self.tell(Engine::Bounded, None, scan);
            bounded.scan();
            for (i, &(claim, _)) in open.iter().enumerate() {
                if self.found[claim].is_some() {
                    continue;
                }
                let most = QUESTION.min(self.limits.conflicts).min(conflicts);
                let mut left = most;
                let found = bounded.find(i, &mut left);
                conflicts -= most - left;
                match found {
                    Ok(None) => {}
                    Ok(Some(trace)) => {
                        self.settle(claim, Engine::Bounded, Err(Trace { shortest: sure[i], ..trace }));
                    }
                    Err(_) => sure[i] = false,
                }
            }
        }
    }
}
