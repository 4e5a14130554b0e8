//! Where transitions enter regions other than by default.
//!
//! A region that becomes active goes where it begins by default unless it is told otherwise. It has
//! to be told in three cases: a transition leads to another of its states or into one, a transition
//! enters it where it was left, and a transition leaves and enters the region's parent in one scan,
//! which the parent's flag does not show. Of all that a transition tells in one scan, at most one
//! state of a region is meant, whatever order it is asked in.

use crate::ir::chart::{Atom, Inside, Machine, Phase, RegionId, StateId, TransitionId};
use crate::ir::expr::Expr;
use std::collections::BTreeMap;

/// When a transition that fires enters a state, as far as it is not certain.
pub type When = Expr<Read>;

/// What that depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Read {
    /// What a guard reads.
    Guard(Atom),
    /// Whether the state was the last one of its region when the scan began.
    Last(StateId),
    /// Whether the state ever was active, and was not done as a whole: a state that is not final was the last one of
    /// one of its regions.
    Unfinished(StateId),
}

/// In which steps a region can be when it is told to start at a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Found {
    /// It is not active.
    #[default]
    Idle,
    /// It is not active, or in that very state, which is left and entered again.
    There,
    /// It may be in any.
    Anywhere,
}

/// One state at which a region is told to start.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// The transitions that say so, in order, and when.
    pub by: Vec<(TransitionId, When)>,
    /// Where the region can be then.
    pub found: Found,
}

/// For each region, the states at which it is told to start.
pub struct Entries {
    of: Vec<BTreeMap<StateId, Entry>>,
    told: Vec<bool>,
    /// For each state, the transitions that enter it and may find it active.
    again: BTreeMap<StateId, Vec<(TransitionId, When)>>,
}

impl Entries {
    /// Walks all transitions.
    pub fn of(machine: &Machine) -> Entries {
        let mut entries = Entries {
            of: vec![BTreeMap::new(); machine.regions.len()],
            told: vec![false; machine.transitions.len()],
            again: BTreeMap::new(),
        };
        // What moves after the filter is flat, and no program of its own.
        let moving = machine.transitions.iter().filter(|(_, t)| !t.internal && t.phase == Phase::Start);
        for (id, t) in moving {
            let top = machine.child_in(t.scope, t.target).expect("the scope holds the target");
            let reenters = machine.child_in(t.scope, t.source) == Some(top);
            if reenters {
                entries.again.entry(top).or_default().push((id, Expr::TRUE));
            }
            let outward = |&goal: &StateId| machine.ancestors(goal).take_while(|&s| s != top);
            let named = t.goals().iter().flat_map(outward).map(|s| (machine.states[s].region, s)).collect();
            Walk { entries: &mut entries, machine, id, reenters, named: &named }.named(top);
        }
        entries
    }

    /// The states at which `region` is told to start.
    pub fn of_region(&self, region: RegionId) -> impl Iterator<Item = (StateId, &Entry)> {
        self.of[region.index()].iter().map(|(s, e)| (*s, e))
    }

    /// Whether the transition tells some region where to start.
    pub fn tells(&self, transition: TransitionId) -> bool {
        self.told[transition.index()]
    }

    /// The transitions that enter the state and may find it active, and when they do.
    pub fn reentering(&self, state: StateId) -> &[(TransitionId, When)] {
        self.again.get(&state).map(Vec::as_slice).unwrap_or_default()
    }
}

/// What one transition tells.
struct Walk<'w> {
    entries: &'w mut Entries,
    machine: &'w Machine,
    id: TransitionId,
    /// Whether it can find active what it enters.
    reenters: bool,
    /// For each region on the way down, the state that is named there.
    named: &'w BTreeMap<RegionId, StateId>,
}

impl Walk<'_> {
    /// Enters the regions of a state that is on the way to the transition's goals, or one of them.
    fn named(&mut self, state: StateId) {
        let t = &self.machine.transitions[self.id];
        let (resumes, deep) = match t.inside {
            Inside::History => (state == t.target, false),
            Inside::DeepHistory => (state == t.target, true),
            Inside::Default | Inside::Fork(_) => (false, false),
        };
        for &region in &self.machine.states[state].regions {
            if let Some(&next) = self.named.get(&region) {
                self.tell(region, next, Expr::TRUE, Found::Anywhere);
                self.named(next);
            } else if resumes {
                let unfinished = Expr::Atom(Read::Unfinished(state));
                self.resume(region, &unfinished, deep);
                self.by_default(region, &unfinished.not());
            } else {
                self.by_default(region, &Expr::TRUE);
            }
        }
    }

    /// Enters a region where it was left; it was active at some time.
    fn resume(&mut self, region: RegionId, when: &When, deep: bool) {
        let machine = self.machine;
        for &state in &machine.regions[region].states {
            let when = Expr::all([when.clone(), Expr::Atom(Read::Last(state))]);
            self.tell(region, state, when.clone(), Found::There);
            for &inner in &machine.states[state].regions {
                if deep {
                    self.resume(inner, &when, deep);
                } else {
                    self.by_default(inner, &when);
                }
            }
        }
    }

    /// Enters a region by default. If it was not active it does so by itself.
    fn by_default(&mut self, region: RegionId, when: &When) {
        if !self.reenters {
            return;
        }
        let machine = self.machine;
        let mut rest = when.clone();
        for (guard, state) in &machine.regions[region].entries {
            let guard = guard.map(&mut |&atom| Expr::Atom(Read::Guard(atom)));
            self.begin(region, *state, Expr::all([rest.clone(), guard.clone()]));
            rest = Expr::all([rest, guard.not()]);
        }
        self.begin(region, machine.regions[region].initial, rest);
    }

    fn begin(&mut self, region: RegionId, state: StateId, when: When) {
        if when == Expr::FALSE {
            return;
        }
        for &inner in &self.machine.states[state].regions {
            self.by_default(inner, &when);
        }
        self.tell(region, state, when, Found::Anywhere);
    }

    fn tell(&mut self, region: RegionId, state: StateId, when: When, found: Found) {
        let own = &self.machine.regions[region];
        if self.reenters {
            self.entries.again.entry(state).or_default().push((self.id, when.clone()));
        } else if own.initial == state && own.entries.is_empty() {
            return;
        }
        let entry = self.entries.of[region.index()].entry(state).or_default();
        entry.by.push((self.id, when));
        entry.found = entry.found.max(if self.reenters { found } else { Found::Idle });
        self.entries.told[self.id.index()] = true;
    }
}
