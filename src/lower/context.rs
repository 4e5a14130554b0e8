//! What the passes share: the globals made so far and which of them stands for what.

use super::entries::Entries;
use super::integers::Integers;
use super::names::Names;
use crate::base::Arena;
use crate::ir::chart::{Atom, ChartKind, Guard, Machine, OutputId, Phase, RegionId, StateId, StateKind, TransitionId};
use crate::ir::expr::Expr;
use crate::ir::ladder::Rung;
use crate::ir::plc::{Global, GlobalId, Origin, Role, Value};
use std::collections::BTreeMap;

/// An expression over globals.
pub type Condition = Expr<GlobalId>;

/// What the passes share.
pub struct Context<'m> {
    pub machine: &'m Machine,
    pub names: Names,
    pub globals: Arena<Global>,
    pub inputs: Vec<GlobalId>,
    pub outputs: Vec<GlobalId>,
    pub variables: Vec<GlobalId>,
    /// For each event, its value in this scan, and whether it is raised for the next one.
    pub events: Vec<(GlobalId, GlobalId)>,
    /// For each state, TRUE while its step is active.
    pub flags: Vec<GlobalId>,
    /// For each output, what the chart wants of it; filled by the pass that computes it.
    pub commands: Vec<GlobalId>,
    /// For each region, the transitions whose scope it is, in the order in which they are tried.
    pub scoped: Vec<Vec<TransitionId>>,
    /// For each region, those that are tried after the filter; nothing for most.
    pub ending: Vec<Vec<TransitionId>>,
    pub entries: Entries,
    pub conditions: Conditions,
    pub integers: Integers,
}

/// The conditions asked for so far, and the rungs that compute them, in groups that depend only on
/// earlier groups and on earlier rungs of their own.
#[derive(Default)]
pub struct Conditions {
    pub previous: BTreeMap<usize, GlobalId>,
    pub decided: BTreeMap<OutputId, GlobalId>,
    pub active: BTreeMap<StateId, GlobalId>,
    pub done: BTreeMap<StateId, GlobalId>,
    /// For each state and time, the condition and the timer's name.
    pub elapsed: BTreeMap<(StateId, u32), (GlobalId, String)>,
    pub enabled: BTreeMap<TransitionId, GlobalId>,
    pub left: BTreeMap<StateId, Option<GlobalId>>,
    pub fires: BTreeMap<TransitionId, GlobalId>,
    pub before: BTreeMap<TransitionId, GlobalId>,
    pub entered: BTreeMap<StateId, GlobalId>,
    pub last: BTreeMap<StateId, GlobalId>,
    pub unfinished: BTreeMap<StateId, GlobalId>,
    pub again: BTreeMap<StateId, GlobalId>,
    pub latches: Vec<Rung>,
    pub timing: Vec<Rung>,
    pub enabling: Vec<Rung>,
    pub ranking: Vec<Rung>,
    pub firing: Vec<Rung>,
    pub entering: Vec<Rung>,
}

impl<'m> Context<'m> {
    /// Globals for signals, variables and states; those with an address first.
    pub fn new(machine: &'m Machine) -> Self {
        let (scoped, ending) = (machine.scoped(Phase::Start), machine.scoped(Phase::End));
        let mut context = Context {
            machine,
            names: Names::new(machine),
            globals: Arena::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            variables: Vec::new(),
            events: Vec::new(),
            flags: Vec::new(),
            commands: Vec::new(),
            entries: Entries::of(machine),
            scoped,
            ending,
            conditions: Conditions::default(),
            integers: Integers::default(),
        };
        context.signals();
        for (id, v) in machine.variables.iter() {
            let global = context.globals.push(Global {
                name: v.name.clone(),
                address: None,
                initial: Value::Bool(v.initial),
                role: Role::Variable,
                description: v.description.clone(),
                origin: Origin::Variable(id),
            });
            context.variables.push(global);
        }
        for (id, e) in machine.events.iter() {
            let origin = Origin::Event(id);
            let now = context.global(e.name.clone(), Role::Event, e.description.clone(), origin);
            let name = context.names.give("Raise", &e.name);
            let next = context.global(name, Role::Condition, format!("{} is raised for the next scan", e.name), origin);
            context.events.push((now, next));
        }
        context.integers();
        for (id, state) in machine.states.iter() {
            let name = context.names.state("X", id);
            let path = machine.state_path(id);
            let text =
                if state.description.is_empty() { format!("{path} is active") } else { state.description.clone() };
            let flag = context.global(name, Role::StepFlag, text, Origin::State(id));
            context.flags.push(flag);
        }
        context
    }

