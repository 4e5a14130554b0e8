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

/// A number, and whether a part of it has left the type of the expression.
struct Computed {
    value: Vector,
    leaves: Lit,
}

impl Computed {
    fn whole(value: Vector) -> Self {
        Computed { value, leaves: Lit::FALSE }
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
        let kind = self.step.project.variables[to].kind;
        let computed = self.number(number, Some(kind));
        let leaves = self.aig.and(run, computed.leaves);
        let step = self.step;
        self.note(leaves, || format!("what {} becomes", step.project.variables[to].name));
        let value = vector::fit(&computed.value, bits.len());
        for (latch, value) in bits.zip(value) {
            self.assign(latch, run, value);
        }
    }

    /// Whether a comparison holds.
    pub fn compare(&mut self, relation: Relation, left: &Number, right: &Number) -> Lit {
        let kind = self.kind(left).or_else(|| self.kind(right));
        let (left, right) = (self.number(left, kind), self.number(right, kind));
        let leaves = self.aig.or(left.leaves, right.leaves);
        let (step, program) = (self.step, self.program);
        self.note(leaves, || format!("a comparison in {}", step.project.programs[program].kind));
        let (left, right) = (left.value, right.value);
        match relation {
            Relation::Equal => vector::equal(self.aig, &left, &right),
            Relation::Unequal => !vector::equal(self.aig, &left, &right),
            Relation::Less => vector::less(self.aig, &left, &right),
            Relation::GreaterOrEqual => !vector::less(self.aig, &left, &right),
            Relation::Greater => vector::less(self.aig, &right, &left),
            Relation::LessOrEqual => !vector::less(self.aig, &right, &left),
        }
    }

    /// The type of the first variable in a number.
    fn kind(&self, number: &Number) -> Option<Kind> {
        match number {
            Number::Const(_) | Number::StepTime(_) | Number::Elapsed(_) => None,
            Number::Variable(id) => Some(self.step.project.variables[*id].kind),
            Number::Negative(n) => self.kind(n),
            Number::Limit { value, .. } => self.kind(value),
            Number::Sum(left, right) | Number::Difference(left, right) => self.kind(left).or_else(|| self.kind(right)),
            Number::Select { no, yes, .. } => self.kind(no).or_else(|| self.kind(yes)),
        }
    }

    /// Tells who asks where a number leaves its type.
    fn note(&mut self, leaves: Lit, what: impl Fn() -> String) {
        if leaves != Lit::FALSE {
            let what = what();
            if let Some(sums) = &mut self.sums {
                sums.push((what, leaves));
            }
        }
    }

    /// A number of an expression of that type.
    fn number(&mut self, number: &Number, kind: Option<Kind>) -> Computed {
        let mut computed = match number {
            Number::Const(n) => Computed::whole(vector::constant(*n)),
            Number::Variable(id) => Computed::whole(self.integer(*id)),
            Number::Negative(n) => {
                let n = self.number(n, kind);
                let value = vector::subtract(self.aig, &vector::constant(0), &n.value);
                self.sum(value, n.leaves, kind)
            }
            Number::Sum(left, right) | Number::Difference(left, right) => {
                let (left, right) = (self.number(left, kind), self.number(right, kind));
                let value = match number {
                    Number::Sum(..) => vector::add(self.aig, &left.value, &right.value),
                    _ => vector::subtract(self.aig, &left.value, &right.value),
                };
                let leaves = self.aig.or(left.leaves, right.leaves);
                self.sum(value, leaves, kind)
            }
            Number::Limit { lowest, value, highest } => {
                let Computed { value, leaves } = self.number(value, kind);
                let (lowest, highest) = (vector::constant(*lowest), vector::constant(*highest));
                let above = vector::less(self.aig, &highest, &value);
                let value = vector::select(self.aig, above, &highest, &value);
                let below = vector::less(self.aig, &value, &lowest);
                Computed { value: vector::select(self.aig, below, &lowest, &value), leaves }
            }
            Number::Select { by, no, yes } => {
                let by = self.state[self.variable(*by)];
                let (no, yes) = (self.number(no, kind), self.number(yes, kind));
                let leaves = self.aig.select(by, yes.leaves, no.leaves);
                Computed { value: vector::select(self.aig, by, &yes.value, &no.value), leaves }
            }
            Number::StepTime(_) | Number::Elapsed(_) => unreachable!("times have been refused"),
        };
        computed.value.truncate(COMPUTED);
        computed
    }

    /// The result of a computation in that type.
    fn sum(&mut self, value: Vector, leaves: Lit, kind: Option<Kind>) -> Computed {
        let (Some(Kind::Int { bits, signed }), true) = (kind, self.sums.is_some()) else {
            return Computed { value, leaves };
        };
        // All bits from there on are the sign, which there is only among signed integers.
        let first = usize::from(bits) - usize::from(signed);
        let sign = value.last().copied().unwrap_or(Lit::FALSE);
        let expected = if signed { sign } else { Lit::FALSE };
        let beyond = value.iter().copied().skip(first.min(value.len().saturating_sub(1)));
        let wrong: Vec<Lit> = beyond.map(|bit| self.aig.xor(bit, expected)).collect();
        let wrong = self.aig.any(&wrong);
        let leaves = self.aig.or(leaves, wrong);
        Computed { value, leaves }
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
