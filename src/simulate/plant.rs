//! Runs a plant scan by scan, by the meaning that [`crate::ir::scenario`] gives it.

use super::chance;
use super::frame::{Frame, Layout};
use crate::ir::chart::{ActuatorId, InputId, Machine};
use crate::ir::scenario::{Alteration, CountId, Given, Valve};

/// The plant of a machine that runs, with what a scenario does to it.
#[derive(Clone, Debug)]
pub struct Plant {
    layout: Layout,
    /// For each travel, where it is.
    travels: Vec<Place>,
    /// For each rule, how many scans its condition has held.
    counts: Vec<u32>,
    /// For each input, the value at which it is held.
    forced: Vec<Option<bool>>,
    /// For each rule, whether it acts when outputs are written, and only then.
    at_writing: Vec<bool>,
    /// Where steps happen by chance, the state of the generator.
    chance: Option<u64>,
    /// The outputs that the program has decided and that are still to be written.
    decided: Option<Vec<bool>>,
    /// What stands at the terminals: inputs, hidden values and outputs that have been written.
    values: Frame,
    first: bool,
}

/// Where an actuator is.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// From 0 at the first position to `out * back` at the second, so that both ways take whole steps.
    at: u64,
    /// The position to which it was last ordered.
    order: Option<usize>,
}

impl Plant {
    /// The plant as it stands before the first scan.
    pub fn new(machine: &Machine) -> Plant {
        let layout = Layout::of(machine);
        let mut plant = Plant {
            layout,
            travels: vec![Place { at: 0, order: None }; machine.plant.travels.len()],
            counts: vec![0; machine.plant.rules.len()],
            forced: vec![None; machine.inputs.len()],
            at_writing: machine.plant.rules.iter().map(|r| machine.plant.by_steps && r.is_of_valve()).collect(),
            chance: None,
            decided: None,
            values: layout.frame(),
            first: true,
        };
        for &(given, value) in &machine.plant.initially {
            plant.set(given, value);
        }
        for &(actuator, position) in &machine.plant.places {
            plant.place(machine, actuator, position);
        }
        for (id, count) in machine.plant.counts.iter() {
            layout.put_count(id, count.initial, &mut plant.values);
        }
        plant
    }

    /// From now on steps happen by chance, and what nobody knows to begin with is decided by it.
    pub fn leave_to_chance(&mut self, machine: &Machine, seed: u64) {
        let mut state = seed;
        for &bit in &machine.plant.unknown {
            self.values[self.layout.bit(bit)] = chance::next(&mut state) & 1 == 1;
        }
        self.chance = Some(state);
    }

    /// Gives a value to what the plant does not change by itself; else the plant goes on from there.
    pub fn set(&mut self, given: Given, value: bool) {
        self.values[self.layout.place(given)] = value;
    }

    /// Holds an input at a value, or holds it no more.
    pub fn force(&mut self, input: InputId, value: Option<bool>) {
        self.forced[input.index()] = value;
    }

    /// Puts an actuator at a position; its valve has no order any more.
    pub fn place(&mut self, machine: &Machine, actuator: ActuatorId, position: usize) {
        for (place, travel) in self.travels.iter_mut().zip(&machine.plant.travels) {
            if travel.actuator == actuator {
                let end = u64::from(travel.out) * u64::from(travel.back);
                *place = Place { at: if position == 0 { 0 } else { end }, order: None };
            }
        }
    }

    /// The program has decided on outputs.
    pub fn decide(&mut self, outputs: &[bool]) {
        self.decided = Some(outputs.to_vec());
    }

    /// Whether outputs are still to be written that the program has decided on.
    pub fn waits(&self) -> bool {
        self.decided.is_some()
    }

    /// Writes the outputs on which the program has decided, unless that has been done.
    pub fn write(&mut self, machine: &Machine) {
        let Some(decided) = self.decided.take() else { return };
        self.live_by_chance(machine);
        let outputs = self.layout.outputs();
        self.values[outputs].copy_from_slice(&decided);
        self.follow(machine);
        self.live_by_chance(machine);
    }

    /// What may happen now and does by itself, by index.
    pub fn possible(&self, machine: &Machine) -> Vec<usize> {
        if self.first || self.chance.is_some() {
            return Vec::new();
        }
        // What only others make possible waits for the next scan, so that nothing goes its whole way in one.
        (0..machine.plant.happenings.len()).filter(|&i| self.can_happen(machine, i)).collect()
    }

    /// Moves up to the next reading, once outputs have been written. `before` is the frame of the scan before, `earlier` of the
    /// one before that; both are all FALSE as far as there was none. Returns the inputs that the program samples.
    pub fn step(&mut self, machine: &Machine, before: &Frame, earlier: &Frame) -> &[bool] {
        self.write(machine);
        let outputs = self.layout.outputs();
        let mut past = before.clone();
        past[outputs.clone()].copy_from_slice(&earlier[outputs]);
        self.travel(machine, &past);
        self.hold();
        for (i, rule) in machine.plant.rules.iter().enumerate() {
            if self.at_writing[i] {
                continue;
            }
            let place = self.layout.place(rule.target);
            let held = matches!(rule.target, Given::Input(input) if self.forced[input.index()].is_some());
            // What had no scan before it has no edge.
            let before = if self.first { &self.values } else { &past };
            let pending = !held
                && self.values[place] != rule.value
                && self.layout.holds(machine, &rule.condition, &self.values, before);
            if !pending {
                self.counts[i] = 0;
            } else if self.counts[i] >= rule.delay {
                self.counts[i] = 0;
                self.values[place] = rule.value;
            } else {
                self.counts[i] += 1;
            }
        }
        self.first = false;
        &self.values[self.layout.inputs()]
    }

