//! A PLC project as any tool may have written it, and as it is executed.
//!
//! [`plc`](super::plc) holds the restricted form that the compiler emits; this holds what a reader
//! of PLCopen XML finds, of whatever origin: several tasks, local variables, timers and triggers,
//! simultaneous branches, all action qualifiers, integers and times. Nothing in it knows of XML. A
//! project is *instantiated*: a program type that runs twice stands here as two programs, each with
//! its own variables, so that every id names one piece of memory.
//!
//! # What one scan means
//!
//! The rules are those of the C programs that the open compiler matiec makes of the texts that
//! Beremiz makes of PLCopen XML, observed and confirmed by fuzzing. Where IEC 61131-3 leaves
//! something open, this is one of its readings.
//!
//! **Scan.** Time stands still during a scan. Inputs are set before it. Then the programs run in
//! the order of [`Project::programs`], each to its end; what one writes, those after it read in the
//! same scan and those before it in the next. A program with a [task](Task) runs only in scans whose
//! number, counted from 1, is a multiple of the task's interval divided by the [tick](Project::tick).
//! Priorities of tasks mean nothing.
//!
//! **Code** ([`Statement`]). Statements run from first to last, and each reads what those before it
//! have written. A coil evaluates its whole [`Condition`] when its turn comes.
//!
//! **Function blocks.** A [`Call`] sets those inputs that it gives (the others keep their values),
//! then runs the block. Outputs keep their values between calls; everything is 0 at first.
//! - `R_TRIG`: `Q := CLK AND NOT M; M := CLK`. `F_TRIG`: `Q := NOT CLK AND NOT M; M := NOT CLK`, so
//!   it fires in the first call if CLK is FALSE then.
//! - `SR`: `Q1 := S1 OR NOT R AND Q1`. `RS`: `Q1 := NOT R1 AND (S OR Q1)`.
//! - `TON`: a rising edge of IN (against the last call) while idle starts it: Q is FALSE, ET as it
//!   was. Otherwise IN FALSE makes it idle, with Q FALSE and ET 0; and while it runs, from the
//!   first call with `now >= start + PT` on it has ended, Q TRUE and ET PT; before that ET is
//!   `now - start`.
//! - `TOF`: a falling edge of IN while idle starts it. Otherwise IN TRUE makes it idle, with ET 0;
//!   and while it runs it ends as above. After that Q is `IN OR running`.
//! - `TP`: a rising edge of IN while idle starts it, with Q TRUE. If it ran before this call, it
//!   ends as above, with Q FALSE, else ET is `now - start`. Once it has ended and IN is FALSE it is
//!   idle, with ET 0; this can be in the call in which it ends.
//!
//! **SFC** ([`Sfc`]). In each call, in this order:
//! 1. `elapsed` is the time since the program's last call (since 0, in the first one). For each
//!    step: `was` is its flag `X`; if X, its time `T` grows by `elapsed`.
//! 2. For each action: `set` and `reset` are cleared. Its delays that run are shortened by
//!    `elapsed`; one that ends gives `set` (SD, DS) or `reset` (SL) for this scan.
//! 3. Transitions are tested once each. Those with a priority come in ascending order over the
//!    whole chart, equal ones in the order of [`Sfc::transitions`]; where those without come is
//!    said at [`Sfc::test_order`]. One is enabled if all its source steps have X *now*; only then its
//!    condition is evaluated. If it holds and the transition has a priority, X of its sources is
//!    cleared at once, so of several such transitions out of one step at most one fires. Without
//!    priority nothing is cleared yet: all that hold fire, together.
//! 4. X of the sources of all others that fired is cleared.
//! 5. X of the targets of all that fired becomes TRUE, their T 0; this wins over 4.
//! 6. The associations of all steps, in order; `on` is `X AND NOT was`, `off` is `was AND NOT X`.
//!    To "write" is to assign to the variable, or to the flag `run` of the action.
//!    - N: if X write TRUE; if off write FALSE.
//!    - P, P1: write on. P0: write off. (So FALSE is written in every other scan.)
//!    - S: if X then set. R: if X then reset.
//!    - L: if X and T < duration write TRUE, else if X or off write FALSE.
//!    - D: if X and T >= duration write TRUE, else if off write FALSE.
//!    - SL: if on then set, and the delay of its reset begins.
//!    - SD, DS: if on, the delay of its set begins; DS: if off it is stopped.
//! 7. For each action: `set` makes `stored` TRUE and stops the delay of the set; `reset` then makes
//!    it FALSE and stops the delay of the reset. `run` becomes `run OR stored`.
//! 8. Each *variable* that is associated: reset assigns FALSE, else set assigns TRUE.
//! 9. The bodies of those actions that have `run`, in the order of [`Sfc::actions`].
//!
//! `set`, `reset`, `stored` and the delays belong to the variable or action, not to the association;
//! `run` starts as FALSE in each scan. There is no last run of an action after its step is left.

