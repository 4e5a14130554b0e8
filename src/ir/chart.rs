//! The machine: what a model means, with every name resolved.
//!
//! # What it means, scan by scan
//!
//! A machine moves once per PLC scan, and everything that it reads was true when the scan began.
//!
//! 1. Inputs are sampled. [`Atom::PrevInput`] is the input's value of the scan before; in the first
//!    scan it is the input itself, so what has no past has no edge. [`Atom::PrevOutput`] is what the
//!    filter let through in the scan before, FALSE in the first scan.
//! 2. Each [`ChartKind::Observer`] takes one step, as 3 to 5 say. Its guards read of states
//!    and variables only what observers decide, from before the step. All that follows sees what has
//!    come of it.
//! 3. Each [`ChartKind::Control`] chart takes one step. Regions are visited from the outside in. A transition belongs to
//!    its *scope*, the innermost region that contains source and target. In an active region, of the
//!    enabled transitions of this scope the one with the outermost source fires, then the one that
//!    comes first in [`Machine::scoped`] order. If one fires, nothing else inside the region's
//!    active state takes a step. Guards read states, variables and integers from before the step. Only
//!    transitions of [`Phase::Start`] take part.
//! 4. Firing leaves the scope's active state with all that is inside, then enters the target: the
//!    way down to it, and below it and beside that way each region as [`Inside`] and [`Region::entries`]
//!    say. Source and target may lie in the same state of the scope: it is left and entered again.
//!    Guards of entries read what guards of transitions do. *Last* in a region is the state that was
//!    active in it when it was active last: now, if it is active when the scan begins.
//!    An [internal](Transition::internal) transition takes part in none of this. It happens in each scan in which
//!    its source was active before the step and is not left in it, and its guard holds.
//! 5. [`Deeds`] happen: those of internal transitions, of outer states first, then as they are written; those of [exits](State::exit) of the states that were active and are left, from the
//!    inside out; those of the fired transitions, of outer scopes first; those of [entries](State::entry)
//!    of the states that are entered, from the outside in. Of several that write one variable the last one
//!    wins; [`check`](crate::check) sees to it that there is a last one. Among them are [`Assignment`]s: an
//!    integer becomes the value, or the bound of its range that the value is beyond, and the value is that
//!    of the integers from before the step. An event that any of them raises
//!    is [TRUE](Atom::Event) throughout the next scan, and only then. Observers raise and read none.
//! 6. [`Action`]s of the states that are active now happen: first all that set, then all that reset.
//!    Their conditions read states as they are now and variables as 5 left them.
//! 7. The command of an output is the OR of the [`Drive`]s of the states that are active now;
//!    conditions read states and variables as they are now.
//! 8. The filter turns commands into outputs ([`super::relief`] says how); [`Atom::Output`] is what it
//!    decides. A constraint *acts* when the commands violate it, or what other constraints make of them
//!    does. With [`FilterMode::Blocking`] it acts when the commands violate it, and from the scan in which
//!    one does until [`Safety::reset`] rises, that scan excluded, the filter takes all commands as FALSE.
//!    Both can happen in one scan: then the machine stays stopped.
//! 9. Observers' transitions of [`Phase::End`] are tried, in each region as in 3. Their guards read
//!    what the filter has decided, and states and variables from before this; their deeds come last.
//!
//! The first scan enters the outermost regions by default instead of 2 and 3, those of observers first,
//! entries of states included: no transition of [`Phase::Start`] fires. What conditions on the way read is
//! that no state of the charts that enter was active, with variables as they are before it. Those of
//! [`Phase::End`] may fire: outputs that the first scan writes are as real as any.
//!
//! States of observers do nothing: they have no drives, actions, entries and exits.

use super::expr::Expr;
use super::number::Comparison;
use super::scenario::{Acceptance, Excuse, Plant, Property, Scenario};
use crate::base::{Arena, Id, Span};

mod paths;
mod safety;

