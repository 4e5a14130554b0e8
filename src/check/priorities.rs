//! Transitions of one source have distinct priorities.

use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::Machine;
use std::collections::BTreeMap;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut first = BTreeMap::new();
    for (id, t) in machine.transitions.iter() {
        let Some(priority) = t.priority else { continue };
        if let Some(&other) = first.get(&(t.source, t.scope, t.phase, priority)) {
            let other: crate::ir::chart::TransitionId = other;
            // Those of one text are the ways through a choice.
            if machine.transitions[other].span == t.span {
                continue;
            }
            found.push(
                Diagnostic::new(
                    Code::SamePriority,
                    format!("two transitions from `{}` have priority {priority}", machine.state_path(t.source)),
                )
                .label(t.span, "the second one")
                .label(machine.transitions[other].span, "the first one")
                .help("give them different priorities; the lower one is tried first"),
            );
        } else {
            first.insert((t.source, t.scope, t.phase, priority), id);
        }
    }
}
