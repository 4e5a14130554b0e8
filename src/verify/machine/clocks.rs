//! What counts scans where times are exact, and leaps over scans in which nothing else happens.
//!
//! A [`Counter`] counts up to the largest number that anything asks of it and stops there. One serves all states of a region, one each
//! actuator that travels and each rule with a delay.
//!
//! A scan that changes nothing but counters is followed by one that is just like it, as long as no counter comes to a number at which
//! something looks. So a transition of the system may *leap*: it stands for such a scan and for `more` others that are like it, and
//! takes all counters on by as much. A time of a minute then costs no more steps than one of a moment, and each state
//! that is reached with leaps is reached without them.

use super::super::aig::{Aig, Lit};
use super::super::system::{Alternative, Giver, Input, System};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{ActuatorId, Machine, RegionId, StateId};
use crate::prove::chart_step::{ChartState, ChartStep};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// How times are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Times {
    /// In scans of the declared cycle, as they are simulated.
    Exact,
    /// They pass when they will.
    Free,
}

/// Something that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Clock {
    /// What the states of a region wait for.
    Region(RegionId),
    /// What an actuator takes on its way.
    Travel(ActuatorId),
    /// What a rule of the plant takes, by index.
    Rule(usize),
}

/// Which clocks count. With one that does not more can happen than with one that does, and all else is the same: so what holds in all
/// runs while some of them count does so when all do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counted {
    /// All.
    All,
    /// These; what the others wait for comes when it will.
    These(BTreeSet<Clock>),
}

impl From<Times> for Counted {
    fn from(times: Times) -> Counted {
        match times {
            Times::Exact => Counted::All,
            Times::Free => Counted::These(BTreeSet::new()),
        }
    }
}

impl Counted {
    /// Whether that clock counts.
    pub fn has(&self, clock: Clock) -> bool {
        match self {
            Counted::All => true,
            Counted::These(clocks) => clocks.contains(&clock),
        }
    }

    /// Whether any may count.
    pub fn some(&self) -> bool {
        match self {
            Counted::All => true,
            Counted::These(clocks) => !clocks.is_empty(),
        }
    }
}

/// What is shared by all that counts.
#[derive(Clone, Debug)]
pub struct Clocks {
    /// Which clocks count.
    pub counted: Counted,
    /// Whether the transition leaps.
    pub leap: Lit,
    /// How many scans it stands for, beside the first one; 0 without a leap.
    more: Vector,
    /// The latches that count.
    counting: Vec<bool>,
    /// Whose they are, with the first of each.
    owned: Vec<(Clock, usize)>,
    /// For what a leap must not go beyond: the first latch of the counter, and that it does not.
    bounds: Vec<(usize, Lit)>,
    /// What else has to be so for a leap: that writing the same outputs once more changes nothing.
    pub settled: Vec<Lit>,
}

/// A number of scans.
#[derive(Clone, Debug)]
pub struct Counter {
    first: usize,
    /// Its value; never negative.
    pub value: Vector,
    most: u64,
}

impl Clocks {
    /// Of a system in which nothing asks for more than `most` scans.
    pub fn new(system: &mut System, counted: &Counted, most: u64) -> Clocks {
        let (mut leap, mut more) = (Lit::FALSE, vec![Lit::FALSE]);
        if counted.some() && most > 1 {
            leap = system.input("time passes", Giver::Clock);
            let bits = u64::BITS - (most - 1).leading_zeros();
            let inputs: Vec<Lit> =
                (0..bits).map(|i| system.input(format!("bit {i} of the time that passes"), Giver::Wait)).collect();
            more = inputs.into_iter().map(|bit| system.aig.and(leap, bit)).collect();
            more.push(Lit::FALSE);
        }
        Clocks {
            counted: counted.clone(),
            leap,
            more,
            counting: Vec::new(),
            owned: Vec::new(),
            bounds: Vec::new(),
            settled: Vec::new(),
        }
    }

    /// Whether times are exact.
    pub fn exact(&self) -> bool {
        self.counted == Counted::All
    }

    /// The clock of something that takes time, from 0 to `most`, at first `initial`.
    pub fn clock(&mut self, system: &mut System, clock: Clock, name: &str, most: u64, initial: u64) -> Counter {
        self.owned.push((clock, system.latches.len()));
        self.counter(system, name, most, initial)
    }

    /// The clocks that count among those latches, which are in order.
    pub fn among(&self, latches: &[usize]) -> BTreeSet<Clock> {
        let owned = self.owned.iter().filter(|(_, first)| latches.binary_search(first).is_ok());
        owned.map(|(clock, _)| *clock).collect()
    }

