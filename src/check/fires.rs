//! Every written transition can fire, as far as constant guards decide it.

use super::dead::{Dead, dead};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::Machine;
use std::collections::BTreeMap;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    // One text can make several: `from any` one from each state, a choice one for each way, a time limit one
    // for each movement. Of those to one target it is right if one can fire. The two halves of a movement
    // have different targets.
    let mut texts = BTreeMap::new();
    for ((id, t), dead) in machine.transitions.iter().zip(dead(machine)) {
        let reason = dead.map(|d| (id, d));
        let text = texts.entry((t.span, (!t.internal).then_some(t.target))).or_insert(reason);
        if reason.is_none() {
            *text = None;
        }
    }
    for reason in texts.into_values() {
        let Some((id, reason)) = reason else { continue };
        let t = &machine.transitions[id];
        let source = machine.state_path(t.source);
        let what = if t.internal {
            format!("this internal transition of `{source}`")
        } else {
            format!("this transition from `{source}` to `{}`", machine.state_path(t.target))
        };
        let d = Diagnostic::new(Code::NeverFires, format!("{what} can never fire"));
        found.push(match reason {
            Dead::Beaten(winner) if t.internal => d
                .label(t.span, "never happens")
                .label(machine.transitions[winner].span, "leaves the state whenever it is active")
                .help("give the transition a condition, or write `then` behind it"),
            Dead::Beaten(winner) => d
                .label(t.span, "never fires")
                .label(machine.transitions[winner].span, "always enabled then, and tried first")
                .help("write the one with the condition first, or give both conditions"),
            Dead::NeverEnabled => d.label(t.span, "its condition is never TRUE"),
        });
    }
}
