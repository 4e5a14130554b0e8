//! All that a plant can do, choice by choice.

use super::program::Memory;
use chartwright::ir::chart::{InputId, Machine};
use chartwright::ir::scenario::{Alteration, Condition, Given, Rule, Travel, Valve};
use chartwright::simulate::frame::{Frame, Layout};

/// The plant of a machine.
pub struct Plant<'m> {
    pub machine: &'m Machine,
    pub layout: Layout,
    /// Whether there is none: everything is free.
    pub open: bool,
    /// Whether all takes as long as it says.
    pub exact: bool,
}

/// How a plant stands.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Moment {
    /// What it gives as far as it has come; FALSE where it gives nothing.
    inputs: Vec<bool>,
    bits: Vec<bool>,
    counts: Vec<i64>,
    /// Hidden bits when the inputs were read last.
    past_bits: Vec<bool>,
    /// For each travel, where it is: 0 and 1 are its positions, 2 is between them.
    places: Vec<usize>,
    /// For each travel, where its valve leads.
    orders: Vec<Option<usize>>,
    /// For each rule with a time, whether its condition held in the scan before and it did not act.
    waited: Vec<bool>,
    /// If times are exact, how far each travel has come, in scans out times scans back; and how long each rule has waited.
    ways: Vec<u64>,
    waits: Vec<u32>,
    /// What stands at the terminals, and what stood there when the inputs were read last.
    outputs: Vec<bool>,
    earlier: Vec<bool>,
    /// What the program has decided and not yet written.
    waiting: Option<Vec<bool>>,
}

/// What else a plant depends on: the inputs that nobody gives, and what the program has read.
#[derive(Clone, Copy)]
pub struct Surroundings<'s> {
    pub free: &'s [(InputId, bool)],
    pub memory: &'s Memory,
}

/// Something that happens between two readings of the inputs.
pub struct Between {
    pub then: Moment,
    pub fair: u64,
}

/// The inputs when they are read.
pub struct Reading {
    pub then: Moment,
    pub inputs: Vec<bool>,
    pub fair: u64,
}

