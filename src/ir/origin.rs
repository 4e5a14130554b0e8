//! What something in a PLC project stands for in the model, and the words for it.

use super::chart::{
    ChartKind, ComparisonId, ConstraintId, EventId, InputId, IntegerId, Machine, OutputId, RegionId, StateId,
    TransitionId, VariableId,
};
use super::number::Comparison;
use crate::base::Span;

/// What something in a PLC project stands for in the model. Together with the [role](super::plc::Role) of a global
/// it says which global that is: the command of an output, the flag of a state, the last state of a region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// For nothing: the compiler needs it for itself.
    #[default]
    Own,
    /// An input.
    Input(InputId),
    /// An output.
    Output(OutputId),
    /// A variable of type BOOL.
    Variable(VariableId),
    /// A variable of an integer type.
    Integer(IntegerId),
    /// An event.
    Event(EventId),
    /// A chart or an observer, by its index.
    Chart(usize),
    /// A region.
    Region(RegionId),
    /// That a region is not active.
    Idle(RegionId),
    /// That the state around a region is left.
    Left(RegionId),
    /// A state.
    State(StateId),
    /// That a state was active when the scan began.
    Active(StateId),
    /// That the regions of a state were in final states when the scan began.
    Done(StateId),
    /// That a state has been active for so many milliseconds.
    After(StateId, u32),
    /// That a state is the last one of its region.
    Last(StateId),
    /// That a state has been left or is active, and was not done as a whole.
    Unfinished(StateId),
    /// That a region begins at a state because a transition says so.
    Entry(StateId),
    /// That a region begins at a state because the guard of one of its beginnings says so.
    Beginning(StateId),
    /// That a region begins at its initial state.
    Initial(RegionId),
    /// A transition.
    Transition(TransitionId),
    /// A comparison of integers; it stands where the first of them is declared.
    Comparison(ComparisonId),
    /// A constraint.
    Constraint(ConstraintId),
    /// An assumption, by its index.
    Assumption(usize),
    /// The safety filter as a whole.
    Filter,
}

impl Origin {
    /// It in words and the model's names: `state InProduction.Automatic`. Empty for what the compiler needs for itself.
    pub fn says(self, machine: &Machine) -> String {
        let state = |id| machine.state_path(id);
        let region = |id| machine.region_path(id);
        match self {
            Origin::Own => String::new(),
            Origin::Input(id) => format!("input {}", machine.inputs[id].name),
            Origin::Output(id) => format!("output {}", machine.outputs[id].name),
            Origin::Variable(id) => format!("variable {}", machine.variables[id].name),
            Origin::Integer(id) => format!("integer {}", machine.integers[id].name),
            Origin::Event(id) => format!("event {}", machine.events[id].name),
            Origin::Chart(index) => {
                let chart = &machine.charts[index];
                let kind = if chart.kind == ChartKind::Observer { "observer" } else { "chart" };
                format!("{kind} {}", chart.name)
            }
            Origin::Region(id) => format!("region {}", region(id)),
            Origin::Idle(id) => format!("{} is not active", region(id)),
            Origin::Left(id) => format!("{} is left", region(id)),
            Origin::State(id) => format!("state {}", state(id)),
            Origin::Active(id) => format!("in({})", state(id)),
            Origin::Done(id) => format!("done({})", state(id)),
            Origin::After(id, milliseconds) => format!("after({}, {milliseconds}ms)", state(id)),
            Origin::Last(id) | Origin::Unfinished(id) => format!("history of {}", state(id)),
            Origin::Entry(id) => format!("entry of {}", state(id)),
            Origin::Beginning(id) => format!("entry of {} by default", state(id)),
            Origin::Initial(id) => format!("initial state of {}", region(id)),
            Origin::Transition(id) => {
                let t = &machine.transitions[id];
                let source = state(t.source);
                if t.internal {
                    format!("internal transition of {source}")
                } else {
                    format!("transition {source} -> {}", machine.destination(id))
                }
            }
            Origin::Comparison(id) => format!("comparison {}", machine.comparison(id)),
            Origin::Constraint(id) => format!("constraint {}", machine.safety.constraints[id].name),
            Origin::Assumption(index) => format!("assumption {}", machine.safety.assumptions[index].name),
            Origin::Filter => "safety filter".to_owned(),
        }
    }

    /// Where it is declared, if it is.
    pub fn span(self, machine: &Machine) -> Option<Span> {
        let span = match self {
            Origin::Own | Origin::Idle(_) | Origin::Left(_) => return None,
            Origin::Input(id) => machine.inputs[id].span,
            Origin::Output(id) => machine.outputs[id].span,
            Origin::Variable(id) => machine.variables[id].span,
            Origin::Integer(id) => machine.integers[id].span,
            Origin::Event(id) => machine.events[id].span,
            Origin::Chart(index) => machine.charts[index].span,
            Origin::Region(id) | Origin::Initial(id) => machine.regions[id].span,
            Origin::Beginning(id) => machine.regions[machine.states[id].region].span,
            Origin::State(id)
            | Origin::Active(id)
            | Origin::Done(id)
            | Origin::After(id, _)
            | Origin::Last(id)
            | Origin::Unfinished(id)
            | Origin::Entry(id) => machine.states[id].span,
            Origin::Transition(id) => machine.transitions[id].span,
            Origin::Comparison(id) => {
                let Comparison { left, right, .. } = &machine.comparisons[id];
                let mut span = None;
                for side in [left, right] {
                    side.for_each_value(&mut |&i| span = span.or(Some(machine.integers[i].span)));
                }
                return span;
            }
            Origin::Constraint(id) => machine.safety.constraints[id].span,
            Origin::Assumption(index) => machine.safety.assumptions[index].span,
            Origin::Filter => machine.safety.span,
        };
        Some(span)
    }
}
