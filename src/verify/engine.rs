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
use super::pdr::{self, Cube, Proof};
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

/// A system that does all that another one does, and more.
pub struct Coarser<'s> {
    /// The system.
    pub system: &'s System,
    /// For each claim of the other one, the claim of this one that is TRUE of it only if that is; if there is one.
    pub claims: Vec<Option<usize>>,
}

/// Answers all claims as far as the limits allow. What holds of a `coarser` system is not asked again.
pub fn check(
    system: &System,
    coarser: Option<&Coarser<'_>>,
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
        known: Vec::new(),
    };
    let mut report = Report { findings: Vec::new(), states: None, scans: None };
    let alone = choice == Choice::Only(Engine::Exact);
    let mut limit = Limit::Kind;
    let mut exact = limit;
    let mut explore = |check: &mut Check<'_, '_, '_>, steps: u64| {
        let explored = check.explore(steps);
        report.states = explored.0;
        report.scans = report.states.is_some().then_some(explored.1);
        explored.2.unwrap_or(Limit::Kind)
    };
    match choice {
        Choice::Automatic => {
            // What is easily found needs no proof, and what is easily proved no search.
            exact = explore(&mut check, limits.steps / FIRST);
            let open = check.count();
            let states = if open > 0 { check.wander() } else { Vec::new() };
            // Where chance finds little, the system is one that has to be searched through, if it can be.
            let late = check.count() < open / 2;
            check.prove(GLANCE.min(limits.conflicts));
            if system.alternatives.is_empty() && check.count() > FEW {
                check.prove_together(limits.conflicts);
            }
            let more = limits.steps.saturating_mul(if system.alternatives.is_empty() { 1 } else { PATIENCE });
            if !late && check.count() > 0 && exact == Limit::Steps {
                exact = explore(&mut check, more);
            }
            if check.count() > 0 {
                check.plan(&states, possible::SHORT, (5 * GLANCE).min(limits.conflicts));
                check.ask(coarser);
                check.prove_together((30 * GLANCE).min(limits.conflicts));
                if late {
                    check.look_ahead(limits.scans, AHEAD);
                }
                check.prove((30 * GLANCE).min(limits.conflicts));
            }
            if late && check.count() > 0 && exact == Limit::Steps {
                exact = explore(&mut check, more);
            }
            if check.count() > 0 {
                check.look_ahead(limits.scans, u64::MAX);
                check.prove(limits.conflicts);
                check.plan(&states, possible::LONG, limits.conflicts);
                limit = Limit::Scans;
            }
        }
        Choice::Only(Engine::Exact) => {
            exact = explore(&mut check, u64::MAX);
            limit = exact;
        }
        Choice::Only(Engine::Bounded) => {
            check.look_ahead(limits.scans, u64::MAX);
            limit = Limit::Scans;
        }
        Choice::Only(Engine::Proof) => {
            check.prove(limits.conflicts);
            check.plan(&[], possible::SHORT, (5 * GLANCE).min(limits.conflicts));
            check.plan(&[], possible::LONG, limits.conflicts);
        }
        Choice::Only(Engine::Chance) => drop(check.wander()),
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

struct Check<'s, 'a, 'p> {
    system: &'s System,
    limits: &'s Limits,
    stop: Stop<'a>,
    progress: &'p mut dyn FnMut(Progress),
    found: Vec<Option<Finding>>,
    /// Why the last proof of a claim was given up.
    gave_up: Vec<Option<Limit>>,
    /// Cubes in which no reachable state is, as proofs have shown. The next proof may use them.
    known: Vec<Cube>,
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
        open.filter_map(|(i, p)| Some((i, p.never()?))).collect()
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

    /// Asks a coarser system about what is open.
    fn ask(&mut self, coarser: Option<&Coarser<'_>>) {
        let Some(Coarser { system, claims }) = coarser else { return };
        let open = self.open().into_iter().filter_map(|(claim, _)| Some((claim, claims[claim]?)));
        let (open, there): (Vec<usize>, Vec<usize>) = open.unzip();
        if open.is_empty() {
            return;
        }
        let claims = there.iter().map(|&i| system.claims[i].clone()).collect();
        let system = System { claims, ..(*system).clone() };
        let progress = &mut *self.progress;
        let mut told = |scans: usize| progress(Progress { engine: Engine::Exact, claim: None, scans });
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

    /// How many claims are open, those aside that say what comes eventually.
    fn count(&self) -> usize {
        let claims = self.system.claims.iter().zip(&self.found);
        claims.filter(|(c, f)| f.is_none() && !matches!(c.property, Property::Eventually { .. })).count()
    }

    /// Looks at runs by chance. Returns some states that are reachable.
    fn wander(&mut self) -> Vec<Vec<bool>> {
        let wanted: Vec<bool> = self.found.iter().map(Option::is_none).collect();
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
            if self.found[claim].is_some() {
                continue;
            }
            let progress = &mut *self.progress;
            let mut told = |scans: usize| progress(Progress { engine: Engine::Proof, claim: Some(claim), scans });
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
            (self.progress)(Progress { engine: Engine::Bounded, claim: None, scans: scan });
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

    /// Tries to prove that nothing of what is open ever is, all at once: what one proof finds out serves the others. What turns out to
    /// be goes aside, and the rest is tried again.
    fn prove_together(&mut self, conflicts: u64) {
        let mut limits = Limits { conflicts, ..*self.limits };
        for _ in 0..ASIDE {
            let open = self.open();
            if open.len() < 2 {
                return;
            }
            let mut joint = self.system.clone();
            let bads: Vec<Lit> = open.iter().map(|&(_, bad)| bad).collect();
            let bad = joint.aig.any(&bads);
            let progress = &mut *self.progress;
            let mut told = |scans: usize| progress(Progress { engine: Engine::Proof, claim: None, scans });
            match pdr::prove(&joint, bad, &self.known, &limits, self.stop, &mut told) {
                Ok(Proof::Never(cubes)) if certificate::holds(&joint, bad, &self.known, &cubes) => {
                    open.iter().for_each(|&(claim, _)| self.settle(claim, Engine::Proof, Ok(())));
                    self.learn(cubes);
                    return;
                }
                Ok(Proof::Run(trace)) => {
                    let shown = |&&(_, bad): &&(usize, Lit)| self.system.shows(&trace, Property::Never(bad));
                    let shown: Vec<(usize, Lit)> = open.iter().filter(shown).copied().collect();
                    if shown.is_empty() {
                        return;
                    }
                    for (claim, bad) in shown {
                        let trace = self.shorter(bad, trace.clone());
                        self.settle(claim, Engine::Proof, Err(trace));
                    }
                }
                Ok(Proof::Never(_)) | Err(_) => return,
            }
            limits.conflicts /= 2;
        }
    }

    /// Tries to prove or refute what is open, with so many conflicts for each claim.
    fn prove(&mut self, conflicts: u64) {
        for (claim, bad) in self.open() {
            let limits = Limits { conflicts, ..*self.limits };
            let progress = &mut *self.progress;
            let mut told = |scans: usize| progress(Progress { engine: Engine::Proof, claim: Some(claim), scans });
            match pdr::prove(self.system, bad, &self.known, &limits, self.stop, &mut told) {
                Ok(Proof::Never(cubes)) => {
                    if certificate::holds(self.system, bad, &self.known, &cubes) {
                        self.settle(claim, Engine::Proof, Ok(()));
                        self.learn(cubes);
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

    /// Keeps cubes that a proof has excluded, short ones.
    fn learn(&mut self, cubes: Vec<Cube>) {
        for cube in cubes {
            if self.known.len() < KNOWN && !self.known.iter().any(|known| pdr::is_part(known, &cube)) {
                self.known.retain(|known| !pdr::is_part(&cube, known));
                self.known.push(cube);
            }
        }
    }

    /// A shortest run that shows the same, if the solver finds one.
    fn shorter(&mut self, bad: Lit, trace: Trace) -> Trace {
        let mut bounded = Bounded::new(self.system, &[bad], self.stop);
        let mut sure = true;
        let mut left = AHEAD;
        for scan in 1..trace.inputs.len() {
            if scan > SHORTER || left == 0 || (self.stop)() {
                return Trace { shortest: false, ..trace };
            }
            bounded.scan();
            let most = QUESTION.min(left);
            let mut question = most;
            let found = bounded.find(0, &mut question);
            left -= most - question;
            match found {
                Ok(None) => {}
                Ok(Some(shorter)) => return Trace { shortest: sure, ..shorter },
                Err(_) => sure = false,
            }
        }
        Trace { shortest: sure, ..trace }
    }
}
