//! A plant to what it gives the program: the closed loop.
//!
//! It is that of [`scenario`](crate::ir::scenario), with [times](super::clocks::Times) that are exact or left open. If they are exact,
//! an actuator that travels takes as long as it says, or at most so long where that is all that is said, and a rule with a delay fires when
//! its time is over. If they are open, an actuator that is on its way may make
//! progress in a scan or not; it is at least one scan between its positions if it travels for more than
//! one, and otherwise as long as it likes, or is allowed to. A rule with a delay fires in any scan in which its condition holds
//! as it did in the scan before, or does not fire. So everything that the plant can do at any speed is covered, and
//! more: a counterexample may need an actuator that stands still.
//!
//! A plant that goes by steps is left to [`steps`].

use super::super::aig::{Aig, Lit};
use super::super::system::{Giver, System};
use super::clocks::{Clock, Clocks, Counter};
use super::steps::{self, Turn};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{ActuatorId, Atom, Machine};
use crate::ir::scenario::{Condition, Count, Counted, Given, Rule, Seen, Travel, Valve};
use crate::prove::chart_numbers::compare_of;
use crate::prove::chart_step::ChartState;

/// What stands at the terminals when the program samples, and what is hidden behind them.
pub struct Terminals {
    /// For each input, its value.
    pub inputs: Vec<Lit>,
    /// For each hidden bit, its value.
    pub bits: Vec<Lit>,
    /// For each hidden bit, its value in the scan before, if there was one.
    pub past_bits: Vec<Lit>,
    /// For each hidden integer, its value.
    pub counts: Vec<Vector>,
    /// Whose turn it is.
    pub turn: Turn,
}

/// Lets the plant move under the outputs of the scan before; with `open` it gives nothing. In a plant that goes by
/// steps, hidden values are those after whatever happens, and inputs are those that are read if that happens.
pub fn give(
    system: &mut System,
    clocks: &mut Clocks,
    machine: &Machine,
    started: Lit,
    before: &ChartState,
    open: bool,
) -> Terminals {
    let plant = &machine.plant;
    let gives = if open { vec![false; machine.inputs.len()] } else { plant.gives(machine.inputs.len()) };
    let begins = |given: Given| plant.initially.iter().any(|&(g, value)| g == given && value);
    let mut memory = Vec::new();
    let (mut inputs, mut past_inputs) = (Vec::new(), Vec::new());
    for (id, input) in machine.inputs.iter() {
        if gives[id.index()] {
            memory.push((system.latches.len(), Given::Input(id)));
            let latch = system.latch(format!("plant: {}", input.name), Some(begins(Given::Input(id))));
            inputs.push(latch);
            past_inputs.push(latch);
        } else {
            let free = system.input(&input.name, Giver::Operator);
            inputs.push(free);
            past_inputs.push(before.inputs[id.index()]);
        }
    }
    let mut bits = Vec::new();
    for (id, bit) in plant.bits.iter() {
        if !open {
            memory.push((system.latches.len(), Given::Bit(id)));
            let initial = (!plant.unknown.contains(&id)).then(|| begins(Given::Bit(id)));
            bits.push(system.latch(&bit.name, initial));
        } else {
            bits.push(system.input(&bit.name, Giver::Plant));
        }
    }
    let count_latches: Vec<(usize, Vector)> =
        plant.counts.values().map(|c| (system.latches.len(), count(system, c, open))).collect();
    let (count_latches, counts): (Vec<usize>, Vec<Vector>) = count_latches.into_iter().unzip();
    let past_bits = bits.clone();
    if open {
        let past_bits = remembered(system, machine, &bits);
        return Terminals { inputs, bits, past_bits, counts, turn: Turn::always() };
    }
    let first_earlier = system.latches.len();
    let mut earlier = Vec::new();
    for (id, output) in machine.outputs.iter() {
        let latch = system.latches.len();
        earlier.push(system.latch(format!("prev(prev({}))", output.name), Some(false)));
        system.latches[latch].next = before.outputs[id.index()];
    }
    let outputs = before.outputs.clone();
    let mut terminals = Moving {
        machine,
        started,
        outputs,
        earlier,
        first_earlier,
        inputs,
        past_inputs,
        bits,
        past_bits,
        counts,
        count_latches,
    };
    if plant.by_steps {
        return steps::live(system, clocks, terminals, &memory);
    }
    for travel in &plant.travels {
        terminals.travel(system, clocks, travel);
    }
    for (i, rule) in plant.rules.iter().enumerate() {
        terminals.rule(system, clocks, i, rule, Lit::TRUE);
    }
    for (latch, given) in memory {
        system.latches[latch].next = terminals.value(given);
    }
    let Moving { inputs, bits, past_bits, counts, .. } = terminals;
    Terminals { inputs, bits, past_bits, counts, turn: Turn::always() }
}

