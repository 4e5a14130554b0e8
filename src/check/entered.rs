//! Every state can be entered, as far as the shape of the chart decides it.

use super::dead::dead;
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::{Machine, RegionId, StateId};
use crate::ir::expr::Expr;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut leaving = vec![Vec::new(); machine.states.len()];
    // A transition that can never fire enters nothing, and no step of a program would lead there.
    for ((id, t), dead) in machine.transitions.iter().zip(dead(machine)) {
        if dead.is_none() && !t.internal {
            leaving[t.source.index()].push(id);
        }
    }
    let mut walk = Walk {
        machine,
        entered: vec![false; machine.states.len()],
        started: vec![false; machine.regions.len()],
        fresh: Vec::new(),
    };
    for chart in &machine.charts {
        chart.regions.iter().for_each(|&r| walk.enter_region(r));
    }
    while let Some(state) = walk.fresh.pop() {
        for &t in &leaving[state.index()] {
            walk.enter(machine.transitions[t].goals());
        }
    }
    for (id, state) in machine.states.iter() {
        let parent_entered = machine.regions[state.region].parent.is_none_or(|p| walk.entered[p.index()]);
        if !walk.entered[id.index()] && parent_entered {
            found.push(
                Diagnostic::new(Code::NeverEntered, format!("`{}` is never entered", machine.state_path(id)))
                    .label(state.span, "no transition leads here")
                    .help("lead a transition to it, make it initial, or remove it"),
            );
        }
    }
}

struct Walk<'m> {
    machine: &'m Machine,
    entered: Vec<bool>,
    /// The regions that have been entered by default. A state that was entered on the way to one inside
    /// it has not yet started the region on that way.
    started: Vec<bool>,
    fresh: Vec<StateId>,
}

impl Walk<'_> {
    /// Enters what a transition names: all that contains it with their other regions, and what is
    /// inside it. What it enters by history has been entered before or is entered by default.
    fn enter(&mut self, goals: &[StateId]) {
        for &goal in goals {
            for outer in self.machine.ancestors(goal).collect::<Vec<_>>() {
                if !std::mem::replace(&mut self.entered[outer.index()], true) {
                    self.fresh.push(outer);
                }
                for &region in &self.machine.states[outer].regions {
                    let named = |&goal: &StateId| goal != outer && self.machine.child_in(region, goal).is_some();
                    if !self.started[region.index()] && !goals.iter().any(named) {
                        self.enter_region(region);
                    }
                }
            }
        }
    }

    fn enter_region(&mut self, region: RegionId) {
        self.started[region.index()] = true;
        let begins = &self.machine.regions[region];
        let mut rest = Expr::TRUE;
        for (guard, state) in &begins.entries {
            if Expr::all([rest.clone(), guard.clone()]) != Expr::FALSE {
                self.enter(&[*state]);
            }
            rest = Expr::all([rest, guard.clone().not()]);
        }
        if rest != Expr::FALSE {
            self.enter(&[begins.initial]);
        }
    }
}
