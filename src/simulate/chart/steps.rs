//! Transitions to tables: what each leaves and enters is known before the first scan.
//!
//! A transition's source lies in one state of its scope, and firing leaves that state with all that is
//! inside, active or not: a mask over the words of states. What it enters mostly depends on nothing but
//! the transition: another mask, and for each entered region its new state. Where it depends on guards
//! or on where a region was left, it is looked up when the transition fires, see [`ways`](super::ways).
//!
//! Observers step first, all at once, and then the other charts. What an observer does after the filter is
//! a table of its own: flat, so that its active state says what to look at.
//!
//! The table is sorted by the state of the scope that is left. So for an active region only the
//! transitions that leave its active state are looked at, in the order in which they are tried.
//!
//! A step is two passes: the first looks for the transitions that fire, the second fires them. So
//! guards read states and variables from before the step without a copy of them. Nothing is lost by
//! it: of two transitions that fire in one scan, neither leaves or enters what the other does. What
//! states do when they are left comes before all that, because it asks which of them were active.

use super::code::{Code, Condition, HALF, Layout, Memory, append, part};
use super::ways::{Way, Ways};
use crate::ir::chart::{Atom, ChartKind, Deeds, Inside, Machine, Phase, RegionId, StateId, Transition, TransitionId};
use crate::ir::expr::Expr;
use std::collections::BTreeMap;
use std::ops::Range;

/// A transition.
#[derive(Clone, Debug)]
struct Step {
    id: TransitionId,
    /// Its guard; with it that its source is active, where that is not certain.
    enabled: Condition,
    /// The states with something to do when they are left that it may leave.
    exits: Range<u32>,
    changes: Range<u32>,
    enters: Enters,
}

/// What a transition enters.
#[derive(Clone, Debug)]
enum Enters {
    /// Always the same: for each region, its new state; their bits are among the changes.
    Fixed(Range<u32>),
    /// It depends.
    Looked(Way),
}

/// A state that does something when it is left.
#[derive(Clone, Debug)]
struct Exit {
    state: StateId,
    word: u32,
    bit: u64,
    changes: Range<u32>,
}

/// What becomes of one word: first bits are cleared, then set.
#[derive(Clone, Copy, Debug, Default)]
struct Change {
    word: u32,
    clear: u64,
    set: u64,
}

/// Something that happens once.
#[derive(Clone, Copy, Debug)]
pub enum Deed {
    /// A state is left.
    Exit(StateId),
    /// A transition fires.
    Fire(TransitionId),
    /// A state is entered.
    Entry(StateId),
}

/// The tables of all transitions.
#[derive(Clone, Debug)]
pub struct Steps {
    /// For each state, the transitions that leave it as the active state of their scope, in the step and
    /// after the filter.
    leaving: Vec<Range<u32>>,
    ending: Vec<Range<u32>>,
    /// For each state, its internal transitions.
    internals: Vec<Range<u32>>,
    steps: Vec<Step>,
    /// For each state, those in it that do something when they are left, the innermost first.
    leavers: Vec<Range<u32>>,
    exits: Vec<Exit>,
    changes: Vec<Change>,
    enters: Vec<(RegionId, StateId)>,
    /// For each state, what it does when it is entered; nothing at all if none does anything.
    entry: Vec<Range<u32>>,
    /// For each state, its regions.
    inside: Vec<Range<u32>>,
    regions: Vec<RegionId>,
    /// The outermost regions of observers and of control charts.
    observing: Range<u32>,
    controlling: Range<u32>,
    /// The regions with transitions that are tried after the filter.
    again: Range<u32>,
    ways: Ways,
    layout: Layout,
    /// Whether there are integers.
    counts: bool,
}

/// Which state is active in each region, and room for work that never has to grow.
#[derive(Clone, Debug)]
pub struct Configuration {
    /// The active state of each region; of an inactive one, the last one, if there was one.
    active: Vec<StateId>,
    /// The transitions that fired in this scan.
    fired: Vec<TransitionId>,
    /// What happened in this step, in order; only of a machine with integers.
    happened: Vec<Deed>,
    /// The same as places in the table, with what they enter as far as it was looked up.
    firing: Vec<(u32, Range<u32>)>,
    /// The internal ones among them, those of outer states first.
    internal: Vec<u32>,
    looked: Vec<(RegionId, StateId)>,
    /// Active regions that have still to be looked at.
    open: Vec<RegionId>,
}

