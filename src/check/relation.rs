//! How two states of a machine stand to each other in time.

use crate::ir::chart::{Machine, RegionId, StateId};

/// How two states stand to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// They are the same, or one contains the other.
    Nested,
    /// They lie in regions that run side by side.
    Parallel,
    /// They are never active together.
    Exclusive,
}

/// The relation of two states.
pub fn relation(machine: &Machine, a: StateId, b: StateId) -> Relation {
    let Some(region) = machine.scope(a, b) else { return Relation::Parallel };
    let (in_a, in_b) = (machine.child_in(region, a), machine.child_in(region, b));
    if in_a != in_b {
        Relation::Exclusive
    } else if in_a == Some(a) || in_b == Some(b) {
        Relation::Nested
    } else {
        Relation::Parallel
    }
}

/// Whether two regions can each take a step in the same scan.
pub fn run_together(machine: &Machine, a: RegionId, b: RegionId) -> bool {
    a != b && relation(machine, machine.regions[a].initial, machine.regions[b].initial) == Relation::Parallel
}