    fn signals(&mut self) {
        let machine = self.machine;
        let inputs =
            machine.inputs.iter().map(|(id, i)| (&i.name, &i.address, &i.description, Origin::Input(id), Role::Input));
        let outputs = machine
            .outputs
            .iter()
            .map(|(id, o)| (&o.name, &o.address, &o.description, Origin::Output(id), Role::Output));
        let signals: Vec<_> = inputs.chain(outputs).collect();
        let mut ids = vec![None; signals.len()];
        for located in [true, false] {
            for (i, (name, address, description, origin, role)) in signals.iter().enumerate() {
                if address.is_some() == located {
                    ids[i] = Some(self.globals.push(Global {
                        name: (*name).clone(),
                        address: (*address).clone(),
                        initial: Value::Bool(false),
                        role: *role,
                        description: (*description).clone(),
                        origin: *origin,
                    }));
                }
            }
        }
        let mut ids = ids.into_iter().flatten();
        self.inputs = ids.by_ref().take(machine.inputs.len()).collect();
        self.outputs = ids.collect();
    }

    /// A new global that is FALSE before the first scan.
    pub fn global(&mut self, name: String, role: Role, description: String, origin: Origin) -> GlobalId {
        self.globals.push(Global { name, address: None, initial: Value::Bool(false), role, description, origin })
    }

    /// A guard as a program reads it that runs before the step of `own`'s kind of charts or takes part in
    /// it. Flags of `own` region's steps are read directly: its SFC writes them after it has tried its
    /// transitions. So are those of observers by charts, which come later. Others are latched.
    pub fn guard(&mut self, guard: &Guard, own: RegionId) -> Condition {
        let settled = |m: &Machine, s: StateId| m.observes(s) && m.kind(own) == ChartKind::Control;
        guard.map(&mut |atom| match *atom {
            Atom::In(s) if own == self.machine.states[s].region || settled(self.machine, s) => {
                Expr::Atom(self.flags[s.index()])
            }
            Atom::In(s) => Expr::Atom(self.active(s)),
            Atom::Done(s) if settled(self.machine, s) => self.done_by_flags(s),
            Atom::Done(s) => Expr::Atom(self.done(s)),
            Atom::After(s, ms) => Expr::Atom(self.elapsed(s, ms)),
            Atom::Compare(c) if self.machine.kind(own) == ChartKind::Control && self.is_observed(c) => {
                Expr::Atom(self.compared_by_observers(c))
            }
            Atom::Compare(c) => Expr::Atom(self.compared_before(c)),
            other => self.value(other),
        })
    }

    /// A condition as a program reads it that runs after the chart's step.
    pub fn after_step(&mut self, condition: &Guard) -> Condition {
        condition.map(&mut |atom| match *atom {
            Atom::In(s) => Expr::Atom(self.flags[s.index()]),
            Atom::Done(s) => self.done_by_flags(s),
            Atom::Compare(c) => Expr::Atom(self.compared_after(c)),
            other => self.value(other),
        })
    }

    /// A condition as a program reads it that runs after the filter.
    pub fn after_filter(&mut self, condition: &Guard) -> Condition {
        condition.map(&mut |atom| match *atom {
            Atom::In(s) => Expr::Atom(self.flags[s.index()]),
            Atom::Done(s) => self.done_by_flags(s),
            Atom::Output(o) => Expr::Atom(self.outputs[o.index()]),
            Atom::PrevOutput(o) => Expr::Atom(self.decided(o)),
            // Observers compare what they count, and that has been left alone since their step.
            Atom::Compare(c) => Expr::Atom(self.compared_by_observers(c)),
            other => self.value(other),
        })
    }

    /// What every program but the last one reads alike. Outputs are written by the last rungs of the last program, so
    /// until then they hold the value of the scan before.
    pub fn value(&mut self, atom: Atom) -> Condition {
        Expr::Atom(match atom {
            Atom::Input(i) => self.inputs[i.index()],
            Atom::PrevInput(i) => self.previous(i.index()),
            Atom::PrevOutput(o) => self.outputs[o.index()],
            Atom::Variable(v) => self.variables[v.index()],
            Atom::Event(e) => self.events[e.index()].0,
            Atom::Compare(_) | Atom::Output(_) | Atom::In(_) | Atom::Done(_) | Atom::After(..) => {
                unreachable!("{atom:?} depends on where it is read")
            }
        })
    }

    /// A transition in words.
    pub fn about_transition(&self, transition: TransitionId) -> String {
        Origin::Transition(transition).says(self.machine)
    }

    /// What is the case with a transition, and why the transition is there.
    pub fn says_of(&self, transition: TransitionId, says: &str) -> String {
        let text = format!("{} {says}", self.about_transition(transition));
        with_reason(text, &self.machine.transitions[transition].description)
    }

    /// Whether every region of the state is in a final state, by the flags as they are.
    pub fn done_by_flags(&self, state: StateId) -> Condition {
        Expr::all(self.machine.states[state].regions.iter().map(|&r| {
            let states = self.machine.regions[r].states.iter();
            let finals = states.filter(|&&s| self.machine.states[s].kind == StateKind::Final);
            Expr::any(finals.map(|s| Expr::Atom(self.flags[s.index()])).collect::<Vec<_>>())
        }))
    }
}

/// A text of the compiler, and that of the model if there is one.
pub fn with_reason(text: String, reason: &str) -> String {
    if reason.is_empty() { text } else { format!("{text}: {reason}") }
}
