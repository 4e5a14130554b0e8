//! What is entered where that depends on guards or on where a region was left.
//!
//! It is looked up before the transitions of a scan are carried out, so guards read what was before.

use super::code::{Code, Condition, Memory, append, part};
use crate::ir::chart::{Inside, Machine, RegionId, StateId, StateKind, Transition};
use std::ops::Range;

/// Where regions begin and what states contain.
#[derive(Clone, Debug)]
pub struct Ways {
    /// For each region, the states at which it begins under a condition, and the one at which it begins
    /// otherwise.
    begins: Vec<(Range<u32>, StateId)>,
    conditional: Vec<(Condition, StateId)>,
    states: Vec<State>,
    regions: Vec<RegionId>,
    /// What transitions name on their ways down.
    named: Vec<StateId>,
}

#[derive(Clone, Debug)]
struct State {
    region: RegionId,
    is_final: bool,
    inside: Range<u32>,
}

/// A transition's way into what it enters.
#[derive(Clone, Debug)]
pub struct Way {
    /// The state of the scope that is entered.
    first: StateId,
    /// The states on the way down from there.
    named: Range<u32>,
    /// The state whose regions are entered where they were left; with whether those below are, too.
    history: Option<(StateId, bool)>,
}

/// How the regions of a state are entered.
#[derive(Clone, Copy, Debug)]
enum How {
    /// On the way down.
    Way,
    /// Where they were left.
    Left,
    /// By default.
    Default,
}

impl Ways {
    /// Tabulates the regions of `machine`; guards of their entries go into `code`.
    pub fn of(machine: &Machine, code: &mut Code) -> Ways {
        let mut all = Ways {
            begins: Vec::with_capacity(machine.regions.len()),
            conditional: Vec::new(),
            states: Vec::with_capacity(machine.states.len()),
            regions: Vec::new(),
            named: Vec::new(),
        };
        for region in machine.regions.values() {
            let entries = region.entries.iter().map(|(guard, state)| (code.add(machine, guard), *state));
            let range = append(&mut all.conditional, entries);
            all.begins.push((range, region.initial));
        }
        for state in machine.states.values() {
            let inside = append(&mut all.regions, state.regions.iter().copied());
            let is_final = state.kind == StateKind::Final;
            all.states.push(State { region: state.region, is_final, inside });
        }
        all
    }

    /// The way of a transition that enters `first` in its scope.
    pub fn way(&mut self, machine: &Machine, first: StateId, transition: &Transition) -> Way {
        let below = |&goal: &StateId| machine.ancestors(goal).take_while(|&s| s != first);
        let named = append(&mut self.named, transition.goals().iter().flat_map(below));
        let history = match transition.inside {
            Inside::Default | Inside::Fork(_) => None,
            Inside::History => Some((transition.target, false)),
            Inside::DeepHistory => Some((transition.target, true)),
        };
        Way { first, named, history }
    }

    /// Looks up what a transition enters that goes this way: each region with its new state.
    pub fn look(&self, way: &Way, code: &Code, memory: &Memory, last: &[StateId], into: &mut Vec<(RegionId, StateId)>) {
        self.enter(way.first, How::Way, Some((way, last)), code, memory, into);
    }

    /// The same for a region that begins by default.
    pub fn begin(&self, region: RegionId, code: &Code, memory: &Memory, into: &mut Vec<(RegionId, StateId)>) {
        self.enter(self.default(region, code, memory), How::Default, None, code, memory, into);
    }

    /// Recursion is bounded by the nesting limit.
    fn enter(
        &self,
        state: StateId,
        how: How,
        way: Option<(&Way, &[StateId])>,
        code: &Code,
        memory: &Memory,
        into: &mut Vec<(RegionId, StateId)>,
    ) {
        let State { region, inside, .. } = &self.states[state.index()];
        into.push((*region, state));
        for &region in part(&self.regions, inside) {
            let taken = way.and_then(|(way, last)| match how {
                How::Default => None,
                How::Left => Some((last[region.index()], How::Left)),
                How::Way => {
                    let named = part(&self.named, &way.named).iter().find(|s| self.states[s.index()].region == region);
                    let deep = way.history.filter(|(target, _)| *target == state).map(|(_, deep)| deep);
                    let left = |deep| (last[region.index()], if deep { How::Left } else { How::Default });
                    let unfinished = deep.filter(|_| self.unfinished(state, last, memory));
                    named.map(|&s| (s, How::Way)).or_else(|| unfinished.map(left))
                }
            });
            let (next, how) = taken.unwrap_or_else(|| (self.default(region, code, memory), How::Default));
            self.enter(next, how, way, code, memory, into);
        }
    }

    /// Whether the state ever was active and was not done as a whole: then all its regions have last states, and so
    /// have those inside these.
    fn unfinished(&self, state: StateId, last: &[StateId], memory: &Memory) -> bool {
        part(&self.regions, &self.states[state.index()].inside).iter().any(|region| {
            let last = last[region.index()];
            memory.entered[last.index()] != 0 && !self.states[last.index()].is_final
        })
    }

    fn default(&self, region: RegionId, code: &Code, memory: &Memory) -> StateId {
        let (conditional, otherwise) = &self.begins[region.index()];
        let conditional = part(&self.conditional, conditional);
        conditional.iter().find(|(guard, _)| code.holds(*guard, memory)).map_or(*otherwise, |(_, state)| *state)
    }
}
