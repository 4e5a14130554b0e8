//! Ladder diagrams (IEC 61131-3, 4.2), in the form on which all PLC IDEs agree.
//!
//! # What one means
//!
//! Rungs run from the first to the last; what one writes the next ones read. The condition of a rung
//! is a sum of products: parallel branches from the left rail, each a series of contacts. IDEs
//! differ in what they make of deeper nesting, of boxes in branches and of edge contacts, so there
//! are none. A rung may have one box, behind all contacts: an on-delay timer.

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
            f(rung.coil);
        }
    }
}
