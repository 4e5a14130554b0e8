//! A plant to what it gives the program: the closed loop.
//!
//! It is that of [`scenario`](crate::ir::scenario), with times left open. An actuator that is on its way may make
//! progress in a scan or not; it is at least one scan between its positions if it travels for more than
//! one, and otherwise as long as it likes. A rule with a delay fires in any scan in which its condition holds
//! as it did in the scan before, or does not fire. So everything that the plant can do at any speed is covered, and
//! more: a counterexample may need an actuator that stands still.

use super::super::aig::{Aig, Lit};
use super::super::system::{Giver, System};
use crate::ir::chart::{Atom, Machine};
use crate::ir::scenario::{Condition, Given, Seen, Travel, Valve};
use crate::prove::chart_step::ChartState;

/// What stands at the terminals when the program samples.
pub struct Terminals {
    /// For each input, its value.
    pub inputs: Vec<Lit>,
    /// For each hidden bit, its value.
    pub bits: Vec<Lit>,
    /// For each hidden bit, its value in the scan before.
    pub past_bits: Vec<Lit>,
}

/// Lets the plant move under the outputs of the scan before; with `open` it gives nothing.
pub fn give(system: &mut System, machine: &Machine, started: Lit, before: &ChartState, open: bool) -> Terminals {
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
            // What has no past has no edge.
            past_inputs.push(system.aig.select(started, before.inputs[id.index()], free));
        }
    }
    let mut bits = Vec::new();
    for (id, bit) in plant.bits.iter() {
        if !open {
            memory.push((system.latches.len(), Given::Bit(id)));
            bits.push(system.latch(&bit.name, Some(begins(Given::Bit(id)))));
        } else {
            bits.push(system.input(&bit.name, Giver::Plant));
        }
    }
    let past_bits = bits.clone();
    if open {
        return Terminals { inputs, bits, past_bits };
    }
    let mut earlier = Vec::new();
    for (id, output) in machine.outputs.iter() {
        let latch = system.latches.len();
        earlier.push(system.latch(format!("prev(prev({}))", output.name), Some(false)));
        system.latches[latch].next = before.outputs[id.index()];
    }
    let mut terminals = Moving { started, outputs: &before.outputs, earlier, inputs, past_inputs, bits, past_bits };
    for travel in &plant.travels {
        terminals.travel(system, machine, travel);
    }
    for (i, rule) in plant.rules.iter().enumerate() {
        let now = terminals.value(rule.target);
        let holds = terminals.holds(&mut system.aig, &rule.condition);
        let differs = now.xor(rule.value);
        let pending = system.aig.and(holds, differs);
        let fires = if rule.delay == 0 {
            pending
        } else {
            let latch = system.latches.len();
            let held = system.latch(format!("rule {} has waited", i + 1), Some(false));
            let time = system.input(format!("rule {} fires", i + 1), Giver::Plant);
            let ripe = system.aig.and(held, time);
            let fires = system.aig.and(pending, ripe);
            // A rule whose condition holds for ever acts.
            let acts = system.aig.or(!pending, fires);
            system.fairness(format!("rule {}", i + 1), acts);
            system.latches[latch].next = system.aig.and(pending, !fires);
            fires
        };
        let value = system.aig.select(fires, Lit::of(rule.value), now);
        *terminals.place(rule.target) = value;
    }
    for (latch, given) in memory {
        system.latches[latch].next = terminals.value(given);
    }
    let Moving { inputs, bits, past_bits, .. } = terminals;
    Terminals { inputs, bits, past_bits }
}

/// The plant while it moves.
struct Moving<'a> {
    started: Lit,
    /// What was written in the scan before.
    outputs: &'a [Lit],
    /// What was written a scan earlier.
    earlier: Vec<Lit>,
    inputs: Vec<Lit>,
    past_inputs: Vec<Lit>,
    bits: Vec<Lit>,
    past_bits: Vec<Lit>,
}

