//! The program, scan by scan: what it remembers, and one scan as a function of that and of the inputs.
//!
//! Of a program of which nothing is known, the observers and the filter remain. They run as they do
//! with the charts of the machine; in between, commands, events, and all variables and integers that no
//! observer writes take any value in each scan.

use super::super::aig::{Aig, Lit};
use super::super::system::{Giver, System};
use super::Program;
use super::clocks::{Clock, Clocks, Counted, Regions};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{ChartKind, Machine, StateId};
use crate::ir::number::Range;
use crate::prove::chart_step::{ChartScan, ChartState, ChartStep, Unknown};
use crate::prove::parts::WIDTH;
use std::collections::BTreeMap;

/// A program with its filter.
#[derive(Clone, Copy)]
pub struct Running<'m> {
    /// The machine.
    pub machine: &'m Machine,
    /// What runs in front of its filter.
    pub program: Program,
    /// How many rounds the filter takes.
    pub rounds: usize,
}

impl Running<'_> {
    /// Latches for what it remembers, the next ones of the system. All is FALSE before the first scan, which
    /// does not look at it.
    pub fn remembered(&self, system: &mut System) -> ChartState {
        let machine = self.machine;
        // Once over literals that mean nothing, to know which bit is what.
        let mut aig = Aig::new();
        let inputs: Vec<Lit> = machine.inputs.values().map(|_| Lit::FALSE).collect();
        let step = ChartStep::new(machine, self.rounds).without_scans();
        let shape = map(&step.first(&mut aig, &inputs).after, &mut |_| aig.leaf(""));
        let mut names = BTreeMap::new();
        let mut name = |lits: &[Lit], words: Vec<String>| names.extend(lits.iter().copied().zip(words));
        name(&shape.active, machine.states.ids().map(|s| format!("in({})", machine.state_path(s))).collect());
        name(&shape.variables, machine.variables.values().map(|v| v.name.clone()).collect());
        name(&shape.inputs, machine.inputs.values().map(|i| format!("prev({})", i.name)).collect());
        name(&shape.raised, machine.events.values().map(|e| e.name.clone()).collect());
        name(&shape.outputs, machine.outputs.values().map(|o| format!("prev({})", o.name)).collect());
        let mut number = 0;
        map(&shape, &mut |l| {
            number += 1;
            let name = names.get(&l).cloned().unwrap_or_else(|| format!("memory {number}"));
            system.latch(name, Some(false))
        })
    }

    /// One scan, the first one if it has not `started`. What it leaves open comes into the system: the course of
    /// time where it is open, and what an unknown program does. Clocks go on when it is the program's `turn`.
    pub fn scan(
        &self,
        system: &mut System,
        clocks: &mut Clocks,
        started: Lit,
        before: &ChartState,
        inputs: &[Lit],
        turn: Lit,
    ) -> ChartScan {
        let step = self.step();
        let step = match self.program {
            Program::Chart => step,
            Program::Any => step.behind(unknown(system, self.machine)),
        };
        let regions = Regions::new(system, clocks, self.machine, &step, &|state| self.runs(state));
        let passed = self.clocks(system, &regions, &step, before);
        let later = step.scan(&mut system.aig, before, inputs, &passed);
        let first = step.first(&mut system.aig, inputs);
        let scan = either(&mut system.aig, started, &later, &first);
        regions.tick(system, clocks, self.machine, &step, [before, &scan.after], turn);
        scan
    }

    fn step(&self) -> ChartStep<'_> {
        ChartStep::new(self.machine, self.rounds).without_scans()
    }

    /// The times that guards wait for.
    pub fn timers(&self) -> Vec<(StateId, u32)> {
        self.step().timers().filter(|t| self.runs(t.0)).collect()
    }

    /// Whether it waits for times.
    pub fn is_timed(&self) -> bool {
        !self.timers().is_empty()
    }

    /// What is chosen of a time that is open.
    fn passes(&self, (state, time): (StateId, u32)) -> String {
        format!("{time} ms of {} have passed", self.machine.state_path(state))
    }

    /// Whether the state can be active.
    fn runs(&self, state: StateId) -> bool {
        self.program == Program::Chart || self.machine.observes(state)
    }

    /// What is remembered of times that clocks tell.
    pub fn told(&self, counted: &Counted, before: &ChartState) -> Vec<Lit> {
        let of = |state: StateId| Clock::Region(self.machine.states[state].region);
        let step = self.step();
        let told = step.timers().enumerate().filter(|(_, t)| counted.has(of(t.0)));
        told.flat_map(|(i, _)| [before.fresh[i], before.past[i]]).collect()
    }

    /// For each timer, whether its time has passed by now, if it runs.
    fn clocks(&self, system: &mut System, regions: &Regions, step: &ChartStep<'_>, before: &ChartState) -> Vec<Lit> {
        let timers: Vec<(StateId, u32)> = step.timers().collect();
        let is_open = |t: &(StateId, u32)| self.runs(t.0) && !regions.has(*t);
        let mut clock = |t: &(StateId, u32)| {
            if is_open(t) {
                return system.input(self.passes(*t), Giver::Clock);
            }
            regions.passed(&mut system.aig, self.machine, *t).unwrap_or(Lit::FALSE)
        };
        let clocks: Vec<Lit> = timers.iter().map(&mut clock).collect();
        for (i, t) in timers.iter().enumerate().filter(|(_, t)| is_open(t)) {
            // A time that runs for ever passes.
            let runs = system.aig.and(before.active[t.0.index()], !before.fresh[i]);
            let passed = system.aig.or(before.past[i], clocks[i]);
            let passed = system.aig.or(!runs, passed);
            system.fairness(self.passes(*t), passed);
        }
        for i in 1..timers.len() {
            // They are in order of state and time.
            if timers[i].0 == timers[i - 1].0 && is_open(&timers[i]) {
                let shorter_first = system.aig.or(!clocks[i], clocks[i - 1]);
                system.constraints.push(shorter_first);
            }
        }
        clocks
    }
}

