//! Every written transition can fire, as far as constant guards decide it.

use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Machine, TransitionId};
use crate::ir::expr::Expr;
use std::collections::BTreeMap;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let scoped = machine.scoped();
    // For each state, the transitions that always fire when it is active, with their rank.
    let mut always = vec![Vec::new(); machine.states.len()];
    let mut rank = vec![0; machine.transitions.len()];
    for list in &scoped {
        for (i, &id) in list.iter().enumerate() {
            rank[id.index()] = i;
            if machine.transitions[id].guard == Expr::TRUE {
                always[machine.transitions[id].source.index()].push(id);
            }
        }
    }
    let beaten = |id: TransitionId| -> Option<TransitionId> {
        let t = &machine.transitions[id];
        let scope_depth = |r| machine.regions[r].parent.map_or(0, |p| machine.states[p].depth + 1);
        let key = (scope_depth(t.scope), rank[id.index()]);
        machine
            .ancestors(t.source)
            .flat_map(|s| always[s.index()].iter().copied())
            .find(|&o| (scope_depth(machine.transitions[o].scope), rank[o.index()]) < key)
    };
    // `from any` makes several of one text: it is right if one of them can fire.
    let mut dead: BTreeMap<Span, Option<(TransitionId, Option<TransitionId>)>> = BTreeMap::new();
    for (id, t) in machine.transitions.iter() {
        let winner = beaten(id);
        let never = winner.is_some() || t.guard == Expr::FALSE;
        dead.entry(t.span)
            .and_modify(|d| {
                if !never {
                    *d = None
                }
            })
            .or_insert(never.then_some((id, winner)));
    }
    for (span, reason) in dead {
        let Some((id, winner)) = reason else { continue };
        let source = machine.state_path(machine.transitions[id].source);
        let d = Diagnostic::new(Code::NeverFires, format!("this transition from `{source}` can never fire"));
        found.push(match winner {
            Some(winner) => d
                .label(span, "never fires")
                .label(machine.transitions[winner].span, "always fires first")
                .help("write the one with the condition first, or give both conditions"),
            None => d.label(span, "its condition is never TRUE"),
        });
    }
}
