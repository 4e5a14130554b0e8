//! Every configuration that a chart can be in, and nothing else, as functions of free bits.
//!
//! In each region whose parent is active exactly one state is active, in each other none. Instead of
//! asking a solver to keep to that, the states are decoded from free bits: a region of n states is a
//! tree with n leaves, each fork of which is decided by one bit, below the literal of its parent. Every
//! assignment of the bits is a configuration, and every configuration is some assignment.
//!
//! An integer is decoded from free bits as well, so that it is within its range whatever they are.
//!
//! That the chart's own step never leaves these configurations and ranges is proved like everything else
//! ([`broken`], [`beyond`]).

use super::chart_step::{ChartState, ChartStep};
use super::parts::{SCAN_WIDTH, WIDTH};
use crate::bits::aig::{Aig, Lit};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{Integer, Machine, RegionId, StateId};
use crate::ir::number::Range;

/// A state of memory about which nothing is known but that its configuration is one, that no time has
/// passed in a state that has just been entered, and that the last state of a region is its active one,
/// or one or none of its states while it is not active.
pub fn any(aig: &mut Aig, machine: &Machine, chart: &ChartStep<'_>) -> ChartState {
    let active = active(aig, machine);
    let last = last(aig, machine, chart, &active);
    let (mut fresh, mut past) = (Vec::new(), Vec::new());
    for (s, ms) in chart.timers() {
        let path = machine.state_path(s);
        fresh.push(aig.leaf(format!("{path} is fresh")));
        let passed = aig.leaf(format!("{path} lasts {ms} ms"));
        past.push(aig.and(passed, !fresh[fresh.len() - 1]));
    }
    ChartState {
        active,
        fresh,
        past,
        last,
        variables: machine.variables.values().map(|v| aig.leaf(&v.name)).collect(),
        inputs: machine.inputs.values().map(|i| aig.leaf(format!("prev({})", i.name))).collect(),
        raised: machine.events.values().map(|e| aig.leaf(format!("raised({})", e.name))).collect(),
        outputs: machine.outputs.values().map(|o| aig.leaf(format!("prev({})", o.name))).collect(),
        marks: machine.safety.marks().map(|mark| aig.leaf(machine.mark(mark))).collect(),
        integers: machine.integers.values().map(|i| within(aig, i)).collect(),
        scans: (0..chart.scans())
            .map(|n| (0..SCAN_WIDTH).map(|bit| aig.leaf(format!("scan {n}#{bit}"))).collect())
            .collect(),
    }
}

/// For each state, whether it is active, in a configuration of which no more is known.
pub fn active(aig: &mut Aig, machine: &Machine) -> Vec<Lit> {
    let mut active = vec![Lit::FALSE; machine.states.len()];
    for (id, region) in machine.regions.iter() {
        let parent = region.parent.map_or(Lit::TRUE, |p| active[p.index()]);
        let path = machine.region_path(id);
        let mut bits = Vec::new();
        decode(aig, &region.states, parent, (0, &mut bits), &path, &mut active);
    }
    active
}

/// The last states of regions with a history.
fn last(aig: &mut Aig, machine: &Machine, chart: &ChartStep<'_>, active: &[Lit]) -> Vec<Option<Lit>> {
    let mut left = vec![Lit::FALSE; machine.states.len()];
    for (id, region) in machine.regions.iter() {
        let Some(parent) = region.parent.filter(|_| chart.remembers(region.initial)) else { continue };
        let path = format!("last in {}", machine.region_path(id));
        let known = aig.leaf(format!("{path} is one"));
        let under = aig.and(known, !active[parent.index()]);
        decode(aig, &region.states, under, (0, &mut Vec::new()), &path, &mut left);
    }
    let each = machine.states.ids().zip(active.iter().zip(left));
    each.map(|(s, (&now, left))| chart.remembers(s).then(|| aig.or(now, left))).collect()
}

fn decode(
    aig: &mut Aig,
    states: &[StateId],
    under: Lit,
    (depth, bits): (usize, &mut Vec<Lit>),
    path: &str,
    active: &mut [Lit],
) {
    if let [state] = states {
        active[state.index()] = under;
        return;
    }
    if depth == bits.len() {
        bits.push(aig.leaf(format!("{path}#{depth}")));
    }
    let (left, right) = states.split_at(states.len() / 2);
    let (no, yes) = (aig.and(under, !bits[depth]), aig.and(under, bits[depth]));
    decode(aig, left, no, (depth + 1, bits), path, active);
    decode(aig, right, yes, (depth + 1, bits), path, active);
}

/// Whether something is wrong with what `after` remembers of the region: two of its states were its
/// last one, or another than the active one was while the region is active.
pub fn confused(aig: &mut Aig, machine: &Machine, region: RegionId, after: &ChartState) -> Lit {
    let region = &machine.regions[region];
    let last: Vec<Lit> = region.states.iter().filter_map(|s| after.last[s.index()]).collect();
    let parent = region.parent.map_or(Lit::TRUE, |p| after.active[p.index()]);
    let differ: Vec<Lit> = region.states.iter().zip(&last).map(|(s, &l)| aig.xor(l, after.active[s.index()])).collect();
    let some = aig.any(&differ);
    let differs = aig.and(parent, some);
    let two = aig.two_or_more(&last);
    aig.or(differs, two)
}

/// An integer of which nothing is known but its range.
///
/// As many free bits as the range needs say how far the value is from the lowest one. What would be too far is
/// brought back by leaving the highest bit out: every value of the range is some assignment of the bits.
pub fn within(aig: &mut Aig, integer: &Integer) -> Vector {
    let Range { lowest, highest } = integer.range;
    let count = highest - lowest;
    let needed = 64 - count.leading_zeros();
    let mut distance: Vector = (0..needed).map(|bit| aig.leaf(format!("{}#{bit}", integer.name))).collect();
    distance.push(Lit::FALSE);
    let too_far = vector::less(aig, &vector::constant(count), &distance);
    if needed > 0 {
        let top = distance.len() - 2;
        distance[top] = aig.and(distance[top], !too_far);
    }
    let value = vector::add(aig, &distance, &vector::constant(lowest));
    vector::fit(&value, usize::from(WIDTH))
}

/// Whether the integer's value lies beyond its range.
pub fn beyond(aig: &mut Aig, integer: &Integer, value: &[Lit]) -> Lit {
    let Range { lowest, highest } = integer.range;
    let below = vector::less(aig, value, &vector::constant(lowest));
    let above = vector::less(aig, &vector::constant(highest), value);
    aig.or(below, above)
}

/// Whether something is wrong with the region in the configuration `active`: two of its states are
/// active, or one while its parent is not, or none while its parent is.
pub fn broken(aig: &mut Aig, machine: &Machine, region: RegionId, active: &[Lit]) -> Lit {
    let region = &machine.regions[region];
    let states: Vec<Lit> = region.states.iter().map(|s| active[s.index()]).collect();
    let parent = region.parent.map_or(Lit::TRUE, |p| active[p.index()]);
    let some = aig.any(&states);
    let differs = aig.xor(some, parent);
    let two = aig.two_or_more(&states);
    aig.or(differs, two)
}