/// Whatever a program can do in a scan.
fn unknown(system: &mut System, machine: &Machine) -> Unknown {
    let mut observed = vec![false; machine.variables.len()];
    let mut counted = vec![false; machine.integers.len()];
    let observes = |region| machine.kind(region) == ChartKind::Observer;
    let transitions = machine.transitions.values().filter(|t| observes(t.scope)).map(|t| &t.deeds);
    let states = machine.states.values().filter(|s| observes(s.region)).flat_map(|s| [&s.entry, &s.exit]);
    for deeds in transitions.chain(states) {
        deeds.effects.iter().for_each(|e| observed[e.variable.index()] = true);
        deeds.assignments.iter().for_each(|a| counted[a.integer.index()] = true);
    }
    let mut free = |name: String| system.input(name, Giver::Controller);
    let commands = machine.outputs.values().map(|o| free(format!("command {}", o.name))).collect();
    let variables = machine.variables.iter();
    let variables = variables.map(|(id, v)| (!observed[id.index()]).then(|| free(v.name.clone()))).collect();
    let raised = machine.events.values().map(|e| free(format!("raise {}", e.name))).collect();
    let integers = machine.integers.iter();
    let integers = integers.map(|(id, i)| (!counted[id.index()]).then(|| within(system, &i.name, i.range))).collect();
    Unknown { commands, variables, raised, integers }
}

/// Any integer within a range.
fn within(system: &mut System, name: &str, range: Range) -> Vector {
    let Range { lowest, highest } = range;
    let (lowest, highest) = (vector::constant(lowest), vector::constant(highest));
    let width = lowest.len().max(highest.len());
    // Without negative values there is no need of a sign.
    let free = if range.lowest < 0 { width } else { width - 1 };
    let mut value: Vector = (0..free).map(|i| system.input(format!("{name}[{i}]"), Giver::Controller)).collect();
    value.resize(width, Lit::FALSE);
    let below = vector::less(&mut system.aig, &value, &lowest);
    let above = vector::less(&mut system.aig, &highest, &value);
    system.constraints.extend([!below, !above]);
    vector::fit(&value, usize::from(WIDTH))
}

/// `then` if `condition`, else `otherwise`, bit by bit.
fn either(aig: &mut Aig, condition: Lit, then: &ChartScan, otherwise: &ChartScan) -> ChartScan {
    let readings = then.readings.iter().zip(otherwise.readings.values());
    let readings = readings.map(|((&atom, &a), &b)| (atom, aig.select(condition, a, b))).collect();
    let mut pick =
        |a: &[Lit], b: &[Lit]| -> Vec<Lit> { a.iter().zip(b).map(|(&a, &b)| aig.select(condition, a, b)).collect() };
    let bits = pick(&then.after.bits(), &otherwise.after.bits());
    let mut bits = bits.into_iter();
    ChartScan {
        events: pick(&then.events, &otherwise.events),
        fires: pick(&then.fires, &otherwise.fires),
        enabled: pick(&then.enabled, &otherwise.enabled),
        commands: pick(&then.commands, &otherwise.commands),
        acted: pick(&then.acted, &otherwise.acted),
        broken: pick(&then.broken, &otherwise.broken),
        beyond: pick(&then.beyond, &otherwise.beyond),
        begins: pick(&then.begins, &otherwise.begins),
        readings,
        after: map(&then.after, &mut |_| bits.next().expect("both remember the same")),
    }
}

/// The same memory with other bits, made in the order of [`ChartState::bits`].
pub fn map(state: &ChartState, f: &mut impl FnMut(Lit) -> Lit) -> ChartState {
    let mut each = |lits: &[Lit]| -> Vec<Lit> { lits.iter().map(|&l| f(l)).collect() };
    ChartState {
        active: each(&state.active),
        variables: each(&state.variables),
        inputs: each(&state.inputs),
        outputs: each(&state.outputs),
        raised: each(&state.raised),
        fresh: each(&state.fresh),
        past: each(&state.past),
        marks: each(&state.marks),
        last: state.last.iter().map(|l| l.map(|l| each(&[l])[0])).collect(),
        integers: state.integers.iter().map(|i| each(i)).collect(),
        scans: state.scans.iter().map(|n| each(n)).collect(),
    }
}
