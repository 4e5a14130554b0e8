//! A plant that goes by steps: whose turn it is.
//!
//! What one transition of the system is: something happens in the plant, or the inputs are read and the program
//! runs, or the outputs on which it has decided are written. Reading and writing take turns; what happens is
//! anywhere between them, any number of times. So until outputs are written the plant goes on under the old ones.
//!
//! An actuator that travels is one of those to whom something happens: it gets away from a position, or arrives. Where times are exact it
//! travels from reading to reading, as long as it takes; all else takes no time.
//!
//! What has no meaning at a moment, such as outputs that wait to be written when none do, is FALSE then, so that one state of the machine
//! is one state of the system.

use super::super::aig::{Aig, Lit};
use super::super::system::{Alternative, Giver, System};
use super::clocks::{Clock, Clocks};
use super::plant::{Moving, Terminals, width};
use super::program::map;
use crate::bits::vector::{self, Vector};
use crate::ir::chart::Machine;
use crate::ir::number::Range as Bounds;
use crate::ir::scenario::{Alteration, CountId, Given, Happening, Travel, Valve};
use crate::prove::chart_numbers::number_of;
use crate::prove::chart_step::{ChartScan, ChartState};
use std::ops::Range;

/// Whose turn it is in a transition of the system.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Inputs are read and the program runs. Without steps, that is all that there is.
    pub reading: Lit,
    /// Outputs are written.
    pub writing: Lit,
    /// For each output, whether it waits to be written as TRUE.
    pub waiting: Vec<Lit>,
    /// What happens otherwise, each with words for it.
    pub moves: Vec<(Lit, String)>,
    /// Whether outputs wait to be written.
    waits: Lit,
    /// The first of the latches that keep those outputs.
    first_waiting: usize,
}

impl Turn {
    /// Each transition is a scan.
    pub fn always() -> Turn {
        let (waiting, moves) = (Vec::new(), Vec::new());
        Turn { reading: Lit::TRUE, writing: Lit::FALSE, waiting, moves, waits: Lit::FALSE, first_waiting: 0 }
    }

    /// The latches that keep what waits to be written, and whether it does.
    pub fn latches(&self) -> Range<usize> {
        if self.reading == Lit::TRUE { 0..0 } else { self.first_waiting - 1..self.first_waiting + self.waiting.len() }
    }

    /// The scan, if it is the program's turn; else nothing happens to what it remembers in the latches of `memory`, except
    /// that outputs on which it has decided are written: `before` has those at the terminals. Returns what is seen of it.
    pub fn scan(&self, system: &mut System, memory: Range<usize>, before: &ChartState, scan: ChartScan) -> ChartScan {
        let nexts = scan.after.bits();
        if self.reading == Lit::TRUE {
            for (latch, next) in memory.zip(nexts) {
                system.latches[latch].next = next;
            }
            return scan;
        }
        let mut kept = Vec::new();
        for ((latch, next), was) in memory.clone().zip(nexts).zip(before.bits()) {
            let next = system.aig.select(self.reading, next, was);
            system.latches[latch].next = next;
            kept.push(next);
        }
        let mut kept = kept.into_iter();
        let mut after = map(&scan.after, &mut |_| kept.next().expect("both remember the same"));
        for (i, &terminal) in before.outputs.iter().enumerate() {
            let decided = scan.after.outputs[i];
            let latch = memory.clone().find(|&l| system.latches[l].leaf == terminal).expect("it is remembered");
            let aig = &mut system.aig;
            let stays = aig.and(self.waiting[i], !self.writing);
            let waits = aig.select(self.reading, decided, stays);
            let then = aig.select(self.writing, self.waiting[i], terminal);
            let last = aig.select(self.waits, self.waiting[i], terminal);
            after.outputs[i] = aig.select(self.reading, decided, last);
            system.latches[latch].next = then;
            system.latches[self.first_waiting + i].next = waits;
        }
        let aig = &mut system.aig;
        let mut now = |lits: &[Lit]| -> Vec<Lit> { lits.iter().map(|&l| aig.and(l, self.reading)).collect() };
        ChartScan {
            after,
            events: now(&scan.events),
            fires: now(&scan.fires),
            enabled: now(&scan.enabled),
            commands: now(&scan.commands),
            acted: now(&scan.acted),
            broken: now(&scan.broken),
            beyond: now(&scan.beyond),
            ..scan
        }
    }
}

