//! Property directed reachability: a proof by clauses that are learnt where they are needed, or a run.
//!
//! Bradley (2011) as Eén, Mishchenko and Brayton (2011) put it. Frame k holds clauses that are TRUE of all
//! states that k scans can reach; a state that could lead to the bad one is excluded, in a
//! form as general as can be found, by asking what could lead to it. When two neighbouring frames are
//! equal their clauses are an inductive invariant, the certificate.

use super::aig::{Aig, Lit};
use super::limits::{Limit, Limits, Stop};
use super::solver::{Outcome, SatLit, Solver};
use super::system::{System, Trace};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Values of some latches, by index, in order.
pub type Cube = Vec<(usize, bool)>;

/// What came of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Proof {
    /// It never happens: each reachable state is in none of these cubes, and they exclude it.
    Never(Vec<Cube>),
    /// It does.
    Run(Trace),
}

/// Switched clauses that are no longer used before the solver is built anew.
const STALE: usize = 1_500;

/// Attempts to leave out a literal that may fail in a row.
const ATTEMPTS: usize = 6;

/// Whether `bad` can be TRUE in some scan. `known` are cubes in which no reachable state is; what comes back may rely on them.
pub fn prove(
    system: &System,
    bad: Lit,
    known: &[Cube],
    limits: &Limits,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(usize),
) -> Result<Proof, Limit> {
    let mut search = Search::new(system, bad, known, limits, stop);
    search.run(progress)
}

/// A state from which the bad one can be reached.
struct Obligation {
    cube: Cube,
    /// The inputs that lead from any state of the cube to `after`, or show the bad literal.
    inputs: Vec<bool>,
    after: Option<usize>,
}

struct Search<'s, 'a> {
    system: &'s System,
    known: &'s [Cube],
    latches: Vec<usize>,
    bad: Lit,
    /// The graph of the system, and more: whether bad and constraints hold together.
    aig: Aig,
    constraints: Lit,
    shown: Lit,
    /// One scan, with the constraints and all frames.
    step: Solver<'a>,
    /// One scan without either: for asking what a state has to do with it.
    lift: Solver<'a>,
    /// For each frame, the cubes that are excluded there and not in the next one.
    frames: Vec<Vec<Cube>>,
    /// Switches the clauses of a frame on.
    switch: Vec<SatLit>,
    stale: usize,
    obligations: Vec<Obligation>,
    /// State and inputs that lead into what was last found not to be inductive.
    found: Option<(Cube, Vec<bool>)>,
    left: u64,
    stop: Stop<'a>,
}

impl<'s, 'a> Search<'s, 'a> {
    fn new(system: &'s System, bad: Lit, known: &'s [Cube], limits: &Limits, stop: Stop<'a>) -> Self {
        let mut aig = system.aig.clone();
        let constraints = aig.all(&system.constraints);
        let shown = aig.and(constraints, bad);
        let roots: Vec<Lit> = system.constraints.iter().copied().chain([bad]).collect();
        let mut search = Search {
            system,
            known,
            latches: system.cone(&roots).0,
            bad,
            aig,
            constraints,
            shown,
            step: Solver::new(stop),
            lift: Solver::new(stop),
            frames: vec![Vec::new()],
            switch: Vec::new(),
            stale: 0,
            obligations: Vec::new(),
            found: None,
            left: limits.conflicts,
            stop,
        };
        search.rebuild();
        search
    }

    /// A fresh solver that knows the constraints and the frames.
    fn rebuild(&mut self) {
        self.stale = 0;
        self.step = Solver::new(self.stop);
        for &c in &self.system.constraints {
            self.step.demand(&self.aig, c);
        }
        for cube in self.known {
            let outside = cube.iter().map(|&(l, value)| self.system.latches[l].leaf.xor(value));
            let clause: Vec<SatLit> = outside.map(|l| self.step.literal(&self.aig, l)).collect();
            self.step.clause(&clause);
        }
        self.switch.clear();
        for frame in 0..self.frames.len() {
            self.open(frame);
            for cube in self.frames[frame].clone() {
                self.tell(&cube, frame);
            }
        }
    }

    /// A switch for the frame; that of frame 0 makes it the initial states.
    fn open(&mut self, frame: usize) {
        let switch = self.step.fresh();
        self.switch.push(switch);
        if frame == 0 {
            for &l in &self.latches {
                let latch = self.system.latches[l];
                if let Some(value) = latch.initial {
                    let l = self.step.literal(&self.aig, latch.leaf.xor(!value));
                    self.step.clause(&[!switch, l]);
                }
            }
        }
    }

    fn tell(&mut self, cube: &Cube, frame: usize) {
        let mut clause = vec![!self.switch[frame]];
        for &(l, value) in cube {
            clause.push(self.step.literal(&self.aig, self.system.latches[l].leaf.xor(value)));
        }
        self.step.clause(&clause);
    }

