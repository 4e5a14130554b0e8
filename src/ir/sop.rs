//! Sums of products: the form in which ladder rungs and safety constraints are written.

use super::expr::Expr;
use std::fmt::Debug;

/// An atom or its negation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Literal<A> {
    /// What is read.
    pub atom: A,
    /// Whether its opposite is meant.
    pub negated: bool,
}

/// A conjunction of literals, without repetitions and without contradiction, in order of first
/// mention. Without literals it is TRUE.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Product<A> {
    literals: Vec<Literal<A>>,
}

impl<A: Copy + Eq + Debug> Product<A> {
    /// The product without literals: TRUE.
    pub const fn one() -> Self {
        Product { literals: Vec::new() }
    }

    /// The literals, in order of first mention.
    pub fn literals(&self) -> &[Literal<A>] {
        &self.literals
    }

    /// The product of both, or nothing if it is contradictory.
    pub fn times(&self, other: &Product<A>) -> Option<Product<A>> {
        let mut literals = self.literals.clone();
        for &l in &other.literals {
            match literals.iter().find(|m| m.atom == l.atom) {
                Some(m) if m.negated == l.negated => {}
                Some(_) => return None,
                None => literals.push(l),
            }
        }
        Some(Product { literals })
    }

    /// Whether every literal of `other` is one of `self`, so that `self` implies `other`.
    pub fn implies(&self, other: &Product<A>) -> bool {
        other.literals.iter().all(|l| self.literals.contains(l))
    }

    /// The literal on `atom`, if there is one.
    pub fn literal(&self, atom: A) -> Option<Literal<A>> {
        self.literals.iter().copied().find(|l| l.atom == atom)
    }

    /// The product of those literals that `keep` accepts.
    #[must_use]
    pub fn retain(&self, keep: impl Fn(A) -> bool) -> Product<A> {
        Product { literals: self.literals.iter().copied().filter(|l| keep(l.atom)).collect() }
    }
}

impl<A: Copy + Eq + Debug> FromIterator<Literal<A>> for Option<Product<A>> {
    /// The product of the literals, or nothing if they contradict each other.
    fn from_iter<I: IntoIterator<Item = Literal<A>>>(literals: I) -> Self {
        literals.into_iter().try_fold(Product::one(), |p, l| p.times(&Product { literals: vec![l] }))
    }
}

/// A disjunction of products; without products it is FALSE. As long as it is short
/// ([`ABSORBED`]), no product implies another.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Sum<A> {
    products: Vec<Product<A>>,
}

/// Longest sum that is searched for products that imply each other: the search is quadratic.
pub const ABSORBED: usize = 64;

impl<A: Copy + Eq + Debug> Sum<A> {
    /// The sum without products: FALSE.
    pub const fn zero() -> Self {
        Sum { products: Vec::new() }
    }

    /// The sum of the one product TRUE.
    pub fn one() -> Self {
        Sum { products: vec![Product::one()] }
    }

    /// The products, in order of first mention.
    pub fn products(&self) -> &[Product<A>] {
        &self.products
    }

    /// Whether it is FALSE whatever the atoms are.
    pub fn is_zero(&self) -> bool {
        self.products.is_empty()
    }

    /// Whether one product is TRUE whatever the atoms are.
    pub fn is_one(&self) -> bool {
        self.products.iter().any(|p| p.literals.is_empty())
    }

    /// Adds a product unless one that it implies is there; drops those that imply it.
    pub fn add(&mut self, product: Product<A>) {
        if self.products.len() <= ABSORBED {
            if self.products.iter().any(|p| product.implies(p)) {
                return;
            }
            self.products.retain(|p| !p.implies(&product));
        }
        self.products.push(product);
    }

    /// `expr` as a sum of products, or nothing when more than `limit` products arise on the way.
    pub fn of(expr: &Expr<A>, limit: usize) -> Option<Sum<A>> {
        Self::convert(expr, false, limit)
    }

    fn convert(expr: &Expr<A>, negated: bool, limit: usize) -> Option<Sum<A>> {
        let sum = match expr {
            Expr::Const(c) => {
                if *c != negated {
                    Sum::one()
                } else {
                    Sum::zero()
                }
            }
            Expr::Atom(a) => Sum { products: vec![Product { literals: vec![Literal { atom: *a, negated }] }] },
            Expr::Not(e) => return Self::convert(e, !negated, limit),
            Expr::Or(es) if !negated => Self::union(es.iter().map(|e| Self::convert(e, negated, limit)), limit)?,
            Expr::And(es) if negated => Self::union(es.iter().map(|e| Self::convert(e, negated, limit)), limit)?,
            Expr::And(es) | Expr::Or(es) => {
                let mut all = Sum::one();
                for e in es {
                    all = Self::times(&all, &Self::convert(e, negated, limit)?, limit)?;
                }
                all
            }
            Expr::Xor(l, r) => {
                let left = Self::times(&Self::convert(l, false, limit)?, &Self::convert(r, !negated, limit)?, limit)?;
                let right = Self::times(&Self::convert(l, true, limit)?, &Self::convert(r, negated, limit)?, limit)?;
                Self::union([Some(left), Some(right)].into_iter(), limit)?
            }
        };
        (sum.products.len() <= limit).then_some(sum)
    }

    fn union(parts: impl Iterator<Item = Option<Sum<A>>>, limit: usize) -> Option<Sum<A>> {
        let mut all = Sum::zero();
        for part in parts {
            for p in part?.products {
                all.add(p);
                if all.products.len() > limit {
                    return None;
                }
            }
        }
        Some(all)
    }

    fn times(left: &Sum<A>, right: &Sum<A>, limit: usize) -> Option<Sum<A>> {
        let mut all = Sum::zero();
        for l in &left.products {
            for r in &right.products {
                if let Some(p) = l.times(r) {
                    all.add(p);
                    if all.products.len() > limit {
                        return None;
                    }
                }
            }
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn expressions() -> impl Strategy<Value = Expr<u8>> {
        let leaf = prop_oneof![(0u8..5).prop_map(Expr::Atom), any::<bool>().prop_map(Expr::Const)];
        leaf.prop_recursive(4, 24, 3, |inner| {
            prop_oneof![
                inner.clone().prop_map(|e| Expr::Not(Box::new(e))),
                prop::collection::vec(inner.clone(), 0..4).prop_map(Expr::And),
                prop::collection::vec(inner.clone(), 0..4).prop_map(Expr::Or),
                (inner.clone(), inner).prop_map(|(a, b)| Expr::Xor(Box::new(a), Box::new(b))),
            ]
        })
    }

    proptest! {
        #[test]
        fn a_sum_means_what_the_expression_means(e in expressions()) {
            let sum = Sum::of(&e, 10_000).unwrap();
            for bits in 0u8..32 {
                let value = |a: u8| bits >> a & 1 == 1;
                let of_sum = sum.products().iter().any(|p| p.literals().iter().all(|l| value(l.atom) != l.negated));
                prop_assert_eq!(of_sum, e.eval(&mut |a| value(*a)));
            }
        }
    }
}
