//! Where transitions enter regions other than by default.
//!
//! A region that becomes active goes to its initial state unless it is told otherwise. It has to be
//! told in two cases: a transition leads to another of its states or into one, and a transition
//! leaves and enters the region's parent in one scan, which the parent's flag does not show.

use crate::ir::chart::{Machine, RegionId, StateId, TransitionId};
use std::collections::BTreeMap;

/// One state at which a region is told to start.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// The transitions that say so, in order.
    pub by: Vec<TransitionId>,
    /// Whether one of them can find the region active.
    pub reenters: bool,
}

/// For each region, the states at which it is told to start.
pub struct Entries {
    of: Vec<BTreeMap<StateId, Entry>>,
    told: Vec<bool>,
    /// For each state, the transitions that enter it and may find it active.
    again: BTreeMap<StateId, Vec<TransitionId>>,
}

impl Entries {
    /// Walks all transitions.
    pub fn of(machine: &Machine) -> Entries {
        let mut entries = Entries {
            of: vec![BTreeMap::new(); machine.regions.len()],
            told: vec![false; machine.transitions.len()],
            again: BTreeMap::new(),
        };
        for (id, t) in machine.transitions.iter().filter(|(_, t)| !t.internal) {
            let reenters = machine.child_in(t.scope, t.source) == machine.child_in(t.scope, t.target);
            let mut path: Vec<StateId> =
                machine.ancestors(t.target).take_while(|&s| machine.states[s].region != t.scope).collect();
            path.reverse();
            for &state in &path {
                let region = machine.states[state].region;
                if reenters || machine.regions[region].initial != state {
                    entries.add(region, state, id, reenters);
                }
            }
            if reenters {
                // By default, but told so: what is beside the path and what is inside the target.
                let top = machine.child_in(t.scope, t.target).expect("the scope holds the target");
                entries.again.entry(top).or_default().push(id);
                for &state in std::iter::once(&top).chain(&path) {
                    for &region in &machine.states[state].regions {
                        if machine.child_in(region, t.target).is_none() {
                            entries.by_default(machine, region, id);
                        }
                    }
                }
            }
        }
        entries
    }

    /// The states at which `region` is told to start.
    pub fn of_region(&self, region: RegionId) -> impl Iterator<Item = (StateId, &Entry)> {
        self.of[region.index()].iter().map(|(s, e)| (*s, e))
    }

    /// Whether the transition tells some region where to start.
    pub fn tells(&self, transition: TransitionId) -> bool {
        self.told[transition.index()]
    }

    /// The transitions that enter the state and may find it active.
    pub fn reentering(&self, state: StateId) -> &[TransitionId] {
        self.again.get(&state).map(Vec::as_slice).unwrap_or_default()
    }

    fn add(&mut self, region: RegionId, state: StateId, by: TransitionId, reenters: bool) {
        let entry = self.of[region.index()].entry(state).or_default();
        entry.by.push(by);
        entry.reenters |= reenters;
        self.told[by.index()] = true;
        if reenters {
            self.again.entry(state).or_default().push(by);
        }
    }

    fn by_default(&mut self, machine: &Machine, region: RegionId, by: TransitionId) {
        let mut open = vec![region];
        while let Some(region) = open.pop() {
            let initial = machine.regions[region].initial;
            self.add(region, initial, by, true);
            open.extend(&machine.states[initial].regions);
        }
    }
}
