//! A machine to a transition system, and to the questions that are worth asking of it.
//!
//! | module | does |
//! | --- | --- |
//! | this one | program and plant together |
//! | [`program`] | chart, or any program, and filter, scan by scan from power-up |
//! | [`clocks`] | what counts scans |
//! | [`plant`] | what the plant gives it |
//! | [`steps`] | a plant that moves between scans |
//! | [`questions`] | what is claimed |
//! | `rivals` | which transitions only their order tells apart |
//!
//! One scan of the program is that of [`chart_step`](crate::prove::chart_step), the same that every build is proved
//! equal to. What is left open, and so is verified for all ways in which it can go: the inputs that no
//! plant gives, under the declared assumptions; and what [`plant`] says. Times are counted in scans, or are left open, too: then a time
//! that a guard waits for passes in any scan, except that of one state a shorter one passes no later than a longer one.

pub mod clocks;
pub mod plant;
pub mod program;
pub mod questions;
mod rivals;
pub mod steps;

use super::aig::Lit;
use super::sat::Sat;
use super::system::{Property, System, Trace};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::Machine;
use crate::prove::chart_filter;
use crate::prove::chart_step::{ChartScan, ChartState};
use crate::prove::parts::WIDTH;
use clocks::{Clock, Clocks, Counted, Times};
use program::Running;
use questions::Question;
use std::collections::BTreeSet;
use std::fmt;
use steps::Turn;

/// What runs in front of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// The charts of the machine.
    Chart,
    /// Nobody knows: each scan any commands. Observers run.
    Any,
}

/// Why a machine cannot be verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The solver cannot say how many rounds the filter takes.
    Rounds,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Refusal::Rounds => "nobody knows how many rounds the filter takes",
        })
    }
}

/// A machine as a transition system.
pub struct Subject<'m> {
    /// The machine.
    pub machine: &'m Machine,
    /// The system. Its claims belong to the questions, one by one.
    pub system: System,
    /// What is asked.
    pub questions: Vec<Question>,
    /// What there is to see of it.
    pub view: View,
    /// How its times are counted.
    pub clocks: Clocks,
    /// Whether anything waits for a time, so that it matters how times are taken.
    pub timed: bool,
    /// All clocks that it has, counted or not.
    pub all: BTreeSet<Clock>,
    running: Running<'m>,
    /// Whether the plant is left out.
    open: bool,
    /// The outputs that stand at the terminals, with those that a scan decides.
    outputs: Vec<(Lit, Lit)>,
    /// The latches that keep what waits to be written.
    waits: std::ops::Range<usize>,
}

/// The values at the end of a scan.
#[derive(Clone, Debug)]
pub struct View {
    /// For each input, its value.
    pub inputs: Vec<Lit>,
    /// For each input, its value in the scan before.
    pub past_inputs: Vec<Lit>,
    /// For each hidden bit of the plant, its value.
    pub bits: Vec<Lit>,
    /// For each hidden bit of the plant, its value in the scan before.
    pub past_bits: Vec<Lit>,
    /// For each hidden integer of the plant, its value.
    pub counts: Vec<Vector>,
    /// For each output, its value in the scan before.
    pub past_outputs: Vec<Lit>,
    /// For each state, whether it was active at the end of the scan before.
    pub past_active: Vec<Lit>,
    /// What happens in the scan. What is remembered is that of the last scan where this is none.
    pub scan: ChartScan,
    /// Whether this is a scan, and what it is otherwise.
    pub turn: Turn,
    /// Whether a scan has run by now.
    pub begun: Lit,
}

impl View {
    /// What can be seen, in this order: inputs, hidden bits, outputs, variables, events, states, alarms of
    /// constraints, alarms of assumptions, what the filter remembers, the bits of integers, hidden ones last.
    pub fn frame(&self) -> Vec<Lit> {
        let ChartScan { after, events, acted, broken, .. } = &self.scan;
        let ChartState { outputs, variables, active, marks, .. } = after;
        let lists = [&self.inputs, &self.bits, outputs, variables, events, active, acted, broken, marks];
        let seen = lists.into_iter().flatten().chain(after.integers.iter().flatten()).copied();
        seen.chain(self.counts.iter().flat_map(|c| vector::fit(c, usize::from(WIDTH)))).collect()
    }
}

impl<'m> Subject<'m> {
    /// The machine in its plant, if it has one, as a system. With `open` the plant gives nothing, and all inputs are
    /// free.
    pub fn new(machine: &'m Machine, program: Program, open: bool, times: Times) -> Result<Subject<'m>, Refusal> {
        let rounds = chart_filter::rounds(machine, &mut Sat::new()).ok_or(Refusal::Rounds)?;
        Ok(Subject::of(Running { machine, program, rounds }, open, &times.into()))
    }

    /// The same with those clocks that are `counted`.
    pub fn counting(&self, counted: &Counted) -> Subject<'m> {
        Subject::of(self.running, self.open, counted)
    }

