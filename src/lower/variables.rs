//! Effects and actions to set and reset coils, events to plain ones.
//!
//! First what happened once, in the order of [`Step`]; of what has the same place there, only one
//! happens in a scan. Then what active states do: all sets, all resets. Conditions of actions read
//! variables as the transitions left them; where one reads a variable that an action writes, all
//! conditions are taken down in coils before anything is written. What regions with a history remember
//! comes last: where they are when the chart has taken its step.

use super::context::{Condition, Context};
use super::rungs::rung;
use crate::ir::chart::{Atom, ChartKind, Phase, StateId, TransitionId};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder, Rung};
use crate::ir::plc::{GlobalId, Role};

/// What the step of charts of that kind does.
pub fn lower(context: &mut Context<'_>, kind: ChartKind) -> Ladder {
    let machine = context.machine;
    let count = machine.variables.len();
    let happened = happened(context, kind);
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

    let mut rungs = once(context, happened);
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
                let origin = context.globals[context.variables[id.index()]].origin;
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
    if kind == ChartKind::Control {
        raised(context, &mut rungs);
    }
    history(context, &mut rungs);
    Ladder { rungs }
}

/// One coil per event: whether anything raises it in this scan.
fn raised(context: &mut Context<'_>, rungs: &mut Vec<Rung>) {
    let machine = context.machine;
    let mut by: Vec<Vec<Condition>> = vec![Vec::new(); machine.events.len()];
    for (id, t) in machine.transitions.iter() {
        for event in &t.deeds.raises {
            by[event.index()].push(Expr::Atom(context.fires(id)));
        }
    }
    for (id, state) in machine.states.iter() {
        for event in &state.exit.raises {
            by[event.index()].push(context.left(id));
        }
        for event in &state.entry.raises {
            by[event.index()].push(context.entered_now(id));
        }
    }
    for (by, (_, next)) in by.into_iter().zip(context.events.clone()) {
        let text = context.globals[next].description.clone();
        rung(context, rungs, (next, CoilKind::Plain), &Expr::any(by), text);
    }
}

/// What was the last state of a region: the active one; while none is, the one that was.
fn history(context: &mut Context<'_>, rungs: &mut Vec<Rung>) {
    let machine = context.machine;
    for (state, id) in context.conditions.last.clone() {
        let path = machine.state_path(state);
        let parent =
            machine.regions[machine.states[state].region].parent.expect("what has a history is inside a state");
        let (active, around) = (context.flags[state.index()], context.flags[parent.index()]);
        let kept = Expr::all([Expr::Atom(id), Expr::Atom(around).not()]);
        let condition = Expr::any([Expr::Atom(active), kept]);
        rung(context, rungs, (id, CoilKind::Plain), &condition, format!("{path} is where its region is or was last"));
    }
}

/// What flat observers write when these transitions fire, each with the coil that says so: what their
/// sources do when they are left, they themselves, what their targets do when they are entered.
pub fn effects(context: &mut Context<'_>, firing: &[(TransitionId, GlobalId)]) -> Vec<Rung> {
    let machine = context.machine;
    let mut writes: Vec<Vec<Write>> = machine.variables.ids().map(|_| Vec::new()).collect();
    for &(t, fires) in firing {
        let t = &machine.transitions[t];
        let (source, target) = (&machine.states[t.source], &machine.states[t.target]);
        for (step, deeds) in [
            (Step::Left(std::cmp::Reverse(source.depth)), &source.exit),
            (Step::Fired, &t.deeds),
            (Step::Entered(target.depth), &target.entry),
        ] {
            for effect in &deeds.effects {
                let condition = Expr::Atom(fires);
                writes[effect.variable.index()].push(Write { step, value: effect.value, condition });
            }
        }
    }
    writes.iter_mut().for_each(|list| list.sort_by_key(|write| (write.step, !write.value)));
    once(context, writes)
}

/// The rungs of what writes variables once.
fn once(context: &mut Context<'_>, writes: Vec<Vec<Write>>) -> Vec<Rung> {
    let mut rungs = Vec::new();
    for ((id, v), list) in context.machine.variables.iter().zip(writes) {
        for run in list.chunk_by(|a, b| (a.step.who(), a.value) == (b.step.who(), b.value)) {
            let (verb, kind) = word(run[0].value);
            let coil = (context.variables[id.index()], kind);
            let by = Expr::any(run.iter().map(|write| write.condition.clone()));
            rung(context, &mut rungs, coil, &by, format!("{} {verb} {}", run[0].step.who(), v.name));
        }
    }
    rungs
}

fn word(value: bool) -> (&'static str, CoilKind) {
    if value { ("set", CoilKind::Set) } else { ("reset", CoilKind::Reset) }
}

/// What writes a variable once, in the order in which it does.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    /// An internal transition happens; those further out come first, then as they are written.
    Inside(u32, TransitionId),
    /// A state is left; those further in come first.
    Left(std::cmp::Reverse<u32>),
    /// Any other transition fires.
    Fired,
    /// A state is entered; those further out come first.
    Entered(u32),
}

impl Step {
    fn who(self) -> &'static str {
        match self {
            Step::Left(_) => "states that are left and",
            Step::Inside(..) => "internal transitions that",
            Step::Fired => "transitions that",
            Step::Entered(_) => "states that are entered and",
        }
    }
}

struct Write {
    step: Step,
    value: bool,
    condition: Condition,
}

/// For each variable, what in the step of charts of that kind writes it once, in order; sets before
/// resets where that is free.
fn happened(context: &mut Context<'_>, kind: ChartKind) -> Vec<Vec<Write>> {
    let machine = context.machine;
    let mut writes: Vec<Vec<Write>> = machine.variables.ids().map(|_| Vec::new()).collect();
    let fires = machine.transitions.iter().filter(|(_, t)| t.phase == Phase::Start && machine.kind(t.scope) == kind);
    for (id, t) in fires {
        let step = if t.internal { Step::Inside(machine.states[t.source].depth, id) } else { Step::Fired };
        for effect in &t.deeds.effects {
            let condition = Expr::Atom(context.fires(id));
            writes[effect.variable.index()].push(Write { step, value: effect.value, condition });
        }
    }
    for (id, state) in machine.states.iter().filter(|(_, s)| machine.kind(s.region) == kind) {
        for effect in &state.exit.effects {
            let (step, condition) = (Step::Left(std::cmp::Reverse(state.depth)), context.left(id));
            writes[effect.variable.index()].push(Write { step, value: effect.value, condition });
        }
        for effect in &state.entry.effects {
            let (step, condition) = (Step::Entered(state.depth), context.entered_now(id));
            writes[effect.variable.index()].push(Write { step, value: effect.value, condition });
        }
    }
    for list in &mut writes {
        list.sort_by_key(|write| (write.step, !write.value));
    }
    writes
}

impl Context<'_> {
    /// Whether the state was active when the scan began and has been left.
    pub fn left(&mut self, state: StateId) -> Condition {
        let was = Expr::Atom(self.active(state));
        let gone = Expr::Atom(self.flags[state.index()]).not();
        Expr::all([was, Expr::any([gone].into_iter().chain(self.again(state).map(Expr::Atom)))])
    }

    /// Whether the state is active and has been entered in this scan.
    pub fn entered_now(&mut self, state: StateId) -> Condition {
        let is = Expr::Atom(self.flags[state.index()]);
        let new = Expr::Atom(self.active(state)).not();
        Expr::all([is, Expr::any([new].into_iter().chain(self.again(state).map(Expr::Atom)))])
    }
}
