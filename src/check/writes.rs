//! No two regions that run side by side write one variable.

use super::relation::{Relation, relation, run_together};
use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Deeds, Machine, RegionId, StateId};

/// Something that writes a variable.
#[derive(Clone, Copy)]
enum Writer {
    /// A transition of that scope.
    Step(RegionId, Span),
    /// That state, while it is active or when it is entered or left.
    State(StateId, Span),
}

impl Writer {
    fn span(self) -> Span {
        match self {
            Writer::Step(_, span) | Writer::State(_, span) => span,
        }
    }
}

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut writers = vec![Vec::new(); machine.variables.len()];
    let mut assigners = vec![Vec::new(); machine.integers.len()];
    let mut note = |deeds: &Deeds, writer: &dyn Fn(Span) -> Writer| {
        for effect in &deeds.effects {
            writers[effect.variable.index()].push(writer(effect.span));
        }
        for assignment in &deeds.assignments {
            assigners[assignment.integer.index()].push(writer(assignment.span));
        }
    };
    for t in machine.transitions.values() {
        note(&t.deeds, &|_| Writer::Step(t.scope, t.span));
    }
    for (id, state) in machine.states.iter() {
        note(&state.entry, &|span| Writer::State(id, span));
        note(&state.exit, &|span| Writer::State(id, span));
    }
    for (id, state) in machine.states.iter() {
        for a in &state.actions {
            writers[a.variable.index()].push(Writer::State(id, a.span));
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
        (Writer::State(a, _), Writer::State(b, _)) => relation(machine, a, b) == Relation::Parallel,
        (Writer::Step(region, _), Writer::State(state, _)) | (Writer::State(state, _), Writer::Step(region, _)) => {
            machine.child_in(region, state).is_none()
                && relation(machine, machine.regions[region].initial, state) == Relation::Parallel
        }
    }
}
