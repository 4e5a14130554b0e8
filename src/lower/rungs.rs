//! Conditions to rungs: sums of products, with auxiliary coils where a sum would grow too long.

use super::context::{Condition, Context};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Rung, Timer};
use crate::ir::plc::{GlobalId, Origin};
use crate::ir::sop::{Literal, Product, Sum};

/// Most products that multiplying out a conjunction may make; beyond it, its factors become
/// auxiliary coils. A disjunction as it is written may be longer.
const PRODUCTS: usize = 16;

/// Appends the rung that writes `condition` to `coil`, preceded by rungs for what it has to be split
/// into. A plain coil that would never be TRUE has no rung: its variable stays FALSE.
pub fn rung(
    context: &mut Context<'_>,
    rungs: &mut Vec<Rung>,
    (coil, kind): (GlobalId, CoilKind),
    condition: &Condition,
    comment: String,
) {
    let mut writer = Writer { context, rungs, coil, parts: 0 };
    let sum = writer.sum(condition, false);
    if !sum.is_zero() {
        let origin = context.globals[coil].origin;
        rungs.push(Rung { comment, condition: sum, timer: None, function: None, coil, kind, origin });
    }
}

/// Appends a rung with a timer, whose condition is one product.
pub fn timer(
    context: &mut Context<'_>,
    rungs: &mut Vec<Rung>,
    coil: GlobalId,
    timer: Timer,
    condition: &Condition,
    comment: String,
) {
    let before = rungs.len();
    rung(context, rungs, (coil, CoilKind::Plain), condition, comment);
    debug_assert_eq!(rungs.len(), before + 1, "a product needs no auxiliary coil and is not FALSE");
    if let Some(rung) = rungs.last_mut() {
        rung.timer = Some(timer);
    }
}

struct Writer<'w, 'm> {
    context: &'w mut Context<'m>,
    rungs: &'w mut Vec<Rung>,
    coil: GlobalId,
    parts: usize,
}

impl Writer<'_, '_> {
    /// Recursion is bounded by the depth of conditions, which the nesting limit bounds.
    fn sum(&mut self, e: &Condition, negated: bool) -> Sum<GlobalId> {
        match e {
            Expr::Const(c) if *c != negated => Sum::one(),
            Expr::Const(_) => Sum::zero(),
            Expr::Atom(a) => literal(*a, negated),
            Expr::Not(e) => self.sum(e, !negated),
            Expr::And(es) if negated => self.union(es, negated),
            Expr::Or(es) if !negated => self.union(es, negated),
            Expr::And(es) | Expr::Or(es) => {
                let factors = es.iter().map(|e| self.sum(e, negated)).collect();
                self.product(factors)
            }
            Expr::Xor(l, r) => {
                let (l, r) = (self.single(l), self.single(r));
                let mut sum = product_of(&literal_of(l, false), &literal_of(r, !negated));
                product_of(&literal_of(l, true), &literal_of(r, negated))
                    .products()
                    .iter()
                    .for_each(|p| sum.add(p.clone()));
                sum
            }
        }
    }

    fn union(&mut self, es: &[Condition], negated: bool) -> Sum<GlobalId> {
        let mut all = Sum::zero();
        for e in es {
            for p in self.sum(e, negated).products() {
                all.add(p.clone());
            }
        }
        all
    }

    fn product(&mut self, mut factors: Vec<Sum<GlobalId>>) -> Sum<GlobalId> {
        let size = |fs: &[Sum<GlobalId>]| fs.iter().fold(1usize, |n, f| n.saturating_mul(f.products().len()));
        while size(&factors) > PRODUCTS {
            let widest =
                (0..factors.len()).max_by_key(|&i| factors[i].products().len()).expect("a product has factors");
            if factors[widest].products().len() == 1 {
                break;
            }
            let part = std::mem::replace(&mut factors[widest], Sum::zero());
            factors[widest] = self.part(part);
        }
        factors.iter().fold(Sum::one(), |all, f| product_of(&all, f))
    }

    /// One literal that means `e`.
    fn single(&mut self, e: &Condition) -> Result<Literal<GlobalId>, bool> {
        let sum = self.sum(e, false);
        let sum = match sum.products() {
            [] => return Err(false),
            [p] if p.literals().is_empty() => return Err(true),
            [p] if p.literals().len() == 1 => return Ok(p.literals()[0]),
            _ => self.part(sum),
        };
        Ok(sum.products()[0].literals()[0])
    }

    /// An auxiliary coil for `sum`.
    fn part(&mut self, sum: Sum<GlobalId>) -> Sum<GlobalId> {
        self.parts += 1;
        let whole = &self.context.globals[self.coil];
        let (role, origin, description) = (whole.role, whole.origin, format!("part {} of {}", self.parts, whole.name));
        let name = whole.name.clone();
        let name = self.context.names.give(&format!("Part{}", self.parts), &name);
        let coil = self.context.global(name, role, description.clone(), origin);
        self.rungs.push(Rung {
            comment: description,
            condition: sum,
            timer: None,
            function: None,
            coil,
            kind: CoilKind::Plain,
            origin,
        });
        literal(coil, false)
    }
}

fn literal(atom: GlobalId, negated: bool) -> Sum<GlobalId> {
    let mut sum = Sum::zero();
    let product: Option<Product<GlobalId>> = [Literal { atom, negated }].into_iter().collect();
    product.into_iter().for_each(|p| sum.add(p));
    sum
}

/// A literal or a constant, negated if asked.
fn literal_of(l: Result<Literal<GlobalId>, bool>, negated: bool) -> Sum<GlobalId> {
    match l {
        Ok(l) => literal(l.atom, l.negated != negated),
        Err(c) if c != negated => Sum::one(),
        Err(_) => Sum::zero(),
    }
}

fn product_of(left: &Sum<GlobalId>, right: &Sum<GlobalId>) -> Sum<GlobalId> {
    let mut all = Sum::zero();
    for l in left.products() {
        for r in right.products() {
            l.times(r).into_iter().for_each(|p| all.add(p));
        }
    }
    all
}

/// Origin of what the compiler needs for itself.
pub fn own() -> Origin {
    Origin::default()
}
