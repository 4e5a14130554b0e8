//! Machine to PLC project. It cannot fail on a machine that [`check`](crate::check) accepts.
//!
//! Gone after it: the hierarchy (each region is an SFC that its parent's flag starts and stops),
//! guards over states (latched conditions), effects and actions (set and reset coils),
//! integers and comparisons (rungs with functions), drives (one
//! rung per output), constraints (rungs of the filter).
//!
//! The programs of the one task, in the order in which it runs them:
//!
//! | program | pass | does |
//! | --- | --- | --- |
//! | `Conditions` | [`conditions`] | latches what guards read from other programs; decides early what several programs need to know |
//! | one per region, parents first | [`regions`] | the chart |
//! | `Variables` | [`integers`], [`variables`] | what transitions and active states set, reset and count |
//! | `Outputs` | [`outputs`] | one rung per output: its command |
//! | `Filter` | [`filter`] | one rung per constraint, the forcings, the rounds of relief, the output coils |
//!
//! Everything before `Outputs` reads the flags of steps, the variables and the outputs as the scan
//! before left them, except that a region's SFC reads its parent's new flag.

mod conditions;
mod context;
mod entries;
mod filter;
mod integers;
mod names;
mod outputs;
mod regions;
mod rungs;
mod variables;

use crate::ir::chart::Machine;
use crate::ir::plc::{Body, Origin, Program, Project, Task};
use context::Context;

/// Lowers a machine that has been checked.
pub fn lower(machine: &Machine) -> Project {
    let mut context = Context::new(machine);
    // The passes that follow ask for conditions; so they come first and `Conditions` last, though
    // it runs first.
    let regions = regions::lower(&mut context);
    let mut variables = variables::lower(&mut context);
    integers::lower(&mut context);
    let outputs = outputs::lower(&mut context);
    let filter = filter::lower(&mut context);
    integers::finish(&mut context, &mut variables);
    let conditions = conditions::finish(&mut context);

    let mut programs = Vec::new();
    let mut ladder = |context: &mut Context<'_>, name: &str, description: &str, rungs| {
        programs.push(Program {
            name: context.names.fixed(name),
            instance: context.names.fixed(&format!("I_{name}")),
            description: description.into(),
            body: Body::Ladder(rungs),
            origin: Origin::default(),
        });
    };
    if !conditions.rungs.is_empty() {
        ladder(&mut context, "Conditions", "What guards read, as it was when the scan began", conditions);
    }
    let before = if variables.rungs.is_empty() { 0 } else { 1 };
    if before == 1 {
        ladder(&mut context, "Variables", "What transitions and active states set and reset", variables);
    }
    ladder(&mut context, "Outputs", "What the chart wants of each output", outputs);
    ladder(&mut context, "Filter", "What must never happen does not: the only program that writes outputs", filter);
    let tail = programs.split_off(programs.len() - 2 - before);
    programs.extend(regions);
    programs.extend(tail);

    let task = Task {
        name: context.names.fixed("Cycle"),
        configuration: context.names.fixed("Config"),
        resource: context.names.fixed("Res"),
        interval: machine.cycle,
    };
    Project {
        name: machine.name.clone(),
        description: machine.description.clone(),
        globals: context.globals,
        programs,
        task,
    }
}
