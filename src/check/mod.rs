//! Machine to diagnostics: the rules that a resolved machine has to meet before it is lowered.
//!
//! One file per rule, and no rule depends on another. After a run without errors:
//!
//! - [`lower`](crate::lower) cannot fail;
//! - every state can be entered, so every step of every SFC is reached from its initial step;
//! - observers know nothing of control charts;
//! - no variable is written by two regions in one scan, no actuator driven both ways;
//! - it says how many sweeps reliefs in order take, and after these no constraint is violated;
//! - the corrected filter algorithm leaves no constraint violated (properties 0, 1, 3, 4 and the
//!   absence of opposite reliefs, under the declared assumptions).

mod assumed;
mod coherence;
mod dead;
mod done;
mod entered;
mod excuses;
mod fires;
mod observers;
mod opposed_drives;
mod order;
mod priorities;
mod relation;
mod size;
mod unused;
mod writes;

use crate::base::Diagnostics;
use crate::ir::chart::Machine;
use excuses::Excuses;

/// Applies every rule.
pub fn check(machine: &mut Machine) -> Diagnostics {
    let mut found = Diagnostics::new();
    size::check(machine, &mut found);
    entered::check(machine, &mut found);
    done::check(machine, &mut found);
    priorities::check(machine, &mut found);
    fires::check(machine, &mut found);
    observers::check(machine, &mut found);
    writes::check(machine, &mut found);
    opposed_drives::check(machine, &mut found);
    assumed::check(machine, &mut found);
    order::check(machine, &mut found);
    let mut excuses = Excuses::new(machine);
    coherence::check(machine, &mut excuses, &mut found);
    unused::check(machine, &mut excuses, &mut found);
    // An error may be the reason that a warning is absent.
    if !found.has_errors() {
        excuses.stale(&mut found);
    }
    found
}
