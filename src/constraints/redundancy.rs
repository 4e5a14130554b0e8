//! Constraints that the others imply: without one of them, nothing more would be allowed.

use super::questions::{Found, Questions};
use crate::bits::aig::Lit;
use crate::ir::chart::{ConstraintId, Machine};

/// A constraint that can be left out alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Redundant {
    /// The constraint.
    pub constraint: ConstraintId,
    /// Those that imply it together with the assumptions; none if these do alone.
    pub implied_by: Vec<ConstraintId>,
}

/// Each constraint whose products are all FALSE whenever those of the others are, whatever the outputs
/// of this scan are and whatever is read, as far as assumptions allow. One of two that say the same is
/// implied by the other, so each of them is in the list.
pub fn redundant(machine: &Machine) -> Vec<Redundant> {
    let mut questions = Questions::new(machine);
    let ids: Vec<ConstraintId> = machine.safety.constraints.ids().collect();
    let violated: Vec<Lit> = ids
        .iter()
        .map(|&id| {
            let products = &machine.safety.constraints[id].products;
            // An output of this scan is what somebody may command, were there no filter.
            let lits: Vec<Lit> = products.iter().map(|p| questions.product(p, &mut Questions::command)).collect();
            questions.aig.any(&lits)
        })
        .collect();
    // What holds if all before, and all behind, are met.
    let mut before = vec![Lit::TRUE];
    for &v in &violated {
        let so_far = before[before.len() - 1];
        before.push(questions.aig.and(so_far, !v));
    }
    let mut behind = vec![Lit::TRUE; ids.len() + 1];
    for (i, &v) in violated.iter().enumerate().rev() {
        behind[i] = questions.aig.and(behind[i + 1], !v);
    }
    let mut found = Vec::new();
    for (i, &constraint) in ids.iter().enumerate() {
        if let Found::Never = questions.ask(&[violated[i], before[i], behind[i + 1]]) {
            let implied_by = reasons(&mut questions, &violated, i).into_iter().map(|j| ids[j]).collect();
            found.push(Redundant { constraint, implied_by });
        }
    }
    found
}

/// Longest list of reasons in which each is tried whether it is needed.
const SHORTENED: usize = 64;

/// Some of the others that imply this one; where these are few, none of them is superfluous.
fn reasons(questions: &mut Questions<'_>, violated: &[Lit], i: usize) -> Vec<usize> {
    let mut others: Vec<usize> = (0..violated.len()).filter(|&j| j != i).collect();
    loop {
        let goals: Vec<Lit> = others.iter().map(|&j| !violated[j]).chain([violated[i]]).collect();
        let Found::Never = questions.ask(&goals) else { return others };
        let needed: Vec<usize> = others.iter().copied().filter(|&j| questions.was_needed(!violated[j])).collect();
        if needed.len() == others.len() {
            break;
        }
        others = needed;
    }
    if others.len() > SHORTENED {
        return others;
    }
    // What the solver needed it may not need without another.
    for j in others.clone() {
        let rest: Vec<usize> = others.iter().copied().filter(|&k| k != j).collect();
        let goals: Vec<Lit> = rest.iter().map(|&j| !violated[j]).chain([violated[i]]).collect();
        if let Found::Never = questions.ask(&goals) {
            others = rest;
        }
    }
    others
}