    fn of(running: Running<'m>, open: bool, counted: &Counted) -> Subject<'m> {
        let Running { machine, program, .. } = running;
        let mut system = System::default();
        let longest = clocks::longest(machine, counted, &running.timers(), !open);
        let mut clocks = Clocks::new(&mut system, counted, longest);
        let started = system.latch("started", Some(false));
        let first_latch = system.latches.len();
        let before = running.remembered(&mut system);
        let memory = first_latch..system.latches.len();
        let given = plant::give(&mut system, &mut clocks, machine, started, &before, open);
        let plant::Terminals { inputs, bits, past_bits, counts, turn } = given;
        // In the first scan inputs and hidden bits have no other past than themselves.
        let mut past = |was: &[Lit], is: &[Lit]| -> Vec<Lit> {
            was.iter().zip(is).map(|(&was, &is)| system.aig.select(started, was, is)).collect()
        };
        let (past_inputs, past_bits) = (past(&before.inputs, &inputs), past(&past_bits, &bits));
        let owed = system.fair.len();
        let scan = running.scan(&mut system, &mut clocks, started, &before, &inputs, turn.reading);
        for fairness in &mut system.fair[owed..] {
            // Time passes for a program when it looks.
            fairness.holds = system.aig.and(fairness.holds, turn.reading);
        }
        let outputs = before.outputs.iter().copied().zip(scan.after.outputs.iter().copied()).collect();
        let scan = turn.scan(&mut system, memory.clone(), &before, scan);
        let told = running.told(counted, &before);
        system.latches[memory].iter_mut().filter(|l| told.contains(&l.leaf)).for_each(|l| l.next = Lit::FALSE);
        let begun = system.aig.or(started, turn.reading);
        system.latches[0].next = begun;
        system.constraints.extend(scan.broken.iter().map(|&b| !b));
        let inputs = inputs.iter().zip(&before.inputs);
        let inputs = inputs.map(|(&is, &was)| system.aig.select(turn.reading, is, was)).collect();
        let (past_outputs, past_active) = (before.outputs, before.active);
        system.notable.clone_from(&scan.after.variables);
        if counted.some() {
            // Not all claims are asked, but it is from their states that a walk goes on.
            system.notable.extend(&scan.after.active);
        }
        system.numbers = scan.after.integers.iter().chain(&counts).cloned().collect();
        let timed = running.is_timed() || !open && clocks::waits(machine);
        let all = clocks::of(machine, &running.timers(), !open);
        let waits = turn.latches();
        let view = View { inputs, past_inputs, bits, past_bits, counts, past_outputs, past_active, scan, turn, begun };
        let questions = Vec::new();
        let mut subject =
            Subject { machine, system, questions, view, clocks, timed, all, running, open, outputs, waits };
        subject.ask_about_outputs(program);
        if program == Program::Chart {
            subject.ask_about_chart();
        }
        subject
    }

    /// Keeps those claims that are `wanted`, by index, and lets time pass in leaps where that makes no difference to them. It is done
    /// once, when all is asked.
    pub fn wanting(mut self, wanted: &[usize]) -> Subject<'m> {
        let claims = wanted.iter().map(|&i| self.system.claims[i].clone()).collect();
        self.questions = wanted.iter().map(|&i| self.questions[i]).collect();
        self.system.claims = claims;
        self.clocks.close(&mut self.system, self.view.turn.reading, &self.outputs, self.waits.clone());
        self
    }

    /// The run scan by scan, in which no time passes in leaps. What it leads to and shows of a property is the same.
    pub fn stretched(&self, trace: &Trace, property: Property) -> Trace {
        let place = |leaf: Lit| self.system.inputs.iter().position(|i| i.leaf == leaf);
        let mut inputs = Vec::new();
        let rest = if self.view.turn.reading == Lit::TRUE { 1 } else { 2 };
        let mut leaps = false;
        for (number, values) in trace.inputs.iter().enumerate() {
            let more = self.clocks.leapt(&|leaf| place(leaf).is_some_and(|i| values[i]), &self.system);
            let mut scan = values.clone();
            self.system
                .inputs
                .iter()
                .zip(&mut scan)
                .filter(|(i, _)| self.clocks.is_of_leaps(i))
                .for_each(|(_, v)| *v = false);
            // What never must be shows at once.
            let last = number + 1 == trace.inputs.len() && property.never().is_some();
            let more = if last { 0 } else { more };
            leaps |= more > 0;
            inputs.extend(std::iter::repeat_n(scan, 1 + rest * more));
        }
        Trace { initial: trace.initial.clone(), inputs, shortest: trace.shortest && !leaps }
    }

    fn ask(&mut self, question: Question, name: String, property: Property) {
        self.system.claim(name, property);
        self.questions.push(question);
    }
}
