//! A sequential function chart, compiled and executed. The numbers in comments are those of the
//! rules in [`crate::ir::iec`].

use super::memory::{Bit, Code, Compiler, Decision, Memory, Word};
use super::statements::{self, Block};
use crate::ir::iec::{Qualifier, Sfc, Target, Time};
use std::collections::BTreeMap;

/// A compiled chart with its state.
#[derive(Clone, Debug)]
pub struct Chart {
    steps: Vec<Step>,
    /// In the order in which they are tested.
    transitions: Vec<Transition>,
    /// The ends of all transitions, as indices of steps.
    ends: Vec<u32>,
    /// Those of all steps, in order.
    associations: Vec<Association>,
    /// What can be stored or has a body: first the actions, then the variables.
    targets: Vec<TargetState>,
    bodies: Vec<Vec<statements::Step>>,
    last: Time,
}

#[derive(Clone, Debug)]
struct Step {
    x: Bit,
    t: Word,
    was: bool,
}

#[derive(Clone, Debug)]
struct Transition {
    /// Ranges of [`Chart::ends`]: sources from `from` up to `to`, targets up to `end`.
    from: u32,
    to: u32,
    end: u32,
    exclusive: bool,
    condition: Decision,
    fired: bool,
}

#[derive(Clone, Debug)]
struct Association {
    step: u32,
    qualifier: Qualifier,
    duration: Time,
    writes: Writes,
    /// An index of [`Chart::targets`]; meaningless where nothing is ever stored.
    target: u32,
}

/// What "to write" means.
#[derive(Clone, Copy, Debug)]
enum Writes {
    Variable(Bit),
    /// The flag `run` of an action.
    Run,
}

#[derive(Clone, Debug, Default)]
struct TargetState {
    /// Of a variable.
    bit: Option<Bit>,
    stored: bool,
    run: bool,
    set: bool,
    reset: bool,
    /// What is left of the delay of the set, 0 if it does not run; the same of the reset.
    set_in: Time,
    reset_in: Time,
}

const NOWHERE: u32 = u32::MAX;

impl Chart {
    /// Compiles a chart; gives its steps places in memory.
    pub fn new(sfc: &Sfc, compiler: &mut Compiler) -> Self {
        compiler.steps.clear();
        let mut steps = Vec::new();
        for step in sfc.steps.values() {
            let (x, t) = (compiler.bit(step.initial), compiler.word(0));
            compiler.steps.push((x, t));
            steps.push(Step { x, t, was: false });
        }
        let (mut transitions, mut ends) = (Vec::new(), Vec::new());
        for index in sfc.test_order() {
            let transition = &sfc.transitions[index];
            let from = ends.len() as u32;
            ends.extend(transition.from.iter().map(|s| s.index() as u32));
            let to = ends.len() as u32;
            ends.extend(transition.to.iter().map(|s| s.index() as u32));
            let end = ends.len() as u32;
            let condition = compiler.condition(&transition.condition);
            let exclusive = transition.priority.is_some();
            transitions.push(Transition { from, to, end, exclusive, condition, fired: false });
        }

        let mut targets = vec![TargetState::default(); sfc.actions.len()];
        let mut stored = BTreeMap::new();
        let all = || sfc.steps.values().flat_map(|s| &s.associations);
        for association in all().filter(|a| stores(a.qualifier)) {
            if let Target::Variable(variable) = association.target {
                stored.entry(variable).or_insert_with(|| {
                    let bit = Some(compiler.variable_bit(variable));
                    targets.push(TargetState { bit, ..TargetState::default() });
                    targets.len() as u32 - 1
                });
            }
        }
        let mut associations = Vec::new();
        for (step, a) in sfc.steps.iter().flat_map(|(id, s)| s.associations.iter().map(move |a| (id, a))) {
            let (writes, target) = match a.target {
                Target::Action(action) => (Writes::Run, action.index() as u32),
                Target::Variable(variable) => {
                    let target = stored.get(&variable).copied().unwrap_or(NOWHERE);
                    (Writes::Variable(compiler.variable_bit(variable)), target)
                }
            };
            let step = step.index() as u32;
            associations.push(Association { step, qualifier: a.qualifier, duration: a.duration, writes, target });
        }
        let bodies = sfc.actions.values().map(|a| statements::compile(&a.body, compiler)).collect();
        Chart { steps, transitions, ends, associations, targets, bodies, last: 0 }
    }

    /// The places of flag X and time T of a step.
    pub fn places(&self, step: usize) -> (Bit, Word) {
        (self.steps[step].x, self.steps[step].t)
    }

