//! Every state can be entered, as far as the shape of the chart and constant guards decide it.
//!
//! What is found to be entered may in truth never be; what is not found never is, in any run.

use super::dead::dead;
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::{Inside, Machine, RegionId, StateId};
use crate::ir::expr::Expr;

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let walk = Walk::through(machine);
    for (id, state) in machine.states.iter() {
        let parent_entered = machine.regions[state.region].parent.is_none_or(|p| walk.entered[p.index()]);
        if !walk.entered[id.index()] && parent_entered {
            let (label, help) = walk.why(id);
            found.push(
                Diagnostic::new(Code::NeverEntered, format!("`{}` is never entered", machine.state_path(id)))
                    .label(state.span, label)
                    .help(help),
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
    /// The states that are entered by shallow history.
    resumed: Vec<bool>,
    fresh: Vec<StateId>,
}

impl Walk<'_> {
    fn through(machine: &Machine) -> Walk<'_> {
        let mut leaving = vec![Vec::new(); machine.states.len()];
        // A transition that can never fire enters nothing, and no step of a program would lead there.
        for ((id, t), dead) in machine.transitions.iter().zip(dead(machine)) {
            if dead.is_none() && !t.internal {
                leaving[t.source.index()].push(id);
            }
        }
        let none = vec![false; machine.states.len()];
        let mut walk = Walk {
            machine,
            entered: none.clone(),
            started: vec![false; machine.regions.len()],
            resumed: none,
            fresh: Vec::new(),
        };
        for chart in &machine.charts {
            chart.regions.iter().for_each(|&r| walk.enter_region(r));
        }
        while !walk.fresh.is_empty() {
            while let Some(state) = walk.fresh.pop() {
                for &t in &leaving[state.index()] {
                    let t = &machine.transitions[t];
                    walk.enter(t.goals());
                    match t.inside {
                        Inside::History => walk.resumed[t.target.index()] = true,
                        Inside::DeepHistory | Inside::Default | Inside::Fork(_) => {}
                    }
                }
            }
            walk.resume();
        }
        walk
    }

    /// Enters what a transition names: all that contains it with their other regions, and what is
    /// inside it by default. A history may do that, too: before its state was ever active.
    fn enter(&mut self, goals: &[StateId]) {
        for &goal in goals {
            for outer in self.machine.ancestors(goal).collect::<Vec<_>>() {
                if !std::mem::replace(&mut self.entered[outer.index()], true) {
                    self.fresh.push(outer);
                }
                for &region in &self.machine.states[outer].regions {
                    let named = |&goal: &StateId| goal != outer && self.machine.child_in(region, goal).is_some();
                    if !goals.iter().any(named) {
                        self.enter_region(region);
                    }
                }
            }
        }
    }

    /// Enters what histories enter that nothing else has: by default what is inside a last state that a
    /// shallow history comes back to.
    fn resume(&mut self) {
        let entered = self.machine.states.iter().filter(|(id, _)| self.entered[id.index()]);
        for state in entered.map(|(_, state)| state).collect::<Vec<_>>() {
            let parent = self.machine.regions[state.region].parent;
            if parent.is_some_and(|p| self.resumed[p.index()]) {
                state.regions.iter().for_each(|&r| self.enter_region(r));
            }
        }
    }

    fn enter_region(&mut self, region: RegionId) {
        if std::mem::replace(&mut self.started[region.index()], true) {
            return;
        }
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

    /// What keeps the state from being entered, and what would help.
    fn why(&self, state: StateId) -> (String, &'static str) {
        let region = &self.machine.regions[self.machine.states[state].region];
        let leads = |t: &crate::ir::chart::Transition| {
            !t.internal && t.goals().iter().any(|&goal| self.machine.contains(state, goal))
        };
        if self.machine.transitions.values().any(leads) {
            let label = "no transition that leads here can ever fire";
            return (label.into(), "mend the transition that leads here, lead another one to it, or remove it");
        }
        let begins = region.initial == state || region.entries.iter().any(|(_, s)| *s == state);
        match (begins, region.parent) {
            (true, Some(parent)) if !self.started[self.machine.states[state].region.index()] => {
                let parent = self.machine.state_path(parent);
                let label = format!("whatever enters `{parent}` leads to another state of this region");
                (label, "lead a transition to it, make another state initial, or remove it")
            }
            (true, _) => {
                ("no way that leads here is ever taken".into(), "mend the initial choice, or remove the state")
            }
            (false, _) => ("no transition leads here".into(), "lead a transition to it, make it initial, or remove it"),
        }
    }
}