    /// A number from 0 to `most`, at first `initial`.
    pub fn counter(&mut self, system: &mut System, name: &str, most: u64, initial: u64) -> Counter {
        let first = system.latches.len();
        let bits = u64::BITS - most.leading_zeros();
        let bit = |i| (format!("bit {i} of {name}"), Some(initial >> i & 1 == 1));
        let mut value: Vector = (0..bits).map(bit).map(|(name, initial)| system.latch(name, initial)).collect();
        value.push(Lit::FALSE);
        self.counting.resize(system.latches.len(), false);
        self.counting[first..].fill(true);
        Counter { first, value, most }
    }

    /// A sum of a value and as many steps as a leap takes beside the first one.
    fn further(&self, aig: &mut Aig, value: &[Lit], step: i64) -> Vector {
        let mut sum = value.to_vec();
        if self.leap == Lit::FALSE {
            return sum;
        }
        for i in (0..63).filter(|i| step.unsigned_abs() >> i & 1 == 1) {
            let shifted: Vector = std::iter::repeat_n(Lit::FALSE, i).chain(self.more.iter().copied()).collect();
            sum = if step < 0 { vector::subtract(aig, &sum, &shifted) } else { vector::add(aig, &sum, &shifted) };
        }
        sum
    }

    /// No leap takes a counter to `bound` or beyond it while it counts on from `value`, which is not there yet.
    pub fn stop_before(&mut self, system: &mut System, counter: &Counter, counts: Lit, value: &[Lit], bound: u64) {
        if self.leap == Lit::FALSE {
            return;
        }
        let aig = &mut system.aig;
        let bound = vector::constant(bound as i64);
        let below = vector::less(aig, value, &bound);
        let then = self.further(aig, value, 1);
        let stays = vector::less(aig, &then, &bound);
        let asked = aig.all(&[self.leap, counts, below]);
        let fits = aig.or(!asked, stays);
        self.bounds.push((counter.first, fits));
    }

    /// In each scan in which it `runs` the counter goes on by one, unless it is `full`; else it begins anew. All that happens only
    /// when it is its `turn`. Who asks it keeps leaps [before](Self::stop_before) the numbers at which something changes.
    pub fn count(&mut self, system: &mut System, counter: &Counter, runs: Lit, full: Lit, turn: Lit) {
        let aig = &mut system.aig;
        // What begins anew is looked at with another number in the next scan.
        if self.leap != Lit::FALSE {
            let nought = !counter.is_at_least(aig, 1);
            let like = aig.any(&[!self.leap, runs, nought]);
            self.bounds.push((counter.first, like));
        }
        let one = vector::add(aig, &counter.value, &vector::constant(1));
        let more = self.further(aig, &one, 1);
        let then = vector::select(aig, full, &counter.value, &more);
        let then = vector::select(aig, runs, &then, &vector::constant(0));
        let then = vector::select(aig, turn, &then, &counter.value);
        counter.becomes(system, &then);
    }

    /// Lets a place between 0 and the counter's most go on by steps toward its ends, and returns for each end whether it is there
    /// after one step.
    pub fn travel(
        &mut self,
        system: &mut System,
        place: &Counter,
        toward: [Lit; 2],
        steps: [u64; 2],
        turn: Lit,
    ) -> [Lit; 2] {
        let aig = &mut system.aig;
        let (nought, most) = (vector::constant(0), vector::constant(place.most as i64));
        let back = vector::subtract(aig, &place.value, &vector::constant(steps[0] as i64));
        let out = vector::add(aig, &place.value, &vector::constant(steps[1] as i64));
        let arrives = [!vector::less(aig, &nought, &back), !vector::less(aig, &out, &most)];
        let far = [self.further(aig, &back, -(steps[0] as i64)), self.further(aig, &out, steps[1] as i64)];
        let between = [vector::less(aig, &nought, &far[0]), vector::less(aig, &far[1], &most)];
        let mut then = place.value.clone();
        let mut at = [vector::equal(aig, &place.value, &nought), vector::equal(aig, &place.value, &most)];
        for p in [0, 1] {
            let end = if p == 0 { &nought } else { &most };
            let way = vector::select(aig, arrives[p], end, &far[p]);
            then = vector::select(aig, toward[p], &way, &then);
            at = [0, 1].map(|q| aig.select(toward[p], if p == q { arrives[p] } else { Lit::FALSE }, at[q]));
            let asked = aig.all(&[self.leap, toward[p], !arrives[p]]);
            let fits = aig.or(!asked, between[p]);
            if self.leap != Lit::FALSE {
                self.bounds.push((place.first, fits));
            }
        }
        let then = vector::select(aig, turn, &then, &place.value);
        place.becomes(system, &then);
        at
    }

