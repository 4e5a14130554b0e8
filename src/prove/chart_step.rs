//! One scan of a chart as Boolean functions: configuration, memory and inputs before it to those
//! after it, to commands, outputs and alarms.
//!
//! It is written from the meaning of a [`Machine`], which stands at the head of
//! [`chart`](crate::ir::chart), and shares nothing with [`lower`](crate::lower): what a compiled program
//! is compared with must not have been made by the same hands.
//!
//! # Time
//!
//! `after(S, T)` compares a clock with the moment of the first scan that began in S. What matters of
//! that are three things: whether this is that first scan (then no time has passed), whether the time
//! had passed in an earlier scan already, and whether it passes now. The first two are remembered; the
//! last one is a literal that is given for each scan, so that all courses of time are covered, those of
//! a late scan included.

mod counting;
mod histories;
mod reading;
mod unknown;

use super::chart_filter;
use super::chart_numbers as numbers;
use crate::bits::aig::{Aig, Lit};
use crate::bits::vector::Vector;
use crate::ir::chart::{
    Atom, ChartKind, Deeds, Inside, Machine, Phase, ScanNumber, StateId, StateKind, TransitionId, VariableId,
};
use std::collections::{BTreeMap, HashMap};

use reading::Reading;
pub use unknown::Unknown;

/// What a chart remembers from scan to scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartState {
    /// For each state, whether it is active.
    pub active: Vec<Lit>,
    /// For each variable, its value.
    pub variables: Vec<Lit>,
    /// For each input, its value in the last scan.
    pub inputs: Vec<Lit>,
    /// For each output, what the filter let through in the last scan.
    pub outputs: Vec<Lit>,
    /// For each event, whether it was raised in the last scan.
    pub raised: Vec<Lit>,
    /// For each [timer](ChartStep::timers), whether its state was entered in the last scan.
    pub fresh: Vec<Lit>,
    /// For each timer, whether its state is active and its time had passed in the last scan.
    pub past: Vec<Lit>,
    /// What the filter remembers, in the order of [`Safety::marks`](crate::ir::chart::Safety::marks).
    pub marks: Vec<Lit>,
    /// For each state of a region with a history, whether it was active when the region was active
    /// last; nothing for other states.
    pub last: Vec<Option<Lit>>,
    /// For each integer, its value in as many bits as an INT has.
    pub integers: Vec<Vector>,
    /// Each number that the filter keeps, in the order of
    /// [`Safety::scan_numbers`](crate::ir::chart::Safety::scan_numbers), in as many bits as a UDINT has;
    /// nothing where [nobody asks](ChartStep::without_scans).
    pub scans: Vec<Vector>,
}

impl ChartState {
    /// A bit of a number that the filter keeps.
    pub fn scan_bit(&self, number: ScanNumber, bit: u8) -> Lit {
        self.scans[number as usize][usize::from(bit)]
    }

    /// All of it in one row: states, variables, inputs, outputs, events, timers, the filter's marks, histories,
    /// integers, numbers of scans.
    pub fn bits(&self) -> Vec<Lit> {
        let ChartState { active, variables, inputs, outputs, raised, fresh, past, marks, last, integers, scans } = self;
        let always = [active, variables, inputs, outputs, raised, fresh, past, marks].into_iter().flatten();
        let numbers = integers.iter().chain(scans).flatten();
        always.chain(last.iter().flatten()).chain(numbers).copied().collect()
    }
}

/// What happens in one scan.
#[derive(Clone, Debug)]
pub struct ChartScan {
    /// What is remembered; its outputs are those of this scan.
    pub after: ChartState,
    /// For each event, whether it is TRUE.
    pub events: Vec<Lit>,
    /// For each transition, whether it fires.
    pub fires: Vec<Lit>,
    /// For each transition, whether it may fire: source and guard let it, and no outer one takes it away.
    pub enabled: Vec<Lit>,
    /// For each output, whether an active state drives it.
    pub commands: Vec<Lit>,
    /// For each constraint, whether it had to act on the commands.
    pub acted: Vec<Lit>,
    /// For each assumption, whether the plant breaks it.
    pub broken: Vec<Lit>,
    /// For each integer, whether a value beyond its range is assigned, and so becomes the bound.
    pub beyond: Vec<Lit>,
    /// For each timer, whether this is the first scan that began in its state.
    pub begins: Vec<Lit>,
    /// What constraints read, outputs of this scan apart, as it is when the filter runs.
    pub readings: BTreeMap<Atom, Lit>,
}

