//! What waits for `done` can wait with hope: every region of the state has a final state.

use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Atom, Guard, Machine, StateKind};

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    for t in machine.transitions.values() {
        guard(machine, &t.guard, t.span, found);
    }
    for region in machine.regions.values() {
        region.entries.iter().for_each(|(g, _)| guard(machine, g, region.span, found));
    }
    for state in machine.states.values() {
        state.drives.iter().for_each(|d| guard(machine, &d.condition, d.span, found));
        state.actions.iter().for_each(|a| guard(machine, &a.condition, a.span, found));
    }
}

fn guard(machine: &Machine, guard: &Guard, span: Span, found: &mut Diagnostics) {
    guard.for_each_atom(&mut |atom| {
        let Atom::Done(id) = *atom else { return };
        let state = &machine.states[id];
        let path = machine.state_path(id);
        if state.regions.is_empty() {
            found.push(
                Diagnostic::new(Code::NeverDone, format!("`{path}` holds no regions that could be done"))
                    .label(span, "waits for ever")
                    .label(state.span, "an elementary state"),
            );
        }
        for &r in &state.regions {
            let region = &machine.regions[r];
            if !region.states.iter().any(|&s| machine.states[s].kind == StateKind::Final) {
                found.push(
                    Diagnostic::new(Code::NeverDone, format!("`{path}` is never done"))
                        .label(span, "waits for ever")
                        .label(region.span, "has no final state")
                        .help("write `final state …` where the region ends, or `when` with a condition"),
                );
            }
        }
    });
}
