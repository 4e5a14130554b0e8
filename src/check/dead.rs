//! Transitions that can never fire, as far as constant guards decide it.

use crate::ir::chart::{Machine, Phase, TransitionId};
use crate::ir::expr::Expr;

/// Why a transition can never fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dead {
    /// Its guard is FALSE.
    NeverEnabled,
    /// Whenever it is enabled, this one is tried before it and fires.
    Beaten(TransitionId),
}

/// For each transition, why it can never fire, if it cannot.
pub fn dead(machine: &Machine) -> Vec<Option<Dead>> {
    // For each state, the transitions that always fire when it is active and they are tried, with their
    // rank.
    let mut always = vec![Vec::new(); machine.states.len()];
    let mut rank = vec![0; machine.transitions.len()];
    let (start, end) = (machine.scoped(Phase::Start), machine.scoped(Phase::End));
    for list in start.iter().chain(&end) {
        for (i, &id) in list.iter().enumerate() {
            rank[id.index()] = i;
            if machine.transitions[id].guard == Expr::TRUE {
                always[machine.transitions[id].source.index()].push(id);
            }
        }
    }
    // Outer scopes are tried first, then by rank.
    let key = |id: TransitionId| {
        let scope = machine.transitions[id].scope;
        (machine.regions[scope].parent.map_or(0, |p| machine.states[p].depth + 1), rank[id.index()])
    };
    let judge = |(id, t): (TransitionId, &crate::ir::chart::Transition)| {
        if t.guard == Expr::FALSE {
            return Some(Dead::NeverEnabled);
        }
        let mut rivals = machine.ancestors(t.source).flat_map(|s| always[s.index()].iter().copied());
        // One that leaves nothing beats those of its own scope only.
        let beats = |o: TransitionId| {
            let other = &machine.transitions[o];
            other.phase == t.phase && key(o) < key(id) && (!other.internal || other.scope == t.scope)
        };
        rivals.find(|&o| beats(o)).map(Dead::Beaten)
    };
    machine.transitions.iter().map(judge).collect()
}