    fn ask(&mut self, which: Which, assumptions: &[SatLit]) -> Result<bool, Limit> {
        if (self.stop)() {
            return Err(Limit::Stopped);
        }
        let solver = match which {
            Which::Step => &mut self.step,
            Which::Lift => &mut self.lift,
        };
        match solver.solve(assumptions, &mut self.left) {
            Outcome::Sometimes => Ok(true),
            Outcome::Never => Ok(false),
            Outcome::GaveUp if (self.stop)() => Err(Limit::Stopped),
            Outcome::GaveUp => Err(Limit::Conflicts),
        }
    }

    fn run(&mut self, progress: &mut dyn FnMut(usize)) -> Result<Proof, Limit> {
        loop {
            let top = self.frames.len() - 1;
            progress(top);
            while let Some((cube, inputs)) = self.bad_state(top)? {
                let first = self.oblige(cube, inputs, None);
                if let Some(run) = self.block(first, top)? {
                    return Ok(Proof::Run(run));
                }
                self.obligations.clear();
            }
            self.frames.push(Vec::new());
            self.open(top + 1);
            if let Some(frame) = self.propagate()? {
                return Ok(Proof::Never(self.frames[frame + 1..].concat()));
            }
        }
    }

    /// The switches of a frame and all above it, whose clauses hold in it as well.
    fn frame(&self, frame: usize) -> Vec<SatLit> {
        self.switch[frame..].to_vec()
    }

    /// A state of the frame in which bad can be, with the inputs.
    fn bad_state(&mut self, frame: usize) -> Result<Option<(Cube, Vec<bool>)>, Limit> {
        let mut assumptions = self.frame(frame);
        assumptions.push(self.step.literal(&self.aig, self.bad));
        if !self.ask(Which::Step, &assumptions)? {
            return Ok(None);
        }
        let (cube, inputs) = self.model();
        let shown = self.lift.literal(&self.aig, self.shown);
        let cube = self.lifted(cube, &inputs, &[!shown])?;
        Ok(Some((cube, inputs)))
    }

    /// State and inputs that the last question found.
    fn model(&self) -> (Cube, Vec<bool>) {
        let cube = self.latches.iter().map(|&l| (l, self.step.value(self.system.latches[l].leaf))).collect();
        let inputs = self.system.inputs.iter().map(|i| self.step.value(i.leaf)).collect();
        (cube, inputs)
    }

    /// Those values of the cube that, with these inputs, suffice for what `otherwise` denies.
    fn lifted(&mut self, cube: Cube, inputs: &[bool], otherwise: &[SatLit]) -> Result<Cube, Limit> {
        let on = self.lift.fresh();
        let mut clause = vec![!on];
        clause.extend(otherwise);
        self.lift.clause(&clause);
        let mut assumptions = vec![on];
        for (input, &value) in self.system.inputs.iter().zip(inputs) {
            assumptions.push(self.lift.literal(&self.aig, input.leaf.xor(!value)));
        }
        let state: Vec<SatLit> = cube
            .iter()
            .map(|&(l, value)| self.lift.literal(&self.aig, self.system.latches[l].leaf.xor(!value)))
            .collect();
        assumptions.extend(&state);
        let possible = self.ask(Which::Lift, &assumptions)?;
        assert!(!possible, "a state and inputs leave nothing open");
        let needed = cube.iter().zip(&state).filter(|(_, s)| self.lift.was_needed(**s)).map(|(&v, _)| v).collect();
        self.lift.clause(&[!on]);
        Ok(needed)
    }

    fn oblige(&mut self, cube: Cube, inputs: Vec<bool>, after: Option<usize>) -> usize {
        self.obligations.push(Obligation { cube, inputs, after });
        self.obligations.len() - 1
    }

