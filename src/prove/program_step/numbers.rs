//! Integers of a program: what is computed from them, and what cannot be encoded.
//!
//! Numbers are computed in 64 bits, wrapping, and cut when they are assigned, as
//! [`iec`](crate::ir::iec) says; narrower rows hold the same values where nothing can wrap.

use super::{ProgramStep, Refusal, Run};
use crate::bits::aig::Lit;
use crate::bits::vector::{self, Vector};
use crate::ir::iec::{Kind, Number, Relation, VarId};
use std::ops::Range;

/// In how many bits numbers are computed.
const COMPUTED: usize = 64;

/// How many latches a variable takes; nothing if it cannot be encoded.
pub fn width(kind: Kind) -> Option<usize> {
    match kind {
        Kind::Bool => Some(1),
        Kind::Int { bits, .. } => Some(usize::from(bits)),
        Kind::Time => None,
    }
}

impl ProgramStep<'_> {
    /// Where the bits of an integer variable stand among the latches, the lowest first.
    pub fn integer(&self, id: VarId) -> Option<Range<usize>> {
        let kind = self.project.variables[id].kind;
        let first = self.variables[id.index()].filter(|_| matches!(kind, Kind::Int { .. }))?;
        Some(first..first + width(kind)?)
    }
}

impl Run<'_, '_> {
    /// Assigns a number if `run`.
    pub fn move_number(&mut self, to: VarId, number: &Number, run: Lit) {
        let bits = self.step.integer(to).expect("what is no integer has been refused");
        let value = vector::fit(&self.number(number), bits.len());
        for (latch, value) in bits.zip(value) {
            self.assign(latch, run, value);
        }
    }

    /// Whether a comparison holds.
    pub fn compare(&mut self, relation: Relation, left: &Number, right: &Number) -> Lit {
        let (left, right) = (self.number(left), self.number(right));
        match relation {
            Relation::Equal => vector::equal(self.aig, &left, &right),
            Relation::Unequal => !vector::equal(self.aig, &left, &right),
            Relation::Less => vector::less(self.aig, &left, &right),
            Relation::GreaterOrEqual => !vector::less(self.aig, &left, &right),
            Relation::Greater => vector::less(self.aig, &right, &left),
            Relation::LessOrEqual => !vector::less(self.aig, &right, &left),
        }
    }

    fn number(&mut self, number: &Number) -> Vector {
        let mut value = match number {
            Number::Const(n) => vector::constant(*n),
            Number::Variable(id) => self.integer(*id),
            Number::Negative(n) => {
                let n = self.number(n);
                vector::subtract(self.aig, &vector::constant(0), &n)
            }
            Number::Sum(left, right) => {
                let (left, right) = (self.number(left), self.number(right));
                vector::add(self.aig, &left, &right)
            }
            Number::Difference(left, right) => {
                let (left, right) = (self.number(left), self.number(right));
                vector::subtract(self.aig, &left, &right)
            }
            Number::Limit { lowest, value, highest } => {
                let value = self.number(value);
                let (lowest, highest) = (vector::constant(*lowest), vector::constant(*highest));
                let above = vector::less(self.aig, &highest, &value);
                let value = vector::select(self.aig, above, &highest, &value);
                let below = vector::less(self.aig, &value, &lowest);
                vector::select(self.aig, below, &lowest, &value)
            }
            Number::Select { by, no, yes } => {
                let by = self.state[self.variable(*by)];
                let (no, yes) = (self.number(no), self.number(yes));
                vector::select(self.aig, by, &yes, &no)
            }
            Number::StepTime(_) | Number::Elapsed(_) => unreachable!("times have been refused"),
        };
        value.truncate(COMPUTED);
        value
    }

    /// The value of an integer variable.
    fn integer(&self, id: VarId) -> Vector {
        let bits = self.step.integer(id).expect("what is no integer has been refused");
        let mut value = self.state[bits].to_vec();
        if let Kind::Int { signed: false, .. } = self.step.project.variables[id].kind
            && value.len() < COMPUTED
        {
            value.push(Lit::FALSE);
        }
        value
    }
}

impl Refusal<'_> {
    pub fn number(&self, number: &Number) -> Result<(), String> {
        match number {
            Number::Const(_) => Ok(()),
            Number::Variable(id) => self.integer(*id),
            Number::Negative(n) => self.number(n),
            Number::Limit { value, .. } => self.number(value),
            Number::Sum(left, right) | Number::Difference(left, right) => {
                self.number(left)?;
                self.number(right)
            }
            Number::Select { by, no, yes } => {
                self.variable(*by)?;
                self.number(no)?;
                self.number(yes)
            }
            Number::StepTime(_) | Number::Elapsed(_) => self.because("a time"),
        }
    }

    pub fn integer(&self, id: VarId) -> Result<(), String> {
        match self.project.variables[id].kind {
            Kind::Int { .. } => Ok(()),
            Kind::Bool | Kind::Time => self.because("a time"),
        }
    }
}
