//! A system to one that the oldest readers take: without anything that holds in each scan and without memory that begins
//! with either value.
//!
//! What never is is asked of those scans up to which all that has to hold has held: a latch remembers that something has not.
//! Memory that can begin with either value begins with FALSE, and in the first scan an input stands for it. What is added
//! stands behind the latches and inputs of the system, which keep their places. Claims of anything but what never is are
//! left as they are, though they do not mean the same.

use super::super::aig::{Lit, Node};
use super::super::system::{Claim, Giver, Property, System, Trace};

/// A system, and what stands for the beginning of the one that it was made of.
pub struct Plain {
    /// The system.
    pub system: System,
    /// For each latch of the other one that can begin with either value, the index of the input that says with which.
    given: Vec<Option<usize>>,
    /// How many latches and inputs that one has.
    sizes: (usize, usize),
}

/// Makes a system plain.
pub fn of(system: &System) -> Plain {
    let mut plain = System::default();
    let mut of = vec![Lit::FALSE; system.aig.len()];
    for input in &system.inputs {
        of[input.leaf.node()] = plain.input(system.name(input.leaf), input.giver);
    }
    for latch in &system.latches {
        of[latch.leaf.node()] = plain.latch(system.name(latch.leaf), Some(latch.initial.unwrap_or(false)));
    }
    let given = beginnings(system, &mut plain, &mut of);
    for n in 0..system.aig.len() {
        if let Node::And(a, b) = system.aig.node(n) {
            let operand = |l: Lit, of: &[Lit]| of[l.node()].xor(l.is_negated());
            of[n] = plain.aig.and(operand(a, &of), operand(b, &of));
        }
    }
    let lit = |l: Lit| of[l.node()].xor(l.is_negated());
    for (latch, old) in plain.latches.iter_mut().zip(&system.latches) {
        latch.next = lit(old.next);
    }
    let counts = lasting(&mut plain, system.constraints.iter().map(|&c| lit(c)));
    for Claim { name, property } in &system.claims {
        let property = match *property {
            Property::Never(bad) => Property::Never(plain.aig.and(lit(bad), counts)),
            Property::AlwaysPossible(goal) => Property::AlwaysPossible(lit(goal)),
            Property::Eventually { after, then } => Property::Eventually { after: lit(after), then: lit(then) },
            Property::NeverStuck => Property::NeverStuck,
        };
        plain.claim(name, property);
    }
    Plain { system: plain, given, sizes: (system.latches.len(), system.inputs.len()) }
}

/// Lets inputs stand for latches that can begin with either value, as long as the first scan lasts.
fn beginnings(system: &System, plain: &mut System, of: &mut [Lit]) -> Vec<Option<usize>> {
    let mut given = vec![None; system.latches.len()];
    if system.latches.iter().all(|l| l.initial.is_some()) {
        return given;
    }
    let at = plain.latches.len();
    let begun = plain.latch("the first scan is over", Some(false));
    plain.latches[at].next = Lit::TRUE;
    for (latch, given) in system.latches.iter().zip(&mut given).filter(|(l, _)| l.initial.is_none()) {
        *given = Some(plain.inputs.len());
        let first = plain.input(format!("{} at first", system.name(latch.leaf)), Giver::Plant);
        let node = latch.leaf.node();
        of[node] = plain.aig.select(begun, of[node], first);
    }
    given
}

/// Whether all of that has held up to this scan, this one included.
fn lasting(plain: &mut System, constraints: impl Iterator<Item = Lit>) -> Lit {
    let now = constraints.fold(Lit::TRUE, |all, c| plain.aig.and(all, c));
    if now == Lit::TRUE {
        return now;
    }
    let at = plain.latches.len();
    let broken = plain.latch("what has to hold has not", Some(false));
    let still = plain.aig.and(now, !broken);
    plain.latches[at].next = !still;
    still
}

impl Plain {
    /// A run of the other system, made of a run of this one.
    pub fn run(&self, initial: Vec<bool>, mut inputs: Vec<Vec<bool>>) -> Trace {
        let first = inputs.first();
        let value = |latch: usize| match (self.given[latch], first) {
            (Some(input), Some(first)) => first[input],
            _ => initial[latch],
        };
        let initial = (0..self.sizes.0).map(value).collect();
        inputs.iter_mut().for_each(|scan| scan.truncate(self.sizes.1));
        Trace { initial, inputs, shortest: false }
    }
}