/// Something that may happen, and what comes of it.
struct Move {
    words: String,
    may: Lit,
    outcomes: Vec<(Lit, Then)>,
}

/// What changes when something happens.
enum Then {
    Bit(usize, Lit),
    Count(usize, Vector),
    /// A latch of an actuator.
    Latch(usize, Lit),
}

/// Lets happen what may. `memory` says which latch keeps what of inputs and hidden bits.
pub fn live(system: &mut System, clocks: &mut Clocks, mut plant: Moving<'_>, memory: &[(usize, Given)]) -> Terminals {
    let machine = plant.machine;
    // Bits in the scan before: as they were when inputs were read last.
    let first_past = system.latches.len();
    let names = machine.plant.bits.values().map(|b| format!("prev({})", b.name));
    let past: Vec<Lit> = names.map(|name| system.latch(name, Some(false))).collect();
    plant.past_bits = past.clone();

    let waits_latch = system.latches.len();
    let waits = system.latch("outputs wait to be written", Some(false));
    let first_waiting = system.latches.len();
    let waiting: Vec<Lit> =
        machine.outputs.values().map(|o| system.latch(format!("{} waits", o.name), Some(false))).collect();

    let mut moves: Vec<Move> = machine.plant.happenings.iter().map(|h| happening(system, &plant, h)).collect();
    // For each travel, where it is, with the latch; what its valve was ordered, with the latch.
    let mut places = Vec::new();
    let mut valves = Vec::new();
    let mut ways = Vec::new();
    let mut going_on = Vec::new();
    for travel in &machine.plant.travels {
        let ordered = match travel.valve {
            Valve::WhileDriven => plant.driven(&mut system.aig, travel.actuator, &plant.outputs).0,
            Valve::Spring => {
                let some = plant.driven(&mut system.aig, travel.actuator, &plant.outputs).1;
                [!some, some]
            }
            Valve::Keeps => {
                let latches = system.latches.len();
                let last = plant.order(system, travel.actuator);
                valves.push((latches, last, travel.actuator));
                last
            }
        };
        if !travel.at_most && clocks.counted.has(Clock::Travel(travel.actuator)) {
            let toward = plant.toward(&mut system.aig, travel, ordered);
            going_on.push((travel, toward.map(|t| system.aig.and(t, plant.started))));
            continue;
        }
        let latches = system.latches.len();
        let at = plant.at(system, travel.actuator);
        (0..2).for_each(|p| system.latches[latches + p].next = at[p]);
        places.push((travel, at));
        let toward = plant.toward(&mut system.aig, travel, ordered);
        // Outputs may be written late in a scan: so it may take a reading more.
        for (p, way) in plant.ways(system, clocks, travel, 1).into_iter().flatten().enumerate() {
            ways.push((way, system.aig.and(toward[p], !at[p])));
        }
        moves.extend([0, 1].map(|p| going(system, machine, travel, p, toward[p], at, latches)));
        for p in [0, 1] {
            // An actuator that is ordered for ever arrives. Of a step that a model writes nothing is owed.
            let there = system.aig.or(!toward[p], at[p]);
            let actuator = &machine.actuators[travel.actuator];
            system.fairness(format!("{} to {}", actuator.name, actuator.positions[p].name), there);
        }
    }

    let (happens, none) = choose(system, &moves);
    let program = !system.aig.any(&happens);
    let aig = &mut system.aig;
    let (reading, writing) = (aig.and(program, !waits), aig.and(program, waits));
    for (is, when) in [(reading, !waits), (writing, waits)] {
        system.alternatives.push(Alternative { is, when, choice: none.clone() });
    }
    // Nothing is read before it has arrived where it must be by then.
    for (way, is_on) in ways {
        way.go_on(system, clocks, is_on, reading);
        let over = way.is_over(&mut system.aig);
        let late = system.aig.all(&[reading, is_on, over]);
        system.constraints.push(!late);
    }
    // The program runs again and again, whatever happens meanwhile.
    system.fairness("inputs are read", reading);
    let stays = system.aig.and(waits, !writing);
    system.latches[waits_latch].next = system.aig.or(reading, stays);

    // What happens, and what valves do when outputs are written.
    let (bits, counts) = (plant.bits.clone(), plant.counts.clone());
    for (happens, step) in happens.iter().zip(&moves) {
        for (condition, then) in &step.outcomes {
            let changes = system.aig.and(*happens, *condition);
            match then {
                Then::Bit(bit, value) => plant.bits[*bit] = system.aig.select(changes, *value, plant.bits[*bit]),
                Then::Count(count, value) => {
                    let then = &mut plant.counts[*count];
                    *then = vector::select(&mut system.aig, changes, value, then);
                }
                Then::Latch(latch, value) => {
                    let next = system.latches[*latch].next;
                    system.latches[*latch].next = system.aig.select(changes, *value, next);
                }
            }
        }
    }
    let terminals = std::mem::replace(&mut plant.outputs, waiting.clone());
    for rule in machine.plant.rules.iter().filter(|r| r.is_of_valve()) {
        let again = std::mem::replace(&mut plant.outputs, terminals.clone());
        let holds = plant.holds(&mut system.aig, &rule.condition);
        let bit = plant.value(rule.target);
        let stays = system.aig.and(holds, bit.xor(rule.value));
        clocks.settled.push(!stays);
        plant.outputs = again;
        let holds = plant.holds(&mut system.aig, &rule.condition);
        let fires = system.aig.and(writing, holds);
        let now = plant.value(rule.target);
        *plant.place(rule.target) = system.aig.select(fires, Lit::of(rule.value), now);
    }
    for (latches, last, actuator) in valves {
        let (alone, _) = plant.driven(&mut system.aig, actuator, &waiting);
        let (again, _) = plant.driven(&mut system.aig, actuator, &terminals);
        for p in [0, 1] {
            let changes = system.aig.and(again[p], !last[p]);
            clocks.settled.push(!changes);
        }
        for p in [0, 1] {
            let stays = system.aig.and(last[p], !alone[1 - p]);
            let order = system.aig.or(alone[p], stays);
            system.latches[latches + p].next = system.aig.select(writing, order, last[p]);
        }
    }
    let after = std::mem::replace(&mut plant.bits, bits);
    let counted = std::mem::replace(&mut plant.counts, counts);
    plant.outputs = terminals;

    // The reading, at which nothing else happens.
    let kept = plant.inputs.clone();
    for (travel, at) in places {
        plant.sense(travel, at);
    }
    for (travel, toward) in going_on {
        let at = plant.go(system, clocks, travel, toward, reading);
        plant.sense(travel, at);
    }
    let mut follows = None;
    for (i, rule) in machine.plant.rules.iter().enumerate().filter(|(_, r)| !r.is_of_valve()) {
        let condition = plant.holds(&mut system.aig, &rule.condition);
        plant.rule(system, clocks, i, rule, reading);
        // What follows a condition is that condition, and nothing that is remembered.
        if rule.delay == 0 && !rule.value && follows == Some((rule.target, !condition)) {
            *plant.place(rule.target) = !condition;
        }
        follows = (rule.delay == 0 && rule.value).then_some((rule.target, condition));
    }
    for (i, (&was, &earlier)) in plant.outputs.iter().zip(&plant.earlier).enumerate() {
        system.latches[plant.first_earlier + i].next = system.aig.select(reading, was, earlier);
    }
    for (i, &was) in past.iter().enumerate() {
        system.latches[first_past + i].next = system.aig.select(reading, plant.bits[i], was);
    }
    let bits: Vec<Lit> =
        plant.bits.iter().zip(&after).map(|(&read, &then)| system.aig.select(reading, read, then)).collect();
    for &(latch, given) in memory {
        system.latches[latch].next = match given {
            Given::Input(i) => system.aig.select(reading, plant.inputs[i.index()], kept[i.index()]),
            Given::Bit(b) => bits[b.index()],
        };
    }
    for ((count, value), &first) in machine.plant.counts.values().zip(&counted).zip(&plant.count_latches) {
        let above = vector::subtract(&mut system.aig, value, &vector::constant(count.range.lowest));
        for (i, &bit) in vector::fit(&above, width(count)).iter().enumerate() {
            system.latches[first + i].next = bit;
        }
    }
    let words = moves.into_iter().map(|m| m.words);
    let turn =
        Turn { reading, writing, waiting, moves: happens.into_iter().zip(words).collect(), waits, first_waiting };
    Terminals { inputs: plant.inputs, bits, past_bits: plant.past_bits, counts: counted, turn }
}

