//! A PLC project, executed scan by scan by the rules of [`crate::ir::iec`].
//!
//! Everything is resolved beforehand: a scan walks flat arrays, allocates nothing and looks nothing
//! up, so that long runs and many runs are cheap.

mod chart;
mod memory;
mod statements;
#[cfg(test)]
mod tests;

use crate::ir::iec::{Body, Project, StepId, Time, VarId};
use chart::Chart;
use memory::{Code, Compiler, Memory, Place, fit};
use statements::Block;

/// A PLC that runs one project.
#[derive(Clone, Debug)]
pub struct Plc {
    code: Code,
    memory: Memory,
    blocks: Vec<Block>,
    programs: Vec<Program>,
    variables: Vec<Place>,
    scans: u64,
}

#[derive(Clone, Debug)]
struct Program {
    /// It runs in scans whose numbers are multiples of this.
    every: u64,
    body: Machine,
}

#[derive(Clone, Debug)]
enum Machine {
    Chart(Chart),
    Code(Vec<statements::Step>),
}

impl Plc {
    /// A PLC before its first scan.
    ///
    /// # Panics
    ///
    /// If the project breaks a rule of its types, such as a coil on a variable that is not BOOL;
    /// [`crate::read`] makes none that does.
    pub fn new(project: &Project) -> Plc {
        let mut compiler = Compiler::new(project);
        let tick = project.tick();
        let mut programs = Vec::new();
        for program in &project.programs {
            let every = program.task.zip(tick).map_or(1, |(task, tick)| project.tasks[task].interval / tick);
            let body = match &program.body {
                Body::Sfc(sfc) => Machine::Chart(Chart::new(sfc, &mut compiler)),
                Body::Code(statements) => Machine::Code(statements::compile(statements, &mut compiler)),
            };
            programs.push(Program { every: every.unsigned_abs().max(1), body });
        }
        let blocks = statements::blocks(project, &compiler);
        let Compiler { memory, code, variables, .. } = compiler;
        Plc { code, memory, blocks, programs, variables, scans: 0 }
    }

    /// Runs one scan at time `now`, in microseconds since the PLC was started; it should not be
    /// earlier than the last one. One [tick](Project::tick) lies between two scans of a real PLC.
    pub fn scan(&mut self, now: Time) {
        self.scans += 1;
        for program in &mut self.programs {
            if program.every > 1 && !self.scans.is_multiple_of(program.every) {
                continue;
            }
            match &mut program.body {
                Machine::Chart(chart) => chart.run(&self.code, &mut self.memory, &mut self.blocks, now),
                Machine::Code(steps) => {
                    statements::run(steps, &self.code, &mut self.memory, &mut self.blocks, now);
                }
            }
        }
    }

    /// How many scans there were.
    pub fn scans(&self) -> u64 {
        self.scans
    }

    /// The value of a variable: 0 or 1, an integer, or a time in microseconds.
    pub fn read(&self, variable: VarId) -> i64 {
        match self.variables[variable.index()] {
            Place::Bit(bit) => i64::from(self.memory.bits[bit as usize]),
            Place::Word(word, _) => self.memory.words[word as usize],
        }
    }

    /// Gives a variable a value, cut to its type.
    pub fn write(&mut self, variable: VarId, value: i64) {
        match self.variables[variable.index()] {
            Place::Bit(bit) => self.memory.bits[bit as usize] = value != 0,
            Place::Word(word, kind) => self.memory.words[word as usize] = fit(value, kind),
        }
    }

    /// Whether a step of the program at that index is active.
    pub fn is_active(&self, program: usize, step: StepId) -> bool {
        match &self.programs[program].body {
            Machine::Chart(chart) => self.memory.bits[chart.places(step.index()).0 as usize],
            Machine::Code(_) => false,
        }
    }

    /// How long a step of the program at that index has been active, in microseconds.
    pub fn step_time(&self, program: usize, step: StepId) -> Time {
        match &self.programs[program].body {
            Machine::Chart(chart) => self.memory.words[chart.places(step.index()).1 as usize],
            Machine::Code(_) => 0,
        }
    }
}
