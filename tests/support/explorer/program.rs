//! What the program remembers, and its scans, by the simulator of the chart.

use super::of_phase;
use chartwright::ir::chart::{Atom, Guard, InputId, IntegerId, Machine, Phase, StateId, TransitionId};
use chartwright::simulate::chart::Chart;
use chartwright::simulate::frame::{Frame, Layout};
use std::collections::HashMap;
use std::rc::Rc;

/// A time that guards wait for, and the input that says whether it has passed.
#[derive(Clone, Copy, Debug)]
pub struct Timer {
    pub state: StateId,
    pub time: u32,
    pub input: InputId,
}

/// What a program remembers between two scans.
#[derive(Clone)]
pub struct Memory {
    chart: Chart,
    pub begun: bool,
    /// What was so at the end of the last scan, alarms and events left out; all is FALSE before the first.
    pub frame: Frame,
    /// For each timer, whether its state was entered in the last scan, and whether its time has passed.
    fresh: Vec<bool>,
    past: Vec<bool>,
    /// If times are exact, for each timer how many scans have begun in its state since the one that entered it, up to its time.
    begun_in: Vec<u32>,
}

/// The times that have passed when a scan begins.
pub struct Times {
    pub passed: Vec<bool>,
    /// For each timer a bit: it does not run, or has passed.
    pub fair: u64,
}

/// What a scan does.
pub struct Scan {
    pub to: usize,
    pub frame: Frame,
    pub fired: Vec<TransitionId>,
    /// For each transition, whether it could have fired.
    pub enabled: Vec<bool>,
    /// For each constraint, whether the outputs violate it.
    pub violated: Vec<bool>,
}

/// What tells two memories apart: the frame, and what each list of the memory says.
type Remembered = (Frame, Vec<bool>, Vec<bool>, Vec<bool>, Vec<u32>);

/// All that programs have remembered so far.
pub struct Memories<'m> {
    machine: &'m Machine,
    layout: Layout,
    timers: Vec<Timer>,
    /// Whether times are those of the declared cycle.
    exact: bool,
    all: Vec<Memory>,
    known: HashMap<Remembered, usize>,
    scans: HashMap<(usize, Vec<bool>), Rc<Scan>>,
}

impl Memory {
    /// All that times may have done since the last scan. A time can have passed if the scan is not the first that
    /// began in its state, then stays so; of one state a shorter one passes no later.
    pub fn times(&self, layout: Layout, timers: &[Timer], cycle: Option<u32>) -> Vec<Times> {
        let running: Vec<bool> =
            timers.iter().zip(&self.fresh).map(|(t, fresh)| self.frame[layout.state(t.state)] && !fresh).collect();
        if let Some(cycle) = cycle {
            let over = |(i, t): (usize, &Timer)| running[i] && self.begun_in[i] == t.time.div_ceil(cycle);
            let fair = (1 << timers.len()) - 1;
            return vec![Times { passed: timers.iter().enumerate().map(over).collect(), fair }];
        }
        let mut all = Vec::new();
        for chosen in 0..1usize << timers.len() {
            let passed: Vec<bool> = (0..timers.len()).map(|i| chosen >> i & 1 == 1).collect();
            let fits = |i: usize| if running[i] { passed[i] || !self.past[i] } else { !passed[i] };
            let ordered = |i: usize| {
                let shorter = |j: &usize| timers[*j].state == timers[i].state && timers[*j].time < timers[i].time;
                !passed[i] || (0..timers.len()).filter(shorter).all(|j| passed[j])
            };
            if (0..timers.len()).all(|i| fits(i) && ordered(i)) {
                let fair = (0..timers.len()).map(|i| u64::from(!running[i] || passed[i]) << i).sum();
                all.push(Times { passed, fair });
            }
        }
        all
    }
}

