//! The safety part of a machine: what must never be, and what the filter does about it.

use super::{Atom, ConstraintId, Guard, InputId, OutputId};
use crate::base::{Arena, Span};
use crate::ir::sop::Product;

/// The safety part of a model.
#[derive(Clone, Debug, Default)]
pub struct Safety {
    /// What the filter does about a violation; nothing when the model has no constraints.
    pub mode: Option<FilterMode>,
    /// Where the mode stands.
    pub span: Span,
    /// How combined constraints are relieved.
    pub relief: Relief,
    /// Whose rising edge makes the filter forget which constraint acted first; there is one if, and only
    /// if, it remembers that.
    pub reset: Option<InputId>,
    /// What must never be, in the order in which it is written.
    pub constraints: Arena<Constraint>,
    /// What the plant cannot do.
    pub assumptions: Vec<Assumption>,
    /// What is forbidden and left to constraints that are not derived from it.
    pub unkept: Vec<Forbidden>,
}

/// A forbidden position from which no constraint is derived: words for people.
#[derive(Clone, Debug)]
pub struct Forbidden {
    /// Its name.
    pub name: String,
    /// Why it is forbidden.
    pub text: String,
    /// Where it is declared.
    pub span: Span,
}

/// What the filter does about a violation (the paper on logical constraints).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilterMode {
    /// A violation stops the machine until it is reset: commands are taken as FALSE, and outputs are
    /// what constraints make of that.
    Blocking,
    /// Outputs are corrected, the program goes on, each correction is an alarm.
    Supervisor,
    /// Outputs are corrected, and that is normal.
    Controller,
}

/// How combined constraints are relieved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Relief {
    /// In rounds, all that are violated together (the paper on logical constraints, corrected): order means nothing.
    #[default]
    Together,
    /// In sweeps, each in its turn and at once, as they are written (the paper on ITS PLC).
    InOrder {
        /// How many sweeps are made: as many as it takes at most to meet all constraints.
        sweeps: usize,
    },
}

/// What the filter remembers from scan to scan; FALSE before the first one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mark {
    /// A constraint has acted since the last reset. In [`FilterMode::Blocking`] the machine is stopped
    /// while this is TRUE.
    Noted,
    /// The constraint acted in the scan in which this began.
    First(ConstraintId),
}

/// A number that a filter with a reset keeps, for the operator; both are 0 before the first scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ScanNumber {
    /// Which scan since power-up this is: the first one is 1. After [`LAST_SCAN`] comes 1 again.
    This,
    /// In which scan began what is [noted](Mark::Noted); 0 while nothing is.
    First,
}

/// The highest number of a scan: what the type UDINT of IEC 61131-3 can hold.
pub const LAST_SCAN: u32 = u32::MAX;

/// A safety constraint: none of its products may be TRUE when the outputs are written.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its name.
    pub name: String,
    /// What it says, in words for the operator.
    pub text: String,
    /// What must never be TRUE.
    pub never: Guard,
    /// The same as it is written, or as `constraints --derive` writes it.
    pub written: String,
    /// The actuators and forbidden positions that it is derived from, each with its place; none if it is written.
    pub from: Vec<(String, Span)>,
    /// The same split into products; none contradicts itself.
    pub products: Vec<Product<Atom>>,
    /// Who gives way when a combined product would be TRUE.
    pub yields: Vec<OutputId>,
    /// Where it is declared.
    pub span: Span,
}

/// Something that the plant cannot do, over inputs, previous values and variables.
#[derive(Clone, Debug)]
pub struct Assumption {
    /// Its name.
    pub name: String,
    /// What it says in words.
    pub text: String,
    /// What is never TRUE.
    pub never: Guard,
    /// The same as it is written.
    pub written: String,
    /// The same split into products.
    pub products: Vec<Product<Atom>>,
    /// Where it is declared.
    pub span: Span,
}

/// The outputs of this scan in a product, each with whether it stands negated.
pub fn outputs_of(product: &Product<Atom>) -> impl Iterator<Item = (OutputId, bool)> + '_ {
    product.literals().iter().filter_map(|l| match l.atom {
        Atom::Output(o) => Some((o, l.negated)),
        _ => None,
    })
}

impl Safety {
    /// What the filter remembers, the stop first.
    pub fn marks(&self) -> impl Iterator<Item = Mark> + '_ {
        let any = self.reset.is_some();
        std::iter::once(Mark::Noted).chain(self.constraints.ids().map(Mark::First)).filter(move |_| any)
    }

    /// The numbers that the filter keeps: both if it remembers anything.
    pub fn scan_numbers(&self) -> impl Iterator<Item = ScanNumber> + '_ {
        [ScanNumber::This, ScanNumber::First].into_iter().filter(|_| self.reset.is_some())
    }

    /// Whether a constraint that acts is an alarm.
    pub fn alarms(&self) -> bool {
        self.mode != Some(FilterMode::Controller)
    }
}
