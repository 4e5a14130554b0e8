//! Sequential function charts (IEC 61131-3, 2.6).
//!
//! # What one means, cycle by cycle
//!
//! First transitions: those whose `from` steps are all active are tried in order of priority; one
//! whose condition holds deactivates its `from` steps at once, so that of several transitions out of
//! one step at most one fires. All `to` steps of those that fired become active together. A step
//! entered in a cycle is not tried again in it. Then actions: each flag becomes TRUE if its step is
//! active, FALSE in the cycle in which the step is left: an N action on a BOOL.

use super::expr::Expr;
use super::plc::{GlobalId, Origin};
use crate::base::{Arena, Id};

/// Names a step.
pub type StepId = Id<Step>;

/// The body of a program.
#[derive(Clone, Debug, Default)]
pub struct Sfc {
    /// The steps; the first one is the initial step.
    pub steps: Arena<Step>,
    /// The transitions. Those out of one step stand in order of priority.
    pub transitions: Vec<Transition>,
}

/// A step.
#[derive(Clone, Debug)]
pub struct Step {
    /// A legal IEC identifier, unique in the project.
    pub name: String,
    /// TRUE while the step is active: its only action, qualifier N. An idle step has none.
    pub flag: Option<GlobalId>,
    /// What it is for, for the reader of the PLC project.
    pub description: String,
    /// What it stands for in the model.
    pub origin: Origin,
}

/// A transition.
#[derive(Clone, Debug)]
pub struct Transition {
    /// The step that it leaves.
    pub from: StepId,
    /// The step that it enters.
    pub to: StepId,
    /// Distinct for the transitions out of one step; lower is tried first. Conditions of
    /// transitions out of one step exclude each other, so that nothing rests on it.
    pub priority: u32,
    /// What must hold.
    pub condition: Expr<GlobalId>,
    /// Why it is there, for the reader of the PLC project.
    pub description: String,
    /// What it stands for in the model.
    pub origin: Origin,
}

impl Sfc {
    /// The step that is active before the first cycle.
    pub fn initial(&self) -> StepId {
        StepId::from_index(0)
    }

    /// For each step, the indices of the transitions that leave it, in order of priority.
    pub fn outgoing(&self) -> Vec<Vec<usize>> {
        let mut by_step = vec![Vec::new(); self.steps.len()];
        for (i, t) in self.transitions.iter().enumerate() {
            by_step[t.from.index()].push(i);
        }
        by_step
    }

    /// Calls `f` with every global that the body mentions, repetitions included.
    pub fn for_each_global(&self, f: &mut impl FnMut(GlobalId)) {
        for step in self.steps.values() {
            step.flag.into_iter().for_each(&mut *f);
        }
        for t in &self.transitions {
            t.condition.for_each_atom(&mut |&g| f(g));
        }
    }
}
