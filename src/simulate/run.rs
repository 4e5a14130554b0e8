//! A program in its plant: one closed loop, scan by scan.

use super::chart::Chart;
use super::frame::{Frame, Layout};
use super::plant::Plant;
use super::plc::Plc;
use crate::ir::chart::{Atom, InputId, Machine, Mark, ScanNumber};
use crate::ir::number::Comparison;
use crate::ir::plc::{self, Origin, Role};
use crate::ir::scenario::{Condition, CountId, Counted, Seen};
use crate::ir::{iec, iec::VarId};

/// What runs the machine.
#[derive(Clone, Debug)]
pub enum Program {
    /// The chart, by its own meaning.
    Chart(Box<Chart>),
    /// A PLC that runs what the chart was compiled to.
    Plc(Box<Wired>),
}

/// A PLC, and which of its variables are what of the machine.
#[derive(Clone, Debug)]
pub struct Wired {
    plc: Plc,
    inputs: Vec<VarId>,
    /// Places in frames with their variables.
    shown: Vec<(usize, VarId)>,
    /// For each integer, its variable.
    integers: Vec<VarId>,
    /// Of a filter with a reset, the number of the scan in which began what it notes.
    first_scan: Option<VarId>,
}

impl Program {
    /// The chart of `machine`.
    pub fn chart(machine: &Machine) -> Program {
        Program::Chart(Box::new(Chart::new(machine)))
    }