impl Moving<'_> {
    fn place(&mut self, given: Given) -> &mut Lit {
        match given {
            Given::Input(i) => &mut self.inputs[i.index()],
            Given::Bit(b) => &mut self.bits[b.index()],
        }
    }

    fn value(&mut self, given: Given) -> Lit {
        *self.place(given)
    }

    fn holds(&self, aig: &mut Aig, condition: &Condition) -> Lit {
        aig.expression(condition, &mut |_, &seen| match seen {
            Seen::Machine(Atom::Input(i)) => self.inputs[i.index()],
            Seen::Machine(Atom::PrevInput(i)) => self.past_inputs[i.index()],
            Seen::Machine(Atom::Output(o)) => self.outputs[o.index()],
            Seen::Machine(Atom::PrevOutput(o)) => self.earlier[o.index()],
            Seen::Bit(b) => self.bits[b.index()],
            Seen::PrevBit(b) => self.past_bits[b.index()],
            Seen::Machine(_) | Seen::Mark(_) | Seen::Acted(_) | Seen::Broken(_) => {
                unreachable!("a plant knows nothing of the program")
            }
        })
    }

    /// One actuator: where it is ordered, and where it may be then.
    fn travel(&mut self, system: &mut System, machine: &Machine, travel: &Travel) {
        let actuator = &machine.actuators[travel.actuator];
        let driven = |p: usize| actuator.positions[p].output.map_or(Lit::FALSE, |o| self.outputs[o.index()]);
        let (first, second) = (driven(0), driven(1));
        let aig = &mut system.aig;
        let alone = [aig.and(first, !second), aig.and(second, !first)];
        let some = aig.or(first, second);
        let spring = travel.valve == Valve::Spring;
        let ordered = match travel.valve {
            Valve::WhileDriven => alone,
            Valve::Spring => [!some, some],
            Valve::Keeps => [0, 1].map(|p| {
                let latch = system.latches.len();
                let last = system
                    .latch(format!("{} was ordered to {}", actuator.name, actuator.positions[p].name), Some(false));
                let stays = system.aig.and(last, !alone[1 - p]);
                let order = system.aig.or(alone[p], stays);
                system.latches[latch].next = order;
                order
            }),
        };
        let power = self.holds(&mut system.aig, &travel.power);
        let aig = &mut system.aig;
        let out = aig.and(ordered[1], power);
        // A spring needs nothing to go back.
        let back = if spring { !out } else { aig.and(ordered[0], power) };
        let toward = [aig.and(back, self.started), aig.and(out, self.started)];
        let beginning =
            machine.plant.places.iter().rev().find(|(a, _)| *a == travel.actuator).map_or(0, |&(_, position)| position);
        let latches = system.latches.len();
        let at = [0, 1].map(|p| {
            system.latch(format!("{} is at {}", actuator.name, actuator.positions[p].name), Some(p == beginning))
        });
        let leaves = system.input(format!("{} gets away", actuator.name), Giver::Plant);
        let arrives = system.input(format!("{} arrives", actuator.name), Giver::Plant);
        let aig = &mut system.aig;
        let scans = [travel.back, travel.out];
        let mut then = [Lit::FALSE; 2];
        // Whether it arrives at a position in this scan, from the other one only if that takes one scan.
        let arrived = [0, 1].map(|p| {
            let near = if scans[p] > 1 { aig.and(arrives, !at[1 - p]) } else { arrives };
            aig.and(toward[p], near)
        });
        for p in [0, 1] {
            let gets_away = aig.or(leaves, arrived[1 - p]);
            let gone = aig.and(toward[1 - p], gets_away);
            let stays = aig.and(at[p], !gone);
            then[p] = aig.or(stays, arrived[p]);
        }
        for p in [0, 1] {
            system.latches[latches + p].next = then[p];
        }
        for p in [0, 1] {
            // An actuator that is ordered for ever arrives.
            let there = system.aig.or(!toward[p], then[p]);
            system.fairness(format!("{} to {}", actuator.name, actuator.positions[p].name), there);
        }
        for sensor in &travel.sensors {
            self.inputs[sensor.input.index()] = then[sensor.position].xor(!sensor.there);
        }
    }
}