    /// What happens by chance before or after a writing.
    fn live_by_chance(&mut self, machine: &Machine) {
        let Some(mut state) = self.chance else { return };
        // Some rounds, mostly few: a plant that is slower than the program, and now and then faster.
        while chance::next(&mut state) & 1 == 1 {
            for happening in 0..machine.plant.happenings.len() {
                if chance::next(&mut state) & 1 == 1 {
                    self.happen(machine, happening);
                }
            }
        }
        self.chance = Some(state);
    }

    /// Whether the happening of that index can happen now.
    pub fn can_happen(&self, machine: &Machine, happening: usize) -> bool {
        // A step reads no past.
        self.layout.holds(machine, &machine.plant.happenings[happening].condition, &self.values, &self.values)
    }

    /// Lets something happen if it can, and says whether it could.
    pub fn happen(&mut self, machine: &Machine, happening: usize) -> bool {
        if !self.can_happen(machine, happening) {
            return false;
        }
        let happening = &machine.plant.happenings[happening];
        let before = self.values.clone();
        for outcome in happening.outcomes.iter().filter(|o| self.layout.holds(machine, &o.condition, &before, &before))
        {
            match &outcome.change {
                Alteration::Bit(bit, value) => self.values[self.layout.bit(*bit)] = *value,
                Alteration::Count(id, value) => {
                    let range = machine.plant.counts[*id].range;
                    let value = value.eval(&|&c| self.layout.count(c, &before));
                    self.layout.put_count(*id, value.clamp(range.lowest, range.highest), &mut self.values);
                }
            }
        }
        true
    }

    /// Valves follow outputs that have just been written.
    fn follow(&mut self, machine: &Machine) {
        for (rule, _) in machine.plant.rules.iter().zip(&self.at_writing).filter(|(_, at_writing)| **at_writing) {
            if self.layout.holds(machine, &rule.condition, &self.values, &self.values) {
                let place = self.layout.place(rule.target);
                self.values[place] = rule.value;
            }
        }
    }

    /// The value of a hidden integer.
    pub fn count(&self, count: CountId) -> i64 {
        self.layout.count(count, &self.values)
    }

    /// Writes all that is hidden into a frame.
    pub fn reveal(&self, frame: &mut Frame) {
        let bits = self.layout.inputs().end..self.layout.given().end;
        frame[bits.clone()].copy_from_slice(&self.values[bits]);
        self.tell(frame);
    }

    /// Writes the values of hidden integers into a frame.
    pub fn tell(&self, frame: &mut Frame) {
        let counts = self.layout.counts();
        frame[counts.clone()].copy_from_slice(&self.values[counts]);
    }

    /// The values of inputs and hidden bits.
    pub fn given(&self) -> &[bool] {
        &self.values[self.layout.given()]
    }

    fn travel(&mut self, machine: &Machine, past: &Frame) {
        for (place, travel) in self.travels.iter_mut().zip(&machine.plant.travels) {
            let actuator = &machine.actuators[travel.actuator];
            let ordered: Vec<usize> = (0..actuator.positions.len())
                .filter(|&p| actuator.positions[p].output.is_some_and(|o| self.values[self.layout.output(o)]))
                .collect();
            let alone = if let [one] = ordered[..] { Some(one) } else { None };
            place.order = match travel.valve {
                Valve::Keeps => alone.or(place.order),
                Valve::WhileDriven => alone,
                Valve::Spring => Some(usize::from(!ordered.is_empty())),
            };
            let before = if self.first { &self.values } else { past };
            let power = self.layout.holds(machine, &travel.power, &self.values, before);
            let (out, back) = (u64::from(travel.out), u64::from(travel.back));
            if !self.first {
                match place.order {
                    // A spring needs nothing to go back.
                    Some(0) if power || travel.valve == Valve::Spring => place.at = place.at.saturating_sub(out),
                    Some(1) if power => place.at = (place.at + back).min(out * back),
                    Some(1) if travel.valve == Valve::Spring => place.at = place.at.saturating_sub(out),
                    _ => {}
                }
            }
            for sensor in &travel.sensors {
                let end = if sensor.position == 0 { 0 } else { out * back };
                self.values[self.layout.input(sensor.input)] = (place.at == end) == sensor.there;
            }
        }
    }

    /// Puts forced inputs back to their values.
    fn hold(&mut self) {
        for (value, forced) in self.values[self.layout.inputs()].iter_mut().zip(&self.forced) {
            if let Some(forced) = forced {
                *value = *forced;
            }
        }
    }
}
