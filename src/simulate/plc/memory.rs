//! Variables, flags and pins in flat arrays, and compiled expressions over them.
//!
//! A condition becomes a decision: each test looks at one bit and says where to go on if it is TRUE
//! and where if not. Comparisons and what a test cannot express get a bit of their own, computed
//! before.

use crate::ir::expr::Expr;
use crate::ir::iec::{Atom, BlockId, Bool, Condition, Kind, Number, Project, Relation, StepId, VarId};

/// Where something of type BOOL stands.
pub type Bit = u32;
/// Where an integer or time stands.
pub type Word = u32;

/// The values of everything.
#[derive(Clone, Debug)]
pub struct Memory {
    /// BOOL values.
    pub bits: Vec<bool>,
    /// Integers and times.
    pub words: Vec<i64>,
}

/// Where a variable stands, and what it holds.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// A BOOL.
    Bit(Bit),
    /// Anything else.
    Word(Word, Kind),
}

const HOLDS: u32 = u32::MAX;
const FAILS: u32 = u32::MAX - 1;

/// Looks at one bit.
#[derive(Clone, Copy, Debug)]
struct Test {
    bit: Bit,
    /// The next test, or the outcome, if it is TRUE.
    on: u32,
    /// The same if it is FALSE.
    off: u32,
}

/// A value that is computed before a condition.
#[derive(Clone, Debug)]
enum Part {
    /// `bit` becomes the outcome of the tests from `entry` on.
    Bool { entry: u32, bit: Bit },
    /// `bit` becomes the outcome of a comparison.
    Compare { comparison: Relation, left: Value, right: Value, bit: Bit },
}

/// A compiled number.
#[derive(Clone, Debug)]
pub enum Value {
    /// A literal.
    Const(i64),
    /// What stands at a place.
    Word(Word),
    /// The opposite.
    Negative(Box<Value>),
    /// The sum.
    Sum(Box<Value>, Box<Value>),
    /// The difference.
    Difference(Box<Value>, Box<Value>),
    /// The value between two bounds.
    Limit(i64, Box<Value>, i64),
    /// The first if the bit is FALSE, else the second.
    Select(Bit, Box<Value>, Box<Value>),
}

/// A compiled condition.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    entry: u32,
    first_part: u32,
    parts: u32,
}

/// All compiled conditions.
#[derive(Clone, Debug, Default)]
pub struct Code {
    tests: Vec<Test>,
    parts: Vec<Part>,
}

impl Code {
    /// Whether a condition holds.
    #[inline]
    pub fn holds(&self, decision: Decision, memory: &mut Memory) -> bool {
        if decision.parts != 0 {
            self.compute(decision, memory);
        }
        self.outcome(decision.entry, memory)
    }

    #[inline]
    fn outcome(&self, mut at: u32, memory: &Memory) -> bool {
        // Tests only go on to tests made before them, so this ends.
        while at < FAILS {
            let test = self.tests[at as usize];
            at = if memory.bits[test.bit as usize] { test.on } else { test.off };
        }
        at == HOLDS
    }

    fn compute(&self, decision: Decision, memory: &mut Memory) {
        let first = decision.first_part as usize;
        for part in &self.parts[first..first + decision.parts as usize] {
            let (bit, value) = match part {
                Part::Bool { entry, bit } => (*bit, self.outcome(*entry, memory)),
                Part::Compare { comparison, left, right, bit } => {
                    let (left, right) = (left.of(memory), right.of(memory));
                    let value = match comparison {
                        Relation::Equal => left == right,
                        Relation::Unequal => left != right,
                        Relation::Less => left < right,
                        Relation::LessOrEqual => left <= right,
                        Relation::Greater => left > right,
                        Relation::GreaterOrEqual => left >= right,
                    };
                    (*bit, value)
                }
            };
            memory.bits[bit as usize] = value;
        }
    }
}

impl Value {
    /// The number.
    pub fn of(&self, memory: &Memory) -> i64 {
        match self {
            Value::Const(n) => *n,
            Value::Word(word) => memory.words[*word as usize],
            Value::Negative(n) => n.of(memory).wrapping_neg(),
            Value::Sum(l, r) => l.of(memory).wrapping_add(r.of(memory)),
            Value::Difference(l, r) => l.of(memory).wrapping_sub(r.of(memory)),
            Value::Limit(lowest, value, highest) => value.of(memory).min(*highest).max(*lowest),
            Value::Select(by, no, yes) => if memory.bits[*by as usize] { yes } else { no }.of(memory),
        }
    }
}

/// What an assignment to a variable keeps of a value.
pub fn fit(value: i64, kind: Kind) -> i64 {
    match kind {
        Kind::Bool => i64::from(value != 0),
        Kind::Time => value,
        Kind::Int { bits, signed } => {
            let unused = 64 - u32::from(bits.clamp(1, 64));
            let shifted = value << unused;
            if signed { shifted >> unused } else { (shifted as u64 >> unused) as i64 }
        }
    }
}

/// Gives everything a place, then compiles.
pub struct Compiler {
    /// The initial values.
    pub memory: Memory,
    /// What is compiled so far.
    pub code: Code,
    /// Where each variable stands.
    pub variables: Vec<Place>,
    /// Q and ET of each block.
    pub outputs: Vec<(Bit, Word)>,
    /// X and T of each step of the current program.
    pub steps: Vec<(Bit, Word)>,
    /// The bits of the shared parts of the current condition.
    shared: Vec<Bit>,
}