/// What a model says that may happen.
fn happening(system: &mut System, plant: &Moving<'_>, happening: &Happening) -> Move {
    let aig = &mut system.aig;
    let may = plant.holds(aig, &happening.condition);
    let outcomes = happening.outcomes.iter().map(|outcome| {
        let then = match &outcome.change {
            Alteration::Bit(bit, value) => Then::Bit(bit.index(), Lit::of(*value)),
            Alteration::Count(id, value) => {
                let Bounds { lowest, highest } = plant.machine.plant.counts[*id].range;
                let value = number_of(aig, value, &|c: &CountId| plant.counts[c.index()].clone());
                Then::Count(id.index(), within(aig, &value, lowest, highest))
            }
        };
        (plant.holds(aig, &outcome.condition), then)
    });
    let outcomes = outcomes.collect();
    Move { words: happening.text.clone(), may, outcomes }
}

/// The value, or the bound beyond which it lies.
fn within(aig: &mut Aig, value: &[Lit], lowest: i64, highest: i64) -> Vector {
    let (lowest, highest) = (vector::constant(lowest), vector::constant(highest));
    let (low, high) = (vector::less(aig, value, &lowest), vector::less(aig, &highest, value));
    let kept = vector::select(aig, low, &lowest, value);
    vector::select(aig, high, &highest, &kept)
}