    /// Excludes the state from the frame, with all that leads to it; a run if that fails.
    fn block(&mut self, first: usize, frame: usize) -> Result<Option<Trace>, Limit> {
        let mut queue = BinaryHeap::from([Reverse((frame, first))]);
        while let Some(Reverse((frame, obligation))) = queue.pop() {
            let cube = self.obligations[obligation].cube.clone();
            if self.may_start(&cube) {
                return Ok(Some(self.lead(obligation)));
            }
            if frame == 0 {
                // Only initial states are there, and this is none.
                continue;
            }
            if self.is_excluded(&cube, frame) {
                continue;
            }
            match self.is_inductive(&cube, frame)? {
                None => {
                    let (before, inputs) = self.predecessor(&cube)?;
                    let before = self.oblige(before, inputs, Some(obligation));
                    queue.push(Reverse((frame - 1, before)));
                    queue.push(Reverse((frame, obligation)));
                }
                Some(core) => {
                    let top = self.frames.len() - 1;
                    let mut lemma = self.generalise(core, frame)?;
                    // As far up as it holds.
                    let mut at = frame;
                    while at < top {
                        match self.is_inductive(&lemma, at + 1)? {
                            Some(core) => lemma = core,
                            None => break,
                        }
                        at += 1;
                    }
                    self.exclude(lemma, at);
                    if at < top {
                        queue.push(Reverse((at + 1, obligation)));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Whether an initial state is in the cube.
    fn may_start(&self, cube: &Cube) -> bool {
        cube.iter().all(|&(l, value)| self.system.latches[l].initial.is_none_or(|i| i == value))
    }

    fn is_excluded(&self, cube: &Cube, frame: usize) -> bool {
        self.frames[frame..].iter().flatten().any(|known| is_part(known, cube))
    }

    fn exclude(&mut self, cube: Cube, frame: usize) {
        for below in &mut self.frames[..=frame] {
            below.retain(|known| !is_part(&cube, known));
        }
        self.tell(&cube, frame);
        self.frames[frame].push(cube);
        if self.stale > STALE {
            self.rebuild();
        }
    }

    /// Whether nothing leads, in one scan, from the frame below and from outside the cube into it; then those of
    /// its values that are reason enough.
    fn is_inductive(&mut self, cube: &Cube, frame: usize) -> Result<Option<Cube>, Limit> {
        self.stale += 1;
        let on = self.step.fresh();
        let mut outside = vec![!on];
        for &(l, value) in cube {
            outside.push(self.step.literal(&self.aig, self.system.latches[l].leaf.xor(value)));
        }
        self.step.clause(&outside);
        let mut assumptions = self.frame(frame - 1);
        assumptions.push(on);
        let then: Vec<SatLit> = cube
            .iter()
            .map(|&(l, value)| self.step.literal(&self.aig, self.system.latches[l].next.xor(!value)))
            .collect();
        assumptions.extend(&then);
        let possible = self.ask(Which::Step, &assumptions)?;
        let core = cube.iter().zip(&then).filter(|(_, s)| !possible && self.step.was_needed(**s));
        let mut core: Cube = core.map(|(&v, _)| v).collect();
        self.found = possible.then(|| self.model());
        self.step.clause(&[!on]);
        if possible {
            return Ok(None);
        }
        if self.may_start(&core) {
            // Initial states must not be excluded: one value that none of them has comes back.
            let differs = |&&(l, value): &&(usize, bool)| self.system.latches[l].initial == Some(!value);
            core.push(*cube.iter().find(differs).expect("no initial state is in the cube"));
            core.sort_unstable();
        }
        Ok(Some(core))
    }

    /// After [`Search::is_inductive`] said no: what leads into the cube, and the inputs.
    fn predecessor(&mut self, cube: &Cube) -> Result<(Cube, Vec<bool>), Limit> {
        let (before, inputs) = self.found.take().expect("something leads there");
        let mut otherwise: Vec<SatLit> = Vec::new();
        for &(l, value) in cube {
            otherwise.push(self.lift.literal(&self.aig, self.system.latches[l].next.xor(value)));
        }
        otherwise.push(!self.lift.literal(&self.aig, self.constraints));
        Ok((self.lifted(before, &inputs, &otherwise)?, inputs))
    }

    /// Leaves out what can be left out: the less a lemma says, the more it excludes.
    fn generalise(&mut self, cube: Cube, frame: usize) -> Result<Cube, Limit> {
        let mut kept = cube.clone();
        let mut failed = 0;
        for value in cube {
            if kept.len() == 1 || failed > ATTEMPTS {
                break;
            }
            if !kept.contains(&value) {
                continue;
            }
            let fewer: Cube = kept.iter().copied().filter(|v| *v != value).collect();
            if self.may_start(&fewer) {
                continue;
            }
            match self.is_inductive(&fewer, frame)? {
                Some(core) => {
                    kept = core;
                    failed = 0;
                }
                None => failed += 1,
            }
        }
        Ok(kept)
    }

    /// Moves clauses up as far as they hold; a frame that equals the next one is an invariant.
    fn propagate(&mut self) -> Result<Option<usize>, Limit> {
        for frame in 1..self.frames.len() - 1 {
            for cube in self.frames[frame].clone() {
                if !self.frames[frame].contains(&cube) {
                    continue;
                }
                if let Some(core) = self.is_inductive(&cube, frame + 1)? {
                    self.exclude(core, frame + 1);
                }
            }
            if self.frames[frame].is_empty() {
                return Ok(Some(frame));
            }
        }
        Ok(None)
    }

    /// The run that begins with this obligation.
    fn lead(&self, obligation: usize) -> Trace {
        let mut initial: Vec<bool> = self.system.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
        self.obligations[obligation].cube.iter().for_each(|&(l, value)| initial[l] = value);
        let chain = std::iter::successors(Some(obligation), |&o| self.obligations[o].after);
        let inputs = chain.map(|o| self.obligations[o].inputs.clone()).collect();
        Trace { initial, inputs, shortest: false }
    }
}

#[derive(Clone, Copy)]
enum Which {
    Step,
    Lift,
}

/// Whether each state of `inner` is in `outer`: both in order.
pub fn is_part(outer: &Cube, inner: &Cube) -> bool {
    let mut rest = inner.iter();
    outer.iter().all(|value| rest.any(|v| v == value))
}
