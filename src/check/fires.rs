//! Every written transition can fire, as far as constant guards decide it.

use super::dead::{Dead, dead};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::Machine;
use std::collections::BTreeMap;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    // `from any` makes several of one text to one target: it is right if one of them can fire. The two
    // halves of a movement have different targets.
    let mut texts = BTreeMap::new();
    for ((id, t), dead) in machine.transitions.iter().zip(dead(machine)) {
        let reason = dead.map(|d| (id, d));
        let text = texts.entry((t.span, t.target)).or_insert(reason);
        if reason.is_none() {
            *text = None;
        }
    }
    for ((span, _), reason) in texts {
        let Some((id, reason)) = reason else { continue };
        let source = machine.state_path(machine.transitions[id].source);
        let d = Diagnostic::new(Code::NeverFires, format!("this transition from `{source}` can never fire"));
        found.push(match reason {
            Dead::Beaten(winner) => d
                .label(span, "never fires")
                .label(machine.transitions[winner].span, "always fires first")
                .help("write the one with the condition first, or give both conditions"),
            Dead::NeverEnabled => d.label(span, "its condition is never TRUE"),
        });
    }
}
