//! Integers, their sums and comparisons, to those of the syntax tree.

use super::Rule;
use super::build::{name, span};
use crate::base::Span;
use crate::ir::ast::{Name, VariableKind};
use crate::ir::number::{Comparison, Number, Operand, Relation};
use pest::iterators::Pair;

/// A comparison.
pub fn comparison(p: Pair<'_, Rule>) -> Comparison<Name> {
    let (mut sums, mut relation) = (Vec::with_capacity(2), Relation::Equal);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::sum => sums.push(sum(p)),
            _ => relation = Relation::ALL.into_iter().find(|r| r.symbol() == p.as_str()).unwrap_or(relation),
        }
    }
    let (right, left) = (sums.pop(), sums.pop());
    let (left, right) = left.zip(right).expect("a comparison has two sides");
    Comparison { left, relation, right }
}

/// An integer's range, without a value to begin with.
pub fn range(p: Pair<'_, Rule>) -> VariableKind {
    let span = span(&p);
    let mut ends = p.into_inner().filter(|p| p.as_rule() == Rule::integer).map(|p| integer(p).0);
    let mut end = || ends.next().expect("a range has two ends");
    let (lowest, highest) = (end(), end());
    VariableKind::Integer { lowest, highest, initial: None, span }
}

/// An integer and where it stands; what is too large is as large as can be.
pub fn integer(p: Pair<'_, Rule>) -> (i64, Span) {
    let span = span(&p);
    let (mut negative, mut value) = (false, 0);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::minus => negative = true,
            _ => value = p.as_str().parse().unwrap_or(i64::MAX),
        }
    }
    (if negative { -value } else { value }, span)
}

/// An integer expression; recursion is bounded by the nesting limit of parentheses.
pub fn sum(p: Pair<'_, Rule>) -> Number<Name> {
    let mut operands: Vec<Operand<Name>> = Vec::new();
    let (mut negative, mut minus) = (false, false);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::sign => negative = p.as_str() == "-",
            Rule::minus => minus = true,
            Rule::factor => {
                let value = match (factor(p), std::mem::take(&mut minus)) {
                    (Number::Const(n), true) => Number::Const(-n),
                    (value, true) if operands.is_empty() => {
                        negative = true;
                        value
                    }
                    (value, true) => Number::Sum(vec![Operand { negative: true, value }]),
                    (value, false) => value,
                };
                operands.push(Operand { negative: std::mem::take(&mut negative), value });
            }
            _ => {}
        }
    }
    match operands.as_slice() {
        [Operand { negative: false, .. }] => operands.remove(0).value,
        _ => Number::Sum(operands),
    }
}

fn factor(p: Pair<'_, Rule>) -> Number<Name> {
    let inner = p.into_inner().next().expect("a factor holds something");
    match inner.as_rule() {
        Rule::number => Number::Const(inner.as_str().parse().unwrap_or(i64::MAX)),
        Rule::sum => sum(inner),
        _ => Number::Value(name(inner)),
    }
}