/// What the scans of one machine share.
pub struct ChartStep<'m> {
    machine: &'m Machine,
    /// For each region, its transitions in the order in which they are tried: when the chart steps, and
    /// after the filter.
    scoped: Vec<Vec<TransitionId>>,
    ending: Vec<Vec<TransitionId>>,
    /// For each state, its internal transitions.
    internals: Vec<Vec<TransitionId>>,
    timers: BTreeMap<(StateId, u32), usize>,
    /// For each region, whether some transition asks for its history.
    histories: Vec<bool>,
    rounds: usize,
    /// What runs in place of the control charts, if it is not these.
    unknown: Option<Unknown>,
    /// How many numbers of scans are kept.
    scans: usize,
}

impl<'m> ChartStep<'m> {
    /// `rounds` is the number of rounds after which the filter is known to be at rest, see
    /// [`chart_filter::rounds`].
    pub fn new(machine: &'m Machine, rounds: usize) -> Self {
        let mut timers = BTreeMap::new();
        for t in machine.transitions.values() {
            t.guard.for_each_atom(&mut |atom| {
                if let Atom::After(s, ms) = *atom {
                    timers.insert((s, ms), 0);
                }
            });
        }
        timers.values_mut().enumerate().for_each(|(i, index)| *index = i);
        let (scoped, ending) = (machine.scoped(Phase::Start), machine.scoped(Phase::End));
        let scans = machine.safety.scan_numbers().count();
        ChartStep {
            machine,
            scoped,
            ending,
            internals: machine.internals(),
            timers,
            histories: histories::asked(machine),
            rounds,
            unknown: None,
            scans,
        }
    }

    /// The same without the numbers of scans. Nothing in the machine reads them, but a counter has more
    /// values than a search can visit.
    #[must_use]
    pub fn without_scans(self) -> Self {
        ChartStep { scans: 0, ..self }
    }

    /// The same with that program in place of the control charts: none of their states is ever active.
    #[must_use]
    pub fn behind(self, program: Unknown) -> Self {
        ChartStep { unknown: Some(program), ..self }
    }

    /// How many numbers of scans are kept.
    pub fn scans(&self) -> usize {
        self.scans
    }

    /// Whether the state is of a region whose history some transition asks for.
    pub fn remembers(&self, state: StateId) -> bool {
        self.histories[self.machine.states[state].region.index()]
    }

