//! A machine and its PLC project to the counts of what they consist of.

use crate::ir::chart::{ChartKind, Machine, StateKind, outputs_of};
use crate::ir::plc::{Body, Project};
use serde::Serialize;
use std::fmt;

/// The counts of a model and of its program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Stats {
    /// Of the model.
    pub machine: MachineStats,
    /// Of the PLC project.
    pub program: ProgramStats,
}

/// What a model consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MachineStats {
    /// Charts, composite states and named regions (the paper on statecharts, section 3); observers are no modes of the machine.
    pub macro_states: usize,
    /// All other states, movements and final states included; those of observers are not.
    pub elementary_states: usize,
    /// Deepest nesting of macro states; a chart is level 1.
    pub levels: usize,
    /// Observers.
    pub observers: usize,
    /// Regions, named or not, those of observers included.
    pub regions: usize,
    /// Transitions, the ends of movements included.
    pub transitions: usize,
    /// Movements; they are elementary states too.
    pub movements: usize,
    /// Inputs.
    pub inputs: usize,
    /// Outputs.
    pub outputs: usize,
    /// Variables.
    pub variables: usize,
    /// Integers.
    pub integers: usize,
    /// Actuators.
    pub actuators: usize,
    /// Constraints each of whose products names one output.
    pub simple_constraints: usize,
    /// Constraints with a product that names several outputs.
    pub combined_constraints: usize,
    /// Products of all constraints.
    pub products: usize,
}

/// What a PLC project consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ProgramStats {
    /// Programs, in SFC and ladder.
    pub programs: usize,
    /// Steps of all SFCs.
    pub steps: usize,
    /// Transitions of all SFCs.
    pub transitions: usize,
    /// Rungs of all ladder diagrams.
    pub rungs: usize,
    /// Global variables.
    pub globals: usize,
}

impl Stats {
    /// Counts both.
    pub fn of(machine: &Machine, project: &Project) -> Stats {
        Stats { machine: MachineStats::of(machine), program: ProgramStats::of(project) }
    }
}

impl MachineStats {
    /// Counts what the model consists of.
    pub fn of(machine: &Machine) -> MachineStats {
        let states = |kind: fn(StateKind) -> bool| machine.states.values().filter(|s| kind(s.kind)).count();
        let composite = states(|k| k == StateKind::Composite);
        let named = machine.regions.values().filter(|r| r.name.is_some()).count();
        let combined = |products: &[_]| products.iter().any(|p| outputs_of(p).count() > 1);
        let observers = machine.charts.iter().filter(|c| c.kind == ChartKind::Observer).count();
        let observing = machine.states.ids().filter(|&s| machine.observes(s)).count();
        let constraints = &machine.safety.constraints;
        let combined = constraints.values().filter(|c| combined(&c.products)).count();
        MachineStats {
            macro_states: machine.charts.len() - observers + composite + named,
            elementary_states: machine.states.len() - composite - observing,
            levels: levels(machine),
            observers,
            regions: machine.regions.len(),
            transitions: machine.transitions.len(),
            movements: states(|k| matches!(k, StateKind::Movement { .. })),
            inputs: machine.inputs.len(),
            outputs: machine.outputs.len(),
            variables: machine.variables.len(),
            integers: machine.integers.len(),
            actuators: machine.actuators.len(),
            simple_constraints: constraints.len() - combined,
            combined_constraints: combined,
            products: constraints.values().map(|c| c.products.len()).sum(),
        }
    }
}

/// Deepest nesting of macro states. A region has the level of what contains it, one more if it has
/// a name; a composite state lies one below its region.
fn levels(machine: &Machine) -> usize {
    let mut of_region: Vec<usize> = Vec::new();
    // A region stands behind the one that contains it.
    for region in machine.regions.values() {
        let outer = region.parent.map_or(1, |state| of_region[machine.states[state].region.index()] + 1);
        of_region.push(outer + usize::from(region.name.is_some()));
    }
    let charts = usize::from(!machine.charts.is_empty());
    of_region.into_iter().max().unwrap_or(charts)
}

impl ProgramStats {
    /// Counts what the project consists of.
    pub fn of(project: &Project) -> ProgramStats {
        let mut stats =
            ProgramStats { programs: project.programs.len(), globals: project.globals.len(), ..Default::default() };
        for program in &project.programs {
            match &program.body {
                Body::Sfc(sfc) => {
                    stats.steps += sfc.steps.len();
                    stats.transitions += sfc.transitions.len();
                }
                Body::Ladder(ladder) => stats.rungs += ladder.rungs.len(),
            }
        }
        stats
    }
}

impl fmt::Display for Stats {
    /// One count a line, numbers aligned.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (m, p) = (&self.machine, &self.program);
        let of_machine = [
            ("macro states", m.macro_states),
            ("elementary states", m.elementary_states),
            ("levels", m.levels),
            ("observers", m.observers),
            ("regions", m.regions),
            ("transitions", m.transitions),
            ("movements", m.movements),
            ("inputs", m.inputs),
            ("outputs", m.outputs),
            ("variables", m.variables),
            ("integers", m.integers),
            ("actuators", m.actuators),
            ("simple constraints", m.simple_constraints),
            ("combined constraints", m.combined_constraints),
            ("products", m.products),
        ];
        let of_program = [
            ("programs", p.programs),
            ("steps", p.steps),
            ("transitions", p.transitions),
            ("rungs", p.rungs),
            ("globals", p.globals),
        ];
        writeln!(f, "machine")?;
        of_machine.iter().try_for_each(|(what, count)| writeln!(f, "  {what:<20} {count:>6}"))?;
        writeln!(f, "program")?;
        of_program.iter().try_for_each(|(what, count)| writeln!(f, "  {what:<20} {count:>6}"))
    }
}