pub use super::ast::Technology;
pub use super::integer::{Assignment, Integer};
pub use safety::{
    Assumption, Constraint, FilterMode, Forbidden, LAST_SCAN, Mark, Relief, Safety, ScanNumber, outputs_of,
};

/// Names an input.
pub type InputId = Id<Input>;
/// Names an output.
pub type OutputId = Id<Output>;
/// Names a variable.
pub type VariableId = Id<Variable>;
/// Names an event.
pub type EventId = Id<Event>;
/// Names an integer.
pub type IntegerId = Id<Integer>;
/// Names a comparison.
pub type ComparisonId = Id<Comparison<IntegerId>>;
/// Names an actuator.
pub type ActuatorId = Id<Actuator>;
/// Names a region.
pub type RegionId = Id<Region>;
/// Names a state.
pub type StateId = Id<State>;
/// Names a transition.
pub type TransitionId = Id<Transition>;
/// Names a constraint.
pub type ConstraintId = Id<Constraint>;

/// A whole model.
#[derive(Clone, Debug, Default)]
pub struct Machine {
    /// The machine's name, as written.
    pub name: String,
    /// What it is.
    pub description: String,
    /// The PLC task's cycle time in milliseconds.
    pub cycle: u32,
    /// What comes in, in order of declaration.
    pub inputs: Arena<Input>,
    /// What goes out, in order of declaration.
    pub outputs: Arena<Output>,
    /// What is remembered, in order of declaration.
    pub variables: Arena<Variable>,
    /// What can be raised, in order of declaration.
    pub events: Arena<Event>,
    /// What is counted, in order of declaration.
    pub integers: Arena<Integer>,
    /// What conditions ask of integers, each once, in order of first mention. None is TRUE or FALSE
    /// whatever the integers are within their ranges, and no part of one can leave the type INT.
    pub comparisons: Arena<Comparison<IntegerId>>,
    /// What moves, in order of declaration.
    pub actuators: Arena<Actuator>,
    /// The observers and then the control charts, each in order of declaration. Those of one kind run side
    /// by side.
    pub charts: Vec<Chart>,
    /// The regions of all charts; a parent comes before what it contains.
    pub regions: Arena<Region>,
    /// The states of all charts; a parent comes before what it contains.
    pub states: Arena<State>,
    /// The transitions of all charts, in the order in which they are written.
    pub transitions: Arena<Transition>,
    /// What must never happen.
    pub safety: Safety,
    /// What is said of all its runs, in order of declaration.
    pub properties: Vec<Property>,
    /// The findings of verification that are accepted, each once.
    pub accepted: Vec<Acceptance>,
    /// The warnings that are accepted, each once.
    pub excused: Vec<Excuse>,
    /// How the machine's parts react.
    pub plant: Plant,
    /// Tests of the machine, in order of declaration.
    pub scenarios: Vec<Scenario>,
}

/// An input of type BOOL.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name.
    pub name: String,
    /// Its IEC address in upper case, such as `%IX0.0`.
    pub address: Option<String>,
    /// What it means when TRUE.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// An output of type BOOL.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its name.
    pub name: String,
    /// Its IEC address in upper case, such as `%QX0.0`.
    pub address: Option<String>,
    /// What it does when TRUE.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// A variable of type BOOL.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its value before the first scan.
    pub initial: bool,
    /// What it remembers.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// Something that happens: raised in one scan, TRUE in exactly the next one.
#[derive(Clone, Debug)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// What it means.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// A technical device with positions. What its technology demands of outputs has become
/// [`Drive`]s of states; what remains is for reading and for analysis.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Its name.
    pub name: String,
    /// How its outputs act.
    pub technology: Technology,
    /// What it is.
    pub description: String,
    /// Two positions: first the one at rest for `monostable` and `onoff`.
    pub positions: Vec<Position>,
    /// Where it is declared.
    pub span: Span,
}

