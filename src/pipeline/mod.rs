//! The one place that knows the order of the stages.

use crate::base::Diagnostics;
use crate::ir::chart::Machine;
use crate::ir::plc::Project;
use crate::{check, lower, parse, resolve};

/// Text to a machine that keeps every rule. Without errors among the diagnostics there is one.
pub fn check(source: &str) -> (Option<Machine>, Diagnostics) {
    let (tree, mut diagnostics) = parse::parse(source);
    let Some(tree) = tree else { return (None, diagnostics) };
    let (machine, found) = resolve::resolve(&tree);
    diagnostics.append(found);
    if !diagnostics.has_errors() {
        diagnostics.append(check::check(&machine));
    }
    diagnostics.sort();
    let machine = (!diagnostics.has_errors()).then_some(machine);
    (machine, diagnostics)
}

/// A machine without errors to its PLC project.
pub fn lower(machine: &Machine) -> Project {
    lower::lower(machine)
}