impl Plant<'_> {
    /// How many debts a plant has: bits of fairness, for each travel two, for each rule one, and that inputs are read.
    pub fn debts(&self) -> usize {
        if self.open { 0 } else { 2 * self.machine.plant.travels.len() + self.machine.plant.rules.len() + 1 }
    }

    /// How it may stand before anything has happened.
    pub fn beginnings(&self) -> Vec<Moment> {
        let plant = &self.machine.plant;
        let mut moment = Moment {
            inputs: vec![false; self.machine.inputs.len()],
            bits: vec![false; plant.bits.len()],
            counts: plant.counts.values().map(|c| c.initial).collect(),
            past_bits: vec![false; plant.bits.len()],
            places: vec![0; plant.travels.len()],
            orders: vec![None; plant.travels.len()],
            waited: vec![false; plant.rules.len()],
            ways: vec![0; plant.travels.len()],
            waits: vec![0; plant.rules.len()],
            outputs: vec![false; self.machine.outputs.len()],
            earlier: vec![false; self.machine.outputs.len()],
            waiting: None,
        };
        if self.open {
            moment.counts.fill(0);
            return vec![moment];
        }
        plant.initially.iter().for_each(|&(given, value)| moment.set(given, value));
        for &(actuator, position) in &plant.places {
            for (i, travel) in plant.travels.iter().enumerate().filter(|(_, t)| t.actuator == actuator) {
                moment.places[i] = position;
                moment.ways[i] = if self.exact && position == 1 { whole(travel) } else { 0 };
            }
        }
        let mut all = vec![moment];
        for bit in &plant.unknown {
            all = all
                .into_iter()
                .flat_map(|m| [false, true].map(|value| m.with(|m| m.set(Given::Bit(*bit), value))))
                .collect();
        }
        all
    }

    /// The same with what is seen of it in place of what the program cannot know.
    pub fn seen(&self, moment: &Moment, program: &Frame) -> Frame {
        let mut frame = program.clone();
        moment.bits.iter().zip(self.machine.plant.bits.ids()).for_each(|(&b, id)| frame[self.layout.bit(id)] = b);
        self.put_counts(moment, &mut frame);
        frame
    }

    /// What was so in the scan before.
    pub fn before(&self, moment: &Moment, program: &Frame) -> Frame {
        let mut frame = program.clone();
        moment.past_bits.iter().zip(self.machine.plant.bits.ids()).for_each(|(&b, id)| frame[self.layout.bit(id)] = b);
        frame
    }

    fn put_counts(&self, moment: &Moment, frame: &mut Frame) {
        self.machine
            .plant
            .counts
            .ids()
            .zip(&moment.counts)
            .for_each(|(id, &value)| self.layout.put_count(id, value, frame));
    }

    /// What happens when the program has decided.
    pub fn written(&self, mut moment: Moment, frame: &Frame) -> Moment {
        let outputs = frame[self.layout.outputs()].to_vec();
        if self.open {
            return moment;
        }
        if self.machine.plant.by_steps {
            moment.waiting = Some(outputs);
        } else {
            moment.outputs = outputs;
        }
        moment
    }

    fn holds(&self, moment: &Moment, around: Surroundings<'_>, condition: &Condition) -> bool {
        let frame = |inputs: &[bool], bits: &[bool], outputs: &[bool]| {
            let mut frame = self.layout.frame();
            frame[self.layout.inputs()].copy_from_slice(inputs);
            self.machine.plant.bits.ids().zip(bits).for_each(|(id, &bit)| frame[self.layout.bit(id)] = bit);
            frame[self.layout.outputs()].copy_from_slice(outputs);
            self.put_counts(moment, &mut frame);
            frame
        };
        let inputs = moment.inputs(around.free);
        let now = frame(&inputs, &moment.bits, &moment.outputs);
        // In the first scan inputs and hidden bits have no other past than themselves.
        let before = if around.memory.begun {
            frame(&around.memory.frame[self.layout.inputs()], &moment.past_bits, &moment.earlier)
        } else {
            frame(&inputs, &moment.bits, &moment.earlier)
        };
        self.layout.holds(self.machine, condition, &now, &before)
    }

    /// Which position each output of an actuator orders, if one alone does; and whether any does.
    fn driven(&self, travel: usize, outputs: &[bool]) -> (Option<usize>, bool) {
        let actuator = &self.machine.actuators[self.machine.plant.travels[travel].actuator];
        let is = |p: usize| actuator.positions[p].output.is_some_and(|o| outputs[o.index()]);
        match (is(0), is(1)) {
            (true, false) => (Some(0), true),
            (false, true) => (Some(1), true),
            (both, _) => (None, both),
        }
    }

    /// To which position an actuator moves if it is not there, under the order of its valve.
    fn toward(&self, moment: &Moment, around: Surroundings<'_>, travel: usize, order: Option<usize>) -> Option<usize> {
        let t = &self.machine.plant.travels[travel];
        let power = self.holds(moment, around, &t.power);
        match (t.valve, order) {
            // A spring needs nothing to go back, and without power does so whatever is ordered.
            (Valve::Spring, Some(1)) if power => Some(1),
            (Valve::Spring, _) => Some(0),
            (_, order) => order.filter(|_| power),
        }
    }

    /// The order of a valve under these outputs.
    fn order(&self, moment: &Moment, travel: usize, outputs: &[bool]) -> Option<usize> {
        let (alone, some) = self.driven(travel, outputs);
        match self.machine.plant.travels[travel].valve {
            Valve::Keeps => alone.or(moment.orders[travel]),
            Valve::WhileDriven => alone,
            Valve::Spring => Some(usize::from(some)),
        }
    }

    fn sense(&self, moment: &mut Moment, travel: usize) {
        for sensor in &self.machine.plant.travels[travel].sensors {
            moment.inputs[sensor.input.index()] = (moment.places[travel] == sensor.position) == sensor.there;
        }
    }

    fn takes_time(&self, travel: usize, to: usize) -> bool {
        let t = &self.machine.plant.travels[travel];
        [t.back, t.out][to] > 1
    }

    /// Tries a rule: all that it can do, each with whether it has done what it owes.
    fn rule(&self, moment: Moment, around: Surroundings<'_>, index: usize, rule: &Rule) -> Vec<(Moment, bool)> {
        let pending = moment.get(rule.target) != rule.value && self.holds(&moment, around, &rule.condition);
        if rule.delay == 0 {
            return vec![(if pending { moment.with(|m| m.set(rule.target, rule.value)) } else { moment }, true)];
        }
        if self.exact {
            let over = pending && moment.waits[index] == rule.delay;
            let then = moment.with(|m| {
                m.waits[index] = if pending && !over { m.waits[index] + 1 } else { 0 };
                if over {
                    m.set(rule.target, rule.value);
                }
            });
            return vec![(then, true)];
        }
        let mut all = Vec::new();
        if pending && moment.waited[index] {
            let acts = moment.with(|m| {
                m.set(rule.target, rule.value);
                m.waited[index] = false;
            });
            all.push((acts, true));
        }
        all.push((moment.with(|m| m.waited[index] = pending), !pending));
        all
    }

    /// All ways in which the inputs are read now.
    pub fn readings(&self, moment: &Moment, around: Surroundings<'_>) -> Vec<Reading> {
        let plant = &self.machine.plant;
        if self.open {
            return self.anything(moment, around);
        }
        if moment.waiting.is_some() {
            return Vec::new();
        }
        let rules = 2 * plant.travels.len();
        let mut all: Vec<(Moment, u64)> = vec![(moment.clone(), 0)];
        for travel in 0..plant.travels.len() {
            all = all.into_iter().flat_map(|(m, fair)| self.travel(m, around, travel, fair)).collect();
        }
        for (i, rule) in plant.rules.iter().enumerate() {
            if plant.by_steps && rule.is_of_valve() {
                all.iter_mut().for_each(|(_, fair)| *fair |= 1 << (rules + i));
                continue;
            }
            let tried = |(m, fair): (Moment, u64)| {
                let ways = self.rule(m, around, i, rule).into_iter();
                ways.map(move |(m, paid)| (m, fair | u64::from(paid) << (rules + i))).collect::<Vec<_>>()
            };
            all = all.into_iter().flat_map(tried).collect();
        }
        let read = |(mut then, fair): (Moment, u64)| {
            let inputs = then.inputs(around.free);
            then.past_bits.clone_from(&then.bits);
            then.earlier.clone_from(&then.outputs);
            Reading { then, inputs, fair: fair | 1 << (self.debts() - 1) }
        };
        all.into_iter().map(read).collect()
    }

    /// An actuator before a scan: all that it can do.
    fn travel(&self, mut moment: Moment, around: Surroundings<'_>, travel: usize, fair: u64) -> Vec<(Moment, u64)> {
        if self.exact {
            return vec![(self.go(moment, around, travel), fair | 3 << (2 * travel))];
        }
        if self.machine.plant.by_steps {
            // It has moved already.
            let order = self.order(&moment, travel, &moment.outputs);
            let fair = fair | self.paid(&moment, travel, self.toward(&moment, around, travel, order));
            self.sense(&mut moment, travel);
            return vec![(moment, fair)];
        }
        let order = self.order(&moment, travel, &moment.outputs);
        if self.machine.plant.travels[travel].valve == Valve::Keeps {
            moment.orders[travel] = order;
        }
        let toward = if around.memory.begun { self.toward(&moment, around, travel, order) } else { None };
        let at = moment.places[travel];
        let places = match toward {
            Some(to) if at == to => vec![to],
            Some(to) if at == 2 => vec![2, to],
            Some(to) if self.takes_time(travel, to) => vec![at, 2],
            Some(to) => vec![at, 2, to],
            None => vec![at],
        };
        let then = |place: usize| {
            let mut m = moment.with(|m| m.places[travel] = place);
            self.sense(&mut m, travel);
            let fair = fair | self.paid(&m, travel, toward);
            (m, fair)
        };
        places.into_iter().map(then).collect()
    }

    /// A scan of its way, where it takes as long as it says: from where it is called back it goes back in a part of the time.
    fn go(&self, mut moment: Moment, around: Surroundings<'_>, travel: usize) -> Moment {
        let t = &self.machine.plant.travels[travel];
        let order = self.order(&moment, travel, &moment.outputs);
        if t.valve == Valve::Keeps {
            moment.orders[travel] = order;
        }
        let toward = if around.memory.begun { self.toward(&moment, around, travel, order) } else { None };
        let way = moment.ways[travel];
        let way = match toward {
            Some(0) => way.saturating_sub(u64::from(t.out)),
            Some(_) => (way + u64::from(t.back)).min(whole(t)),
            None => way,
        };
        moment.ways[travel] = way;
        moment.places[travel] = if way == 0 {
            0
        } else if way == whole(t) {
            1
        } else {
            2
        };
        self.sense(&mut moment, travel);
        moment
    }

    /// For both positions of an actuator: it is not on its way there, or there.
    fn paid(&self, moment: &Moment, travel: usize, toward: Option<usize>) -> u64 {
        let paid = |p: usize| u64::from(toward != Some(p) || moment.places[travel] == p);
        (paid(0) | paid(1) << 1) << (2 * travel)
    }

    /// All that can happen between two readings.
    pub fn between(&self, moment: &Moment, around: Surroundings<'_>) -> Vec<Between> {
        let plant = &self.machine.plant;
        if self.open || !plant.by_steps {
            return Vec::new();
        }
        let mut all: Vec<Moment> = Vec::new();
        for happening in plant.happenings.iter().filter(|h| self.holds(moment, around, &h.condition)) {
            let mut then = moment.clone();
            for outcome in happening.outcomes.iter().filter(|o| self.holds(moment, around, &o.condition)) {
                match &outcome.change {
                    Alteration::Bit(bit, value) => then.bits[bit.index()] = *value,
                    Alteration::Count(count, value) => {
                        let range = plant.counts[*count].range;
                        let value = value.eval(&|c| moment.counts[c.index()]);
                        then.counts[count.index()] = value.max(range.lowest).min(range.highest);
                    }
                }
            }
            all.push(then);
        }
        let mut fair = 0;
        for travel in 0..plant.travels.len() {
            let order = self.order(moment, travel, &moment.outputs);
            let toward = self.toward(moment, around, travel, order);
            fair |= self.paid(moment, travel, toward);
            let at = moment.places[travel];
            if self.exact {
                fair |= 3 << (2 * travel);
            } else if let Some(to) = toward.filter(|&to| at != to) {
                let next = if at != 2 && self.takes_time(travel, to) { 2 } else { to };
                all.push(moment.with(|m| m.places[travel] = next));
            }
        }
        if let Some(outputs) = &moment.waiting {
            let mut then = moment.with(|m| {
                m.outputs.clone_from(outputs);
                m.waiting = None;
            });
            for (i, rule) in plant.rules.iter().enumerate().filter(|(_, r)| r.is_of_valve()) {
                then = self.rule(then, around, i, rule).remove(0).0;
            }
            for travel in 0..plant.travels.len() {
                if plant.travels[travel].valve == Valve::Keeps {
                    then.orders[travel] = self.order(moment, travel, outputs);
                }
            }
            all.push(then);
        }
        all.into_iter().map(|then| Between { then, fair }).collect()
    }

    /// Without a plant, inputs and all that is hidden are anything.
    fn anything(&self, moment: &Moment, around: Surroundings<'_>) -> Vec<Reading> {
        let plant = &self.machine.plant;
        let mut all = vec![moment.clone()];
        for bit in 0..plant.bits.len() {
            all = all.into_iter().flat_map(|m| [false, true].map(|v| m.with(|m| m.bits[bit] = v))).collect();
        }
        for (i, count) in plant.counts.values().enumerate() {
            let values = count.range.lowest..=count.range.highest;
            all = all.into_iter().flat_map(|m| values.clone().map(move |v| m.with(|m| m.counts[i] = v))).collect();
        }
        let read = |mut then: Moment| {
            then.past_bits.clone_from(&then.bits);
            Reading { inputs: then.inputs(around.free), then, fair: 0 }
        };
        all.into_iter().map(read).collect()
    }
}

/// The whole way of an actuator.
fn whole(travel: &Travel) -> u64 {
    u64::from(travel.out) * u64::from(travel.back)
}

impl Moment {
    fn with(&self, change: impl FnOnce(&mut Moment)) -> Moment {
        let mut then = self.clone();
        change(&mut then);
        then
    }

    fn get(&self, given: Given) -> bool {
        match given {
            Given::Input(i) => self.inputs[i.index()],
            Given::Bit(b) => self.bits[b.index()],
        }
    }

    fn set(&mut self, given: Given, value: bool) {
        match given {
            Given::Input(i) => self.inputs[i.index()] = value,
            Given::Bit(b) => self.bits[b.index()] = value,
        }
    }

    /// All inputs, with those that nobody gives.
    fn inputs(&self, free: &[(InputId, bool)]) -> Vec<bool> {
        let mut inputs = self.inputs.clone();
        free.iter().for_each(|&(input, value)| inputs[input.index()] = value);
        inputs
    }
}