impl<'m> Memories<'m> {
    /// Nothing is remembered yet: that is number 0.
    pub fn new(machine: &'m Machine, layout: Layout, timers: &[Timer], exact: bool) -> Memories<'m> {
        let no = vec![false; timers.len()];
        let begun_in = vec![0; timers.len()];
        let chart = Chart::new(machine);
        let memory = Memory { chart, begun: false, frame: layout.frame(), fresh: no.clone(), past: no, begun_in };
        Memories {
            machine,
            layout,
            timers: timers.to_vec(),
            exact,
            all: vec![memory],
            known: HashMap::new(),
            scans: HashMap::new(),
        }
    }

    /// What the program of that number remembers.
    pub fn of(&self, program: usize) -> &Memory {
        &self.all[program]
    }

    /// A scan with these inputs.
    pub fn scan(&mut self, program: usize, inputs: &[bool], times: &Times) -> Rc<Scan> {
        let key = (program, inputs.to_vec());
        if let Some(scan) = self.scans.get(&key) {
            return Rc::clone(scan);
        }
        let scan = Rc::new(self.run(program, inputs, times));
        self.scans.insert(key, Rc::clone(&scan));
        scan
    }

    fn run(&mut self, program: usize, inputs: &[bool], times: &Times) -> Scan {
        let (machine, layout) = (self.machine, self.layout);
        let memory = self.all[program].clone();
        let mut chart = memory.chart.clone();
        chart.scan(inputs);
        let frame = self.frame(&chart, inputs);
        let fired = chart.fired().to_vec();
        let reading = Reading { machine, layout, before: &memory, now: &frame, fired: &fired };
        let enabled = machine.transitions.ids().map(|t| memory.begun && reading.enables(t)).collect();
        let violated = machine.safety.constraints.values().map(|c| reading.at_the_filter(&c.never)).collect();
        // What is remembered: alarms and events are of this scan only.
        let mut kept = frame.clone();
        kept[layout.alarms()].fill(false);
        kept[layout.events()].fill(false);
        let active = |s: StateId, frame: &Frame| frame[layout.state(s)];
        let entered = |s: StateId| {
            let left = |t: &TransitionId| {
                let t = &machine.transitions[*t];
                !t.internal && machine.ancestors(s).any(|a| machine.states[a].region == t.scope)
            };
            active(s, &frame) && (!active(s, &memory.frame) || fired.iter().any(left))
        };
        let fresh: Vec<bool> = self.timers.iter().map(|t| entered(t.state)).collect();
        let past: Vec<bool> = self
            .timers
            .iter()
            .zip(&times.passed)
            .zip(&fresh)
            .map(|((t, &passed), fresh)| !self.exact && passed && !fresh && active(t.state, &frame))
            .collect();
        let count = |(i, t): (usize, &Timer)| {
            let counts = self.exact && !fresh[i] && active(t.state, &frame);
            if counts { (memory.begun_in[i] + 1).min(t.time.div_ceil(machine.cycle)) } else { 0 }
        };
        let begun_in: Vec<u32> = self.timers.iter().enumerate().map(count).collect();
        for (t, _) in self.timers.iter().zip(&past) {
            kept[layout.input(t.input)] = false;
        }
        // Events that will be TRUE in the next scan are seen by running it.
        let mut next = chart.clone();
        next.scan(inputs);
        let raised: Vec<bool> = machine.events.ids().map(|e| next.event(e)).collect();
        let to = self.all.len();
        let key = (kept.clone(), raised, fresh.clone(), past.clone(), begun_in.clone());
        let to = *self.known.entry(key).or_insert(to);
        if to == self.all.len() {
            self.all.push(Memory { chart, begun: true, frame: kept, fresh, past, begun_in });
        } else {
            // Two programs that remember the same do the same.
            let mut other = self.all[to].chart.clone();
            other.scan(inputs);
            assert_eq!(self.frame(&next, inputs), self.frame(&other, inputs), "something else is remembered");
        }
        Scan { to, frame, fired, enabled, violated }
    }

    /// The values at the end of a scan; what the plant hides is FALSE.
    fn frame(&self, chart: &Chart, inputs: &[bool]) -> Frame {
        let (machine, layout) = (self.machine, self.layout);
        let mut frame = layout.frame();
        frame[layout.inputs()].copy_from_slice(inputs);
        machine.outputs.ids().for_each(|id| frame[layout.output(id)] = chart.output(id));
        machine.variables.ids().for_each(|id| frame[layout.variable(id)] = chart.variable(id));
        machine.events.ids().for_each(|id| frame[layout.event(id)] = chart.event(id));
        machine.integers.ids().for_each(|id| layout.put_integer(id, chart.integer(id), &mut frame));
        machine.states.ids().for_each(|id| frame[layout.state(id)] = chart.is_active(id));
        machine.safety.constraints.ids().for_each(|id| frame[layout.acted(id)] = chart.acted(id));
        (0..machine.safety.assumptions.len()).for_each(|i| frame[layout.broken(i)] = chart.broken(i));
        machine.safety.marks().for_each(|mark| frame[layout.mark(mark)] = chart.mark(mark));
        frame
    }
}

/// What is read in a scan.
struct Reading<'r> {
    machine: &'r Machine,
    layout: Layout,
    before: &'r Memory,
    now: &'r Frame,
    fired: &'r [TransitionId],
}

