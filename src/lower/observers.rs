//! Observers that take two steps in a scan, one when it begins and one after the filter, to ladder.
//!
//! Each is one region of elementary states. Its flags are set and reset by coils; which transition fires
//! is decided before any of them changes, and of one region at most one fires at a time. So it does not
//! matter in which order flags are written, but for a transition from a state to itself: sets come after
//! resets.

use super::context::{Condition, Context};
use super::rungs::rung;
use super::{integers, variables};
use crate::ir::chart::{RegionId, TransitionId};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder, Rung};
use crate::ir::plc::{GlobalId, Origin, Role};
use std::collections::BTreeMap;

/// From this many transitions on that are tried before one, a coil stands for all of them.
const MANY: usize = 8;

/// The step of a region at the beginning of the scan. In the first scan no flag is TRUE yet, so nothing
/// fires, and the initial state is entered.
pub fn step(context: &mut Context<'_>, region: RegionId) -> Ladder {
    let states = &context.machine.regions[region].states;
    let none = Expr::all(states.iter().map(|s| Expr::Atom(context.flags[s.index()]).not()).collect::<Vec<_>>());
    let initial = context.flags[context.machine.regions[region].initial.index()];
    let mut rungs = Vec::new();
    rung(context, &mut rungs, (initial, CoilKind::Set), &none, "the first scan enters the initial state".into());
    let firing: Vec<(TransitionId, GlobalId)> =
        context.scoped[region.index()].clone().into_iter().map(|t| (t, context.fires(t))).collect();
    flags(context, &mut rungs, &firing);
    Ladder { rungs }
}

/// What all observers do after the filter.
pub fn after_filter(context: &mut Context<'_>) -> Ladder {
    let machine = context.machine;
    let mut rungs = Vec::new();
    let mut firing = Vec::new();
    for (id, region) in machine.regions.iter() {
        let all = context.ending[id.index()].clone();
        let mut leaving: Vec<Vec<TransitionId>> = vec![Vec::new(); region.states.len()];
        for t in all {
            let source = machine.transitions[t].source;
            let at = region.states.iter().position(|&s| s == source).expect("the region holds the source");
            leaving[at].push(t);
        }
        leaving.into_iter().for_each(|rivals| firing.extend(decide(context, &mut rungs, &rivals)));
    }
    rungs.extend(integers::after_filter(context, &firing));
    rungs.extend(variables::effects(context, &firing));
    flags(context, &mut rungs, &firing);
    Ladder { rungs }
}

/// Which of the transitions that leave one state fires: a coil for each.
fn decide(context: &mut Context<'_>, rungs: &mut Vec<Rung>, rivals: &[TransitionId]) -> Vec<(TransitionId, GlobalId)> {
    let machine = context.machine;
    let mut before: Vec<Condition> = Vec::new();
    let mut firing = Vec::new();
    for &id in rivals {
        let t = &machine.transitions[id];
        let mut coil = |context: &mut Context<'_>, word: &str, says: &str, condition: &Condition| {
            let (name, text) = (context.names.transition(word, id), context.says_of(id, says));
            let coil = context.global(name, Role::Condition, text.clone(), Origin::Transition(id));
            rung(context, rungs, (coil, CoilKind::Plain), condition, text);
            coil
        };
        let flag = Expr::Atom(context.flags[t.source.index()]);
        let first = before.iter().map(|b| b.clone().not());
        let condition = Expr::all([flag, context.after_filter(&t.guard)].into_iter().chain(first));
        let fires = coil(context, "Go", "fires", &condition);
        firing.push((id, fires));
        before.push(Expr::Atom(fires));
        if before.len() == MANY {
            let some = coil(context, "Any", "or one tried before it fires", &Expr::any(before));
            before = vec![Expr::Atom(some)];
        }
    }
    firing
}

/// Lets the flags follow the transitions that fire.
fn flags(context: &mut Context<'_>, rungs: &mut Vec<Rung>, firing: &[(TransitionId, GlobalId)]) {
    let machine = context.machine;
    let (mut left, mut entered) = (BTreeMap::new(), BTreeMap::new());
    for &(t, fires) in firing {
        let t = &machine.transitions[t];
        if t.internal {
            continue;
        }
        left.entry(t.source).or_insert_with(Vec::new).push(Expr::Atom(fires));
        entered.entry(t.target).or_insert_with(Vec::new).push(Expr::Atom(fires));
    }
    for (by, kind, verb) in [(left, CoilKind::Reset, "leave"), (entered, CoilKind::Set, "enter")] {
        for (state, by) in by {
            let text = format!("transitions that {verb} {}", machine.state_path(state));
            rung(context, rungs, (context.flags[state.index()], kind), &Expr::any(by), text);
        }
    }
}
