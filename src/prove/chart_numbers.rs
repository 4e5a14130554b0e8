//! What a chart counts, as rows of bits.

use super::chart_filter::Filtered;
use super::parts::{SCAN_WIDTH, WIDTH};
use crate::bits::aig::{Aig, Lit};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{IntegerId, LAST_SCAN, Machine};
use crate::ir::number::{Comparison, Number, Relation};

/// The integers at power-up.
pub fn initial(machine: &Machine) -> Vec<Vector> {
    machine.integers.values().map(|i| vector::fit(&vector::constant(i.initial), usize::from(WIDTH))).collect()
}

/// The value of an expression over `integers`. No part of one leaves the type INT, so it does not matter
/// that rows grow.
pub fn number(aig: &mut Aig, number: &Number<IntegerId>, integers: &[Vector]) -> Vector {
    number_of(aig, number, &|i: &IntegerId| integers[i.index()].clone())
}

/// The value of an expression when `value` gives that of each of its parts.
pub fn number_of<A>(aig: &mut Aig, number: &Number<A>, value: &impl Fn(&A) -> Vector) -> Vector {
    match number {
        Number::Const(n) => vector::constant(*n),
        Number::Value(a) => value(a),
        Number::Sum(operands) => operands.iter().fold(vector::constant(0), |sum, operand| {
            let value = number_of(aig, &operand.value, value);
            if operand.negative { vector::subtract(aig, &sum, &value) } else { vector::add(aig, &sum, &value) }
        }),
    }
}

/// A comparison of what stands in `integers`.
pub fn compare(aig: &mut Aig, comparison: &Comparison<IntegerId>, integers: &[Vector]) -> Lit {
    compare_of(aig, comparison, &|i: &IntegerId| integers[i.index()].clone())
}

/// A comparison when `value` gives the value of each of its parts.
pub fn compare_of<A>(aig: &mut Aig, comparison: &Comparison<A>, value: &impl Fn(&A) -> Vector) -> Lit {
    let (left, right) = (number_of(aig, &comparison.left, value), number_of(aig, &comparison.right, value));
    let difference = vector::subtract(aig, &left, &right);
    let (negative, zero) = (vector::sign(&difference), !aig.any(&difference));
    match comparison.relation {
        Relation::Equal => zero,
        Relation::Unequal => !zero,
        Relation::Less => negative,
        Relation::LessOrEqual => aig.or(negative, zero),
        Relation::Greater => !aig.or(negative, zero),
        Relation::GreaterOrEqual => !negative,
    }
}

/// The number of no scan.
pub fn no_scan() -> Vector {
    vec![Lit::FALSE; usize::from(SCAN_WIDTH)]
}

/// The numbers that the filter keeps after a scan: which one it is, and in which one began what is noted.
/// Nothing if they were not kept before.
pub fn scans(aig: &mut Aig, before: &[Vector], filtered: &Filtered) -> Vec<Vector> {
    let ([this, first], [noted, ..]) = (before, filtered.marks.as_slice()) else { return Vec::new() };
    let width = usize::from(SCAN_WIDTH);
    // They have no sign.
    let this: Vector = this.iter().copied().chain([Lit::FALSE]).collect();
    let last = vector::equal(aig, &this, &vector::constant(i64::from(LAST_SCAN)));
    let more = vector::add(aig, &this, &vector::constant(1));
    let next = vector::select(aig, last, &vector::constant(1), &more);
    let now = vector::select(aig, *noted, &next, &vector::constant(0));
    let kept: Vector = first.iter().copied().chain([Lit::FALSE]).collect();
    let first = vector::select(aig, filtered.held, &kept, &now);
    [next, first].map(|number| vector::fit(&number, width)).into()
}
