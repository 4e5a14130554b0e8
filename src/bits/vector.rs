//! Integers as rows of literals: two's complement, the lowest bit first, the last bit the sign.
//!
//! A row is as wide as its value needs, so nothing here overflows: a sum is one bit wider than its
//! wider operand. Whoever means a type of fixed width [fits](fit) the result into it.

use super::aig::{Aig, Lit};

/// An integer; at least one bit.
pub type Vector = Vec<Lit>;

/// The constant, as narrow as can be.
pub fn constant(value: i64) -> Vector {
    let width = 65 - if value < 0 { value.leading_ones() } else { value.leading_zeros() };
    (0..width.min(64)).map(|i| Lit::of(value >> i & 1 == 1)).collect()
}

/// The same value in `width` bits if it fits; otherwise its lowest bits, as an assignment keeps them.
pub fn fit(vector: &[Lit], width: usize) -> Vector {
    let sign = sign(vector);
    (0..width).map(|i| vector.get(i).copied().unwrap_or(sign)).collect()
}

/// Whether it is negative.
pub fn sign(vector: &[Lit]) -> Lit {
    vector.last().copied().unwrap_or(Lit::FALSE)
}

/// The sum.
pub fn add(aig: &mut Aig, left: &[Lit], right: &[Lit]) -> Vector {
    with_carry(aig, left, right, Lit::FALSE)
}

/// The difference.
pub fn subtract(aig: &mut Aig, left: &[Lit], right: &[Lit]) -> Vector {
    let opposite: Vector = right.iter().map(|&l| !l).collect();
    with_carry(aig, left, &opposite, Lit::TRUE)
}

fn with_carry(aig: &mut Aig, left: &[Lit], right: &[Lit], mut carry: Lit) -> Vector {
    let width = left.len().max(right.len()) + 1;
    let mut sum = Vec::with_capacity(width);
    for (l, r) in fit(left, width).into_iter().zip(fit(right, width)) {
        let differ = aig.xor(l, r);
        sum.push(aig.xor(differ, carry));
        carry = aig.select(differ, carry, l);
    }
    sum
}

/// Whether the first is less than the second.
pub fn less(aig: &mut Aig, left: &[Lit], right: &[Lit]) -> Lit {
    sign(&subtract(aig, left, right))
}

/// Whether both are the same.
pub fn equal(aig: &mut Aig, left: &[Lit], right: &[Lit]) -> Lit {
    let width = left.len().max(right.len());
    let each: Vec<Lit> = fit(left, width).into_iter().zip(fit(right, width)).map(|(l, r)| aig.equal(l, r)).collect();
    aig.all(&each)
}

/// `then` if `condition`, else `otherwise`.
pub fn select(aig: &mut Aig, condition: Lit, then: &[Lit], otherwise: &[Lit]) -> Vector {
    let width = then.len().max(otherwise.len());
    fit(then, width).into_iter().zip(fit(otherwise, width)).map(|(t, o)| aig.select(condition, t, o)).collect()
}

/// The value of bits, the lowest first, the last the sign; at most 64.
pub fn value(bits: impl DoubleEndedIterator<Item = bool>) -> i64 {
    let mut bits = bits.rev();
    let sign = if bits.next() == Some(true) { -1 } else { 0 };
    bits.fold(sign, |value, bit| value << 1 | i64::from(bit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The value of a row of constants.
    fn read(vector: &[Lit]) -> i64 {
        value(vector.iter().map(|l| l.constant().expect("all is constant")))
    }

    proptest! {
        #[test]
        fn rows_compute_what_integers_do(a in -40_000i64..40_000, b in -300i64..300, width in 1usize..20) {
            let aig = &mut Aig::new();
            let (x, y) = (constant(a), constant(b));
            prop_assert_eq!(read(&x), a);
            prop_assert_eq!(read(&add(aig, &x, &y)), a + b);
            prop_assert_eq!(read(&subtract(aig, &x, &y)), a - b);
            prop_assert_eq!(less(aig, &x, &y), Lit::of(a < b));
            prop_assert_eq!(equal(aig, &x, &y), Lit::of(a == b));
            prop_assert_eq!(equal(aig, &x, &fit(&x, 30)), Lit::TRUE);
            prop_assert_eq!(read(&select(aig, Lit::TRUE, &x, &y)), a);
            prop_assert_eq!(read(&fit(&x, width)), a << (64 - width) >> (64 - width));
        }
    }

    #[test]
    fn bounds_of_64_bits_are_constants() {
        for n in [i64::MIN, i64::MAX, 0, -1] {
            assert_eq!(read(&constant(n)), n);
        }
        assert_eq!((constant(0).len(), constant(-1).len(), constant(1).len()), (1, 1, 2));
    }
}
