//! All values of a machine at the end of a scan, and what conditions make of them.

use crate::ir::chart::{
    Atom, ConstraintId, EventId, InputId, IntegerId, Machine, Mark, OutputId, StateId, StateKind, VariableId,
};
use crate::ir::scenario::{BitId, Condition, CountId, Counted, Given, Seen};
use std::ops::Range;

/// Where each value stands in a [`Frame`].
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    bits: usize,
    outputs: usize,
    variables: usize,
    events: usize,
    states: usize,
    acted: usize,
    broken: usize,
    marks: usize,
    integers: usize,
    counts: usize,
    first_scan: usize,
    len: usize,
}

/// The values of one scan, in the order of [`Layout`]: inputs, hidden bits, outputs, variables, events,
/// states, alarms of constraints, alarms of assumptions, what the filter remembers, each integer, hidden ones last, as the
/// [`WIDTH`] bits of its two's complement, the lowest first, and the [`SCAN_WIDTH`] bits of the number of the scan in which
/// began what the filter notes.
pub type Frame = Vec<bool>;

/// How many places an integer takes: those of an INT.
pub const WIDTH: usize = 16;

/// How many places the number of a scan takes: those of a UDINT.
pub const SCAN_WIDTH: usize = 32;

impl Layout {
    /// The layout for `machine`.
    pub fn of(machine: &Machine) -> Layout {
        let bits = machine.inputs.len();
        let outputs = bits + machine.plant.bits.len();
        let variables = outputs + machine.outputs.len();
        let events = variables + machine.variables.len();
        let states = events + machine.events.len();
        let acted = states + machine.states.len();
        let broken = acted + machine.safety.constraints.len();
        let marks = broken + machine.safety.assumptions.len();
        let integers = marks + machine.safety.marks().count();
        let counts = integers + machine.integers.len() * WIDTH;
        let first_scan = counts + machine.plant.counts.len() * WIDTH;
        let len = first_scan + if machine.safety.reset.is_some() { SCAN_WIDTH } else { 0 };
        Layout { bits, outputs, variables, events, states, acted, broken, marks, integers, counts, first_scan, len }
    }

    /// A frame with all values FALSE.
    pub fn frame(&self) -> Frame {
        vec![false; self.len]
    }

    /// The places of inputs.
    pub fn inputs(&self) -> Range<usize> {
        0..self.bits
    }

    /// The places of inputs and hidden bits.
    pub fn given(&self) -> Range<usize> {
        0..self.outputs
    }

    /// The places of outputs.
    pub fn outputs(&self) -> Range<usize> {
        self.outputs..self.variables
    }

    /// The places of events.
    pub fn events(&self) -> Range<usize> {
        self.events..self.states
    }

    /// The places of outputs, variables and events.
    pub fn written(&self) -> Range<usize> {
        self.outputs..self.states
    }

    /// The places of states.
    pub fn states(&self) -> Range<usize> {
        self.states..self.acted
    }

    /// The places of alarms, of constraints and then of assumptions.
    pub fn alarms(&self) -> Range<usize> {
        self.acted..self.marks
    }

    /// The places of what the filter remembers.
    pub fn marks(&self) -> Range<usize> {
        self.marks..self.integers
    }

    /// The place of an input.
    pub fn input(&self, input: InputId) -> usize {
        input.index()
    }

    /// The place of a hidden bit.
    pub fn bit(&self, bit: BitId) -> usize {
        self.bits + bit.index()
    }

    /// The place of an input or hidden bit.
    pub fn place(&self, given: Given) -> usize {
        match given {
            Given::Input(i) => self.input(i),
            Given::Bit(b) => self.bit(b),
        }
    }

    /// The place of an output.
    pub fn output(&self, output: OutputId) -> usize {
        self.outputs + output.index()
    }

    /// The place of a variable.
    pub fn variable(&self, variable: VariableId) -> usize {
        self.variables + variable.index()
    }

    /// The place of an event.
    pub fn event(&self, event: EventId) -> usize {
        self.events + event.index()
    }

    /// The place of a state.
    pub fn state(&self, state: StateId) -> usize {
        self.states + state.index()
    }

    /// The place of a constraint's alarm.
    pub fn acted(&self, constraint: ConstraintId) -> usize {
        self.acted + constraint.index()
    }

    /// The place of an assumption's alarm.
    pub fn broken(&self, assumption: usize) -> usize {
        self.broken + assumption
    }

    /// The place of something that the filter remembers.
    pub fn mark(&self, mark: Mark) -> usize {
        match mark {
            Mark::Noted => self.marks,
            Mark::First(c) => self.marks + 1 + c.index(),
        }
    }