use super::expr::Expr;
pub use super::number::Relation;
use crate::base::{Arena, Id};

/// Names a variable.
pub type VarId = Id<Variable>;
/// Names an instance of a function block.
pub type BlockId = Id<Block>;
/// Names a task.
pub type TaskId = Id<Task>;
/// Names a step within its program.
pub type StepId = Id<Step>;
/// Names an action within its program.
pub type ActionId = Id<Action>;

/// A time or a duration, in microseconds.
pub type Time = i64;

/// A BOOL expression.
pub type Bool = Expr<Atom>;

/// A whole project.
#[derive(Clone, Debug, Default)]
pub struct Project {
    /// The name that the file gives it.
    pub name: String,
    /// All variables: the global ones first, then those of each program, in order of declaration.
    pub variables: Arena<Variable>,
    /// All instances of function blocks, those that stand for edge contacts included.
    pub blocks: Arena<Block>,
    /// The tasks, in order of declaration.
    pub tasks: Arena<Task>,
    /// The programs that run, in the order in which they do.
    pub programs: Vec<Program>,
}

/// A variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// As declared. Names differ by more than case within one scope.
    pub name: String,
    /// Who sees it.
    pub scope: Scope,
    /// What it holds.
    pub kind: Kind,
    /// Its value before the first scan: 0 or 1, an integer, or a [`Time`].
    pub initial: i64,
    /// Its address as written, such as `%IX0.0`.
    pub address: Option<String>,
}

/// Where a variable or block is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// In the configuration or resource.
    Global,
    /// In a program: an index into [`Project::programs`].
    Program(usize),
}

/// What a variable holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// BOOL.
    Bool,
    /// An integer; an assignment keeps the lowest `bits` bits.
    Int {
        /// 8, 16, 32 or 64.
        bits: u8,
        /// Whether it may be negative.
        signed: bool,
    },
    /// TIME, in microseconds.
    Time,
}

/// An instance of a function block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// As declared; empty for one that stands for an edge contact or an edge coil.
    pub name: String,
    /// Who sees it.
    pub scope: Scope,
    /// Its type.
    pub kind: BlockKind,
}

/// The function blocks that are understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockKind {
    /// On-delay.
    Ton,
    /// Off-delay.
    Tof,
    /// Pulse.
    Tp,
    /// Rising edge.
    RTrig,
    /// Falling edge.
    FTrig,
    /// Bistable, set wins.
    Sr,
    /// Bistable, reset wins.
    Rs,
}

/// A task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Task {
    /// As declared.
    pub name: String,
    /// The time between two runs; positive.
    pub interval: Time,
}

/// One instance of a program.
#[derive(Clone, Debug)]
pub struct Program {
    /// The name of the instance.
    pub name: String,
    /// The name of its type.
    pub kind: String,
    /// Its task; without one it runs in every scan.
    pub task: Option<TaskId>,
    /// What it does.
    pub body: Body,
}

