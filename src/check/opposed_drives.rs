//! No actuator is driven both ways at once, unless a filter that is there for it keeps its coils apart.
//!
//! Walks the hierarchy from the inside out. Only where something runs side by side (regions of one
//! state, a state and what it contains) can two drives meet.

use super::relation::{Relation, relation};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::{Atom, Drive, FilterMode, Guard, Machine, OutputId, Position, StateId, Technology, outputs_of};
use crate::ir::expr::Expr;
use crate::ir::sop::{Product, Sum};
use std::collections::BTreeSet;

/// A drive of a coil of a bistable actuator.
#[derive(Clone, Copy)]
struct Coil<'m> {
    actuator: usize,
    state: StateId,
    drive: &'m Drive,
}

/// Most products that the conjunction of two conditions is expanded into before they are held to be
/// compatible.
const PRODUCTS: usize = 256;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut owner: Vec<Option<usize>> = vec![None; machine.outputs.len()];
    for (id, actuator) in machine.actuators.iter() {
        if actuator.technology == Technology::Bistable && !kept_apart(machine, &actuator.positions) {
            for output in actuator.positions.iter().filter_map(|p| p.output) {
                owner[output.index()] = Some(id.index());
            }
        }
    }
    let mut of_region: Vec<Vec<Coil>> = vec![Vec::new(); machine.regions.len()];
    // A parent comes before what it contains, so backwards everything inside is ready.
    for (id, state) in machine.states.iter().rev() {
        let own = state.drives.iter().filter_map(|drive| {
            let actuator = owner[drive.output.index()]?;
            Some(Coil { actuator, state: id, drive })
        });
        let own: Vec<Coil> = own.collect();
        meet(machine, &own, &own, found);
        let mut all = own;
        for &r in &state.regions {
            let inner = std::mem::take(&mut of_region[r.index()]);
            meet(machine, &all, &inner, found);
            all.extend(inner);
        }
        of_region[state.region.index()].extend(all);
    }
    let mut all: Vec<Coil> = Vec::new();
    for region in machine.charts.iter().flat_map(|c| &c.regions) {
        let inner = std::mem::take(&mut of_region[region.index()]);
        meet(machine, &all, &inner, found);
        all.extend(inner);
    }
}

/// Whether a constraint says that the coils are never TRUE together, whatever commands them.
fn kept_apart(machine: &Machine, positions: &[Position]) -> bool {
    if machine.safety.mode == Some(FilterMode::Supervisor) {
        return false; // Its corrections are alarms, and not for normal operation.
    }
    let coils: BTreeSet<OutputId> = positions.iter().filter_map(|p| p.output).collect();
    let mut products = machine.safety.constraints.values().flat_map(|c| &c.products);
    products.any(|p| {
        p.literals().iter().all(|l| !l.negated && matches!(l.atom, Atom::Output(_)))
            && outputs_of(p).map(|(o, _)| o).collect::<BTreeSet<_>>() == coils
    })
}

fn meet(machine: &Machine, left: &[Coil], right: &[Coil], found: &mut Diagnostics) {
    if left.is_empty() || right.is_empty() {
        return;
    }
    let mut sorted: Vec<&Coil> = right.iter().collect();
    sorted.sort_by_key(|c| (c.actuator, c.drive.output));
    for a in left {
        let from = sorted.partition_point(|c| c.actuator < a.actuator);
        let opposed = sorted[from..]
            .iter()
            .take_while(|c| c.actuator == a.actuator)
            .filter(|c| c.drive.output != a.drive.output)
            .find(|c| compatible(machine, &a.drive.condition, &c.drive.condition));
        if let Some(b) = opposed {
            let actuator = machine.actuators.values().nth(a.actuator).expect("the owner is an actuator");
            let name = |o: OutputId| machine.outputs[o].name.as_str();
            found.push(
                Diagnostic::new(
                    Code::OpposedDrives,
                    format!(
                        "`{}` is driven both ways: `{}` by `{}`, `{}` by `{}`",
                        actuator.name,
                        name(a.drive.output),
                        machine.state_path(a.state),
                        name(b.drive.output),
                        machine.state_path(b.state)
                    ),
                )
                .label(a.drive.span, format!("drives {}", name(a.drive.output)))
                .label(b.drive.span, format!("drives {} at the same time", name(b.drive.output)))
                .help("these states can be active together, and their conditions can hold together"),
            );
            return;
        }
    }
}

/// Whether both conditions can hold in one scan, as far as contradictions between single readings
/// and between states that are never active together decide it.
fn compatible(machine: &Machine, a: &Guard, b: &Guard) -> bool {
    match Sum::of(&Expr::all([a.clone(), b.clone()]), PRODUCTS) {
        None => true,
        Some(sum) => sum.products().iter().any(|p| possible(machine, p)),
    }
}

fn possible(machine: &Machine, product: &Product<Atom>) -> bool {
    let active: Vec<StateId> = product
        .literals()
        .iter()
        .filter_map(|l| match l.atom {
            Atom::In(s) if !l.negated => Some(s),
            _ => None,
        })
        .collect();
    !active
        .iter()
        .enumerate()
        .any(|(i, &a)| active[..i].iter().any(|&b| relation(machine, a, b) == Relation::Exclusive))
}
