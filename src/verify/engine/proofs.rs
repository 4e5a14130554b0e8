//! What the engines try to prove: all claims together, or one by one.

use super::super::aig::Lit;
use super::super::bounded::Bounded;
use super::super::certificate;
use super::super::limits::{Limit, Limits};
use super::super::pdr::{self, Cube, Proof};
use super::super::system::{Property, Trace};
use super::{AHEAD, ASIDE, Check, Engine, Finding, KNOWN, Progress, QUESTION, SHORTER, Verdict};

impl Check<'_, '_, '_> {
    /// Tries to prove at little cost that nothing of what is open ever is. What turns out to be is left to others, who find shorter runs.
    pub(super) fn prove_at_first(&mut self, conflicts: u64) {
        let mut open = self.open();
        let mut limits = Limits { conflicts, ..*self.limits };
        for _ in 0..ASIDE {
            if open.is_empty() || (self.stop)() {
                return;
            }
            let mut joint = self.system.clone();
            let bad = joint.aig.any(&open.iter().map(|&(_, bad)| bad).collect::<Vec<_>>());
            let count = self.open_count();
            let progress = &mut *self.progress;
            let mut told = |scans| progress(Progress { engine: Engine::Proof, claim: None, scans, open: count });
            match pdr::prove(&joint, bad, &[], &limits, self.stop, &mut told) {
                Ok(Proof::Never(cubes)) if certificate::holds(&joint, bad, &[], &cubes) => {
                    open.iter().for_each(|&(claim, _)| self.settle(claim, Engine::Proof, Ok(())));
                    self.learn(cubes);
                    return;
                }
                Ok(Proof::Run(trace)) => {
                    let before = open.len();
                    open.retain(|&(_, bad)| !self.system.shows(&trace, Property::Never(bad)));
                    if open.len() == before {
                        return;
                    }
                }
                Ok(Proof::Never(_)) | Err(_) => return,
            }
            limits.conflicts /= 2;
        }
    }

    /// Tries to prove that nothing of what is open ever is, all at once: what one proof finds out serves the others. What turns out to
    /// be goes aside, and the rest is tried again.
    pub(super) fn prove_together(&mut self, conflicts: u64) {
        let mut limits = Limits { conflicts, ..*self.limits };
        for _ in 0..ASIDE {
            let open = self.open();
            if open.len() < 2 || (self.stop)() {
                return;
            }
            let mut joint = self.system.clone();
            let bads: Vec<Lit> = open.iter().map(|&(_, bad)| bad).collect();
            let bad = joint.aig.any(&bads);
            let count = self.open_count();
            let progress = &mut *self.progress;
            let mut told = |scans| progress(Progress { engine: Engine::Proof, claim: None, scans, open: count });
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
    pub(super) fn prove(&mut self, conflicts: u64) {
        for (claim, bad) in self.open() {
            if (self.stop)() {
                return;
            }
            let limits = Limits { conflicts, ..*self.limits };
            let open = self.open_count();
            let progress = &mut *self.progress;
            let mut told = |scans| progress(Progress { engine: Engine::Proof, claim: Some(claim), scans, open });
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
        let scans = trace.inputs.len().saturating_sub(1);
        let mut bounded = Bounded::new(self.system, &[bad], self.stop);
        match bounded.soonest(scans.min(SHORTER), (AHEAD, QUESTION), self.stop, |_| true) {
            Some((Some(shorter), sure)) => Trace { shortest: sure, ..shorter },
            Some((None, sure)) if scans <= SHORTER => Trace { shortest: sure, ..trace },
            Some((None, _)) | None => Trace { shortest: false, ..trace },
        }
    }
}