/// For each hidden bit, a latch that keeps its value.
fn remembered(system: &mut System, machine: &Machine, bits: &[Lit]) -> Vec<Lit> {
    let mut past = Vec::new();
    for (bit, &now) in machine.plant.bits.values().zip(bits) {
        let latch = system.latches.len();
        past.push(system.latch(format!("prev({})", bit.name), Some(false)));
        system.latches[latch].next = now;
    }
    past
}

/// A hidden integer: how far it is above its lowest value.
fn count(system: &mut System, count: &Count, open: bool) -> Vector {
    let (lowest, most) = (count.range.lowest, count.range.highest - count.range.lowest);
    let mut offset = Vector::new();
    for i in 0..width(count) {
        let name = format!("bit {i} of {}", count.name);
        offset.push(if open {
            system.input(name, Giver::Plant)
        } else {
            let latch = system.latches.len();
            let bit = system.latch(name, Some((count.initial - lowest) >> i & 1 == 1));
            system.latches[latch].next = bit;
            bit
        });
    }
    offset.push(Lit::FALSE);
    if open {
        let beyond = vector::less(&mut system.aig, &vector::constant(most), &offset);
        system.constraints.push(!beyond);
    }
    if lowest == 0 { offset } else { vector::add(&mut system.aig, &vector::constant(lowest), &offset) }
}

/// How many bits tell the values of a hidden integer apart.
pub fn width(count: &Count) -> usize {
    let most = count.range.highest - count.range.lowest;
    (0..).find(|&i| most >> i == 0).unwrap_or(0)
}

/// The greatest common divisor.
fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// The plant while it moves.
pub struct Moving<'m> {
    /// Whose plant it is.
    pub machine: &'m Machine,
    /// Whether a scan has run before.
    pub started: Lit,
    /// What stands at the terminals.
    pub outputs: Vec<Lit>,
    /// What stood there a scan earlier.
    pub earlier: Vec<Lit>,
    /// The first of the latches that keep that.
    pub first_earlier: usize,
    /// For each input, its value as far as the plant has come.
    pub inputs: Vec<Lit>,
    /// For each input, what the program read last, if it has.
    pub past_inputs: Vec<Lit>,
    /// For each hidden bit, its value as far as the plant has come.
    pub bits: Vec<Lit>,
    /// For each hidden bit, its value in the scan before, if there was one.
    pub past_bits: Vec<Lit>,
    /// For each hidden integer, its value as far as the plant has come.
    pub counts: Vec<Vector>,
    /// For each hidden integer, the first of its latches.
    pub count_latches: Vec<usize>,
}