/// One end of an actuator's travel.
#[derive(Clone, Debug)]
pub struct Position {
    /// Its name, unique in the actuator.
    pub name: String,
    /// The output that leads there.
    pub output: Option<OutputId>,
    /// What is TRUE when it is reached; over inputs only.
    pub sensor: Option<Guard>,
    /// What happens in a movement to it that takes too long. It has become an internal
    /// [`Transition`] of each movement, which is tried last.
    pub limit: Option<Limit>,
    /// What it is.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// What happens in a movement that takes too long.
#[derive(Clone, Debug)]
pub struct Limit {
    /// How long it may take, in milliseconds.
    pub time: u32,
    /// What happens in each scan in which it has taken that long and does not end.
    pub deeds: Deeds,
    /// Where it is written.
    pub span: Span,
}

/// A Boolean expression over the machine.
pub type Guard = Expr<Atom>;

/// What an expression can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Atom {
    /// The input in this scan.
    Input(InputId),
    /// The input in the scan before.
    PrevInput(InputId),
    /// What the filter lets through in this scan; in constraints and guards of [`Phase::End`] only.
    Output(OutputId),
    /// What the filter let through in the scan before.
    PrevOutput(OutputId),
    /// The variable.
    Variable(VariableId),
    /// Whether the event was raised in the scan before.
    Event(EventId),
    /// Whether the comparison holds, for integers as they are when variables are read here.
    Compare(ComparisonId),
    /// Whether the state is active.
    In(StateId),
    /// Whether every region of the state is in a final state.
    Done(StateId),
    /// Whether the state has been active for that many milliseconds, counted from the first scan
    /// that began in it; in guards only.
    After(StateId, u32),
}

/// What a chart is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChartKind {
    /// It rebuilds what no sensor tells. It drives nothing, and knows nothing of control charts.
    Observer,
    /// It controls the machine.
    Control,
}

/// When in a scan a transition is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// When its chart takes its step.
    Start,
    /// When the filter has decided the outputs. Its source and target are elementary states of an
    /// observer's only region, and no guard of such an observer waits for a time.
    End,
}

/// A chart: a hierarchy of states that runs from the first scan on.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub kind: ChartKind,
    /// What it is.
    pub description: String,
    /// Its outermost regions; more than one makes it parallel.
    pub regions: Vec<RegionId>,
    /// Where it is declared.
    pub span: Span,
}

/// A region: exactly one of its states is active while its parent is.
#[derive(Clone, Debug)]
pub struct Region {
    /// Its name; the only region of a state or chart has none.
    pub name: Option<String>,
    /// What it is.
    pub description: String,
    /// Index of its chart in [`Machine::charts`].
    pub chart: usize,
    /// The state that contains it; nothing for an outermost region.
    pub parent: Option<StateId>,
    /// The actuator whose positions its states are.
    pub actuator: Option<ActuatorId>,
    /// Its states, movements included, in the order in which they are written.
    pub states: Vec<StateId>,
    /// Where it begins by default: the first of these states whose guard holds …
    pub entries: Vec<(Guard, StateId)>,
    /// … or else this one. All of them are states of the region.
    pub initial: StateId,
    /// Why it begins at each of `entries`, then why at `initial`; missing where nothing is said.
    pub reasons: Vec<String>,
    /// Where it is declared.
    pub span: Span,
}

/// A state.
#[derive(Clone, Debug)]
pub struct State {
    /// Its name, unique in its region.
    pub name: String,
    /// What it means.
    pub description: String,
    /// The region that contains it.
    pub region: RegionId,
    /// What kind of state it is.
    pub kind: StateKind,
    /// Its own regions, in the order in which they are written; none for an elementary state.
    pub regions: Vec<RegionId>,
    /// Index into the positions of its region's actuator.
    pub position: Option<usize>,
    /// The outputs that it drives, those from technology first.
    pub drives: Vec<Drive>,
    /// The variables that it sets and resets while it is active.
    pub actions: Vec<Action>,
    /// What happens when it is entered.
    pub entry: Deeds,
    /// What happens when it is left.
    pub exit: Deeds,
    /// How many states contain it.
    pub depth: u32,
    /// Where it is declared.
    pub span: Span,
}