    /// Executes one call at time `now`.
    pub fn run(&mut self, code: &Code, memory: &mut Memory, blocks: &mut [Block], now: Time) {
        let elapsed = now.wrapping_sub(self.last);
        self.last = now;
        // 1
        for step in &mut self.steps {
            step.was = memory.bits[step.x as usize];
            if step.was {
                let time = &mut memory.words[step.t as usize];
                *time = time.wrapping_add(elapsed);
            }
        }
        // 2
        for target in &mut self.targets {
            (target.run, target.set, target.reset) = (false, false, false);
            target.set |= passes(&mut target.set_in, elapsed);
            target.reset |= passes(&mut target.reset_in, elapsed);
        }
        self.evolve(code, memory);
        for index in 0..self.associations.len() {
            self.associate(index, memory);
        }
        for target in &mut self.targets {
            // 7
            if target.set {
                (target.set_in, target.stored) = (0, true);
            }
            if target.reset {
                (target.reset_in, target.stored) = (0, false);
            }
            target.run |= target.stored;
            // 8
            if let Some(bit) = target.bit.filter(|_| target.set || target.reset) {
                memory.bits[bit as usize] = !target.reset;
            }
        }
        // 9
        for (body, target) in self.bodies.iter().zip(&self.targets) {
            if target.run {
                statements::run(body, code, memory, blocks, now);
            }
        }
    }

    /// Rules 3 to 5.
    fn evolve(&mut self, code: &Code, memory: &mut Memory) {
        let mut any = false;
        for transition in &mut self.transitions {
            let sources = &self.ends[transition.from as usize..transition.to as usize];
            let bits = |s: &u32| self.steps[*s as usize].x as usize;
            transition.fired = sources.iter().all(|s| memory.bits[bits(s)]) && code.holds(transition.condition, memory);
            if transition.fired {
                any = true;
                if transition.exclusive {
                    sources.iter().for_each(|s| memory.bits[bits(s)] = false);
                }
            }
        }
        if !any {
            return;
        }
        let fired = || self.transitions.iter().filter(|t| t.fired);
        for transition in fired().filter(|t| !t.exclusive) {
            for &source in &self.ends[transition.from as usize..transition.to as usize] {
                memory.bits[self.steps[source as usize].x as usize] = false;
            }
        }
        for transition in fired() {
            for &target in &self.ends[transition.to as usize..transition.end as usize] {
                let step = &self.steps[target as usize];
                memory.bits[step.x as usize] = true;
                memory.words[step.t as usize] = 0;
            }
        }
    }

    /// Rule 6 for one association.
    #[inline]
    fn associate(&mut self, index: usize, memory: &mut Memory) {
        let Association { step, qualifier, duration, writes, target } = self.associations[index];
        let step = &self.steps[step as usize];
        let (x, was) = (memory.bits[step.x as usize], step.was);
        let (on, off) = (x && !was, was && !x);
        let time = memory.words[step.t as usize];
        let write = match qualifier {
            Qualifier::NonStored => (x || off).then_some(x),
            Qualifier::Pulse | Qualifier::PulseRising => Some(on),
            Qualifier::PulseFalling => Some(off),
            Qualifier::Limited => (x || off).then_some(x && time < duration),
            Qualifier::Delayed => {
                if x && time >= duration {
                    Some(true)
                } else {
                    off.then_some(false)
                }
            }
            Qualifier::Set
            | Qualifier::Reset
            | Qualifier::StoredLimited
            | Qualifier::StoredDelayed
            | Qualifier::DelayedStored => {
                let target = &mut self.targets[target as usize];
                match qualifier {
                    Qualifier::Set => target.set |= x,
                    Qualifier::Reset => target.reset |= x,
                    Qualifier::StoredLimited if on => {
                        target.set = true;
                        target.reset_in = duration;
                    }
                    Qualifier::StoredDelayed | Qualifier::DelayedStored if on => target.set_in = duration,
                    Qualifier::DelayedStored if off => target.set_in = 0,
                    _ => {}
                }
                None
            }
        };
        if let Some(value) = write {
            match writes {
                Writes::Variable(bit) => memory.bits[bit as usize] = value,
                Writes::Run => self.targets[target as usize].run = value,
            }
        }
    }
}

/// Whether an association sets or resets, now or later.
fn stores(qualifier: Qualifier) -> bool {
    match qualifier {
        Qualifier::Set
        | Qualifier::Reset
        | Qualifier::StoredLimited
        | Qualifier::StoredDelayed
        | Qualifier::DelayedStored => true,
        Qualifier::NonStored
        | Qualifier::Pulse
        | Qualifier::PulseRising
        | Qualifier::PulseFalling
        | Qualifier::Limited
        | Qualifier::Delayed => false,
    }
}

/// Shortens a delay that runs; says whether it ends.
fn passes(delay: &mut Time, elapsed: Time) -> bool {
    if *delay <= 0 {
        return false;
    }
    *delay = (*delay - elapsed).max(0);
    *delay == 0
}