impl Moving<'_> {
    /// Where the value of an input or hidden bit is kept.
    pub fn place(&mut self, given: Given) -> &mut Lit {
        match given {
            Given::Input(i) => &mut self.inputs[i.index()],
            Given::Bit(b) => &mut self.bits[b.index()],
        }
    }

    /// The value of an input or hidden bit.
    pub fn value(&mut self, given: Given) -> Lit {
        *self.place(given)
    }

    /// Whether a condition of the plant holds as far as it has come. What has no past has no edge.
    pub fn holds(&self, aig: &mut Aig, condition: &Condition) -> Lit {
        aig.expression(condition, &mut |aig, &seen| match seen {
            Seen::Machine(Atom::Input(i)) => self.inputs[i.index()],
            Seen::Machine(Atom::PrevInput(i)) => {
                aig.select(self.started, self.past_inputs[i.index()], self.inputs[i.index()])
            }
            Seen::Machine(Atom::Output(o)) => self.outputs[o.index()],
            Seen::Machine(Atom::PrevOutput(o)) => self.earlier[o.index()],
            Seen::Bit(b) => self.bits[b.index()],
            Seen::PrevBit(b) => aig.select(self.started, self.past_bits[b.index()], self.bits[b.index()]),
            Seen::Compare(c) => compare_of(aig, &self.machine.plant.comparisons[c], &|&counted| match counted {
                Counted::Hidden(c) => self.counts[c.index()].clone(),
                Counted::Program(_) => unreachable!("a plant knows nothing of the program"),
            }),
            Seen::Machine(_) | Seen::PrevIn(_) | Seen::Mark(_) | Seen::Acted(_) | Seen::Broken(_) => {
                unreachable!("a plant knows nothing of the program")
            }
        })
    }

    /// Tries a rule; what it counts goes on only when it is its `turn`.
    pub fn rule(&mut self, system: &mut System, clocks: &mut Clocks, i: usize, rule: &Rule, turn: Lit) {
        let now = self.value(rule.target);
        let holds = self.holds(&mut system.aig, &rule.condition);
        let differs = now.xor(rule.value);
        let pending = system.aig.and(holds, differs);
        let fires = if rule.delay == 0 {
            pending
        } else if clocks.counted.has(Clock::Rule(i)) {
            let delay = u64::from(rule.delay);
            let name = format!("how long rule {} has waited", i + 1);
            let counter = clocks.clock(system, Clock::Rule(i), &name, delay, 0);
            let over = counter.is_at_least(&mut system.aig, delay);
            let fires = system.aig.and(pending, over);
            let waits = system.aig.and(pending, !over);
            clocks.stop_before(system, &counter, waits, &counter.value, delay);
            clocks.count(system, &counter, waits, Lit::FALSE, turn);
            fires
        } else {
            let latch = system.latches.len();
            let held = system.latch(format!("rule {} has waited", i + 1), Some(false));
            let time = system.input(format!("rule {} fires", i + 1), Giver::Plant);
            let ripe = system.aig.and(held, time);
            let fires = system.aig.and(pending, ripe);
            // A rule whose condition holds for ever acts, and does so when it is its turn.
            let acts = system.aig.or(!pending, fires);
            let acts = system.aig.and(acts, turn);
            system.fairness(format!("rule {}", i + 1), acts);
            let waits = system.aig.and(pending, !fires);
            system.latches[latch].next = system.aig.select(turn, waits, held);
            fires
        };
        let value = system.aig.select(fires, Lit::of(rule.value), now);
        *self.place(rule.target) = value;
    }

    /// For each position of an actuator, whether its output alone is TRUE, and whether any is, under these outputs.
    pub fn driven(&self, aig: &mut Aig, actuator: ActuatorId, outputs: &[Lit]) -> ([Lit; 2], Lit) {
        let positions = &self.machine.actuators[actuator].positions;
        let driven = |p: usize| positions[p].output.map_or(Lit::FALSE, |o| outputs[o.index()]);
        let (first, second) = (driven(0), driven(1));
        ([aig.and(first, !second), aig.and(second, !first)], aig.or(first, second))
    }

    /// For each position of an actuator, a latch that says whether it is ordered there. The caller says what it becomes.
    pub fn order(&self, system: &mut System, actuator: ActuatorId) -> [Lit; 2] {
        let actuator = &self.machine.actuators[actuator];
        [0, 1].map(|p| {
            system.latch(format!("{} was ordered to {}", actuator.name, actuator.positions[p].name), Some(false))
        })
    }

    /// Whether the actuator moves to each of its positions, if it is not there.
    pub fn toward(&self, aig: &mut Aig, travel: &Travel, ordered: [Lit; 2]) -> [Lit; 2] {
        let power = self.holds(aig, &travel.power);
        let out = aig.and(ordered[1], power);
        // A spring needs nothing to go back.
        let back = if travel.valve == Valve::Spring { !out } else { aig.and(ordered[0], power) };
        [back, out]
    }

    /// For each position of an actuator, a latch that says whether it is there. The caller says what it becomes.
    pub fn at(&self, system: &mut System, id: ActuatorId) -> [Lit; 2] {
        let actuator = &self.machine.actuators[id];
        let places = &self.machine.plant.places;
        let beginning = places.iter().rev().find(|(a, _)| *a == id).map_or(0, |&(_, position)| position);
        [0, 1].map(|p| {
            system.latch(format!("{} is at {}", actuator.name, actuator.positions[p].name), Some(p == beginning))
        })
    }

    /// For each position of an actuator that is never slower than it says, how often it has been on its way there without
    /// arriving, up to one scan less than it may take and `more`.
    pub fn ways(&self, system: &mut System, clocks: &mut Clocks, travel: &Travel, more: u32) -> Option<[Way; 2]> {
        let actuator = &self.machine.actuators[travel.actuator];
        let scans = [travel.back, travel.out];
        let way = |p: usize| {
            let most = u64::from(scans[p] - 1 + more);
            let name = format!("the time on the way of {} to {}", actuator.name, actuator.positions[p].name);
            Way { counter: clocks.counter(system, &name, most, 0), most }
        };
        travel.at_most.then(|| [0, 1].map(way))
    }

    /// Lets an actuator take a scan of its way when it is its `turn`, as long as it takes. Returns for each position whether it is there
    /// then.
    pub fn go(
        &self,
        system: &mut System,
        clocks: &mut Clocks,
        travel: &Travel,
        toward: [Lit; 2],
        turn: Lit,
    ) -> [Lit; 2] {
        let actuator = &self.machine.actuators[travel.actuator];
        let beginning = self.machine.plant.places.iter().rev().find(|(a, _)| *a == travel.actuator);
        let (out, back) = (u64::from(travel.out), u64::from(travel.back));
        // Both ways take whole steps.
        let common = divisor(out, back);
        let whole = out / common * back;
        let begins = if beginning.is_some_and(|&(_, position)| position == 1) { whole } else { 0 };
        let name = format!("the place of {}", actuator.name);
        let place = clocks.clock(system, Clock::Travel(travel.actuator), &name, whole, begins);
        clocks.travel(system, &place, toward, [out / common, back / common], turn)
    }

    /// Sensors follow from where the actuator is.
    pub fn sense(&mut self, travel: &Travel, at: [Lit; 2]) {
        for sensor in &travel.sensors {
            self.inputs[sensor.input.index()] = at[sensor.position].xor(!sensor.there);
        }
    }

    /// One actuator: where it is ordered, and where it may be then.
    fn travel(&mut self, system: &mut System, clocks: &mut Clocks, travel: &Travel) {
        let actuator = &self.machine.actuators[travel.actuator];
        let (alone, some) = self.driven(&mut system.aig, travel.actuator, &self.outputs);
        let ordered = match travel.valve {
            Valve::WhileDriven => alone,
            Valve::Spring => [!some, some],
            Valve::Keeps => {
                let latches = system.latches.len();
                let last = self.order(system, travel.actuator);
                [0, 1].map(|p| {
                    let stays = system.aig.and(last[p], !alone[1 - p]);
                    let order = system.aig.or(alone[p], stays);
                    system.latches[latches + p].next = order;
                    order
                })
            }
        };
        let toward = self.toward(&mut system.aig, travel, ordered);
        let toward = toward.map(|t| system.aig.and(t, self.started));
        if !travel.at_most && clocks.counted.has(Clock::Travel(travel.actuator)) {
            let at = self.go(system, clocks, travel, toward, Lit::TRUE);
            self.sense(travel, at);
            return;
        }
        let latches = system.latches.len();
        let at = self.at(system, travel.actuator);
        let ways = self.ways(system, clocks, travel, 0);
        let leaves = system.input(format!("{} gets away", actuator.name), Giver::Plant);
        let arrives = system.input(format!("{} arrives", actuator.name), Giver::Plant);
        let aig = &mut system.aig;
        let scans = [travel.back, travel.out];
        // When it has to have left the other position, and to arrive.
        let late = match &ways {
            Some(ways) => [0, 1].map(|p| {
                let leaves = u64::from(scans[p].saturating_sub(2));
                [ways[p].counter.is_at_least(aig, leaves), ways[p].is_over(aig)]
            }),
            None => [[Lit::FALSE; 2]; 2],
        };
        let mut then = [Lit::FALSE; 2];
        // Whether it arrives at a position in this scan, from the other one only if that takes one scan.
        let arrived = [0, 1].map(|p| {
            let near = if scans[p] > 1 { aig.and(arrives, !at[1 - p]) } else { arrives };
            let near = aig.or(near, late[p][1]);
            aig.and(toward[p], near)
        });
        for p in [0, 1] {
            let gets_away = aig.or(leaves, arrived[1 - p]);
            let gets_away = aig.or(gets_away, late[1 - p][0]);
            let gone = aig.and(toward[1 - p], gets_away);
            let stays = aig.and(at[p], !gone);
            then[p] = aig.or(stays, arrived[p]);
        }
        for p in [0, 1] {
            system.latches[latches + p].next = then[p];
        }
        for (p, way) in ways.iter().flatten().enumerate() {
            let on = system.aig.and(toward[p], !then[p]);
            let leaves = u64::from(scans[p].saturating_sub(2));
            clocks.stop_before(system, &way.counter, on, &way.counter.value, leaves);
            way.go_on(system, clocks, on, Lit::TRUE);
        }
        for p in [0, 1] {
            // An actuator that is ordered for ever arrives.
            let there = system.aig.or(!toward[p], then[p]);
            let actuator = &self.machine.actuators[travel.actuator];
            system.fairness(format!("{} to {}", actuator.name, actuator.positions[p].name), there);
        }
        self.sense(travel, then);
    }
}

/// How often in a row an actuator has been on its way to a position without arriving, up to the most that is possible.
pub struct Way {
    counter: Counter,
    most: u64,
}

impl Way {
    /// Whether it cannot be on its way any more.
    pub fn is_over(&self, aig: &mut Aig) -> Lit {
        self.counter.is_at_least(aig, self.most)
    }

    /// One more time when it `counts` if it is on its way, from the beginning if not.
    pub fn go_on(&self, system: &mut System, clocks: &mut Clocks, is_on: Lit, counts: Lit) {
        let over = self.is_over(&mut system.aig);
        let turn = system.aig.or(counts, !is_on);
        clocks.stop_before(system, &self.counter, is_on, &self.counter.value, self.most);
        clocks.count(system, &self.counter, is_on, over, turn);
    }
}
