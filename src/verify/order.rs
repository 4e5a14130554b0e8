//! Leaves of a system to an order in which diagrams stay small.
//!
//! FORCE (Aloul, Markov, Sakallah, 2003): every gate pulls what it connects toward its centre of
//! gravity, round after round, until the wires get no shorter. It begins with the order of declaration,
//! in which a person has put things together already. All in whole numbers, so that every run ends alike.

use super::aig::Node;
use super::system::System;

/// Rounds after which it ends in any case.
const ROUNDS: usize = 60;

/// Positions are ranks times this, so that centres between two ranks can be told apart.
const SCALE: u64 = 1 << 16;

/// For each node of the graph that the latches' next values and `roots` depend on, its rank in the order; for all
/// others nothing.
pub fn force(system: &System, latches: &[usize], nodes: &[usize]) -> Vec<Option<u32>> {
    let aig = &system.aig;
    let mut wires: Vec<Vec<usize>> = Vec::new();
    for &n in nodes {
        if let Node::And(a, b) = aig.node(n) {
            wires.push(vec![n, a.node(), b.node()]);
        }
    }
    for &l in latches {
        let latch = system.latches[l];
        if latch.next.node() != 0 && latch.next.node() != latch.leaf.node() {
            wires.push(vec![latch.leaf.node(), latch.next.node()]);
        }
    }
    // Leaves as they were declared, gates in the middle of what they read.
    let mut place = vec![0u64; aig.len()];
    let mut count = 0;
    for &n in nodes {
        place[n] = match aig.node(n) {
            Node::False => 0,
            Node::Leaf(_) => {
                count += 1;
                count * SCALE
            }
            Node::And(a, b) => (place[a.node()] + place[b.node()]) / 2,
        };
    }
    let mut order: Vec<usize> = nodes.iter().copied().filter(|&n| n != 0).collect();
    rank(&mut order, &mut place);
    let mut best = (length(&wires, &place), order.clone());
    let mut idle = 0;
    for _ in 0..ROUNDS {
        let mut pull = vec![(0u64, 0u64); aig.len()];
        for wire in &wires {
            let centre = wire.iter().map(|&n| place[n]).sum::<u64>() / wire.len() as u64;
            for &n in wire {
                pull[n] = (pull[n].0 + centre, pull[n].1 + 1);
            }
        }
        for &n in &order {
            place[n] = pull[n].0.checked_div(pull[n].1).unwrap_or(place[n]);
        }
        rank(&mut order, &mut place);
        let length = length(&wires, &place);
        if length < best.0 {
            best = (length, order.clone());
            idle = 0;
        } else {
            idle += 1;
            if idle > 5 {
                break;
            }
        }
    }
    let mut ranks = vec![None; aig.len()];
    best.1.iter().enumerate().for_each(|(i, &n)| ranks[n] = Some(i as u32));
    ranks
}

/// Sorts by place, the old order where places are equal, and spreads the places evenly again.
fn rank(order: &mut [usize], place: &mut [u64]) {
    order.sort_by_key(|&n| place[n]);
    order.iter().enumerate().for_each(|(i, &n)| place[n] = (i as u64 + 1) * SCALE);
}

/// The length of all wires.
fn length(wires: &[Vec<usize>], place: &[u64]) -> u64 {
    let span = |wire: &Vec<usize>| {
        let places = wire.iter().map(|&n| place[n]);
        places.clone().max().unwrap_or(0) - places.min().unwrap_or(0)
    };
    wires.iter().map(span).sum()
}