impl Configuration {
    /// For the regions of `machine`, before the first scan.
    pub fn of(machine: &Machine) -> Configuration {
        // Each region is looked at and fires at most once in a scan.
        let regions = machine.regions.len();
        Configuration {
            active: machine.regions.values().map(|r| r.initial).collect(),
            fired: Vec::with_capacity(regions),
            happened: Vec::with_capacity(if machine.integers.is_empty() {
                0
            } else {
                2 * (regions + 2 * machine.states.len())
            }),
            firing: Vec::with_capacity(regions),
            internal: Vec::with_capacity(machine.transitions.values().filter(|t| t.internal).count()),
            looked: Vec::with_capacity(regions),
            open: Vec::with_capacity(regions),
        }
    }

    /// What happened since the last time that it was asked, in order; nothing of a machine without integers.
    pub fn happened(&mut self) -> impl Iterator<Item = Deed> + '_ {
        self.happened.drain(..)
    }

    /// A scan begins.
    pub fn forget(&mut self) {
        self.fired.clear();
        self.happened.clear();
    }

    /// The transitions that fired in this scan, of each step the internal ones, then those of outer regions first.
    pub fn fired(&self) -> &[TransitionId] {
        &self.fired
    }
}

impl Steps {
    /// Tabulates the transitions of `machine`; their guards go into `code`.
    pub fn of(machine: &Machine, layout: Layout, code: &mut Code) -> Steps {
        let mut all = Steps {
            leaving: Vec::with_capacity(machine.states.len()),
            ending: Vec::with_capacity(machine.states.len()),
            internals: Vec::with_capacity(machine.states.len()),
            steps: Vec::with_capacity(machine.transitions.len()),
            leavers: Vec::new(),
            exits: Vec::new(),
            changes: Vec::new(),
            enters: Vec::new(),
            entry: Vec::new(),
            inside: Vec::with_capacity(machine.states.len()),
            regions: Vec::with_capacity(machine.regions.len()),
            observing: 0..0,
            controlling: 0..0,
            again: 0..0,
            ways: Ways::of(machine, code),
            layout,
            counts: !machine.integers.is_empty(),
        };
        let outermost = |kind: ChartKind| {
            machine.charts.iter().filter(move |c| c.kind == kind).flat_map(|c| c.regions.iter().copied())
        };
        all.observing = append(&mut all.regions, outermost(ChartKind::Observer));
        all.controlling = append(&mut all.regions, outermost(ChartKind::Control));
        let mut again = vec![false; machine.regions.len()];
        machine.transitions.values().filter(|t| t.phase == Phase::End).for_each(|t| again[t.scope.index()] = true);
        all.again = append(&mut all.regions, outermost(ChartKind::Observer).filter(|r| again[r.index()]));
        for state in machine.states.values() {
            let range = append(&mut all.regions, state.regions.iter().copied());
            all.inside.push(range);
        }
        let mut by_state: Vec<Vec<TransitionId>> = vec![Vec::new(); machine.states.len()];
        for (id, transition) in machine.transitions.iter().filter(|(_, t)| !t.internal) {
            by_state[leaves(machine, transition).index()].push(id);
        }
        for list in &mut by_state {
            // They come in the order in which they are written, and sorting keeps that.
            list.sort_by_key(|&id| {
                let t = &machine.transitions[id];
                (machine.states[t.source].depth, t.priority.unwrap_or(u32::MAX))
            });
        }
        all.entries_and_exits(machine, layout);
        let within = within(machine, layout);
        let internals = machine.internals();
        for (state, list) in by_state.into_iter().enumerate() {
            let (end, start): (Vec<TransitionId>, Vec<TransitionId>) =
                list.into_iter().partition(|&id| machine.transitions[id].phase == Phase::End);
            let mut table = |list: Vec<TransitionId>| {
                let from = all.steps.len() as u32;
                for id in list {
                    all.add(machine, layout, code, &within[state], id);
                }
                from..all.steps.len() as u32
            };
            let (start, end, internal) = (table(start), table(end), table(internals[state].clone()));
            all.leaving.push(start);
            all.ending.push(end);
            all.internals.push(internal);
        }
        all
    }

    fn entries_and_exits(&mut self, machine: &Machine, layout: Layout) {
        if machine.states.values().any(|s| !s.entry.is_empty()) {
            for state in machine.states.values() {
                let mut words = BTreeMap::new();
                write(&state.entry, layout, &mut words);
                self.entry.push(append(&mut self.changes, changes(words)));
            }
        }
        let mut leavers: Vec<Vec<StateId>> = vec![Vec::new(); machine.states.len()];
        // A parent comes before what it contains, so backwards the innermost come first.
        for (id, _) in machine.states.iter().rev().filter(|(_, s)| !s.exit.is_empty()) {
            machine.ancestors(id).for_each(|outer| leavers[outer.index()].push(id));
        }
        for list in leavers {
            let exits: Vec<Exit> = list
                .into_iter()
                .map(|state| {
                    let mut words = BTreeMap::new();
                    write(&machine.states[state].exit, layout, &mut words);
                    let (word, bit) = layout.state(state);
                    Exit { state, word: word as u32, bit, changes: append(&mut self.changes, changes(words)) }
                })
                .collect();
            self.leavers.push(append(&mut self.exits, exits));
        }
    }

