//! The parts of a machine that something in a program stands for, and what a program can remember of
//! them.

use super::chart_step::{ChartScan, ChartState};
use crate::bits::aig::Lit;
use crate::ir::chart::{
    ConstraintId, EventId, InputId, IntegerId, Machine, Mark, OutputId, ScanNumber, StateId, VariableId,
};

/// How many bits an integer has: those of an INT.
pub const WIDTH: u8 = 16;

/// How many bits the number of a scan has: those of a UDINT.
pub const SCAN_WIDTH: u8 = 32;

/// A part of a machine that something in the program stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Whether the state is active, as the flag says that other programs read.
    Flag(StateId),
    /// The same, as the step of the SFC has it.
    Step(StateId),
    /// What the filter lets through.
    Output(OutputId),
    /// The variable's value.
    Variable(VariableId),
    /// Whether the event is TRUE.
    Event(EventId),
    /// Whether the event is raised for the next scan.
    Raised(EventId),
    /// A bit of the integer's value, counted from the lowest; the highest is the sign.
    Bit(IntegerId, u8),
    /// A bit of a number that the filter keeps, counted from the lowest; none is the sign.
    Scan(ScanNumber, u8),
    /// Whether an active state drives the output.
    Command(OutputId),
    /// Whether the constraint had to act.
    Acted(ConstraintId),
    /// Whether the plant breaks the assumption of that index.
    Broken(usize),
    /// What the filter remembers, and its place among the marks.
    Mark(Mark, usize),
    /// What was sampled of the input.
    Input(InputId),
    /// Whether this is the scan from which the timer counts.
    Begins(Timer),
}

/// A time that guards wait for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timer {
    /// Where it stands in [`ChartStep::timers`](super::chart_step::ChartStep::timers).
    pub index: usize,
    /// The state whose activity it measures.
    pub state: StateId,
    /// The time in milliseconds.
    pub ms: u32,
}

impl Part {
    /// Its value after a scan of the chart.
    pub fn after(self, scan: &ChartScan) -> Lit {
        match self {
            Part::Flag(s) | Part::Step(s) => scan.after.active[s.index()],
            Part::Output(o) => scan.after.outputs[o.index()],
            Part::Variable(v) => scan.after.variables[v.index()],
            Part::Event(e) => scan.events[e.index()],
            Part::Raised(e) => scan.after.raised[e.index()],
            Part::Bit(i, bit) => scan.after.integers[i.index()][usize::from(bit)],
            Part::Scan(number, bit) => scan.after.scan_bit(number, bit),
            Part::Command(o) => scan.commands[o.index()],
            Part::Acted(c) => scan.acted[c.index()],
            Part::Broken(a) => scan.broken[a],
            Part::Mark(_, i) => scan.after.marks[i],
            Part::Input(i) => scan.after.inputs[i.index()],
            Part::Begins(t) => scan.begins[t.index],
        }
    }

    /// What it is, in the model's names.
    pub fn describe(self, machine: &Machine) -> String {
        match self {
            Part::Flag(s) | Part::Step(s) => format!("state {}", machine.state_path(s)),
            Part::Output(o) => format!("output {}", machine.outputs[o].name),
            Part::Variable(v) => format!("variable {}", machine.variables[v].name),
            Part::Event(e) => format!("event {}", machine.events[e].name),
            Part::Raised(e) => format!("event {} is raised", machine.events[e].name),
            Part::Bit(i, bit) => format!("bit {bit} of integer {}", machine.integers[i].name),
            Part::Scan(number, bit) => format!("bit {bit} of {}", said(number)),
            Part::Command(o) => format!("command of {}", machine.outputs[o].name),
            Part::Acted(c) => format!("constraint {} acts", machine.safety.constraints[c].name),
            Part::Broken(a) => format!("assumption {} broken", machine.safety.assumptions[a].name),
            Part::Mark(mark, _) => machine.mark(mark),
            Part::Input(i) => format!("input {}", machine.inputs[i].name),
            Part::Begins(t) => format!("start of the time in {}", machine.state_path(t.state)),
        }
    }

