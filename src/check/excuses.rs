//! Warnings that the model accepts are not told, and an acceptance that accepts none is.

use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::Machine;
use crate::ir::scenario::Excused;

/// Which acceptances have had something to accept.
pub struct Excuses<'m> {
    machine: &'m Machine,
    used: Vec<bool>,
}

impl<'m> Excuses<'m> {
    /// None of those of the machine yet.
    pub fn new(machine: &'m Machine) -> Self {
        Excuses { machine, used: vec![false; machine.excused.len()] }
    }

    /// Tells a warning, unless it is accepted.
    pub fn warn(&mut self, of: &Excused, warning: Diagnostic, found: &mut Diagnostics) {
        match self.machine.excused.iter().position(|excuse| excuse.warning == *of) {
            Some(i) => self.used[i] = true,
            None => found.push(warning),
        }
    }

    /// Tells which acceptances have had nothing to accept.
    pub fn stale(self, found: &mut Diagnostics) {
        for (excuse, _) in self.machine.excused.iter().zip(&self.used).filter(|(_, used)| !**used) {
            let written = &excuse.written;
            let now = match excuse.warning {
                Excused::Unused(_) => "what it names is used",
                Excused::Cyclic(_) => "no reliefs of just these constraints set each other off",
            };
            found.push(
                Diagnostic::new(Code::StaleAcceptance, format!("`{written}` accepts no warning: {now}"))
                    .label(excuse.span, "stale")
                    .help("take it out"),
            );
        }
    }
}