/// What kind of state it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateKind {
    /// It contains no region.
    Elementary,
    /// It contains no region and ends its region.
    Final,
    /// An actuator on its way to the position of that index; elementary.
    Movement {
        /// Index into the positions of the region's actuator.
        to: usize,
    },
    /// It contains regions.
    Composite,
}

/// An output that is TRUE while the state is active and the condition holds.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The output.
    pub output: OutputId,
    /// Read after the chart's step.
    pub condition: Guard,
    /// Whether an actuator's technology demands it, rather than the text of the model.
    pub technology: bool,
    /// Where it comes from.
    pub span: Span,
}

/// A variable that becomes `value` in each scan in which the state is active and the condition
/// holds: the qualifiers S and R of IEC 61131-3.
#[derive(Clone, Debug)]
pub struct Action {
    /// The variable.
    pub variable: VariableId,
    /// What it becomes.
    pub value: bool,
    /// Read after the chart's step.
    pub condition: Guard,
    /// Where it is written.
    pub span: Span,
}

/// What happens once: when a transition fires, when a state is entered or left.
#[derive(Clone, Debug, Default)]
pub struct Deeds {
    /// What becomes of variables; no variable twice.
    pub effects: Vec<Effect>,
    /// The events that are raised; none twice.
    pub raises: Vec<EventId>,
    /// What becomes of integers; no integer twice.
    pub assignments: Vec<Assignment>,
}

impl Deeds {
    /// Whether nothing happens.
    pub fn is_empty(&self) -> bool {
        self.effects.is_empty() && self.assignments.is_empty() && self.raises.is_empty()
    }
}

/// A variable that becomes `value` once, when what it belongs to happens.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// The variable.
    pub variable: VariableId,
    /// What it becomes.
    pub value: bool,
    /// Where it is written.
    pub span: Span,
}

/// A transition.
#[derive(Clone, Debug)]
pub struct Transition {
    /// The state that must be active.
    pub source: StateId,
    /// The state that it leads to; of an internal transition the source.
    pub target: StateId,
    /// How the regions of the target are entered.
    pub inside: Inside,
    /// Whether it happens inside its source: it leaves and enters nothing.
    pub internal: bool,
    /// The innermost region that contains both.
    pub scope: RegionId,
    /// When it is tried.
    pub phase: Phase,
    /// Read from before the step.
    pub guard: Guard,
    /// What happens when it fires.
    pub deeds: Deeds,
    /// Explicit priority: lower fires first, and before transitions without one.
    pub priority: Option<u32>,
    /// Why it is there.
    pub description: String,
    /// Where it is written.
    pub span: Span,
}

/// How a transition enters the regions of its target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Inside {
    /// Each by default, and so are those further in.
    Default,
    /// Fork: on the way down to these states; they lie in different regions of the target. All other
    /// regions are entered by default.
    Fork(Vec<StateId>),
    /// Shallow history: each at its last state, those further in by default. If there is none yet, or the last states of
    /// all regions of the target are final, so that it was done as a whole: each by default.
    History,
    /// Deep history: the same, and so further in below each last state.
    DeepHistory,
}

impl Transition {
    /// The states that it names: those of a fork, else its target.
    pub fn goals(&self) -> &[StateId] {
        match &self.inside {
            Inside::Fork(states) => states,
            Inside::Default | Inside::History | Inside::DeepHistory => std::slice::from_ref(&self.target),
        }
    }
}

