//! Which histories a machine remembers.

use crate::ir::chart::{Inside, Machine};

/// For each region, whether some transition asks for its history.
pub fn asked(machine: &Machine) -> Vec<bool> {
    let mut shallow = vec![false; machine.states.len()];
    let mut deep = shallow.clone();
    for t in machine.transitions.values() {
        match t.inside {
            Inside::History => shallow[t.target.index()] = true,
            Inside::DeepHistory => deep[t.target.index()] = true,
            Inside::Default | Inside::Fork(_) => {}
        }
    }
    let mut asked = vec![false; machine.regions.len()];
    for (id, region) in machine.regions.iter() {
        // What is deep reaches all that is below; a parent comes before what it contains.
        for &s in &region.states {
            deep[s.index()] |= region.parent.is_some_and(|p| deep[p.index()]);
        }
        asked[id.index()] = region.parent.is_some_and(|p| shallow[p.index()] || deep[p.index()]);
    }
    asked
}
