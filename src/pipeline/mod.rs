//! The one place that knows the order of the stages.

use crate::base::{Diagnostics, LineIndex};
use crate::emit::{self, Header};
use crate::ir::chart::Machine;
use crate::ir::plc::Project;
use crate::ir::scenario::{Condition, Doing};
use crate::simulate::run::Program;
use crate::{check, lower, parse, read, resolve};

pub use crate::emit::Dialect;

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

/// What a machine without errors runs as, each with its name: the chart itself, and the PLC program that is
/// read back from its XML.
pub fn programs(machine: &Machine) -> Vec<(&'static str, Program)> {
    let project = lower(machine);
    let xml = emit::plcopen(&project, Dialect::Beremiz, &Header::default());
    let (read, diagnostics) = read::read(&xml);
    let read = read.unwrap_or_else(|| panic!("what is written can be read back: {diagnostics:?}"));
    vec![("chart", Program::chart(machine)), ("plc", Program::plc(machine, &project, &read))]
}

/// A condition over the machine that `source` describes, as its scenarios write it. The places of the
/// diagnostics mean nothing.
pub fn condition(source: &str, text: &str) -> Result<Condition, Diagnostics> {
    // The scenario that holds it comes last and changes no id of what is there.
    let (machine, diagnostics) = check(&format!("{source}\nscenario \"\" {{ wait until {text}\nwithin 1 scan }}"));
    let step = machine.and_then(|mut m| m.scenarios.pop()).and_then(|mut s| s.steps.pop());
    match step.map(|s| s.doing) {
        Some(Doing::Until(condition, _)) => Ok(condition),
        _ => Err(diagnostics),
    }
}

/// What [`build`] is told.
#[derive(Clone, Debug)]
pub struct Options {
    /// For which family of IDEs.
    pub dialect: Dialect,
    /// When the file says that it was made, as `xsd:dateTime`; never read from a clock here.
    pub created: String,
}

/// What [`build`] makes.
#[derive(Clone, Debug)]
pub struct Output {
    /// The machine.
    pub machine: Machine,
    /// Its PLC project.
    pub project: Project,
    /// The project as PLCopen XML.
    pub xml: String,
    /// What each name in the project stands for, as CSV.
    pub names: String,
}

/// Text to PLCopen XML. Without errors among the diagnostics there is an output.
pub fn build(source: &str, options: &Options) -> (Option<Output>, Diagnostics) {
    let (machine, diagnostics) = check(source);
    let output = machine.map(|machine| {
        let project = lower(&machine);
        let header = Header { created: options.created.clone(), ..Header::default() };
        let xml = emit::plcopen(&project, options.dialect, &header);
        let names = emit::names::table(&project, &LineIndex::new(source));
        Output { machine, project, xml, names }
    });
    (output, diagnostics)
}