impl Machine {
    /// The states that contain `state`, itself first, outermost last.
    pub fn ancestors(&self, state: StateId) -> impl Iterator<Item = StateId> + '_ {
        std::iter::successors(Some(state), |&s| self.regions[self.states[s].region].parent)
    }

    /// Whether `outer` is `inner` or contains it.
    pub fn contains(&self, outer: StateId, inner: StateId) -> bool {
        self.ancestors(inner).any(|s| s == outer)
    }

    /// The state of `region` that is `state` or contains it, if there is one.
    pub fn child_in(&self, region: RegionId, state: StateId) -> Option<StateId> {
        self.ancestors(state).find(|&s| self.states[s].region == region)
    }

    /// The innermost region that contains both states, if they are of one chart and not in
    /// different regions of it.
    pub fn scope(&self, a: StateId, b: StateId) -> Option<RegionId> {
        self.ancestors(a).map(|s| self.states[s].region).find(|&r| self.child_in(r, b).is_some())
    }

    /// Where a transition leads, as a model writes it, with whole paths.
    pub fn destination(&self, transition: TransitionId) -> String {
        let t = &self.transitions[transition];
        match &t.inside {
            Inside::Default => self.state_path(t.target),
            Inside::History => format!("history of {}", self.state_path(t.target)),
            Inside::DeepHistory => format!("deep history of {}", self.state_path(t.target)),
            Inside::Fork(states) => {
                let paths: Vec<String> = states.iter().map(|&s| self.state_path(s)).collect();
                format!("({})", paths.join(", "))
            }
        }
    }

    /// What an expression reads, as a model writes it.
    pub fn atom(&self, atom: Atom) -> String {
        match atom {
            Atom::Input(i) => self.inputs[i].name.clone(),
            Atom::PrevInput(i) => format!("prev({})", self.inputs[i].name),
            Atom::Output(o) => self.outputs[o].name.clone(),
            Atom::PrevOutput(o) => format!("prev({})", self.outputs[o].name),
            Atom::Variable(v) => self.variables[v].name.clone(),
            Atom::Event(e) => self.events[e].name.clone(),
            Atom::Compare(c) => self.comparison(c),
            Atom::In(s) => format!("in({})", self.state_path(s)),
            Atom::Done(s) => format!("done({})", self.state_path(s)),
            Atom::After(s, ms) => format!("after({}, {ms}ms)", self.state_path(s)),
        }
    }

    /// What the filter remembers, as a model asks for it.
    pub fn mark(&self, mark: Mark) -> String {
        match mark {
            Mark::Noted if self.safety.mode == Some(FilterMode::Blocking) => "blocked".to_owned(),
            Mark::Noted => "noted".to_owned(),
            Mark::First(c) => format!("first({})", self.safety.constraints[c].name),
        }
    }

    /// A number that the filter keeps, in words as short as a column's head.
    pub fn scan_number(&self, number: ScanNumber) -> &'static str {
        match number {
            ScanNumber::This => "scan",
            ScanNumber::First => "scan(first)",
        }
    }

    /// Whether the region is one of a control chart or of an observer.
    pub fn kind(&self, region: RegionId) -> ChartKind {
        self.charts[self.regions[region].chart].kind
    }

    /// Whether the state is one of an observer.
    pub fn observes(&self, state: StateId) -> bool {
        self.kind(self.states[state].region) == ChartKind::Observer
    }

    /// For each state, its internal transitions, as they are written.
    pub fn internals(&self) -> Vec<Vec<TransitionId>> {
        let mut by_state = vec![Vec::new(); self.states.len()];
        for (id, t) in self.transitions.iter().filter(|(_, t)| t.internal) {
            by_state[t.source.index()].push(id);
        }
        by_state
    }

    /// For each region, the transitions of that phase whose scope it is, in the order in which they are
    /// tried: outermost source first, then explicit priority, then as written. Internal ones are not tried.
    pub fn scoped(&self, phase: Phase) -> Vec<Vec<TransitionId>> {
        let mut by_region = vec![Vec::new(); self.regions.len()];
        for (id, t) in self.transitions.iter().filter(|(_, t)| t.phase == phase && !t.internal) {
            by_region[t.scope.index()].push(id);
        }
        for list in &mut by_region {
            list.sort_by_key(|&id| {
                let t = &self.transitions[id];
                (self.states[t.source].depth, t.priority.unwrap_or(u32::MAX), id)
            });
        }
        by_region
    }
}
