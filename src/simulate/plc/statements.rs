//! Statements and function blocks, compiled and executed.

use super::memory::{Bit, Code, Compiler, Decision, Memory, Place, Value, Word, fit};
use crate::ir::iec::{BlockKind, CoilKind, Kind, Project, Statement, Time};

/// A compiled statement.
#[derive(Clone, Debug)]
pub enum Step {
    /// The bit becomes the condition.
    Assign(Decision, Bit),
    /// The bit becomes TRUE if the condition holds.
    Set(Decision, Bit),
    /// The bit becomes FALSE if the condition holds.
    Reset(Decision, Bit),
    /// The word becomes the value.
    Move(Value, Word, Kind),
    /// A function block runs.
    Call {
        /// Its index.
        block: usize,
        /// What its inputs become, where given.
        input: Option<Decision>,
        /// The same.
        reset: Option<Decision>,
        /// The same.
        preset: Option<Value>,
    },
}

/// A function block at work. Its outputs stand in memory.
#[derive(Clone, Debug)]
pub struct Block {
    kind: BlockKind,
    input: bool,
    reset: bool,
    preset: Time,
    /// M of a trigger, the last IN of a timer.
    last: bool,
    phase: Phase,
    start: Time,
    q: Bit,
    et: Word,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Running,
    Ended,
}

/// The blocks of a project, before their first call.
pub fn blocks(project: &Project, compiler: &Compiler) -> Vec<Block> {
    let outputs = project.blocks.values().zip(&compiler.outputs);
    let new = |kind, (q, et)| Block {
        kind,
        input: false,
        reset: false,
        preset: 0,
        last: false,
        phase: Phase::Idle,
        start: 0,
        q,
        et,
    };
    outputs.map(|(block, &output)| new(block.kind, output)).collect()
}

/// Compiles statements.
pub fn compile(statements: &[Statement], compiler: &mut Compiler) -> Vec<Step> {
    let compile = |statement: &Statement| match statement {
        Statement::Coil(coil) => {
            let decision = compiler.condition(&coil.condition);
            let bit = compiler.variable_bit(coil.variable);
            match coil.kind {
                CoilKind::Plain => Step::Assign(decision, bit),
                CoilKind::Set => Step::Set(decision, bit),
                CoilKind::Reset => Step::Reset(decision, bit),
            }
        }
        Statement::Move { to, value } => match compiler.variables[to.index()] {
            Place::Word(word, kind) => Step::Move(compiler.number(value), word, kind),
            Place::Bit(_) => panic!("{to:?} is given a number and is BOOL"),
        },
        Statement::Call(call) => Step::Call {
            block: call.block.index(),
            input: call.input.as_ref().map(|c| compiler.condition(c)),
            reset: call.reset.as_ref().map(|c| compiler.condition(c)),
            preset: call.preset.as_ref().map(|n| compiler.number(n)),
        },
    };
    statements.iter().map(compile).collect()
}

/// Executes statements at time `now`.
#[inline]
pub fn run(steps: &[Step], code: &Code, memory: &mut Memory, blocks: &mut [Block], now: Time) {
    for step in steps {
        match step {
            Step::Assign(decision, bit) => {
                let value = code.holds(*decision, memory);
                memory.bits[*bit as usize] = value;
            }
            Step::Set(decision, bit) => {
                if code.holds(*decision, memory) {
                    memory.bits[*bit as usize] = true;
                }
            }
            Step::Reset(decision, bit) => {
                if code.holds(*decision, memory) {
                    memory.bits[*bit as usize] = false;
                }
            }
            Step::Move(value, word, kind) => {
                memory.words[*word as usize] = fit(value.of(memory), *kind);
            }
            Step::Call { block, input, reset, preset } => {
                let block = &mut blocks[*block];
                if let Some(decision) = input {
                    block.input = code.holds(*decision, memory);
                }
                if let Some(decision) = reset {
                    block.reset = code.holds(*decision, memory);
                }
                if let Some(value) = preset {
                    block.preset = value.of(memory);
                }
                block.run(memory, now);
            }
        }
    }
}

impl Block {
    fn run(&mut self, memory: &mut Memory, now: Time) {
        let (q, et) = (&mut memory.bits[self.q as usize], &mut memory.words[self.et as usize]);
        let (input, last) = (self.input, self.last);
        match self.kind {
            BlockKind::RTrig => {
                *q = input && !last;
                self.last = input;
                return;
            }
            BlockKind::FTrig => {
                *q = !input && !last;
                self.last = !input;
                return;
            }
            BlockKind::Sr => {
                *q = input || (!self.reset && *q);
                return;
            }
            BlockKind::Rs => {
                *q = !self.reset && (input || *q);
                return;
            }
            BlockKind::Ton => {
                if self.phase == Phase::Idle && input && !last {
                    (self.phase, self.start) = (Phase::Running, now);
                    *q = false;
                } else if !input {
                    self.phase = Phase::Idle;
                    (*q, *et) = (false, 0);
                } else if self.phase == Phase::Running && self.proceed(et, now) {
                    *q = true;
                }
            }
            BlockKind::Tof => {
                if self.phase == Phase::Idle && !input && last {
                    (self.phase, self.start) = (Phase::Running, now);
                } else if input {
                    self.phase = Phase::Idle;
                    *et = 0;
                } else if self.phase == Phase::Running {
                    self.proceed(et, now);
                }
                *q = input || self.phase == Phase::Running;
            }
            BlockKind::Tp => {
                if self.phase == Phase::Idle && input && !last {
                    (self.phase, self.start) = (Phase::Running, now);
                    *q = true;
                } else if self.phase == Phase::Running && self.proceed(et, now) {
                    *q = false;
                }
                if self.phase == Phase::Ended && !input {
                    self.phase = Phase::Idle;
                    *et = 0;
                }
            }
        }
        self.last = input;
    }

    /// Lets a running timer go on; says whether it has ended now.
    fn proceed(&mut self, et: &mut i64, now: Time) -> bool {
        let ended = self.start.wrapping_add(self.preset) <= now;
        if ended {
            self.phase = Phase::Ended;
            *et = self.preset;
        } else {
            *et = now.wrapping_sub(self.start);
        }
        ended
    }
}
