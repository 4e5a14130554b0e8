//! Whether what is asked for comes sooner or later, in all fair runs.
//!
//! A run in which it does not comes, if there is one, to a loop: all that matters is as it was once before, everything
//! that makes a run fair has come in between, and the answer has not.
//!
//! | module | does |
//! | --- | --- |
//! | [`monitor`] | the system with memory of what is open, so that other engines can look for loops |
//! | [`loops`] | all reachable states and the loops among them |
//!
//! A bounded search looks for a loop as for any state that must never be: the system remembers one of its states and
//! waits for it to come back (Biere, Artho, Schuppan, 2002). A proof shows that what makes a run fair cannot all come
//! so many times over while the answer is open (Claessen, Sörensson, 2012).

pub mod loops;
pub mod monitor;

use super::aig::Lit;
use super::bounded::Bounded;
use super::certificate;
use super::engine::{Choice, Engine};
use super::limits::{Limit, Limits, Stop};
use super::pdr::{self, Proof};
use super::system::{System, Trace};

/// Conflicts for a first attempt, and for a run that is shorter than the one that is known.
const GLANCE: u64 = 2_000;

/// How often what makes a run fair may come while the answer is open, in the last proof that is tried.
const ROUNDS: usize = 6;

/// Who found out whether `then` comes `after` it in all fair runs, and what: a run in which it does not ends in a loop.
pub fn answer(
    system: &System,
    after: Lit,
    then: Lit,
    limits: &Limits,
    choice: Choice,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(Engine, usize),
) -> Result<(Engine, Result<(), Trace>), Limit> {
    let mut search = Search { system, after, then, limits, stop, progress };
    match choice {
        Choice::Only(Engine::Exact) => search.explore(&Limits { steps: u64::MAX, ..*limits }),
        Choice::Only(Engine::Bounded) => search.look_ahead(limits.scans, u64::MAX),
        Choice::Only(Engine::Chance | Engine::Scenario) => Err(Limit::Kind),
        Choice::Only(Engine::Proof) => search.rounds(limits.conflicts).or_else(|_| search.prove()),
        Choice::Automatic => search
            .explore(limits)
            .or_else(|_| search.rounds(GLANCE.min(limits.conflicts)))
            .or_else(|_| search.look_ahead(limits.scans, limits.conflicts))
            .or_else(|_| search.rounds(limits.conflicts))
            .or_else(|_| search.prove()),
    }
    .map_err(|limit| if stop() { Limit::Stopped } else { limit })
}

struct Search<'s, 'a, 'p> {
    system: &'s System,
    after: Lit,
    then: Lit,
    limits: &'s Limits,
    stop: Stop<'a>,
    progress: &'p mut dyn FnMut(Engine, usize),
}

type Found = Result<(Engine, Result<(), Trace>), Limit>;

impl Search<'_, '_, '_> {
    fn explore(&mut self, limits: &Limits) -> Found {
        let told = &mut |scans| (self.progress)(Engine::Exact, scans);
        match loops::find(self.system, self.after, self.then, limits, self.stop, told)? {
            None => Ok((Engine::Exact, Ok(()))),
            Some(trace) => {
                // A run with a short loop is easier to read.
                let shorter = self.look_ahead(trace.inputs.len().saturating_sub(1), GLANCE);
                let trace = if let Ok((_, Err(shorter))) = shorter { shorter } else { trace };
                Ok((Engine::Exact, Err(trace)))
            }
        }
    }

    /// Looks for a run into a loop of up to that many scans.
    fn look_ahead(&mut self, scans: usize, mut conflicts: u64) -> Found {
        let monitor = monitor::lasso(self.system, self.after, self.then);
        let mut bounded = Bounded::new(&monitor.system, &[monitor.bad], self.stop);
        let mut sure = true;
        // The scan in which the state comes back is none of the run any more.
        for scan in 1..=scans + 1 {
            if (self.stop)() {
                return Err(Limit::Stopped);
            }
            (self.progress)(Engine::Bounded, scan);
            bounded.scan();
            match bounded.find(0, &mut conflicts) {
                Ok(None) => {}
                Ok(Some(trace)) => {
                    let trace = Trace { shortest: sure, ..self.cut(&trace) };
                    return Ok((Engine::Bounded, Err(trace)));
                }
                Err(limit) if conflicts == 0 => return Err(limit),
                Err(_) => sure = false,
            }
        }
        Err(Limit::Scans)
    }

    /// Tries to prove that only so many rounds of what makes a run fair fit in while the answer is open.
    fn rounds(&mut self, conflicts: u64) -> Found {
        let limits = Limits { conflicts, ..*self.limits };
        let mut gave_up = Limit::Conflicts;
        for rounds in 1..=ROUNDS {
            let monitor = monitor::rounds(self.system, self.after, self.then, rounds);
            let told = &mut |scans| (self.progress)(Engine::Proof, scans);
            match pdr::prove(&monitor.system, monitor.bad, &[], &limits, self.stop, told) {
                Ok(Proof::Never(cubes)) => {
                    let sound = certificate::holds(&monitor.system, monitor.bad, &[], &cubes);
                    return if sound { Ok((Engine::Proof, Ok(()))) } else { Err(Limit::Certificate) };
                }
                // More may fit in.
                Ok(Proof::Run(_)) => {}
                Err(limit) => gave_up = limit,
            }
            if (self.stop)() {
                break;
            }
        }
        Err(gave_up)
    }

    /// Tries to prove that no state comes back, or finds how one does.
    fn prove(&mut self) -> Found {
        let monitor = monitor::lasso(self.system, self.after, self.then);
        let told = &mut |scans| (self.progress)(Engine::Proof, scans);
        match pdr::prove(&monitor.system, monitor.bad, &[], self.limits, self.stop, told)? {
            Proof::Never(cubes) if certificate::holds(&monitor.system, monitor.bad, &[], &cubes) => {
                Ok((Engine::Proof, Ok(())))
            }
            Proof::Never(_) => Err(Limit::Certificate),
            Proof::Run(trace) => Ok((Engine::Proof, Err(self.cut(&trace)))),
        }
    }

    /// A run of the system out of one of the system that waits for a state to come back.
    fn cut(&self, trace: &Trace) -> Trace {
        let mut initial = trace.initial.clone();
        initial.truncate(self.system.latches.len());
        let scans = trace.inputs.len().saturating_sub(1);
        let of_system = |scan: &Vec<bool>| scan[..self.system.inputs.len()].to_vec();
        let inputs = trace.inputs[..scans].iter().map(of_system).collect();
        Trace { initial, inputs, shortest: false }
    }
}
