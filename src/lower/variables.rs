//! Effects and actions to set and reset coils.
//!
//! First what fired transitions did, then what active states do, in this order: all sets, all
//! resets. Conditions of actions read variables as the transitions left them; where one reads a
//! variable that an action writes, all conditions are taken down in coils before anything is written.

use super::context::{Condition, Context};
use super::rungs::rung;
use crate::ir::chart::{Atom, ChartKind, Phase, Transition};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder, Rung};
use crate::ir::plc::{GlobalId, Role};

/// What the step of charts of that kind does.
pub fn lower(context: &mut Context<'_>, kind: ChartKind) -> Ladder {
    let machine = context.machine;
    let count = machine.variables.len();
    let step = |t: &Transition| t.phase == Phase::Start && machine.kind(t.scope) == kind;
    let mut firing = Vec::new();
    for (id, t) in machine.transitions.iter().filter(|(_, t)| step(t) && !t.effects.is_empty()) {
        firing.push((t, context.fires(id)));
    }
    let mut rungs = effects(context, &firing);
    let mut actions: Vec<[Vec<Condition>; 2]> = vec![Default::default(); count];
    let mut reads_written = false;
    let written: Vec<bool> = {
        let mut written = vec![false; count];
        machine.states.values().flat_map(|s| &s.actions).for_each(|a| written[a.variable.index()] = true);
        written
    };
    for (id, state) in machine.states.iter().filter(|(_, s)| machine.kind(s.region) == kind) {
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

/// What transitions set and reset, each with the coil that says whether it fires.
pub fn effects(context: &mut Context<'_>, firing: &[(&Transition, GlobalId)]) -> Vec<Rung> {
    let machine = context.machine;
    let mut effects: Vec<[Vec<Condition>; 2]> = vec![Default::default(); machine.variables.len()];
    for &(t, fires) in firing {
        for effect in &t.effects {
            effects[effect.variable.index()][usize::from(effect.value)].push(Expr::Atom(fires));
        }
    }
    let mut rungs = Vec::new();
    for (id, v) in machine.variables.iter() {
        for value in [true, false] {
            let by = std::mem::take(&mut effects[id.index()][usize::from(value)]);
            let (verb, kind) = word(value);
            let coil = (context.variables[id.index()], kind);
            rung(context, &mut rungs, coil, &Expr::any(by), format!("transitions that {verb} {}", v.name));
        }
    }
    rungs
}

fn word(value: bool) -> (&'static str, CoilKind) {
    if value { ("set", CoilKind::Set) } else { ("reset", CoilKind::Reset) }
}