/// An actuator's next step toward a position: from the other one to between them if that takes time, else there.
fn going(
    system: &mut System,
    machine: &Machine,
    travel: &Travel,
    position: usize,
    toward: Lit,
    at: [Lit; 2],
    latches: usize,
) -> Move {
    let actuator = &machine.actuators[travel.actuator];
    let takes_time = [travel.back, travel.out][position] > 1;
    let away = at[1 - position];
    let arrives = if takes_time { !away } else { Lit::TRUE };
    Move {
        words: format!("{} goes to {}", actuator.name, actuator.positions[position].name),
        may: system.aig.and(toward, !at[position]),
        outcomes: vec![
            (Lit::TRUE, Then::Latch(latches + position, arrives)),
            (Lit::TRUE, Then::Latch(latches + 1 - position, Lit::FALSE)),
        ],
    }
}

/// For each move, whether it happens: at most one does, and only if it may. Who chooses is the plant; the choice of a move that
/// cannot be made, or of none, is the program's turn; the values for none come back as well.
fn choose(system: &mut System, moves: &[Move]) -> (Vec<Lit>, Vec<(Lit, bool)>) {
    let bits = usize::BITS - moves.len().leading_zeros();
    let choice: Vec<Lit> = (0..bits).map(|i| system.input(format!("choice {i}"), Giver::Plant)).collect();
    let values = |number: usize| -> Vec<(Lit, bool)> {
        choice.iter().enumerate().map(|(i, &bit)| (bit, number >> i & 1 == 1)).collect()
    };
    let mut happens = Vec::new();
    for (number, step) in (1..).zip(moves) {
        let choice = values(number);
        let chosen: Vec<Lit> = choice.iter().map(|&(bit, value)| bit.xor(!value)).collect();
        let chosen = system.aig.all(&chosen);
        let is = system.aig.and(chosen, step.may);
        system.alternatives.push(Alternative { is, when: step.may, choice });
        happens.push(is);
    }
    (happens, values(0))
}