impl Compiler {
    /// Gives places to the variables and blocks of a project.
    pub fn new(project: &Project) -> Self {
        let memory = Memory { bits: Vec::new(), words: Vec::new() };
        let mut compiler = Compiler {
            memory,
            code: Code::default(),
            variables: Vec::new(),
            outputs: Vec::new(),
            steps: Vec::new(),
            shared: Vec::new(),
        };
        for variable in project.variables.values() {
            let place = match variable.kind {
                Kind::Bool => Place::Bit(compiler.bit(variable.initial != 0)),
                kind @ (Kind::Int { .. } | Kind::Time) => Place::Word(compiler.word(fit(variable.initial, kind)), kind),
            };
            compiler.variables.push(place);
        }
        for _ in project.blocks.values() {
            let output = (compiler.bit(false), compiler.word(0));
            compiler.outputs.push(output);
        }
        compiler
    }

    /// A new bit.
    pub fn bit(&mut self, initial: bool) -> Bit {
        self.memory.bits.push(initial);
        index(self.memory.bits.len() - 1)
    }

    /// A new word.
    pub fn word(&mut self, initial: i64) -> Word {
        self.memory.words.push(initial);
        index(self.memory.words.len() - 1)
    }

    /// Where a variable stands that must be BOOL.
    pub fn variable_bit(&self, variable: VarId) -> Bit {
        match self.variables[variable.index()] {
            Place::Bit(bit) => bit,
            Place::Word(..) => panic!("{variable:?} is used as BOOL and is none"),
        }
    }

    fn variable_word(&self, variable: VarId) -> Word {
        match self.variables[variable.index()] {
            Place::Word(word, _) => word,
            Place::Bit(_) => panic!("{variable:?} is used as a number and is BOOL"),
        }
    }

    fn step(&self, step: StepId) -> (Bit, Word) {
        self.steps[step.index()]
    }

    fn output(&self, block: BlockId) -> (Bit, Word) {
        self.outputs[block.index()]
    }

    /// Compiles a condition.
    pub fn condition(&mut self, condition: &Condition) -> Decision {
        let first_part = index(self.code.parts.len());
        self.shared.clear();
        for part in &condition.shared {
            let bit = self.part(part);
            self.shared.push(bit);
        }
        let entry = self.tests(&condition.value, HOLDS, FAILS);
        Decision { entry, first_part, parts: index(self.code.parts.len()) - first_part }
    }

    /// Has a value computed before the current condition.
    fn part(&mut self, value: &Bool) -> Bit {
        // Its own parts come before it.
        let entry = self.tests(value, HOLDS, FAILS);
        let bit = self.bit(false);
        self.code.parts.push(Part::Bool { entry, bit });
        bit
    }

    /// Tests that lead to `on` if `value` holds, else to `off`; returns the first.
    fn tests(&mut self, value: &Bool, on: u32, off: u32) -> u32 {
        match value {
            Expr::Const(true) => on,
            Expr::Const(false) => off,
            Expr::Atom(atom) => {
                let bit = self.atom(atom);
                self.code.tests.push(Test { bit, on, off });
                index(self.code.tests.len() - 1)
            }
            Expr::Not(inner) => self.tests(inner, off, on),
            Expr::And(operands) => operands.iter().rev().fold(on, |on, e| self.tests(e, on, off)),
            Expr::Or(operands) => operands.iter().rev().fold(off, |off, e| self.tests(e, on, off)),
            Expr::Xor(left, right) => {
                // The right side is tested in two places; as a bit it does not grow.
                let bit = self.part(right);
                self.code.tests.push(Test { bit, on: off, off: on });
                let same = index(self.code.tests.len() - 1);
                self.code.tests.push(Test { bit, on, off });
                let other = index(self.code.tests.len() - 1);
                self.tests(left, same, other)
            }
        }
    }

    fn atom(&mut self, atom: &Atom) -> Bit {
        match atom {
            Atom::Variable(variable) => self.variable_bit(*variable),
            Atom::Step(step) => self.step(*step).0,
            Atom::Output(block) => self.output(*block).0,
            Atom::Shared(part) => self.shared[*part],
            Atom::Compare(comparison, left, right) => {
                let (left, right) = (self.number(left), self.number(right));
                let bit = self.bit(false);
                self.code.parts.push(Part::Compare { comparison: *comparison, left, right, bit });
                bit
            }
        }
    }

    /// Compiles a number.
    pub fn number(&self, number: &Number) -> Value {
        match number {
            Number::Const(n) => Value::Const(*n),
            Number::Variable(variable) => Value::Word(self.variable_word(*variable)),
            Number::StepTime(step) => Value::Word(self.step(*step).1),
            Number::Elapsed(block) => Value::Word(self.output(*block).1),
            Number::Negative(n) => Value::Negative(Box::new(self.number(n))),
            Number::Sum(l, r) => Value::Sum(Box::new(self.number(l)), Box::new(self.number(r))),
            Number::Difference(l, r) => Value::Difference(Box::new(self.number(l)), Box::new(self.number(r))),
            Number::Limit { lowest, value, highest } => Value::Limit(*lowest, Box::new(self.number(value)), *highest),
            Number::Select { by, no, yes } => {
                Value::Select(self.variable_bit(*by), Box::new(self.number(no)), Box::new(self.number(yes)))
            }
        }
    }
}

fn index(length: usize) -> u32 {
    u32::try_from(length).ok().filter(|&n| n < FAILS).expect("a project has fewer than 2^32 - 2 things of a kind")
}
