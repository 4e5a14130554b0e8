//! A region fits into one SFC.

use crate::base::{Code, Diagnostic, Diagnostics, limits};
use crate::ir::chart::{Machine, Phase};

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    for (id, region) in machine.regions.iter() {
        if region.states.len() > limits::REGION_STATES {
            let path = machine.region_path(id);
            found.push(
                Diagnostic::new(
                    Code::TooManyStates,
                    format!(
                        "`{path}` has {} states; at most {} fit into one SFC",
                        region.states.len(),
                        limits::REGION_STATES
                    ),
                )
                .label(region.span, "movements count as states")
                .help("gather states that belong together into composite states: each becomes an SFC of its own"),
            );
        }
    }
    let (start, end) = (machine.scoped(Phase::Start), machine.scoped(Phase::End));
    for ((id, region), list) in machine.regions.iter().zip(start).chain(machine.regions.iter().zip(end)) {
        if list.len() > limits::REGION_TRANSITIONS {
            let path = machine.region_path(id);
            found.push(
                Diagnostic::new(
                    Code::TooManyStates,
                    format!("`{path}` has {} transitions; at most {} fit into one SFC", list.len(), limits::REGION_TRANSITIONS),
                )
                .label(region.span, "each state that `from any` stands for counts")
                .help("gather states that are left in the same way into a composite state, and let one transition leave it"),
            );
        }
    }
}
