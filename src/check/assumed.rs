//! The assumptions leave something that can be.

use crate::base::{Code, Diagnostic, Diagnostics};
use crate::constraints::questions::{Found, Questions};
use crate::ir::chart::Machine;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let assumptions = &machine.safety.assumptions;
    if assumptions.is_empty() || !matches!(Questions::new(machine).ask(&[]), Found::Never) {
        return;
    }
    let mut d = Diagnostic::new(Code::NothingPossible, "the assumptions exclude every case");
    for a in assumptions {
        d = d.label(a.span, "one of them");
    }
    found.push(d.help("nothing that is decided under them would mean anything; take one of them back"));
}
