//! Reliefs in order come to rest, for all commands and all readings that the assumptions allow
//! ([`crate::constraints::sweeps`]); after how many sweeps is written into the machine.

use super::coherence;
use crate::base::{Code, Diagnostic, Diagnostics, limits};
use crate::constraints::properties;
use crate::constraints::sweeps::{Kind, Restless, sweeps};
use crate::ir::chart::{Machine, Relief};
use crate::ir::relief::Reliefs;

pub fn check(machine: &mut Machine, found: &mut Diagnostics) {
    if machine.safety.relief == Relief::Together {
        return;
    }
    let reliefs = Reliefs::of(&machine.safety);
    let contradictions = properties::contradictions(machine, &reliefs);
    if !contradictions.is_empty() {
        contradictions.iter().for_each(|v| found.push(coherence::describe(machine, v)));
        return;
    }
    match sweeps(machine, &reliefs) {
        Ok(sweeps) => machine.safety.relief = Relief::InOrder { sweeps },
        Err(restless) => found.push(describe(machine, &restless)),
    }
}

fn describe(machine: &Machine, restless: &Restless) -> Diagnostic {
    let constraints = &machine.safety.constraints;
    let names: Vec<String> = restless.constraints.iter().map(|&c| format!("`{}`", constraints[c].name)).collect();
    let message = match restless.kind {
        Kind::Unsafe => return coherence::no_safe_outputs(machine, &restless.witness),
        Kind::Endless => "the reliefs never come to rest".to_owned(),
        Kind::TooMany => format!("the reliefs do not come to rest within {} sweeps", limits::SWEEPS),
    };
    let mut d =
        Diagnostic::new(Code::RestlessReliefs, message).label(machine.safety.span, "relieved in order, over and over");
    for &c in &restless.constraints {
        d = d.label(constraints[c].span, "violated time and again");
    }
    if !names.is_empty() {
        d = d.help(format!("{} stay violated when {}", names.join(", "), restless.witness.show(machine)));
    }
    d.help("write them in another order, or let another output yield")
}