    fn add(&mut self, machine: &Machine, layout: Layout, code: &mut Code, within: &[(usize, u64)], id: TransitionId) {
        let t = &machine.transitions[id];
        let child = leaves(machine, t);
        let source = if t.source == child { Expr::TRUE } else { Expr::Atom(Atom::In(t.source)) };
        let enabled = code.add(machine, &Expr::all([source, t.guard.clone()]));

        // Clearing and setting, by word.
        let mut words: BTreeMap<usize, (u64, u64)> = BTreeMap::new();
        let mut entered = Vec::new();
        let first = machine.child_in(t.scope, t.target).expect("the scope contains the target");
        let mut fixed = true;
        if !t.internal {
            fixed =
                matches!(t.inside, Inside::Default | Inside::Fork(_)) && enter(machine, first, t.goals(), &mut entered);
            if !fixed {
                entered.clear();
            }
            for &(word, mask) in within {
                words.entry(word).or_default().0 |= mask;
            }
        }
        for &(_, state) in &entered {
            let (word, bit) = layout.state(state);
            words.entry(word).or_default().1 |= bit;
        }
        write(&t.deeds, layout, &mut words);
        let exits = if t.internal { 0..0 } else { self.leavers[child.index()].clone() };
        let changes = append(&mut self.changes, changes(words));
        let enters = if fixed {
            Enters::Fixed(append(&mut self.enters, entered))
        } else {
            Enters::Looked(self.ways.way(machine, first, t))
        };
        self.steps.push(Step { id, enabled, exits, changes, enters });
    }

    /// Enters the outermost regions of the charts of that kind.
    pub fn begin(&self, kind: ChartKind, code: &Code, memory: &mut Memory, configuration: &mut Configuration) {
        let Configuration { active, happened, looked, .. } = configuration;
        looked.clear();
        for &region in part(&self.regions, self.outermost(kind)) {
            self.ways.begin(region, code, memory, looked);
        }
        self.enter(looked, active, memory, happened);
    }

    fn outermost(&self, kind: ChartKind) -> &Range<u32> {
        match kind {
            ChartKind::Observer => &self.observing,
            ChartKind::Control => &self.controlling,
        }
    }

    /// Enters what has been looked up.
    fn enter(
        &self,
        looked: &[(RegionId, StateId)],
        active: &mut [StateId],
        memory: &mut Memory,
        happened: &mut Vec<Deed>,
    ) {
        for &(region, state) in looked {
            active[region.index()] = state;
            memory.entered[state.index()] = memory.scan;
            let (word, bit) = self.layout.state(state);
            memory.words[word] |= bit;
            self.greet(state, memory, happened);
        }
    }

    /// What observers do when the outputs are decided.
    pub fn end(&self, code: &Code, memory: &mut Memory, configuration: &mut Configuration) {
        configuration.firing.clear();
        for &region in part(&self.regions, &self.again) {
            let candidates = self.ending[configuration.active[region.index()].index()].clone();
            let holds = |s: &Step| code.holds(s.enabled, memory);
            if let Some(at) = part(&self.steps, &candidates).iter().position(holds) {
                configuration.firing.push((candidates.start + at as u32, 0..0));
            }
        }
        self.leave(memory, configuration);
        self.fire(memory, configuration);
    }

    /// The charts of that kind take one step, effects on variables included.
    pub fn step(&self, kind: ChartKind, code: &Code, memory: &mut Memory, configuration: &mut Configuration) {
        let Configuration { active, firing, internal, looked, open, .. } = &mut *configuration;
        firing.clear();
        internal.clear();
        looked.clear();
        open.extend_from_slice(part(&self.regions, self.outermost(kind)));
        while let Some(region) = open.pop() {
            let state = active[region.index()].index();
            let candidates = self.leaving[state].clone();
            let fires = part(&self.steps, &candidates).iter().position(|s| code.holds(s.enabled, memory));
            if let Some(at) = fires {
                let at = candidates.start + at as u32;
                let from = looked.len() as u32;
                if let Enters::Looked(way) = &self.steps[at as usize].enters {
                    self.ways.look(way, code, memory, active, looked);
                }
                firing.push((at, from..looked.len() as u32));
            }
            if fires.is_none() {
                let holds = |&at: &u32| code.holds(self.steps[at as usize].enabled, memory);
                internal.extend(self.internals[state].clone().filter(holds));
                open.extend_from_slice(part(&self.regions, &self.inside[state]));
            }
        }
        self.stay(memory, configuration);
        self.leave(memory, configuration);
        self.fire(memory, configuration);
    }