/// The body of a program.
#[derive(Clone, Debug)]
pub enum Body {
    /// A sequential function chart.
    Sfc(Sfc),
    /// A ladder diagram, or the simple structured text that means the same.
    Code(Vec<Statement>),
}

/// A sequential function chart.
#[derive(Clone, Debug, Default)]
pub struct Sfc {
    /// The steps, in the order in which their associations take effect.
    pub steps: Arena<Step>,
    /// The transitions, in text order.
    pub transitions: Vec<Transition>,
    /// The actions that have bodies, in the order in which they run.
    pub actions: Arena<Action>,
}

/// A step.
#[derive(Clone, Debug)]
pub struct Step {
    /// As declared.
    pub name: String,
    /// Whether it is active before the first scan.
    pub initial: bool,
    /// What it does while it is active.
    pub associations: Vec<Association>,
}

/// What a step does to a variable or action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Association {
    /// To what.
    pub target: Target,
    /// How.
    pub qualifier: Qualifier,
    /// How long; 0 with the qualifiers that need no duration.
    pub duration: Time,
}

/// What an association acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// A BOOL variable.
    Variable(VarId),
    /// An action with a body.
    Action(ActionId),
}

/// Action qualifiers (IEC 61131-3, 2.6.4.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Qualifier {
    /// N: while the step is active.
    NonStored,
    /// S: from now on.
    Set,
    /// R: no longer.
    Reset,
    /// P: once, when the step is entered.
    Pulse,
    /// P1: the same.
    PulseRising,
    /// P0: once, when the step is left.
    PulseFalling,
    /// L: while the step is active, but not longer than the duration.
    Limited,
    /// D: while the step is active, once the duration is over.
    Delayed,
    /// SL: from now on for the duration.
    StoredLimited,
    /// SD: from the end of the duration on, even if the step is left before.
    StoredDelayed,
    /// DS: from the end of the duration on, if the step is still active then.
    DelayedStored,
}

/// A transition.
#[derive(Clone, Debug)]
pub struct Transition {
    /// The steps that it leaves; at least one, each once.
    pub from: Vec<StepId>,
    /// The steps that it enters; at least one, each once.
    pub to: Vec<StepId>,
    /// Lower is tried first. Without one the transition does not exclude others.
    pub priority: Option<u32>,
    /// What must hold.
    pub condition: Condition,
}

/// An action with a body.
#[derive(Clone, Debug)]
pub struct Action {
    /// As declared.
    pub name: String,
    /// What it does when it runs.
    pub body: Vec<Statement>,
}

/// A statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Statement {
    /// A coil, or an assignment to a BOOL variable.
    Coil(Coil),
    /// An assignment of an integer or time; the types agree.
    Move {
        /// The variable.
        to: VarId,
        /// The value.
        value: Number,
    },
    /// A call of a function block.
    Call(Call),
}

/// A coil.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coil {
    /// What feeds it.
    pub condition: Condition,
    /// The BOOL variable that it writes.
    pub variable: VarId,
    /// How.
    pub kind: CoilKind,
}

/// How a coil writes. A negated coil is a plain one with the opposite condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoilKind {
    /// The variable becomes the condition.
    Plain,
    /// The variable becomes TRUE if the condition holds.
    Set,
    /// The variable becomes FALSE if the condition holds.
    Reset,
}

/// A call of a function block. An input that is not given keeps its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// Which instance.
    pub block: BlockId,
    /// IN of a timer, CLK of a trigger, S1 of SR, S of RS.
    pub input: Option<Condition>,
    /// R of SR, R1 of RS.
    pub reset: Option<Condition>,
    /// PT of a timer.
    pub preset: Option<Number>,
}

/// A BOOL value, with the parts of it that are used more than once.
///
/// Contacts form a graph, in which branches part and meet again; written out as one expression it
/// could grow beyond bounds. So a point of the graph from which several branches go on has a place
/// in `shared`, and so has one below which an expression would become too deep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Condition {
    /// Values for [`Atom::Shared`]; each may use those before it.
    pub shared: Vec<Bool>,
    /// The value.
    pub value: Bool,
}

