//! Effects and actions to set and reset coils.
//!
//! First what fired transitions did, then what active states do, in this order: all sets, all
//! resets. Conditions of actions read variables as the transitions left them; where one reads a
//! variable that an action writes, all conditions are taken down in coils before anything is written.

use super::context::{Condition, Context};
use super::rungs::rung;
use crate::ir::chart::Atom;
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder};
use crate::ir::plc::Role;

pub fn lower(context: &mut Context<'_>) -> Ladder {
    let machine = context.machine;
    let count = machine.variables.len();
    let mut effects: Vec<[Vec<Condition>; 2]> = vec![Default::default(); count];
    for (id, t) in machine.transitions.iter() {
        for effect in &t.effects {
            let fires = Expr::Atom(context.fires(id));
            effects[effect.variable.index()][usize::from(effect.value)].push(fires);
        }
    }
    let mut actions: Vec<[Vec<Condition>; 2]> = vec![Default::default(); count];
    let mut reads_written = false;
    let written: Vec<bool> = {
        let mut written = vec![false; count];
        machine.states.values().flat_map(|s| &s.actions).for_each(|a| written[a.variable.index()] = true);
        written
    };
    for (id, state) in machine.states.iter() {
        for action in &state.actions {
            action.condition.for_each_atom(&mut |a| {
                if let Atom::Variable(v) = a {
                    reads_written |= written[v.index()];
                }
            });
            let flag = Expr::Atom(context.flags[id.index()]);
            let condition = Expr::all([flag, context.after_step(&action.condition)]);
            actions[action.variable.index()][usize::from(action.value)].push(condition);
        }
    }

    let mut rungs = Vec::new();
    let word = |value: bool| if value { ("set", CoilKind::Set) } else { ("reset", CoilKind::Reset) };
    for (id, v) in machine.variables.iter() {
        for value in [true, false] {
            let by = std::mem::take(&mut effects[id.index()][usize::from(value)]);
            let (verb, kind) = word(value);
            let coil = (context.variables[id.index()], kind);
            rung(context, &mut rungs, coil, &Expr::any(by), format!("transitions that {verb} {}", v.name));
        }
    }
    if reads_written {
        for (id, v) in machine.variables.iter() {
            for value in [true, false] {
                let by = std::mem::take(&mut actions[id.index()][usize::from(value)]);
                if by.is_empty() {
                    continue;
                }
                let (verb, _) = word(value);
                let name = context.names.give(if value { "Set" } else { "Reset" }, &v.name);
                let text = format!("an active state {verb}s {}", v.name);
                let origin = context.globals[context.variables[id.index()]].origin.clone();
                let coil = context.global(name, Role::Condition, text.clone(), origin);
                rung(context, &mut rungs, (coil, CoilKind::Plain), &Expr::any(by), text);
                actions[id.index()][usize::from(value)] = vec![Expr::Atom(coil)];
            }
        }
    }
    for value in [true, false] {
        for (id, v) in machine.variables.iter() {
            let by = std::mem::take(&mut actions[id.index()][usize::from(value)]);
            let (verb, kind) = word(value);
            let coil = (context.variables[id.index()], kind);
            rung(context, &mut rungs, coil, &Expr::any(by), format!("active states that {verb} {}", v.name));
        }
    }
    Ladder { rungs }
}