    /// What internal transitions do that have been found.
    fn stay(&self, memory: &mut Memory, configuration: &mut Configuration) {
        let Configuration { fired, happened, internal, .. } = configuration;
        for &at in internal.iter() {
            let step = &self.steps[at as usize];
            self.change(&step.changes, memory);
            if self.counts {
                happened.push(Deed::Fire(step.id));
            }
            fired.push(step.id);
        }
    }

    /// What states do that are left by what has been found.
    fn leave(&self, memory: &mut Memory, configuration: &mut Configuration) {
        if self.exits.is_empty() {
            return;
        }
        let Configuration { happened, firing, .. } = configuration;
        for (at, _) in firing.iter() {
            for exit in part(&self.exits, &self.steps[*at as usize].exits) {
                if memory.words[exit.word as usize] & exit.bit != 0 {
                    self.change(&exit.changes, memory);
                    if self.counts {
                        happened.push(Deed::Exit(exit.state));
                    }
                }
            }
        }
    }

    /// Fires what has been found.
    fn fire(&self, memory: &mut Memory, configuration: &mut Configuration) {
        let Configuration { active, fired, happened, firing, looked, .. } = configuration;
        for (at, of_looked) in firing.iter() {
            let step = &self.steps[*at as usize];
            self.change(&step.changes, memory);
            if self.counts {
                happened.push(Deed::Fire(step.id));
            }
            match &step.enters {
                Enters::Fixed(enters) => {
                    for &(region, state) in part(&self.enters, enters) {
                        active[region.index()] = state;
                        memory.entered[state.index()] = memory.scan;
                        self.greet(state, memory, happened);
                    }
                }
                Enters::Looked(_) => self.enter(part(looked, of_looked), active, memory, happened),
            }
            fired.push(step.id);
        }
    }

    /// What the state does when it is entered.
    fn greet(&self, state: StateId, memory: &mut Memory, happened: &mut Vec<Deed>) {
        if self.counts {
            happened.push(Deed::Entry(state));
        }
        if let Some(entry) = self.entry.get(state.index()) {
            self.change(entry, memory);
        }
    }

    fn change(&self, changes: &Range<u32>, memory: &mut Memory) {
        for change in part(&self.changes, changes) {
            let word = &mut memory.words[change.word as usize];
            *word = *word & !change.clear | change.set;
        }
    }
}

/// What becomes of words by what happens once; for each word, the bits to clear and to set.
fn write(deeds: &Deeds, layout: Layout, words: &mut BTreeMap<usize, (u64, u64)>) {
    for effect in &deeds.effects {
        let (word, bit) = layout.variable(effect.variable);
        let change = words.entry(word).or_default();
        *(if effect.value { &mut change.1 } else { &mut change.0 }) |= bit;
    }
    for &event in &deeds.raises {
        let (word, bit) = layout.event(event);
        words.entry(word).or_default().1 |= bit << HALF;
    }
}

fn changes(words: BTreeMap<usize, (u64, u64)>) -> impl Iterator<Item = Change> {
    words.into_iter().map(|(word, (clear, set))| Change { word: word as u32, clear, set })
}

/// The state of its scope that a transition leaves.
fn leaves(machine: &Machine, transition: &Transition) -> StateId {
    machine.child_in(transition.scope, transition.source).expect("the scope contains the source")
}

/// For each state, the words and masks of itself and all that is inside.
fn within(machine: &Machine, layout: Layout) -> Vec<Vec<(usize, u64)>> {
    let mut within: Vec<Vec<(usize, u64)>> = vec![Vec::new(); machine.states.len()];
    for state in machine.states.ids() {
        let (word, bit) = layout.state(state);
        for outer in machine.ancestors(state) {
            // States come in the order of their bits, so only the last word can be the same.
            match within[outer.index()].last_mut() {
                Some((last, mask)) if *last == word => *mask |= bit,
                _ => within[outer.index()].push((word, bit)),
            }
        }
    }
    within
}

/// What is entered with `state`, if that is always the same: on the way down to `goals` each region that
/// contains one takes that way, every other region begins where it begins.
fn enter(machine: &Machine, state: StateId, goals: &[StateId], into: &mut Vec<(RegionId, StateId)>) -> bool {
    into.push((machine.states[state].region, state));
    machine.states[state].regions.iter().all(|&region| {
        let mut named = goals.iter().filter(|&&goal| goal != state).filter_map(|&g| machine.child_in(region, g));
        let begins = &machine.regions[region];
        match named.next() {
            Some(child) => enter(machine, child, goals, into),
            None => begins.entries.is_empty() && enter(machine, begins.initial, &[], into),
        }
    })
}
