//! Ladder diagrams (IEC 61131-3, 4.2), in the form on which all PLC IDEs agree.
//!
//! # What one means
//!
//! Rungs run from the first to the last; what one writes the next ones read. The condition of a rung
//! is a sum of products: parallel branches from the left rail, each a series of contacts. IDEs
//! differ in what they make of deeper nesting, of boxes in branches and of edge contacts, so there
//! are none. A rung may have one box, behind all contacts: an on-delay timer.
//!
//! What is no BOOL takes a rung of another form: one box with a [function](Function), computed in each
//! cycle, whose result goes to a variable. Its operands are variables and constants, so that nothing
//! depends on how an IDE orders boxes or what becomes of a box that is not enabled.

use super::number::Relation;
use super::plc::{GlobalId, Origin};
use super::sop::Sum;

/// The body of a program.
#[derive(Clone, Debug, Default)]
pub struct Ladder {
    /// The rungs, from top to bottom.
    pub rungs: Vec<Rung>,
}

/// A rung: one condition, one coil.
#[derive(Clone, Debug)]
pub struct Rung {
    /// What it does, for the reader of the PLC project.
    pub comment: String,
    /// The parallel branches. Never FALSE: a coil that nothing feeds has no rung. TRUE is a coil
    /// on the rail.
    pub condition: Sum<GlobalId>,
    /// A timer between the condition and the coil: what the coil writes is its output Q.
    pub timer: Option<Timer>,
    /// A function instead of contacts: the condition is TRUE, and `coil` takes the result as a plain
    /// coil would. Of the operands' type or BOOL, as the function demands.
    pub function: Option<Function>,
    /// What the coil writes.
    pub coil: GlobalId,
    /// How.
    pub kind: CoilKind,
    /// What it stands for in the model.
    pub origin: Origin,
}

/// A TON (IEC 61131-3, 2.5.2.3.4): its output becomes TRUE when its input has been TRUE for the preset
/// time, and FALSE with its input. An instance may be called by several rungs of its program; each
/// call counts as of the same time.
#[derive(Clone, Debug)]
pub struct Timer {
    /// The instance's name, unique in the project; it is local to the program.
    pub instance: String,
    /// The preset time in milliseconds.
    pub preset: u32,
}

impl Timer {
    /// The preset time as IEC 61131-3 writes it.
    pub fn literal(&self) -> String {
        format!("T#{}ms", self.preset)
    }
}

/// A function of IEC 61131-3 over integers of one type, and over BOOL where that is said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Which.
    pub operator: Operator,
    /// As many as it takes, in the order of its pins.
    pub operands: Vec<Operand>,
}

/// Which function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// MOVE: the operand.
    Move,
    /// ADD: the sum of two.
    Add,
    /// SUB: the first less the second.
    Subtract,
    /// LIMIT: the second, but not less than the first and not more than the third.
    Limit,
    /// SEL: if the first, which is BOOL, is FALSE, the second, else the third.
    Select,
    /// A comparison of two; the result is BOOL.
    Compare(Relation),
}

/// An operand of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    /// A constant of that type.
    Const(i64),
    /// A variable.
    Global(GlobalId),
}

impl Operator {
    /// The name of the function.
    pub fn name(self) -> &'static str {
        match self {
            Operator::Move => "MOVE",
            Operator::Add => "ADD",
            Operator::Subtract => "SUB",
            Operator::Limit => "LIMIT",
            Operator::Select => "SEL",
            Operator::Compare(Relation::Equal) => "EQ",
            Operator::Compare(Relation::Unequal) => "NE",
            Operator::Compare(Relation::Less) => "LT",
            Operator::Compare(Relation::LessOrEqual) => "LE",
            Operator::Compare(Relation::Greater) => "GT",
            Operator::Compare(Relation::GreaterOrEqual) => "GE",
        }
    }

    /// The names of its operands (IEC 61131-3, 2.5.1.5).
    pub fn pins(self) -> &'static [&'static str] {
        match self {
            Operator::Move => &["IN"],
            Operator::Add | Operator::Subtract | Operator::Compare(_) => &["IN1", "IN2"],
            Operator::Limit => &["MN", "IN", "MX"],
            Operator::Select => &["G", "IN0", "IN1"],
        }
    }
}

/// How a coil writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoilKind {
    /// `( )`: the variable becomes the condition.
    Plain,
    /// `(S)`: the variable becomes TRUE if the condition holds, else it keeps its value.
    Set,
    /// `(R)`: the variable becomes FALSE if the condition holds, else it keeps its value.
    Reset,
}

impl Ladder {
    /// Calls `f` with every global that the body mentions, repetitions included.
    pub fn for_each_global(&self, f: &mut impl FnMut(GlobalId)) {
        for rung in &self.rungs {
            for product in rung.condition.products() {
                product.literals().iter().for_each(|l| f(l.atom));
            }
            for operand in rung.function.iter().flat_map(|function| &function.operands) {
                match operand {
                    Operand::Const(_) => {}
                    Operand::Global(global) => f(*global),
                }
            }
            f(rung.coil);
        }
    }
}