    /// A PLC with what `machine` was compiled to: `written` is that project as it was written, `read` as it
    /// was read back. Of the first only names are used.
    ///
    /// # Panics
    ///
    /// If `read` lacks a variable of `written`.
    pub fn plc(machine: &Machine, written: &plc::Project, read: &iec::Project) -> Program {
        let layout = Layout::of(machine);
        // The first one: what takes a long rung is computed in parts, which come after it.
        let find = |role: Role, origin: Origin| {
            let ours = written.globals.values().find(|g| g.role == role && g.origin == origin);
            let ours = ours.unwrap_or_else(|| panic!("the program has nothing for {}", origin.says(machine)));
            let found = read.variables.iter().find(|(_, v)| v.scope == iec::Scope::Global && v.name == ours.name);
            found.map(|(id, _)| id).expect("what was written is read back")
        };
        let inputs = machine.inputs.ids().map(|i| find(Role::Input, Origin::Input(i))).collect();
        let mut shown = Vec::new();
        let mut show = |place: usize, found: VarId| shown.push((place, found));
        for id in machine.outputs.ids() {
            show(layout.output(id), find(Role::Output, Origin::Output(id)));
        }
        for id in machine.variables.ids() {
            show(layout.variable(id), find(Role::Variable, Origin::Variable(id)));
        }
        for id in machine.events.ids() {
            show(layout.event(id), find(Role::Event, Origin::Event(id)));
        }
        let integers = machine.integers.ids().map(|i| find(Role::Variable, Origin::Integer(i))).collect();
        for id in machine.states.ids() {
            show(layout.state(id), find(Role::StepFlag, Origin::State(id)));
        }
        for id in machine.safety.constraints.ids() {
            let role = if machine.safety.alarms() { Role::Alarm } else { Role::Acted };
            show(layout.acted(id), find(role, Origin::Constraint(id)));
        }
        for i in 0..machine.safety.assumptions.len() {
            show(layout.broken(i), find(Role::Alarm, Origin::Assumption(i)));
        }
        for mark in machine.safety.marks() {
            show(
                layout.mark(mark),
                match mark {
                    Mark::Noted => find(Role::Noted, Origin::Filter),
                    Mark::First(c) => find(Role::First, Origin::Constraint(c)),
                },
            );
        }
        let first_scan = machine.safety.reset.map(|_| find(Role::FirstScan, Origin::Filter));
        Program::Plc(Box::new(Wired { plc: Plc::new(read), inputs, shown, integers, first_scan }))
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
                for id in machine.events.ids() {
                    frame[layout.event(id)] = chart.event(id);
                }
                for id in machine.integers.ids() {
                    layout.put_integer(id, chart.integer(id), frame);
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
                for mark in machine.safety.marks() {
                    frame[layout.mark(mark)] = chart.mark(mark);
                }
                layout.put_first_scan(chart.scan_number(ScanNumber::First), frame);
            }
            Program::Plc(wired) => {
                for (&variable, &value) in wired.inputs.iter().zip(&frame[layout.inputs()]) {
                    wired.plc.write(variable, i64::from(value));
                }
                let milliseconds = i64::try_from(milliseconds(machine, wired.plc.scans() + 1)).unwrap_or(i64::MAX);
                wired.plc.scan(milliseconds.saturating_mul(1000));
                frame[layout.written().start..layout.integers().end].fill(false);
                for &(place, variable) in &wired.shown {
                    frame[place] = wired.plc.read(variable) != 0;
                }
                for (id, &variable) in machine.integers.ids().zip(&wired.integers) {
                    layout.put_integer(id, wired.plc.read(variable), frame);
                }
                if let Some(variable) = wired.first_scan {
                    layout.put_first_scan(wired.plc.read(variable) as u32, frame);
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
    /// The values of the last scan with what is hidden as it is by now, if something has happened since.
    since: Option<Frame>,
    scans: u64,
}

impl<'m> Run<'m> {
    /// A run before its first scan.
    pub fn new(machine: &'m Machine, program: Program) -> Run<'m> {
        let layout = Layout::of(machine);
        let plant = Plant::new(machine);
        Run { machine, layout, program, plant, now: layout.frame(), before: layout.frame(), since: None, scans: 0 }
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

    /// The values of inputs and hidden bits, with what was changed since the last scan.
    pub fn given(&self) -> &[bool] {
        self.plant.given()
    }

    /// The value of a hidden integer.
    pub fn count(&self, count: CountId) -> i64 {
        self.plant.count(count)
    }

    /// Lets the plant move and the program run once.
    pub fn scan(&mut self) {
        for happening in self.write() {
            self.happen(happening);
        }
        self.read();
    }

    /// Writes outputs, unless that has been done since the last scan. Returns what may happen then and does by itself, by
    /// index.
    pub fn write(&mut self) -> Vec<usize> {
        self.plant.write(self.machine);
        self.look();
        self.plant.possible(self.machine)
    }

    /// Lets something happen in the plant if it can, and says whether it could.
    pub fn happen(&mut self, happening: usize) -> bool {
        let happens = self.plant.happen(self.machine, happening);
        self.look();
        happens
    }

    fn look(&mut self) {
        if self.machine.plant.by_steps {
            let mut since = self.now.clone();
            self.plant.reveal(&mut since);
            self.since = Some(since);
        }
    }

    /// Reads inputs and lets the program run once.
    pub fn read(&mut self) {
        self.since = None;
        self.plant.step(self.machine, &self.now, &self.before);
        std::mem::swap(&mut self.now, &mut self.before);
        let given = self.layout.given();
        self.now[given.clone()].copy_from_slice(self.plant.given());
        self.plant.tell(&mut self.now);
        self.program.scan(self.machine, &self.layout, &mut self.now);
        self.plant.decide(&self.now[self.layout.outputs()]);
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

    /// The same with what is hidden as it is by now.
    pub fn moment(&self) -> &Frame {
        self.since.as_ref().unwrap_or(&self.now)
    }

    /// Whether something may have happened in the plant since the last scan.
    pub fn is_between(&self) -> bool {
        self.since.is_some()
    }

    /// The input's value in the last scan.
    pub fn input(&self, input: InputId) -> bool {
        self.now[self.layout.input(input)]
    }

    /// Whether the condition holds: it did at the end of the last scan, with what is hidden as it is by now.
    pub fn holds(&self, condition: &Condition) -> bool {
        self.layout.holds(self.machine, condition, self.moment(), &self.before)
    }

    /// The same of a condition over another machine, which has all that this one has with the same ids, and more
    /// comparisons.
    pub fn holds_beside(&self, machine: &Machine, condition: &Condition) -> bool {
        self.layout.holds(machine, condition, self.moment(), &self.before)
    }

    /// What the condition reads, each name once, with its value.
    pub fn values(&self, condition: &Condition) -> Vec<(String, bool)> {
        let mut values: Vec<(String, bool)> = Vec::new();
        condition.for_each_atom(&mut |&seen| {
            let mut name = self.machine.seen(seen);
            match seen {
                Seen::Machine(Atom::Compare(c)) => {
                    name.push_str(&self.integers(&self.machine.comparisons[c], |&i| Counted::Program(i)));
                }
                Seen::Compare(c) => name.push_str(&self.integers(&self.machine.plant.comparisons[c], |&i| i)),
                Seen::Machine(_)
                | Seen::Bit(_)
                | Seen::PrevBit(_)
                | Seen::PrevIn(_)
                | Seen::Acted(_)
                | Seen::Mark(_)
                | Seen::Broken(_) => {}
            }
            if values.iter().all(|(n, _)| *n != name) {
                values.push((name, self.layout.value(self.machine, seen, self.moment(), &self.before)));
            }
        });
        values
    }

    /// The values of what a comparison reads: ` (Jars is 2)`.
    fn integers<A>(&self, comparison: &Comparison<A>, of: impl Fn(&A) -> Counted) -> String {
        let mut read: Vec<Counted> = Vec::new();
        comparison.left.for_each_value(&mut |i| read.push(of(i)));
        comparison.right.for_each_value(&mut |i| read.push(of(i)));
        read.sort_unstable();
        read.dedup();
        let one = |i: Counted| format!("{} is {}", self.machine.counted(i), self.layout.counted(i, self.moment()));
        format!(" ({})", read.into_iter().map(one).collect::<Vec<_>>().join(", "))
    }
}

/// When scan number `scan`, counted from 1, begins: in milliseconds after the first one.
pub fn milliseconds(machine: &Machine, scan: u64) -> u64 {
    scan.saturating_sub(1) * u64::from(machine.cycle)
}
