//! Whether integers are computed alike wherever a program runs.
//!
//! Tools differ in how wide they compute, in what becomes of a sum that does not fit, and in what they make
//! of types that meet. So there is one type in an expression, constants are of that type, and where it
//! matters how wide a sum is, it is one of signed integers so narrow that it fits in every tool.

use crate::base::Arena;
use crate::ir::expr::Expr;
use crate::ir::iec::{Atom, Body, Call, Condition, Kind, Number, Relation, Statement, Variable};

/// What is computed in a way that depends on the tool, if anything is.
pub fn objection(body: &Body, variables: &Arena<Variable>) -> Option<String> {
    let check = Check { variables };
    match body {
        Body::Code(statements) => check.statements(statements),
        Body::Sfc(sfc) => {
            let transitions = sfc.transitions.iter().try_for_each(|t| check.condition(&t.condition));
            transitions.and_then(|()| sfc.actions.values().try_for_each(|a| check.statements(&a.body)))
        }
    }
    .err()
}

struct Check<'v> {
    variables: &'v Arena<Variable>,
}

/// What an expression is made of.
#[derive(Default)]
struct Found {
    kind: Option<Kind>,
    constants: Vec<i64>,
    computes: bool,
}

impl Check<'_> {
    fn statements(&self, statements: &[Statement]) -> Result<(), String> {
        statements.iter().try_for_each(|statement| match statement {
            Statement::Coil(coil) => self.condition(&coil.condition),
            Statement::Call(Call { input, reset, .. }) => {
                input.iter().chain(reset).try_for_each(|condition| self.condition(condition))
            }
            Statement::Move { to, value } => {
                // What is cut to its type is the same however wide it was, unless a bound has looked at it.
                let mut found = Found { kind: Some(self.variables[*to].kind), ..Found::default() };
                self.number(value, &mut found)?;
                found.fits()
            }
        })
    }

    fn condition(&self, condition: &Condition) -> Result<(), String> {
        let mut result = Ok(());
        for value in condition.shared.iter().chain([&condition.value]) {
            self.value(value, &mut result);
        }
        result
    }

    fn value(&self, value: &Expr<Atom>, result: &mut Result<(), String>) {
        value.for_each_atom(&mut |atom| {
            if let Atom::Compare(relation, left, right) = atom
                && result.is_ok()
            {
                *result = self.comparison(*relation, left, right);
            }
        });
    }

    fn comparison(&self, relation: Relation, left: &Number, right: &Number) -> Result<(), String> {
        let mut found = Found::default();
        self.number(left, &mut found)?;
        self.number(right, &mut found)?;
        found.fits()?;
        let ordered = !matches!(relation, Relation::Equal | Relation::Unequal);
        found.seen_whole(ordered)
    }

    fn number(&self, number: &Number, found: &mut Found) -> Result<(), String> {
        match number {
            Number::Const(n) => {
                found.constants.push(*n);
                Ok(())
            }
            Number::Variable(id) => found.meets(self.variables[*id].kind),
            Number::StepTime(_) | Number::Elapsed(_) => found.meets(Kind::Time),
            Number::Negative(n) => {
                found.computes = true;
                self.number(n, found)
            }
            Number::Sum(left, right) | Number::Difference(left, right) => {
                found.computes = true;
                self.number(left, found)?;
                self.number(right, found)
            }
            Number::Limit { lowest, value, highest } => {
                found.constants.extend([*lowest, *highest]);
                let mut inner = Found { kind: found.kind, ..Found::default() };
                self.number(value, &mut inner)?;
                inner.seen_whole(true)?;
                found.kind = inner.kind;
                found.constants.append(&mut inner.constants);
                Ok(())
            }
            Number::Select { by: _, no, yes } => {
                self.number(no, found)?;
                self.number(yes, found)
            }
        }
    }
}

impl Found {
    fn meets(&mut self, kind: Kind) -> Result<(), String> {
        match self.kind.replace(kind) {
            Some(other) if other != kind => Err("integers of different types in one expression".to_owned()),
            Some(_) | None => Ok(()),
        }
    }

    fn fits(&self) -> Result<(), String> {
        match (self.kind, self.constants.iter().find(|n| self.kind.is_some_and(|kind| !kind.holds(**n)))) {
            (Some(_), Some(n)) => Err(format!("the constant {n}, which is not of the type of the expression")),
            _ => Ok(()),
        }
    }

    /// Whether a value that is looked at before it is cut is the same in all tools.
    fn seen_whole(&self, ordered: bool) -> Result<(), String> {
        match self.kind {
            Some(Kind::Int { bits, signed }) if self.computes && (bits > 16 || !signed) => {
                Err("a comparison of a sum that is wider than INT or has no sign".to_owned())
            }
            Some(Kind::Int { bits: 64, signed: false }) if ordered => {
                Err("an order of integers of type ULINT".to_owned())
            }
            Some(_) | None => Ok(()),
        }
    }
}