impl Reading<'_> {
    /// A constraint when the outputs have been decided: observers have moved once, and not yet after the filter.
    fn at_the_filter(&self, never: &Guard) -> bool {
        never.eval(&mut |&atom| match atom {
            Atom::Output(o) => self.now[self.layout.output(o)],
            Atom::Variable(v) => self.now[self.layout.variable(v)],
            Atom::Compare(c) => self.machine.comparisons[c].holds(&|&i| self.layout.integer(i, self.now)),
            other => self.read(other),
        })
    }

    /// Whether a transition could fire: its source is active, its guard holds, and nothing further out takes it away.
    fn enables(&self, id: TransitionId) -> bool {
        let t = &self.machine.transitions[id];
        if t.phase == Phase::End {
            return false;
        }
        let observes = self.machine.observes(t.source);
        let guard = t.guard.eval(&mut |&atom| match atom {
            Atom::In(s) if observes => self.before.frame[self.layout.state(s)],
            other => self.read(other),
        });
        let barred = of_phase(self.machine, self.fired, Phase::Start).any(|f| {
            let f = &self.machine.transitions[f];
            if f.internal || t.internal {
                let left = self.machine.child_in(f.scope, f.source);
                return !f.internal && left.is_some_and(|left| self.machine.contains(left, t.source));
            }
            let inside = self.machine.regions[t.scope].parent;
            f.scope != t.scope && inside.is_some_and(|p| self.machine.child_in(f.scope, p).is_some())
        });
        self.before.frame[self.layout.state(t.source)] && guard && !barred
    }

    /// What guards of charts read.
    fn read(&self, atom: Atom) -> bool {
        let (layout, machine) = (self.layout, self.machine);
        let was = &self.before.frame;
        match atom {
            Atom::Input(i) => self.now[layout.input(i)],
            // What has no past has no edge.
            Atom::PrevInput(i) => {
                if self.before.begun {
                    was[layout.input(i)]
                } else {
                    self.now[layout.input(i)]
                }
            }
            Atom::PrevOutput(o) => was[layout.output(o)],
            Atom::Variable(v) => {
                if self.before.begun {
                    was[layout.variable(v)]
                } else {
                    machine.variables[v].initial
                }
            }
            Atom::Event(e) => self.now[layout.event(e)],
            Atom::Compare(c) => machine.comparisons[c].holds(&|&i: &IntegerId| layout.integer(i, was)),
            Atom::In(s) if machine.observes(s) => {
                let mut late = of_phase(machine, self.fired, Phase::End).map(|t| &machine.transitions[t]);
                match late.find(|t| t.source == s || t.target == s) {
                    Some(t) => t.source == s,
                    None => self.now[layout.state(s)],
                }
            }
            Atom::In(s) => was[layout.state(s)],
            Atom::Done(s) => layout.value(machine, chartwright::ir::scenario::Seen::Machine(Atom::Done(s)), was, was),
            Atom::Output(_) | Atom::After(..) => unreachable!("{atom:?} is not read here"),
        }
    }
}