    /// The states and times in milliseconds that guards ask for, each once.
    pub fn timers(&self) -> impl ExactSizeIterator<Item = (StateId, u32)> + '_ {
        self.timers.keys().copied()
    }

    /// The first scan after power-up: the initial states are entered, no transition fires, inputs
    /// have no other past than themselves.
    pub fn first(&self, aig: &mut Aig, inputs: &[Lit]) -> ChartScan {
        let m = self.machine;
        let before = ChartState {
            active: vec![Lit::FALSE; m.states.len()],
            variables: m.variables.values().map(|v| Lit::of(v.initial)).collect(),
            inputs: inputs.to_vec(),
            outputs: vec![Lit::FALSE; m.outputs.len()],
            raised: vec![Lit::FALSE; m.events.len()],
            fresh: vec![Lit::FALSE; self.timers.len()],
            past: vec![Lit::FALSE; self.timers.len()],
            marks: vec![Lit::FALSE; m.safety.marks().count()],
            last: m.states.ids().map(|s| self.remembers(s).then_some(Lit::FALSE)).collect(),
            integers: numbers::initial(m),
            scans: vec![numbers::no_scan(); self.scans],
        };
        let elapsed = vec![Lit::FALSE; self.timers.len()];
        let given = Given { step: self, inputs, before: &before, elapsed: &elapsed, outputs: None };
        let mut now = Now::of(&before, m);
        let none = now.fires.clone();
        self.move_on(aig, given, &mut now, &none, Some(ChartKind::Observer));
        match &self.unknown {
            Some(program) => program.act(&mut now),
            None => self.move_on(aig, given, &mut now, &none, Some(ChartKind::Control)),
        }
        self.rest(aig, given, now)
    }

    /// Any later scan. `clocks` says for each timer whether its time has passed by now, if it runs.
    pub fn scan(&self, aig: &mut Aig, before: &ChartState, inputs: &[Lit], clocks: &[Lit]) -> ChartScan {
        let mut elapsed = Vec::new();
        for ((s, _), &i) in &self.timers {
            let passed = aig.or(before.past[i], clocks[i]);
            let waits = aig.and(before.active[s.index()], !before.fresh[i]);
            elapsed.push(aig.and(waits, passed));
        }
        let given = Given { step: self, inputs, before, elapsed: &elapsed, outputs: None };
        let mut now = Now::of(before, self.machine);
        self.step(aig, given, &mut now, ChartKind::Observer, Phase::Start);
        match &self.unknown {
            Some(program) => program.act(&mut now),
            None => self.step(aig, given, &mut now, ChartKind::Control, Phase::Start),
        }
        self.rest(aig, given, now)
    }

    /// Charts of one kind take a step, effects on variables included.
    fn step(&self, aig: &mut Aig, given: Given<'_>, now: &mut Now, kind: ChartKind, phase: Phase) {
        let (fires, enabled) = self.fires(aig, given, now, kind, phase);
        now.enabled.iter_mut().zip(&enabled).for_each(|(all, &one)| *all = aig.or(*all, one));
        self.move_on(aig, given, now, &fires, None);
    }

    /// What comes of the transitions that fire; the charts of the kind that starts are entered.
    fn move_on(&self, aig: &mut Aig, given: Given<'_>, now: &mut Now, fires: &[Lit], start: Option<ChartKind>) {
        let moves = self.configuration(aig, &given.with(now), fires, start);
        let (variables, raised) = self.happen(aig, &now.variables, fires, &moves);
        now.variables = variables;
        let (integers, beyond) = self.count(aig, &now.integers, fires, &moves);
        now.integers = integers;
        now.active = moves.active;
        let gathered = [
            (&mut now.entered, &moves.entered[..]),
            (&mut now.fires, fires),
            (&mut now.raised, &raised[..]),
            (&mut now.beyond, &beyond[..]),
        ];
        for (all, one) in gathered {
            all.iter_mut().zip(one).for_each(|(all, &one)| *all = aig.or(*all, one));
        }
    }

    /// Which transitions of charts of that kind fire, and which of them may.
    fn fires(&self, aig: &mut Aig, given: Given<'_>, now: &Now, kind: ChartKind, phase: Phase) -> (Vec<Lit>, Vec<Lit>) {
        let m = self.machine;
        let reading = given.with(now);
        let scoped = if phase == Phase::End { &self.ending } else { &self.scoped };
        let mut fires = vec![Lit::FALSE; m.transitions.len()];
        let mut may = fires.clone();
        // For each state, whether it is active and a transition further out takes it away or a
        // transition of its own region leaves it: either way nothing inside it moves.
        let mut moved = vec![Lit::FALSE; m.states.len()];
        for (id, region) in m.regions.iter().filter(|(id, _)| m.kind(*id) == kind) {
            let barred = region.parent.map_or(Lit::FALSE, |p| moved[p.index()]);
            // Of two transitions only those out of the same state of the region can be enabled
            // together, so each state has its own order.
            let mut tried = vec![Lit::FALSE; region.states.len()];
            let mut left = vec![Lit::FALSE; region.states.len()];
            let place: HashMap<StateId, usize> = region.states.iter().enumerate().map(|(i, &s)| (s, i)).collect();
            for &t in &scoped[id.index()] {
                let transition = &m.transitions[t];
                let child = m.child_in(id, transition.source).expect("the scope holds the source");
                let (tried, left) = (&mut tried[place[&child]], &mut left[place[&child]]);
                let guard = reading.guard(aig, &transition.guard);
                let enabled = aig.and(now.active[transition.source.index()], guard);
                let first = aig.and(enabled, !*tried);
                fires[t.index()] = aig.and(first, !barred);
                may[t.index()] = aig.and(enabled, !barred);
                *tried = aig.or(*tried, enabled);
                *left = aig.or(*left, first);
            }
            for (&s, &left) in region.states.iter().zip(&left) {
                moved[s.index()] = aig.or(barred, left);
                for &t in self.internals[s.index()].iter().filter(|_| phase == Phase::Start) {
                    let guard = reading.guard(aig, &m.transitions[t].guard);
                    let enabled = aig.and(now.active[s.index()], guard);
                    fires[t.index()] = aig.and(enabled, !moved[s.index()]);
                    may[t.index()] = fires[t.index()];
                }
            }
        }
        (fires, may)
    }

    /// What becomes of states by the transitions that fire; the outermost regions of charts of the
    /// kind that starts are entered. `reading` is from before the step.
    fn configuration(&self, aig: &mut Aig, reading: &Reading<'_>, fires: &[Lit], start: Option<ChartKind>) -> Moves {
        let m = self.machine;
        let (before, remembered) = (reading.active, &reading.given.before.last);
        // For each state, who leaves it as a state of the transition's scope, who names it on the way
        // down to the target, and who asks for its history: that of its regions, and of all below.
        let mut leave = vec![Vec::new(); m.states.len()];
        let mut name = vec![Vec::new(); m.states.len()];
        let mut shallow = vec![Vec::new(); m.states.len()];
        let mut deep = vec![Vec::new(); m.states.len()];
        for (id, t) in m.transitions.iter() {
            let fires = fires[id.index()];
            if fires == Lit::FALSE || t.internal {
                continue;
            }
            leave[m.child_in(t.scope, t.source).expect("the scope holds the source").index()].push(fires);
            for &goal in t.goals() {
                for s in m.ancestors(goal) {
                    name[s.index()].push(fires);
                    if m.states[s].region == t.scope {
                        break;
                    }
                }
            }
            let asks = match t.inside {
                Inside::History => &mut shallow[t.target.index()],
                Inside::DeepHistory => &mut deep[t.target.index()],
                Inside::Default | Inside::Fork(_) => continue,
            };
            let unfinished = self.unfinished(aig, remembered, t.target);
            asks.push(aig.and(fires, unfinished));
        }
        let mut left = vec![Lit::FALSE; m.states.len()];
        let mut entered = vec![Lit::FALSE; m.states.len()];
        let mut active = vec![Lit::FALSE; m.states.len()];
        for (id, region) in m.regions.iter() {
            let (gone, come) = match region.parent {
                Some(p) => (left[p.index()], entered[p.index()]),
                None => (Lit::FALSE, Lit::of(start == Some(m.kind(id)))),
            };
            // For each of its states, when it is entered.
            let mut when: Vec<Lit> = region.states.iter().map(|s| aig.any(&name[s.index()])).collect();
            let place = |s: StateId| region.states.iter().position(|&t| t == s).expect("a region begins in itself");
            if let Some(p) = region.parent.filter(|_| self.histories[id.index()]) {
                let (shallow, below) = (aig.any(&shallow[p.index()]), aig.any(&deep[p.index()]));
                let resumes = aig.or(shallow, below);
                for (when, &s) in when.iter_mut().zip(&region.states) {
                    let last = remembered[s.index()].expect("a region with a history remembers its states");
                    let resumed = aig.and(resumes, last);
                    *when = aig.or(*when, resumed);
                    deep[s.index()].push(aig.and(below, last));
                }
            }
            let elsewhere = aig.any(&when);
            let mut rest = aig.and(come, !elsewhere);
            for (guard, s) in &region.entries {
                let guard = reading.guard(aig, guard);
                let here = aig.and(rest, guard);
                when[place(*s)] = aig.or(when[place(*s)], here);
                rest = aig.and(rest, !guard);
            }
            when[place(region.initial)] = aig.or(when[place(region.initial)], rest);
            for (&s, &when) in region.states.iter().zip(&when) {
                let i = s.index();
                let own = aig.any(&leave[i]);
                left[i] = aig.or(gone, own);
                entered[i] = when;
                let stays = aig.and(before[i], !left[i]);
                active[i] = aig.or(stays, entered[i]);
            }
        }
        for (left, &before) in left.iter_mut().zip(before) {
            *left = aig.and(*left, before);
        }
        Moves { left, entered, active }
    }

    /// Whether one of the regions of a state has a last state that is not final.
    fn unfinished(&self, aig: &mut Aig, last: &[Option<Lit>], state: StateId) -> Lit {
        let m = self.machine;
        let states = m.states[state].regions.iter().flat_map(|&r| &m.regions[r].states);
        let others = states.filter(|&&s| m.states[s].kind != StateKind::Final);
        let others: Vec<Lit> = others.filter_map(|s| last[s.index()]).collect();
        aig.any(&others)
    }

    /// What happens once, with whether it does, in order: internal transitions, those of outer states first, then as
    /// they are written, what states do when they are left, from the inside out, transitions, those of outer regions
    /// first, what states do when they are entered, from the outside in.
    fn deeds(&self, fires: &[Lit], moves: &Moves) -> Happening<'_> {
        let m = self.machine;
        let mut steps = Happening::new();
        for (id, state) in m.states.iter() {
            let depth = i64::from(state.depth);
            steps.entry((1, -depth, 0)).or_default().push((moves.left[id.index()], &state.exit));
            steps.entry((3, depth, 0)).or_default().push((moves.entered[id.index()], &state.entry));
        }
        for (id, t) in m.transitions.iter() {
            let depth = m.regions[t.scope].parent.map_or(0, |p| i64::from(m.states[p].depth) + 1);
            // Several internal ones of one state may happen, and then in the order of the text.
            let place = if t.internal { (0, depth, id.index()) } else { (2, depth, 0) };
            steps.entry(place).or_default().push((fires[id.index()], &t.deeds));
        }
        steps
    }

    /// What becomes of variables by what happens once, of which what comes later wins, and which events are
    /// raised.
    fn happen(&self, aig: &mut Aig, before: &[Lit], fires: &[Lit], moves: &Moves) -> (Vec<Lit>, Vec<Lit>) {
        let steps = self.deeds(fires, moves);
        let mut raisers = vec![Vec::new(); self.machine.events.len()];
        for (happens, deeds) in steps.values().flatten() {
            deeds.raises.iter().for_each(|e| raisers[e.index()].push(*happens));
        }
        let raised = raisers.iter().map(|by| aig.any(by)).collect();
        let mut variables = before.to_vec();
        for step in steps.values() {
            let mut writes: BTreeMap<VariableId, [Vec<Lit>; 2]> = BTreeMap::new();
            for (happens, deeds) in step {
                for effect in &deeds.effects {
                    writes.entry(effect.variable).or_default()[usize::from(effect.value)].push(*happens);
                }
            }
            for (v, writes) in writes {
                variables[v.index()] = write(aig, variables[v.index()], &writes);
            }
        }
        (variables, raised)
    }

    /// What was the last state of each region with a history once these states are active.
    fn last(&self, aig: &mut Aig, before: &ChartState, active: &[Lit]) -> Vec<Option<Lit>> {
        let m = self.machine;
        let states = m.states.iter().zip(&before.last);
        states
            .map(|((id, state), &last)| {
                let parent = m.regions[state.region].parent?;
                Some(aig.select(active[parent.index()], active[id.index()], last?))
            })
            .collect()
    }

    /// Everything after the charts' steps.
    fn rest(&self, aig: &mut Aig, given: Given<'_>, mut now: Now) -> ChartScan {
        let m = self.machine;
        let mut writes = vec![[Vec::new(), Vec::new()]; m.variables.len()];
        let reading = given.with(&now);
        for (id, state) in m.states.iter() {
            for action in &state.actions {
                let condition = reading.guard(aig, &action.condition);
                let acts = aig.and(now.active[id.index()], condition);
                writes[action.variable.index()][usize::from(action.value)].push(acts);
            }
        }
        now.variables = now.variables.iter().zip(&writes).map(|(&v, writes)| write(aig, v, writes)).collect();

        let reading = given.with(&now);
        let mut drives = vec![Vec::new(); m.outputs.len()];
        for (id, state) in m.states.iter() {
            for drive in &state.drives {
                let condition = reading.guard(aig, &drive.condition);
                drives[drive.output.index()].push(aig.and(now.active[id.index()], condition));
            }
        }
        let commands = match &self.unknown {
            Some(program) => program.commands.clone(),
            None => drives.iter().map(|d| aig.any(d)).collect(),
        };

        let broken = m.safety.assumptions.iter().map(|a| reading.guard(aig, &a.never)).collect();
        let mut read = |aig: &mut Aig, atom: Atom| reading.atom(aig, atom);
        let filtered = chart_filter::filter(aig, m, &commands, &given.before.marks, &mut read, self.rounds);
        let mut readings = BTreeMap::new();
        for constraint in m.safety.constraints.values() {
            constraint.never.for_each_atom(&mut |&atom| {
                if !matches!(atom, Atom::Output(_)) {
                    readings.entry(atom).or_insert_with(|| reading.atom(aig, atom));
                }
            });
        }
        let decided = Given { outputs: Some(&filtered.outputs), ..given };
        self.step(aig, decided, &mut now, ChartKind::Observer, Phase::End);

        let Now { active, variables, integers, entered, fires, enabled, raised, beyond } = now;
        let last = self.last(aig, given.before, &active);
        let (mut fresh, mut past, mut begins) = (Vec::new(), Vec::new(), Vec::new());
        for ((s, _), &i) in &self.timers {
            fresh.push(entered[s.index()]);
            let stays = aig.and(active[s.index()], !entered[s.index()]);
            past.push(aig.and(stays, given.elapsed[i]));
            begins.push(aig.and(given.before.active[s.index()], given.before.fresh[i]));
        }
        let after = ChartState {
            scans: numbers::scans(aig, &given.before.scans, &filtered),
            active,
            variables,
            inputs: given.inputs.to_vec(),
            outputs: filtered.outputs,
            raised,
            fresh,
            past,
            marks: filtered.marks,
            last,
            integers,
        };
        let events = given.before.raised.clone();
        let acted = filtered.acted;
        ChartScan { after, events, fires, enabled, commands, acted, broken, beyond, begins, readings }
    }
}

