//! No two regions that run side by side write one variable.

use super::relation::{Relation, relation, run_together};
use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Machine, RegionId, StateId};

/// Something that writes a variable.
#[derive(Clone, Copy)]
enum Writer {
    /// A transition of that scope.
    Step(RegionId, Span),
    /// An action of that state.
    Action(StateId, Span),
}

impl Writer {
    fn span(self) -> Span {
        match self {
            Writer::Step(_, span) | Writer::Action(_, span) => span,
        }
    }
}

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut writers = vec![Vec::new(); machine.variables.len()];
    for t in machine.transitions.values() {
        for effect in &t.effects {
            writers[effect.variable.index()].push(Writer::Step(t.scope, t.span));
        }
    }
    for (id, state) in machine.states.iter() {
        for a in &state.actions {
            writers[a.variable.index()].push(Writer::Action(id, a.span));
        }
    }
    let mut assigners = vec![Vec::new(); machine.integers.len()];
    for t in machine.transitions.values() {
        for assignment in &t.assignments {
            assigners[assignment.integer.index()].push(Writer::Step(t.scope, t.span));
        }
    }
    let variables = machine.variables.values().map(|v| &v.name).zip(&writers);
    let integers = machine.integers.values().map(|i| &i.name).zip(&assigners);
    for (name, writers) in variables.chain(integers) {
        let pair = writers
            .iter()
            .enumerate()
            .find_map(|(i, &a)| writers[..i].iter().copied().find(|&b| together(machine, a, b)).map(|b| (a, b)));
        if let Some((a, b)) = pair {
            found.push(
                Diagnostic::new(
                    Code::ParallelWrites,
                    format!("regions that run side by side may write `{name}` in the same scan"),
                )
                .label(a.span(), "written here")
                .label(b.span(), "and here")
                .help("let one region write it, and the other read it or write a variable of its own"),
            );
        }
    }
}

/// Whether both may write in one scan without an order between them.
fn together(machine: &Machine, a: Writer, b: Writer) -> bool {
    match (a, b) {
        (Writer::Step(a, _), Writer::Step(b, _)) => run_together(machine, a, b),
        (Writer::Action(a, _), Writer::Action(b, _)) => relation(machine, a, b) == Relation::Parallel,
        (Writer::Step(region, _), Writer::Action(state, _)) | (Writer::Action(state, _), Writer::Step(region, _)) => {
            machine.child_in(region, state).is_none()
                && relation(machine, machine.regions[region].initial, state) == Relation::Parallel
        }
    }
}