    /// The value of an integer in a frame.
    pub fn integer(&self, integer: IntegerId, frame: &[bool]) -> i64 {
        self.counted(Counted::Program(integer), frame)
    }

    /// Writes the value of an integer into a frame.
    pub fn put_integer(&self, integer: IntegerId, value: i64, frame: &mut [bool]) {
        self.put(Counted::Program(integer), value, frame);
    }

    /// The value of a hidden integer in a frame.
    pub fn count(&self, count: CountId, frame: &[bool]) -> i64 {
        self.counted(Counted::Hidden(count), frame)
    }

    /// Writes the value of a hidden integer into a frame.
    pub fn put_count(&self, count: CountId, value: i64, frame: &mut [bool]) {
        self.put(Counted::Hidden(count), value, frame);
    }

    /// The value of an integer, hidden or not, in a frame.
    pub fn counted(&self, counted: Counted, frame: &[bool]) -> i64 {
        let bits = &frame[self.place_of(counted)];
        // The highest bit says how often the range of all bits is to be taken away.
        bits.iter()
            .enumerate()
            .fold(0, |n, (i, &bit)| n + i64::from(bit) * if i + 1 == WIDTH { -1 << i } else { 1 << i })
    }

    fn put(&self, counted: Counted, value: i64, frame: &mut [bool]) {
        for (i, bit) in frame[self.place_of(counted)].iter_mut().enumerate() {
            *bit = value >> i & 1 == 1;
        }
    }

    fn place_of(&self, counted: Counted) -> Range<usize> {
        let first = match counted {
            Counted::Program(i) => self.integers + i.index() * WIDTH,
            Counted::Hidden(c) => self.counts + c.index() * WIDTH,
        };
        first..first + WIDTH
    }

    /// The places of integers.
    pub fn integers(&self) -> Range<usize> {
        self.integers..self.counts
    }

    /// The places of hidden integers.
    pub fn counts(&self) -> Range<usize> {
        self.counts..self.first_scan
    }

    /// The number of the scan in which began what the filter notes; nothing of a filter that notes nothing.
    pub fn first_scan(&self, frame: &[bool]) -> Option<u32> {
        let bits = &frame[self.first_scan..self.len];
        (!bits.is_empty()).then(|| bits.iter().rev().fold(0, |n, &bit| n << 1 | u32::from(bit)))
    }

    /// Puts that number into a frame.
    pub fn put_first_scan(&self, number: u32, frame: &mut [bool]) {
        for (i, bit) in frame[self.first_scan..self.len].iter_mut().enumerate() {
            *bit = number >> i & 1 == 1;
        }
    }

    /// What a condition reads, in a frame and the one before.
    pub fn value(&self, machine: &Machine, seen: Seen, now: &[bool], before: &[bool]) -> bool {
        match seen {
            Seen::Machine(Atom::Input(i)) => now[self.input(i)],
            Seen::Machine(Atom::PrevInput(i)) => before[self.input(i)],
            Seen::Machine(Atom::Output(o)) => now[self.output(o)],
            Seen::Machine(Atom::PrevOutput(o)) => before[self.output(o)],
            Seen::Machine(Atom::Variable(v)) => now[self.variable(v)],
            Seen::Machine(Atom::Event(e)) => now[self.event(e)],
            Seen::Machine(Atom::Compare(c)) => machine.comparisons[c].holds(&|&i| self.integer(i, now)),
            Seen::Machine(Atom::In(s)) => now[self.state(s)],
            Seen::Machine(Atom::Done(s)) => machine.states[s].regions.iter().all(|&r| {
                let mut states = machine.regions[r].states.iter();
                states.any(|&s| machine.states[s].kind == StateKind::Final && now[self.state(s)])
            }),
            // The time a state has been active is part of guards only, and those are no conditions here.
            Seen::Machine(Atom::After(..)) => false,
            Seen::Bit(b) => now[self.bit(b)],
            Seen::PrevBit(b) => before[self.bit(b)],
            Seen::PrevIn(s) => before[self.state(s)],
            Seen::Compare(c) => machine.plant.comparisons[c].holds(&|&i| self.counted(i, now)),
            Seen::Acted(c) => now[self.acted(c)],
            Seen::Broken(a) => now[self.broken(a)],
            Seen::Mark(mark) => now[self.mark(mark)],
        }
    }

    /// Whether a condition holds in a frame with that one before it.
    pub fn holds(&self, machine: &Machine, condition: &Condition, now: &[bool], before: &[bool]) -> bool {
        condition.eval(&mut |&seen| self.value(machine, seen, now, before))
    }
}
