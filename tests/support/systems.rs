//! Small transition systems by chance, and what is true of them by going through all their states.

use super::rng::Rng;
use chartwright::verify::aig::{Lit, lanes};
use chartwright::verify::{Giver, Property, System};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// A system with up to 6 latches, 3 inputs and 40 gates, and claims of all kinds.
pub fn random(rng: &mut Rng) -> System {
    let mut system = System::default();
    let latches = rng.between(1, 6);
    let mut lits = vec![Lit::TRUE];
    for i in 0..latches {
        let initial = if rng.chance(85) { Some(rng.chance(30)) } else { None };
        let leaf = system.latch(format!("l{i}"), initial);
        lits.push(leaf);
    }
    for i in 0..rng.below(4) {
        let leaf = system.input(format!("i{i}"), *rng.pick(&[Giver::Operator, Giver::Plant]));
        lits.push(leaf);
    }
    for _ in 0..rng.between(3, 40) {
        let (a, b) = (rng.pick(&lits).xor(rng.chance(50)), rng.pick(&lits).xor(rng.chance(50)));
        let gate = if rng.chance(30) { system.aig.xor(a, b) } else { system.aig.and(a, b) };
        lits.push(gate);
    }
    // Late gates are the interesting ones.
    let late = |rng: &mut Rng, lits: &[Lit]| {
        let from = if rng.chance(70) { lits.len() / 2 } else { 0 };
        lits[rng.between(from, lits.len() - 1)].xor(rng.chance(50))
    };
    for i in 0..latches {
        system.latches[i].next = late(rng, &lits);
    }
    if rng.chance(40) {
        let (a, b) = (late(rng, &lits), late(rng, &lits));
        let constraint = system.aig.or(a, b);
        system.constraints.push(constraint);
    }
    for i in 0..3 {
        let (a, b) = (late(rng, &lits), late(rng, &lits));
        let bad = system.aig.and(a, b);
        system.claim(format!("never{i}"), Property::Never(bad));
    }
    let goal = late(rng, &lits);
    system.claim("possible", Property::AlwaysPossible(goal));
    system.claim("stuck", Property::NeverStuck);
    system
}

/// What is true of a claim: `Ok` if it holds, else how many scans the shortest run has that shows it does not.
pub type Truth = Result<(), usize>;

/// Every claim's truth and the number of reachable states, over all latches, by going through all of them.
pub fn truth(system: &System) -> (Vec<Truth>, usize) {
    let (latches, inputs) = (system.latches.len(), system.inputs.len());
    let bits = |n: usize, count: usize| -> Vec<bool> { (0..count).map(|i| n >> i & 1 == 1).collect() };
    // For each state: its successors, and for each claim whether its literal is possible.
    let mut scans: Vec<(BTreeSet<usize>, Vec<bool>)> = Vec::new();
    for state in 0..1 << latches {
        let (mut after, mut possible) = (BTreeSet::new(), vec![false; system.claims.len()]);
        for given in 0..1 << inputs {
            let values = system.evaluate(&bits(state, latches), &bits(given, inputs));
            let value = |l: Lit| lanes(&values, l) & 1 == 1;
            if system.constraints.iter().all(|&c| value(c)) {
                let next = system.latches.iter().enumerate().map(|(i, l)| usize::from(value(l.next)) << i).sum();
                after.insert(next);
                for (claim, possible) in system.claims.iter().zip(&mut possible) {
                    *possible |= match claim.property {
                        Property::Never(l) | Property::AlwaysPossible(l) => value(l),
                        Property::NeverStuck => true,
                    };
                }
            }
        }
        scans.push((after, possible));
    }
    let starts = |state: &usize| {
        system.latches.iter().enumerate().all(|(i, l)| l.initial.is_none_or(|v| v == (state >> i & 1 == 1)))
    };
    let mut depth: BTreeMap<usize, usize> = (0..1 << latches).filter(starts).map(|s| (s, 0)).collect();
    let mut open: VecDeque<usize> = depth.keys().copied().collect();
    while let Some(state) = open.pop_front() {
        for &next in &scans[state].0 {
            if !depth.contains_key(&next) {
                depth.insert(next, depth[&state] + 1);
                open.push_back(next);
            }
        }
    }
    let verdicts = system.claims.iter().enumerate().map(|(c, claim)| {
        let wrong: BTreeSet<usize> = match claim.property {
            Property::Never(_) => depth.keys().copied().filter(|&s| scans[s].1[c]).collect(),
            Property::NeverStuck => depth.keys().copied().filter(|&s| !scans[s].1[c]).collect(),
            Property::AlwaysPossible(_) => {
                let mut saved: BTreeSet<usize> = depth.keys().copied().filter(|&s| scans[s].1[c]).collect();
                loop {
                    let more = depth.keys().filter(|s| scans[**s].0.iter().any(|n| saved.contains(n)));
                    let before = saved.len();
                    saved = more.copied().chain(saved.iter().copied()).collect();
                    if saved.len() == before {
                        break;
                    }
                }
                depth.keys().copied().filter(|s| !saved.contains(s)).collect()
            }
        };
        let scans = usize::from(matches!(claim.property, Property::Never(_)));
        wrong.iter().map(|s| depth[s] + scans).min().map_or(Ok(()), Err)
    });
    (verdicts.collect(), depth.len())
}
