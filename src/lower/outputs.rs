//! Drives to commands: one rung per output over the whole hierarchy.

use super::context::{Condition, Context};
use super::rungs::rung;
use crate::ir::chart::{Machine, Position};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder};
use crate::ir::plc::{GlobalId, Role};

pub fn lower(context: &mut Context<'_>) -> Ladder {
    let machine = context.machine;
    let mut drives: Vec<Vec<Condition>> = vec![Vec::new(); machine.outputs.len()];
    for (id, state) in machine.states.iter() {
        for drive in &state.drives {
            let flag = Expr::Atom(context.flags[id.index()]);
            let condition = Expr::all([flag, context.after_step(&drive.condition)]);
            drives[drive.output.index()].push(condition);
        }
    }
    let mut rungs = Vec::new();
    for (output, drives) in machine.outputs.ids().zip(drives) {
        let coil = command(context, output.index());
        let comment = context.globals[coil].description.clone();
        rung(context, &mut rungs, (coil, CoilKind::Plain), &Expr::any(drives), comment);
    }
    Ladder { rungs }
}

fn command(context: &mut Context<'_>, output: usize) -> GlobalId {
    let signal = &context.globals[context.outputs[output]];
    let (name, origin) = (signal.name.clone(), signal.origin);
    let text = if signal.description.is_empty() { name.clone() } else { signal.description.clone() };
    let name = context.names.give("Cmd", &name);
    let text = with_actuator(context.machine, output, format!("command: {text}"));
    let id = context.global(name, Role::Command, text, origin);
    context.commands.push(id);
    id
}

/// A text on an output, and what the model says of its actuator and of where it leads.
fn with_actuator(machine: &Machine, output: usize, mut text: String) -> String {
    let leads = |p: &&Position| p.output.is_some_and(|o| o.index() == output);
    let place = machine.actuators.values().find_map(|a| Some((a, a.positions.iter().find(leads)?)));
    for (name, says) in place.iter().flat_map(|(a, p)| [(&a.name, &a.description), (&p.name, &p.description)]) {
        if !says.is_empty() {
            text.push_str(&format!("; {name}: {says}"));
        }
    }
    text
}
