//! Regions to SFC programs (those of observers that also move after the filter excepted): a step per state, an idle step, and transitions that exclude each other.

use super::context::{Condition, Context};
use super::entries::Found;
use super::observers;
use crate::base::Arena;
use crate::ir::chart::{ChartKind, RegionId, StateId};
use crate::ir::expr::Expr;
use crate::ir::plc::{Body, Origin, Program};
use crate::ir::sfc::{Sfc, Step, StepId, Transition};

/// One program per region of charts of that kind, parents before children.
pub fn lower(context: &mut Context<'_>, kind: ChartKind) -> Vec<Program> {
    let machine = context.machine;
    machine.regions.ids().filter(|&r| machine.kind(r) == kind).map(|r| program(context, r)).collect()
}

fn program(context: &mut Context<'_>, id: RegionId) -> Program {
    let region = &context.machine.regions[id];
    let (origin, described) = match (region.parent, &region.name) {
        (None, None) => (Origin::Chart(region.chart), &context.machine.charts[region.chart].description),
        (Some(parent), None) => (Origin::State(parent), &context.machine.states[parent].description),
        (_, Some(_)) => (Origin::Region(id), &region.description),
    };
    let description = if described.is_empty() { origin.says(context.machine) } else { described.clone() };
    let name = context.names.region("Prg", id);
    let instance = context.names.region("I", id);
    // An SFC takes one step in a scan; what takes two is a ladder.
    let body = if context.ending[id.index()].is_empty() {
        Body::Sfc(sfc(context, id))
    } else {
        Body::Ladder(observers::step(context, id))
    };
    Program { name, instance, description, body, origin }
}

fn sfc(context: &mut Context<'_>, id: RegionId) -> Sfc {
    let machine = context.machine;
    let region = &machine.regions[id];
    let mut steps = Arena::new();
    let idle = steps.push(Step {
        name: context.names.region("Idle", id),
        flag: None,
        description: Origin::Idle(id).says(machine),
        origin: Origin::Idle(id),
    });
    for &s in &region.states {
        let state = &machine.states[s];
        steps.push(Step {
            name: context.names.state("S", s),
            flag: Some(context.flags[s.index()]),
            description: state.description.clone(),
            origin: Origin::State(s),
        });
    }
    let mut sfc = Sfc { steps, transitions: Vec::new() };
    let step_of = |s: StateId| {
        let at = region.states.iter().position(|&t| t == s).expect("the region holds the state");
        StepId::from_index(at + 1)
    };

    let parent = region.parent.map(|p| Expr::Atom(context.flags[p.index()]));
    let running = parent.clone().unwrap_or(Expr::TRUE);
    let told: Vec<(StateId, Found, Condition)> = {
        let entries: Vec<_> = context.entries.of_region(id).map(|(s, e)| (s, e.clone())).collect();
        entries.into_iter().map(|(s, e)| (s, e.found, Expr::Atom(context.entered(s, &e.by)))).collect()
    };

    // Out of the idle step: where the region is told to start, else where it begins by default.
    let mut out = Leaving::new(idle, running.clone());
    for (state, _, told) in told.iter().filter(|(s, ..)| *s != region.initial || !region.entries.is_empty()) {
        out.unless(told.clone(), step_of(*state), Origin::Entry(*state));
    }
    let mut reasons = region.reasons.iter();
    let mut reason = || reasons.next().map_or("", String::as_str);
    for (guard, state) in &region.entries {
        let guard = context.guard(guard, id);
        out.because(reason()).unless(guard, step_of(*state), Origin::Beginning(*state));
    }
    out.because(reason()).otherwise(step_of(region.initial), Origin::Initial(id));
    sfc.transitions.append(&mut out.list);

    // Positions of the steps' transitions: grouped once, so that the cost stays linear.
    let mut leaving: Vec<Vec<_>> = vec![Vec::new(); region.states.len()];
    for &t in &context.scoped[id.index()] {
        let child = machine.child_in(id, machine.transitions[t].source).expect("the scope holds the source");
        leaving[step_of(child).index() - 1].push(t);
    }
    for (&state, rivals) in region.states.iter().zip(&leaving) {
        let mut out = Leaving::new(step_of(state), running.clone());
        if let Some(parent) = &parent {
            out.when(parent.clone().not(), idle, Origin::Left(id));
        }
        let here = |(entry, found, _): &&(StateId, Found, Condition)| match found {
            Found::Idle => false,
            Found::There => *entry == state,
            Found::Anywhere => true,
        };
        for (entry, _, told) in told.iter().filter(here) {
            out.unless(told.clone(), step_of(*entry), Origin::Entry(*entry));
        }
        let chained = context.is_chained(rivals);
        for &t in rivals {
            let transition = &machine.transitions[t];
            let target = machine.child_in(id, transition.target).expect("the scope holds the target");
            let from = Origin::Transition(t);
            out.because(&transition.description);
            if chained {
                let fires = Expr::Atom(context.fires(t));
                out.when(Expr::all([running.clone(), fires]), step_of(target), from);
                continue;
            }
            // Whoever else needs to know has a coil for it; else the guard stands here.
            let needs_coil = transition.source != state || context.conditions.enabled.contains_key(&t);
            let condition = if needs_coil || context.entries.tells(t) || !transition.deeds.is_empty() {
                Expr::Atom(context.enabled(t))
            } else {
                context.guard(&transition.guard, id)
            };
            out.unless(condition, step_of(target), from);
        }
        sfc.transitions.append(&mut out.list);
    }
    sfc
}

/// The transitions out of one step, in order of priority.
struct Leaving {
    from: StepId,
    /// Holds for all that follow: the region runs, and nothing before them is the case.
    rest: Vec<Condition>,
    /// Why the next one is there.
    reason: String,
    list: Vec<Transition>,
}

impl Leaving {
    fn new(from: StepId, running: Condition) -> Self {
        Leaving { from, rest: vec![running], reason: String::new(), list: Vec::new() }
    }

    /// Says why the next transition is there.
    fn because(&mut self, reason: &str) -> &mut Self {
        reason.clone_into(&mut self.reason);
        self
    }

    /// A transition with exactly this condition.
    fn when(&mut self, condition: Condition, to: StepId, origin: Origin) {
        let priority = self.list.len() as u32 + 1;
        let description = std::mem::take(&mut self.reason);
        self.list.push(Transition { from: self.from, to, priority, condition, description, origin });
    }

    /// A transition if the condition holds and none before it.
    fn unless(&mut self, condition: Condition, to: StepId, origin: Origin) {
        let whole = Expr::all(self.rest.iter().cloned().chain([condition.clone()]));
        self.rest.push(condition.not());
        if whole != Expr::FALSE {
            self.when(whole, to, origin);
        }
        self.reason.clear();
    }

    /// A transition if nothing before it is the case.
    fn otherwise(&mut self, to: StepId, origin: Origin) {
        self.unless(Expr::TRUE, to, origin);
    }
}
