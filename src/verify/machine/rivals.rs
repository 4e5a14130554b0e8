//! Transitions to pairs of which only the order of the text decides which one fires or writes last, where that makes a difference.
//!
//! It makes none where both leave and enter the same states and do the same on the way. What is not known before a run, such as where
//! a history leads or an initial choice, counts as a difference, unless both ask for the same.

use crate::ir::chart::{
    Assignment, Deeds, Effect, Inside, Machine, Phase, RegionId, StateId, Transition, TransitionId,
};
use std::collections::BTreeSet;

/// Pairs of transitions that have one source and scope, no explicit priority, and something that differs; the one that is tried
/// first comes first. Internal transitions of one state both happen: they are a pair where they write something differently.
pub fn rivals(machine: &Machine) -> Vec<(TransitionId, TransitionId)> {
    let mut rivals = Vec::new();
    for scoped in [Phase::Start, Phase::End].into_iter().flat_map(|phase| machine.scoped(phase)) {
        for (i, &a) in scoped.iter().enumerate() {
            for &b in &scoped[i + 1..] {
                let (s, t) = (&machine.transitions[a], &machine.transitions[b]);
                let ranked = s.priority.is_some() || t.priority.is_some();
                if s.source == t.source && !ranked && differ(machine, s, t) {
                    rivals.push((a, b));
                }
            }
        }
    }
    for internals in machine.internals() {
        for (i, &a) in internals.iter().enumerate() {
            let both = |&b: &TransitionId| contradict(&machine.transitions[a].deeds, &machine.transitions[b].deeds);
            rivals.extend(internals[i + 1..].iter().copied().filter(both).map(|b| (a, b)));
        }
    }
    rivals
}

/// Whether two deeds that both happen write something differently, so that the last one decides.
fn contradict(a: &Deeds, b: &Deeds) -> bool {
    let effects = |e: &Effect| b.effects.iter().any(|f| f.variable == e.variable && f.value != e.value);
    let numbers = |m: &Assignment| b.assignments.iter().any(|n| n.integer == m.integer && n.value != m.value);
    a.effects.iter().any(effects) || a.assignments.iter().any(numbers)
}

/// Whether it makes a difference which of two transitions of one source and scope fires.
fn differ(machine: &Machine, s: &Transition, t: &Transition) -> bool {
    !same_deeds(&s.deeds, &t.deeds) || !same_entry(machine, s, t)
}

/// Whether two transitions do the same to variables, integers and events; the order in one of them means nothing.
fn same_deeds(a: &Deeds, b: &Deeds) -> bool {
    let effects = |d: &Deeds| d.effects.iter().map(|e| (e.variable, e.value)).collect::<BTreeSet<_>>();
    let raises = |d: &Deeds| d.raises.iter().copied().collect::<BTreeSet<_>>();
    let assigned = |d: &Deeds| d.assignments.iter().map(|a| (a.integer, a.value.clone())).collect::<BTreeSet<_>>();
    effects(a) == effects(b) && raises(a) == raises(b) && assigned(a) == assigned(b)
}

/// Whether two transitions of one scope enter the same states.
fn same_entry(machine: &Machine, s: &Transition, t: &Transition) -> bool {
    let ways = |t: &Transition| (t.target, inside(machine, t));
    if ways(s) == ways(t) {
        return true;
    }
    match (entered(machine, s), entered(machine, t)) {
        (Some(a), Some(b)) => a == b,
        _ => false,
    }
}

/// How the regions of the target are entered. Where the states of a history hold no others, it is as deep as it can be.
fn inside(machine: &Machine, t: &Transition) -> Inside {
    let flat = |s: &StateId| {
        let regions = machine.states[*s].regions.iter();
        regions.flat_map(|&r| &machine.regions[r].states).all(|&inner| machine.states[inner].regions.is_empty())
    };
    match &t.inside {
        Inside::DeepHistory if flat(&t.target) => Inside::History,
        Inside::Fork(goals) => {
            let mut goals = goals.clone();
            goals.sort_unstable();
            Inside::Fork(goals)
        }
        other => other.clone(),
    }
}

/// The states that it enters, if that is known before a run.
fn entered(machine: &Machine, t: &Transition) -> Option<BTreeSet<StateId>> {
    if matches!(t.inside, Inside::History | Inside::DeepHistory) {
        return None;
    }
    // Those that it names, with all between them and the scope.
    let mut states = BTreeSet::new();
    for &goal in t.goals() {
        for state in machine.ancestors(goal) {
            states.insert(state);
            if machine.states[state].region == t.scope {
                break;
            }
        }
    }
    let mut regions: Vec<RegionId> = states.iter().flat_map(|&s| &machine.states[s].regions).copied().collect();
    while let Some(region) = regions.pop() {
        let region = &machine.regions[region];
        if region.states.iter().any(|s| states.contains(s)) {
            continue;
        }
        if !region.entries.is_empty() {
            return None;
        }
        states.insert(region.initial);
        regions.extend(&machine.states[region.initial].regions);
    }
    Some(states)
}