    /// What the program has to remember of it from scan to scan, if anything.
    pub fn remembered(self) -> Option<Meaning> {
        match self {
            Part::Flag(s) | Part::Step(s) => Some(Meaning::Active(s, true)),
            Part::Output(o) => Some(Meaning::Output(o, true)),
            Part::Variable(v) => Some(Meaning::Variable(v, true)),
            Part::Bit(i, bit) => Some(Meaning::Bit(i, bit, true)),
            Part::Scan(number, bit) => Some(Meaning::Scan(number, bit, true)),
            Part::Input(i) => Some(Meaning::Input(i, true)),
            Part::Raised(e) => Some(Meaning::Raised(e, true)),
            Part::Mark(mark, i) => Some(Meaning::Mark(mark, i, true)),
            Part::Event(_) | Part::Command(_) | Part::Acted(_) | Part::Broken(_) | Part::Begins(_) => None,
        }
    }
}

/// What a latch of the program holds between scans, once the first one is over. The flag says whether
/// it is the value itself; if not, its opposite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Always the same.
    Constant(bool),
    /// Whether the state is active.
    Active(StateId, bool),
    /// The input's value in the last scan.
    Input(InputId, bool),
    /// What the filter let through in the last scan.
    Output(OutputId, bool),
    /// The variable's value.
    Variable(VariableId, bool),
    /// Whether the event was raised in the last scan.
    Raised(EventId, bool),
    /// What the filter remembers, and its place among the marks.
    Mark(Mark, usize, bool),
    /// Whether the state was the last one of its region, active or not; of regions with a history.
    Last(StateId, bool),
    /// That bit of the integer's value.
    Bit(IntegerId, u8, bool),
    /// That bit of a number that the filter keeps.
    Scan(ScanNumber, u8, bool),
    /// Whether the timer's state was entered in the last scan; anything while it is not active.
    Fresh(Timer, bool),
    /// Whether the timer's time had passed in the last scan; anything while its state is not active.
    Past(Timer, bool),
}

impl Meaning {
    /// Its value when the chart remembers `state`.
    pub fn of(self, state: &ChartState) -> Lit {
        match self {
            Meaning::Constant(value) => Lit::of(value),
            Meaning::Active(s, same) => state.active[s.index()].xor(!same),
            Meaning::Input(i, same) => state.inputs[i.index()].xor(!same),
            Meaning::Output(o, same) => state.outputs[o.index()].xor(!same),
            Meaning::Variable(v, same) => state.variables[v.index()].xor(!same),
            Meaning::Raised(e, same) => state.raised[e.index()].xor(!same),
            Meaning::Mark(_, i, same) => state.marks[i].xor(!same),
            Meaning::Last(s, same) => state.last[s.index()].expect("only states of regions with a history").xor(!same),
            Meaning::Bit(i, bit, same) => state.integers[i.index()][usize::from(bit)].xor(!same),
            Meaning::Scan(number, bit, same) => state.scan_bit(number, bit).xor(!same),
            Meaning::Fresh(t, same) => state.fresh[t.index].xor(!same),
            Meaning::Past(t, same) => state.past[t.index].xor(!same),
        }
    }

    /// When it holds; otherwise the latch may hold anything.
    pub fn matters(self, state: &ChartState) -> Lit {
        match self {
            Meaning::Fresh(t, _) | Meaning::Past(t, _) => state.active[t.state.index()],
            Meaning::Constant(_)
            | Meaning::Active(..)
            | Meaning::Input(..)
            | Meaning::Output(..)
            | Meaning::Raised(..)
            | Meaning::Variable(..)
            | Meaning::Mark(..)
            | Meaning::Last(..)
            | Meaning::Bit(..)
            | Meaning::Scan(..) => Lit::TRUE,
        }
    }