/// What happens once, with whether it does, by its place in the order.
type Happening<'a> = BTreeMap<(u8, i64, usize), Vec<(Lit, &'a Deeds)>>;

/// What a scan has made so far of what is remembered.
struct Now {
    active: Vec<Lit>,
    variables: Vec<Lit>,
    integers: Vec<Vector>,
    /// For each state, whether it has been entered.
    entered: Vec<Lit>,
    fires: Vec<Lit>,
    enabled: Vec<Lit>,
    /// For each event, whether it has been raised.
    raised: Vec<Lit>,
    /// For each integer, whether a value beyond its range has been assigned.
    beyond: Vec<Lit>,
}

impl Now {
    fn of(before: &ChartState, machine: &Machine) -> Now {
        Now {
            active: before.active.clone(),
            variables: before.variables.clone(),
            integers: before.integers.clone(),
            entered: vec![Lit::FALSE; machine.states.len()],
            fires: vec![Lit::FALSE; machine.transitions.len()],
            enabled: vec![Lit::FALSE; machine.transitions.len()],
            raised: vec![Lit::FALSE; machine.events.len()],
            beyond: vec![Lit::FALSE; machine.integers.len()],
        }
    }
}

/// For each state, what becomes of it in a step.
struct Moves {
    /// Whether it was active and is left.
    left: Vec<Lit>,
    /// Whether it is entered.
    entered: Vec<Lit>,
    /// Whether it is active then.
    active: Vec<Lit>,
}

/// First all that set, then all that reset; `writes` holds who resets and who sets the variable.
fn write(aig: &mut Aig, before: Lit, [reset, set]: &[Vec<Lit>; 2]) -> Lit {
    let (reset, set) = (aig.any(reset), aig.any(set));
    let on = aig.or(before, set);
    aig.and(on, !reset)
}

/// What does not change in a scan.
#[derive(Clone, Copy)]
struct Given<'a> {
    step: &'a ChartStep<'a>,
    inputs: &'a [Lit],
    before: &'a ChartState,
    elapsed: &'a [Lit],
    /// What the filter lets through, once it is decided.
    outputs: Option<&'a [Lit]>,
}

impl<'a> Given<'a> {
    fn with(self, now: &'a Now) -> Reading<'a> {
        Reading { given: self, active: &now.active, variables: &now.variables, integers: &now.integers }
    }
}
