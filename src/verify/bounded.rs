//! The first scans of a system, one by one: finds shortest runs, proves nothing (Biere et al., 1999).

use super::aig::{Aig, Lit};
use super::limits::{Limit, Stop};
use super::solver::{Outcome, Solver};
use super::system::{System, Trace};

/// An unrolled system to which scans are added.
pub struct Bounded<'s, 'a> {
    system: &'s System,
    latches: Vec<usize>,
    aig: Aig,
    solver: Solver<'a>,
    /// The latches' values when the next scan begins.
    state: Vec<Lit>,
    initial: Vec<Lit>,
    /// The inputs of each scan.
    inputs: Vec<Vec<Lit>>,
    bads: Vec<Lit>,
    /// The bads in the last scan.
    now: Vec<Lit>,
}

impl<'s, 'a> Bounded<'s, 'a> {
    /// No scan yet; `bads` is what will be looked for.
    pub fn new(system: &'s System, bads: &[Lit], stop: Stop<'a>) -> Self {
        let roots: Vec<Lit> = system.constraints.iter().chain(bads).copied().collect();
        let (latches, _) = system.cone(&roots);
        let mut aig = Aig::new();
        let initial: Vec<Lit> =
            system.latches.iter().map(|l| l.initial.map_or_else(|| aig.leaf(system.name(l.leaf)), Lit::of)).collect();
        Bounded {
            system,
            latches,
            aig,
            solver: Solver::new(stop),
            state: initial.clone(),
            initial,
            inputs: Vec::new(),
            bads: bads.to_vec(),
            now: Vec::new(),
        }
    }

    /// Adds one scan.
    pub fn scan(&mut self) {
        let system = self.system;
        let from = &system.aig;
        let mut value = vec![None; from.leaves().len()];
        system.latches.iter().zip(&self.state).for_each(|(l, &state)| value[from.number(l.leaf)] = Some(state));
        let inputs: Vec<Lit> = system.inputs.iter().map(|i| self.aig.leaf(system.name(i.leaf))).collect();
        system.inputs.iter().zip(&inputs).for_each(|(i, &input)| value[from.number(i.leaf)] = Some(input));
        let mut roots = system.constraints.clone();
        roots.extend(&self.bads);
        roots.extend(self.latches.iter().map(|&l| system.latches[l].next));
        let leaf = |_: &mut Aig, n: u32| value[n as usize].expect("leaves are latches and inputs");
        let image = self.aig.import(from, &roots, &mut { leaf });
        let (constraints, rest) = image.split_at(system.constraints.len());
        let (bads, nexts) = rest.split_at(self.bads.len());
        for &c in constraints {
            self.solver.demand(&self.aig, c);
        }
        self.now = bads.to_vec();
        for (&l, &next) in self.latches.iter().zip(nexts) {
            self.state[l] = next;
        }
        self.inputs.push(inputs);
    }

    /// The shortest run of at most that many scans that shows the only bad and `accepts` takes, by so many conflicts in
    /// all and for one scan, if there is one; and whether all shorter ones are known not to show it. Nothing if the
    /// conflicts do not suffice, or somebody ends it.
    pub fn soonest(
        &mut self,
        scans: usize,
        (mut conflicts, question): (u64, u64),
        stop: Stop<'_>,
        accepts: impl Fn(&Trace) -> bool,
    ) -> Option<(Option<Trace>, bool)> {
        let mut sure = true;
        for _ in 0..scans {
            if conflicts == 0 || stop() {
                return None;
            }
            self.scan();
            let most = question.min(conflicts);
            let mut left = most;
            let found = self.find(0, &mut left);
            conflicts -= most - left;
            match found {
                Ok(None) => {}
                Ok(Some(run)) if accepts(&run) => return Some((Some(run), sure)),
                Ok(Some(_)) | Err(_) => sure = false,
            }
        }
        Some((None, sure))
    }

    /// A run that shows the bad of that index in the last scan.
    pub fn find(&mut self, bad: usize, conflicts: &mut u64) -> Result<Option<Trace>, Limit> {
        let goal = self.now[bad];
        if goal == Lit::FALSE {
            return Ok(None);
        }
        let goal = self.solver.literal(&self.aig, goal);
        match self.solver.solve(&[goal], conflicts) {
            Outcome::Never => Ok(None),
            Outcome::GaveUp => Err(Limit::Conflicts),
            Outcome::Sometimes => {
                // A constant is not the solver's to know.
                let value = |l: &Lit| l.constant().unwrap_or_else(|| self.solver.value(*l));
                Ok(Some(Trace {
                    initial: self.initial.iter().map(value).collect(),
                    inputs: self.inputs.iter().map(|scan| scan.iter().map(value).collect()).collect(),
                    shortest: false,
                }))
            }
        }
    }
}
