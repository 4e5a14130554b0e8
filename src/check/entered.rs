//! Every state can be entered, as far as the shape of the chart decides it.

use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::{Machine, RegionId, StateId};
use crate::ir::expr::Expr;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let mut leaving = vec![Vec::new(); machine.states.len()];
    for (id, t) in machine.transitions.iter() {
        if t.guard != Expr::FALSE {
            leaving[t.source.index()].push(id);
        }
    }
    let mut walk = Walk { machine, entered: vec![false; machine.states.len()], fresh: Vec::new() };
    for chart in &machine.charts {
        chart.regions.iter().for_each(|&r| walk.enter_region(r));
    }
    while let Some(state) = walk.fresh.pop() {
        for &t in &leaving[state.index()] {
            walk.enter(machine.transitions[t].target);
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
    fresh: Vec<StateId>,
}

impl Walk<'_> {
    /// Enters `state`: all that contains it with their other regions, and what is inside it.
    fn enter(&mut self, state: StateId) {
        for outer in self.machine.ancestors(state).collect::<Vec<_>>() {
            if std::mem::replace(&mut self.entered[outer.index()], true) {
                continue;
            }
            self.fresh.push(outer);
            let on_path = |r: RegionId| outer != state && self.machine.child_in(r, state).is_some();
            let others: Vec<RegionId> =
                self.machine.states[outer].regions.iter().copied().filter(|&r| !on_path(r)).collect();
            others.into_iter().for_each(|r| self.enter_region(r));
        }
    }

    fn enter_region(&mut self, region: RegionId) {
        self.enter(self.machine.regions[region].initial);
    }
}
