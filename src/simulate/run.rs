//! A program in its plant: one closed loop, scan by scan.

use super::chart::Chart;
use super::frame::{Frame, Layout};
use super::plant::Plant;
use crate::ir::chart::{InputId, Machine};
use crate::ir::scenario::Condition;

/// What runs the machine.
#[derive(Clone, Debug)]
pub enum Program {
    /// The chart, by its own meaning.
    Chart(Box<Chart>),
}

impl Program {
    /// The chart of `machine`.
    pub fn chart(machine: &Machine) -> Program {
        Program::Chart(Box::new(Chart::new(machine)))
    }

    /// Runs one scan with the inputs that stand in `frame` and writes all else into it.
    fn scan(&mut self, machine: &Machine, layout: &Layout, frame: &mut Frame) {
        match self {
            Program::Chart(chart) => {
                chart.scan(&frame[layout.inputs()]);
                for id in machine.outputs.ids() {
                    frame[layout.output(id)] = chart.output(id);
                }
                for id in machine.variables.ids() {
                    frame[layout.variable(id)] = chart.variable(id);
                }
                for id in machine.states.ids() {
                    frame[layout.state(id)] = chart.is_active(id);
                }
                for id in machine.safety.constraints.ids() {
                    frame[layout.acted(id)] = chart.acted(id);
                }
                for i in 0..machine.safety.assumptions.len() {
                    frame[layout.broken(i)] = chart.broken(i);
                }
            }
        }
    }
}

/// A machine that runs in its plant.
#[derive(Clone, Debug)]
pub struct Run<'m> {
    machine: &'m Machine,
    layout: Layout,
    program: Program,
    plant: Plant,
    now: Frame,
    before: Frame,
    scans: u64,
}

impl<'m> Run<'m> {
    /// A run before its first scan.
    pub fn new(machine: &'m Machine, program: Program) -> Run<'m> {
        let layout = Layout::of(machine);
        let plant = Plant::new(machine);
        Run { machine, layout, program, plant, now: layout.frame(), before: layout.frame(), scans: 0 }
    }

    /// The machine.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }

    /// Where the values of frames stand.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The plant, to change what comes in from the next scan on.
    pub fn plant(&mut self) -> &mut Plant {
        &mut self.plant
    }

    /// Lets the plant move and the program run once.
    pub fn scan(&mut self) {
        self.plant.step(self.machine, &self.now, &self.before);
        std::mem::swap(&mut self.now, &mut self.before);
        let given = self.layout.given();
        self.now[given.clone()].copy_from_slice(self.plant.given());
        self.program.scan(self.machine, &self.layout, &mut self.now);
        if self.scans == 0 {
            // What has no past has no edge.
            let (now, before) = (&self.now, &mut self.before);
            before[given.clone()].copy_from_slice(&now[given]);
        }
        self.scans += 1;
    }

    /// How many scans have run.
    pub fn scans(&self) -> u64 {
        self.scans
    }

    /// When the last scan began, in milliseconds after the first one did.
    pub fn milliseconds(&self) -> u64 {
        milliseconds(self.machine, self.scans)
    }

    /// The values at the end of the last scan.
    pub fn frame(&self) -> &Frame {
        &self.now
    }

    /// The input's value in the last scan.
    pub fn input(&self, input: InputId) -> bool {
        self.now[self.layout.input(input)]
    }

    /// Whether the condition held at the end of the last scan.
    pub fn holds(&self, condition: &Condition) -> bool {
        self.layout.holds(self.machine, condition, &self.now, &self.before)
    }

    /// What the condition reads, each name once, with its value at the end of the last scan.
    pub fn values(&self, condition: &Condition) -> Vec<(String, bool)> {
        let mut values: Vec<(String, bool)> = Vec::new();
        condition.for_each_atom(&mut |&seen| {
            let name = self.machine.seen(seen);
            if values.iter().all(|(n, _)| *n != name) {
                values.push((name, self.layout.value(self.machine, seen, &self.now, &self.before)));
            }
        });
        values
    }
}

/// When scan number `scan`, counted from 1, begins: in milliseconds after the first one.
pub fn milliseconds(machine: &Machine, scan: u64) -> u64 {
    scan.saturating_sub(1) * u64::from(machine.cycle)
}
