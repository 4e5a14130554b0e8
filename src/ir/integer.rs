//! Integers of a machine, and what is assigned to them.

use super::chart::{ComparisonId, IntegerId, Machine};
use super::number::{Number, Range};
use crate::base::Span;

/// A variable of type INT that never leaves its range.
#[derive(Clone, Debug)]
pub struct Integer {
    /// Its name.
    pub name: String,
    /// What it can be; within the type INT.
    pub range: Range,
    /// Its value before the first scan; within the range.
    pub initial: i64,
    /// What it counts.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// An integer that takes a value once, when what it belongs to happens. What would leave its range
/// stops at the bound.
#[derive(Clone, Debug)]
pub struct Assignment {
    /// The integer.
    pub integer: IntegerId,
    /// What it becomes; read from before the step. No part of it can leave the type INT.
    pub value: Number<IntegerId>,
    /// Where it is written.
    pub span: Span,
}

impl Machine {
    /// A comparison, as a model writes it.
    pub fn comparison(&self, comparison: ComparisonId) -> String {
        let mut out = String::new();
        let written = self.comparisons[comparison].write(&mut out, &mut |&i, f| f.write_str(&self.integers[i].name));
        written.expect("writing to a string succeeds");
        out
    }

    /// An integer expression, as a model writes it.
    pub fn number(&self, number: &Number<IntegerId>) -> String {
        let mut out = String::new();
        let written = number.write(&mut out, &mut |&i, f| f.write_str(&self.integers[i].name));
        written.expect("writing to a string succeeds");
        out
    }
}