    /// Lets leaps be only what they are: of all that the claims of a system depend on, they change counters alone. `outputs` are
    /// those that stand at the terminals and those that are decided; what is in the latches of `waits` is of the moment only.
    pub fn close(&self, system: &mut System, reading: Lit, outputs: &[(Lit, Lit)], waits: Range<usize>) {
        if self.leap == Lit::FALSE {
            return;
        }
        let leap = self.leap;
        let asked: Vec<Lit> = system.claims.iter().flat_map(|c| c.property.literals()).collect();
        let fair = system.fair.iter().map(|f| f.holds);
        let roots: Vec<Lit> = system.constraints.iter().copied().chain(fair).chain(asked).collect();
        let (latches, _) = system.cone(&roots);
        let counts = |l: usize| self.counting.get(l) == Some(&true);
        if !latches.iter().any(|&l| counts(l)) {
            return;
        }
        let mut needed: Vec<Lit> = self.settled.clone();
        for &l in latches.iter().filter(|&&l| !counts(l) && !waits.contains(&l)) {
            let latch = system.latches[l];
            needed.push(system.aig.equal(latch.next, latch.leaf));
            // So that it is seen that it does not change.
            system.latches[l].next = system.aig.select(leap, latch.leaf, latch.next);
        }
        if reading != Lit::TRUE {
            needed.push(reading);
            needed.extend(outputs.iter().map(|&(was, decided)| system.aig.equal(was, decided)));
        }
        for needed in needed {
            let fits = system.aig.or(!leap, needed);
            system.constraints.push(fits);
        }
        let bounds = self.bounds.iter().filter(|(first, _)| latches.contains(first)).map(|b| b.1);
        system.constraints.extend(bounds);
        // Leaps are kinds of their own.
        let alternatives = std::mem::take(&mut system.alternatives);
        if alternatives.is_empty() {
            let kind = |leaps: bool| Alternative { is: leap.xor(!leaps), when: Lit::TRUE, choice: vec![(leap, leaps)] };
            system.alternatives = vec![kind(false), kind(true)];
        }
        for a in alternatives {
            for leaps in [false, true] {
                if leaps && a.is != reading {
                    continue;
                }
                let is = system.aig.and(a.is, leap.xor(!leaps));
                let choice = a.choice.iter().copied().chain([(leap, leaps)]).collect();
                system.alternatives.push(Alternative { is, when: a.when, choice });
            }
        }
        system.constraints.retain(|&c| c != Lit::TRUE);
    }

    /// How many scans a transition of the system stands for beside its first one, with these values of the inputs.
    pub fn leapt(&self, value: &dyn Fn(Lit) -> bool, system: &System) -> usize {
        if self.leap == Lit::FALSE || !value(self.leap) {
            return 0;
        }
        let bits = system.inputs.iter().filter(|i| i.giver == Giver::Wait);
        bits.enumerate().map(|(i, bit)| usize::from(value(bit.leaf)) << i).sum()
    }

    /// Whether it says that a transition leaps, and how far.
    pub fn is_of_leaps(&self, input: &Input) -> bool {
        self.leap != Lit::FALSE && input.leaf == self.leap || input.giver == Giver::Wait
    }
}

impl Counter {
    /// Whether so many have been counted.
    pub fn is_at_least(&self, aig: &mut Aig, least: u64) -> Lit {
        !vector::less(aig, &self.value, &vector::constant(least as i64))
    }

    fn becomes(&self, system: &mut System, then: &[Lit]) {
        for (i, &bit) in vector::fit(then, self.value.len() - 1).iter().enumerate() {
            system.latches[self.first + i].next = bit;
        }
    }
}

/// How many scans after the first one that began in its state a time has passed.
pub fn scans(machine: &Machine, milliseconds: u32) -> u64 {
    u64::from(milliseconds.div_ceil(machine.cycle))
}

/// Whether anything in the plant takes time, however long.
pub fn waits(machine: &Machine) -> bool {
    !machine.plant.travels.is_empty() || machine.plant.rules.iter().any(|r| r.delay > 0)
}

/// The clocks of a machine, those of its plant only with it.
pub fn of(machine: &Machine, timers: &[(StateId, u32)], plant: bool) -> BTreeSet<Clock> {
    let regions = timers.iter().map(|t| Clock::Region(machine.states[t.0].region));
    // One that takes at most so long is seen to in any case.
    let travels = machine.plant.travels.iter().filter(|t| !t.at_most).map(|t| Clock::Travel(t.actuator));
    let rules = machine.plant.rules.iter().enumerate().filter(|(_, r)| r.delay > 0).map(|(i, _)| Clock::Rule(i));
    regions.chain(travels.chain(rules).filter(|_| plant)).collect()
}