    /// The opposite.
    #[must_use]
    pub fn opposite(self) -> Meaning {
        match self {
            Meaning::Constant(value) => Meaning::Constant(!value),
            Meaning::Active(s, same) => Meaning::Active(s, !same),
            Meaning::Input(i, same) => Meaning::Input(i, !same),
            Meaning::Output(o, same) => Meaning::Output(o, !same),
            Meaning::Variable(v, same) => Meaning::Variable(v, !same),
            Meaning::Raised(e, same) => Meaning::Raised(e, !same),
            Meaning::Mark(mark, i, same) => Meaning::Mark(mark, i, !same),
            Meaning::Last(s, same) => Meaning::Last(s, !same),
            Meaning::Bit(i, bit, same) => Meaning::Bit(i, bit, !same),
            Meaning::Scan(number, bit, same) => Meaning::Scan(number, bit, !same),
            Meaning::Fresh(t, same) => Meaning::Fresh(t, !same),
            Meaning::Past(t, same) => Meaning::Past(t, !same),
        }
    }

    /// Every meaning that always holds, is no constant and not the opposite of another.
    pub fn all(machine: &Machine) -> Vec<Meaning> {
        let inputs = machine.inputs.ids().map(|i| Meaning::Input(i, true));
        let outputs = machine.outputs.ids().map(|o| Meaning::Output(o, true));
        let variables = machine.variables.ids().map(|v| Meaning::Variable(v, true));
        let states = machine.states.ids().map(|s| Meaning::Active(s, true));
        let raised = machine.events.ids().map(|e| Meaning::Raised(e, true));
        let marks = machine.safety.marks().enumerate().map(|(i, mark)| Meaning::Mark(mark, i, true));
        let bits = machine.integers.ids().flat_map(|i| (0..WIDTH).map(move |bit| Meaning::Bit(i, bit, true)));
        let numbers = machine.safety.scan_numbers();
        let scans = numbers.flat_map(|n| (0..SCAN_WIDTH).map(move |bit| Meaning::Scan(n, bit, true)));
        let bits = bits.chain(scans);
        inputs.chain(outputs).chain(variables).chain(raised).chain(states).chain(marks).chain(bits).collect()
    }

    /// What it is, in the model's names.
    pub fn describe(self, machine: &Machine) -> String {
        let (same, what) = match self {
            Meaning::Constant(value) => return if value { "TRUE".into() } else { "FALSE".into() },
            Meaning::Active(s, same) => (same, format!("state {}", machine.state_path(s))),
            Meaning::Input(i, same) => (same, format!("prev({})", machine.inputs[i].name)),
            Meaning::Output(o, same) => (same, format!("prev({})", machine.outputs[o].name)),
            Meaning::Variable(v, same) => (same, format!("variable {}", machine.variables[v].name)),
            Meaning::Raised(e, same) => (same, format!("event {} was raised", machine.events[e].name)),
            Meaning::Mark(mark, _, same) => (same, machine.mark(mark)),
            Meaning::Last(s, same) => (same, format!("{} was last in its region", machine.state_path(s))),
            Meaning::Bit(i, bit, same) => (same, format!("bit {bit} of integer {}", machine.integers[i].name)),
            Meaning::Scan(number, bit, same) => (same, format!("bit {bit} of {}", said(number))),
            Meaning::Fresh(t, same) => (same, format!("{} was just entered", machine.state_path(t.state))),
            Meaning::Past(t, same) => (same, format!("{} has lasted {} ms", machine.state_path(t.state), t.ms)),
        };
        if same { what } else { format!("not {what}") }
    }
}

/// A number that the filter keeps, in words.
pub fn said(number: ScanNumber) -> &'static str {
    match number {
        ScanNumber::This => "the number of the scan",
        ScanNumber::First => "the number of the first scan that is noted",
    }
}