/// The smallest part of a BOOL expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Atom {
    /// A BOOL variable.
    Variable(VarId),
    /// Flag X of a step of the same program. While transitions are tested it is that of the last
    /// scan, except for steps which a transition with priority has left in this one.
    Step(StepId),
    /// Q of a timer or trigger, Q1 of SR or RS.
    Output(BlockId),
    /// An entry of [`Condition::shared`].
    Shared(usize),
    /// A comparison; both sides are integers, or both are times.
    Compare(Relation, Number, Number),
}

/// An integer or time. It is computed in 64 bits, wrapping; only assignments cut it to its type.
///
/// Functions are computed in the type of their operands. [`crate::read`] takes a function only where
/// it makes no difference: all its variables and what it is assigned to are of one type.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Number {
    /// A literal; times in microseconds.
    Const(i64),
    /// A variable that is not BOOL.
    Variable(VarId),
    /// Time T of a step of the same program. It stands still while the step is not active.
    StepTime(StepId),
    /// ET of a timer.
    Elapsed(BlockId),
    /// The opposite.
    Negative(Box<Number>),
    /// The sum.
    Sum(Box<Number>, Box<Number>),
    /// The difference.
    Difference(Box<Number>, Box<Number>),
    /// LIMIT: the value, or the bound that it is beyond.
    Limit {
        /// The lower bound.
        lowest: i64,
        /// The value.
        value: Box<Number>,
        /// The upper bound; not less than the lower one.
        highest: i64,
    },
    /// SEL: one of two.
    Select {
        /// The BOOL variable that decides.
        by: VarId,
        /// The value if it is FALSE.
        no: Box<Number>,
        /// The value if it is TRUE.
        yes: Box<Number>,
    },
}

impl Project {
    /// The time between two scans: the greatest common divisor of the intervals of all tasks;
    /// without tasks, `None`.
    pub fn tick(&self) -> Option<Time> {
        let gcd = |mut a: Time, mut b: Time| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        self.tasks.values().map(|t| t.interval).reduce(gcd)
    }

    /// The global variable with that name, in any case.
    pub fn global(&self, name: &str) -> Option<VarId> {
        self.variables.iter().find(|(_, v)| v.scope == Scope::Global && v.name.eq_ignore_ascii_case(name)).map(|f| f.0)
    }
}

impl Kind {
    /// Whether a number is a value of that type; of BOOL, 0 and 1 are.
    pub fn holds(self, number: i64) -> bool {
        let (lowest, highest) = match self {
            Kind::Bool => (0, 1),
            Kind::Time | Kind::Int { bits: 64, signed: true } => (i64::MIN, i64::MAX),
            Kind::Int { bits: 64, signed: false } => (0, i64::MAX),
            Kind::Int { bits, signed: true } => (-1 << (bits - 1), (1 << (bits - 1)) - 1),
            Kind::Int { bits, signed: false } => (0, (1 << bits) - 1),
        };
        (lowest..=highest).contains(&number)
    }
}

impl Condition {
    /// A condition that is one expression.
    pub fn simple(value: Bool) -> Self {
        Condition { shared: Vec::new(), value }
    }
}

impl Sfc {
    /// The order in which transitions are tested, as indices into [`Sfc::transitions`].
    ///
    /// They come into a list in text order: one with a priority before the first entry whose
    /// priority is larger, where no priority counts as 0; one without at the end.
    pub fn test_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = Vec::with_capacity(self.transitions.len());
        let rank = |i: usize| self.transitions[i].priority.unwrap_or(0);
        for (index, transition) in self.transitions.iter().enumerate() {
            let place = match transition.priority {
                Some(p) => order.iter().position(|&i| rank(i) > p).unwrap_or(order.len()),
                None => order.len(),
            };
            order.insert(place, index);
        }
        order
    }
}
