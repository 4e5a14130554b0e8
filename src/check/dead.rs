//! Transitions that can never fire, as far as constant guards decide it.

use crate::ir::chart::{Machine, Phase, Transition, TransitionId};
use crate::ir::expr::Expr;

/// Why a transition can never fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dead {
    /// Its guard is FALSE.
    NeverEnabled,
    /// Whenever it is enabled, so is this one, and this one or another that keeps it from firing comes first; or leaves
    /// the state of an internal one.
    Beaten(TransitionId),
}

/// For each transition, why it can never fire, if it cannot.
pub fn dead(machine: &Machine) -> Vec<Option<Dead>> {
    // For each state, the transitions out of it that are enabled whenever it is active.
    let mut always = vec![Vec::new(); machine.states.len()];
    let mut rank = vec![0; machine.transitions.len()];
    let (start, end) = (machine.scoped(Phase::Start), machine.scoped(Phase::End));
    for list in start.iter().chain(&end) {
        for (i, &id) in list.iter().enumerate() {
            rank[id.index()] = i;
            let t = &machine.transitions[id];
            if t.guard == Expr::TRUE {
                always[t.source.index()].push(id);
            }
        }
    }
    // Outer scopes are tried first, then by rank.
    let key = |id: TransitionId| {
        let scope = machine.transitions[id].scope;
        (machine.regions[scope].parent.map_or(0, |p| machine.states[p].depth + 1), rank[id.index()])
    };
    let judge = |(id, t): (TransitionId, &Transition)| {
        if t.guard == Expr::FALSE {
            return Some(Dead::NeverEnabled);
        }
        let mut rivals = machine.ancestors(t.source).flat_map(|s| always[s.index()].iter().copied());
        // Of one scope, one fires, and the regions inside its source take no step then. An internal transition does not
        // happen in a scan in which its state is left.
        let beats = |o: TransitionId| machine.transitions[o].phase == t.phase && (t.internal || key(o) < key(id));
        rivals.find(|&o| beats(o)).map(Dead::Beaten)
    };
    machine.transitions.iter().map(judge).collect()
}