/// The largest number of scans for which anything that counts waits.
pub fn longest(machine: &Machine, counted: &Counted, timers: &[(StateId, u32)], plant: bool) -> u64 {
    let timers = timers.iter().filter(|t| counted.has(Clock::Region(machine.states[t.0].region)));
    let timers = timers.map(|t| scans(machine, t.1));
    let travels = machine.plant.travels.iter().filter(|t| t.at_most || counted.has(Clock::Travel(t.actuator)));
    let travels = travels.map(|t| u64::from(t.out.max(t.back)));
    let rules = machine.plant.rules.iter().enumerate().filter(|(i, _)| counted.has(Clock::Rule(*i)));
    let rules = rules.map(|(_, r)| u64::from(r.delay));
    let plant = travels.chain(rules).filter(|_| plant);
    timers.chain(plant).max().unwrap_or(0)
}

/// The clocks of regions in which states wait.
pub struct Regions {
    /// For each timer that runs, the clock of its region.
    clocks: BTreeMap<RegionId, Counter>,
    timers: Vec<(StateId, u32)>,
}

impl Regions {
    /// Clocks for the timers that count, of which the states can be active.
    pub fn new(
        system: &mut System,
        clocks: &mut Clocks,
        machine: &Machine,
        step: &ChartStep<'_>,
        runs: &dyn Fn(StateId) -> bool,
    ) -> Regions {
        let counts = |state: StateId| clocks.counted.has(Clock::Region(machine.states[state].region));
        let timers: Vec<(StateId, u32)> = step.timers().filter(|t| runs(t.0) && counts(t.0)).collect();
        let mut most: BTreeMap<RegionId, u64> = BTreeMap::new();
        for &(state, time) in &timers {
            let most = most.entry(machine.states[state].region).or_default();
            *most = (*most).max(scans(machine, time));
        }
        let of = |(region, most): (RegionId, u64)| {
            let first = timers.iter().find(|t| machine.states[t.0].region == region).expect("it has a timer");
            let name = format!("the time beside {}", machine.state_path(first.0));
            (region, clocks.clock(system, Clock::Region(region), &name, most, 0))
        };
        let counters: BTreeMap<RegionId, Counter> = most.into_iter().map(of).collect();
        Regions { clocks: counters, timers }
    }

    /// Whether its time has passed by now if it runs; nothing of a timer that does not count here.
    pub fn passed(&self, aig: &mut Aig, machine: &Machine, timer: (StateId, u32)) -> Option<Lit> {
        let clock = self.clocks.get(&machine.states[timer.0].region).filter(|_| self.timers.contains(&timer))?;
        Some(clock.is_at_least(aig, scans(machine, timer.1)))
    }

    /// Whether it counts a timer.
    pub fn has(&self, timer: (StateId, u32)) -> bool {
        self.timers.contains(&timer)
    }

    /// Takes the clocks on. `before` is what was remembered when the scan began, `after` what is at its end.
    pub fn tick(
        &self,
        system: &mut System,
        clocks: &mut Clocks,
        machine: &Machine,
        step: &ChartStep<'_>,
        [before, after]: [&ChartState; 2],
        turn: Lit,
    ) {
        let all: Vec<(StateId, u32)> = step.timers().collect();
        for (region, clock) in &self.clocks {
            let mut runs = Vec::new();
            let mut full = Vec::new();
            let own = self.timers.iter().filter(|t| machine.states[t.0].region == *region);
            let mut longest: BTreeMap<StateId, u64> = BTreeMap::new();
            for t in own {
                let i = all.iter().position(|other| other == t).expect("it is a timer of the step");
                let bound = scans(machine, t.1);
                // Nothing has been counted when a state has just been entered: the first scan that begins in it counts as none.
                let stays = system.aig.and(after.active[t.0.index()], !after.fresh[i]);
                let was = system.aig.and(before.active[t.0.index()], stays);
                runs.push(was);
                clocks.stop_before(system, clock, was, &clock.value, bound);
                let most = longest.entry(t.0).or_default();
                *most = (*most).max(bound);
            }
            for (state, most) in longest {
                let all = clock.is_at_least(&mut system.aig, most);
                full.push(system.aig.and(before.active[state.index()], all));
            }
            let (runs, full) = (system.aig.any(&runs), system.aig.any(&full));
            clocks.count(system, clock, runs, full, turn);
        }
    }
}
