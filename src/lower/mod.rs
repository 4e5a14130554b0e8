//! Machine to PLC project. It cannot fail on a machine that [`check`](crate::check) accepts.
//!
//! Gone after it: the hierarchy (each region is an SFC that its parent's flag starts and stops),
//! guards over states (latched conditions), effects and actions (set and reset coils), events (a coil for
//! the next scan), integers and comparisons (rungs with functions), drives (one
//! rung per output), constraints (rungs of the filter).
//!
//! The programs of the one task, in the order in which it runs them:
//!
//! | program | pass | does |
//! | --- | --- | --- |
//! | `Observing` | [`conditions`] | takes down the past; latches what observers read of each other |
//! | one per region of an observer | [`regions`], [`observers`] | the observers |
//! | `Observed` | [`integers`], [`variables`] | what they set, reset and count |
//! | `Conditions` | [`conditions`] | latches what guards read from other programs; decides early what several programs need to know |
//! | one per region of a chart, parents first | [`regions`] | the charts |
//! | `Variables` | [`integers`], [`variables`] | what transitions and active states set, reset and count |
//! | `Outputs` | [`outputs`] | one rung per output: its command |
//! | `Filter` | [`filter`] | one rung per constraint, the forcings, the rounds of relief, the output coils |
//! | `AfterFilter` | [`observers`] | the part of observers that reads what the filter has decided |
//!
//! Everything before `Outputs` reads the flags of steps, the variables and the outputs as the scan
//! before left them, except that a region's SFC reads its parent's new flag, and that charts read what
//! observers have just made of theirs. What is empty is left out, and without observers `Conditions`
//! takes down the past.

mod conditions;
mod context;
mod entries;
mod filter;
mod integers;
mod names;
mod notes;
mod observers;
mod outputs;
mod regions;
mod rungs;
mod variables;

use crate::ir::chart::{ChartKind, Machine};
use crate::ir::ladder::{Ladder, Rung};
use crate::ir::plc::{Body, Origin, Program, Project, Task};
use context::Context;

/// Lowers a machine that has been checked.
pub fn lower(machine: &Machine) -> Project {
    let mut context = Context::new(machine);
    // The passes that follow ask for conditions; so those come first and conditions last, though these
    // run first.
    let observers = regions::lower(&mut context, ChartKind::Observer);
    let mut observed = variables::lower(&mut context, ChartKind::Observer);
    let counted = integers::lower(&mut context, ChartKind::Observer);
    let afterwards = observers::after_filter(&mut context);
    let before_observers = conditions::finish(&mut context);
    let charts = regions::lower(&mut context, ChartKind::Control);
    let mut variables = variables::lower(&mut context, ChartKind::Control);
    let counting = integers::lower(&mut context, ChartKind::Control);
    let outputs = outputs::lower(&mut context);
    let filter = filter::lower(&mut context);
    integers::finish(&mut context, ChartKind::Observer, counted, &mut observed);
    integers::finish(&mut context, ChartKind::Control, counting, &mut variables);
    let mut before_charts = conditions::events(&mut context);
    before_charts.extend(conditions::finish(&mut context));
    let mut past = conditions::previous_values(&mut context);
    let before_charts = if observers.is_empty() {
        past.extend(before_charts);
        std::mem::take(&mut past)
    } else {
        past.extend(before_observers);
        before_charts
    };

    let mut programs = Vec::new();
    let mut ladder = |programs: &mut Vec<Program>, name: &str, description: &str, rungs: Vec<Rung>| {
        if rungs.is_empty() {
            return;
        }
        programs.push(Program {
            name: context.names.fixed(name),
            instance: context.names.fixed(&format!("I_{name}")),
            description: description.into(),
            body: Body::Ladder(Ladder { rungs }),
            origin: Origin::Own,
        });
    };
    let p = &mut programs;
    ladder(p, "Observing", "What observers read, as it was when the scan began", past);
    p.extend(observers);
    ladder(p, "Observed", "What observers set, reset and count", observed.rungs);
    ladder(p, "Conditions", "What guards read, as it was when the scan began", before_charts);
    p.extend(charts);
    ladder(p, "Variables", "What transitions and active states set and reset", variables.rungs);
    ladder(p, "Outputs", "What the chart wants of each output", outputs.rungs);
    ladder(p, "Filter", "What must never happen does not: the only program that writes outputs", filter.rungs);
    ladder(
        p,
        "AfterFilter",
        "What observers take in of the outputs as the filter has let them through",
        afterwards.rungs,
    );

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
        notes: notes::of(machine),
    }
}
