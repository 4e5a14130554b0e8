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

/// The same with one to three claims of what comes eventually, and up to three conditions that make a run fair.
pub fn random_fair(rng: &mut Rng) -> System {
    let mut system = random(rng);
    system.claims.clear();
    let mut lits: Vec<Lit> =
        system.latches.iter().map(|l| l.next).chain(system.inputs.iter().map(|i| i.leaf)).collect();
    lits.extend(system.latches.iter().map(|l| l.leaf));
    for _ in 0..6 {
        let (a, b) = (rng.pick(&lits).xor(rng.chance(50)), rng.pick(&lits).xor(rng.chance(50)));
        lits.push(system.aig.and(a, b));
    }
    let some = |rng: &mut Rng| rng.pick(&lits).xor(rng.chance(50));
    for i in 0..rng.below(4) {
        let holds = some(rng);
        system.fairness(format!("f{i}"), holds);
    }
    for i in 0..rng.between(1, 3) {
        let after = if rng.chance(20) { Lit::TRUE } else { some(rng) };
        let then = if rng.chance(10) { Lit::FALSE } else { some(rng) };
        system.claim(format!("eventually{i}"), Property::Eventually { after, then });
    }
    system
}

/// Whether `then` comes `after` in all fair runs, by going through all states together with whether an answer is
/// open: a set of them that can all reach each other while it stays open, and with all fairness among the scans
/// between them, shows that it does not.
pub fn comes(system: &System, after: Lit, then: Lit) -> bool {
    let (latches, inputs) = (system.latches.len(), system.inputs.len());
    let bits = |n: usize, count: usize| -> Vec<bool> { (0..count).map(|i| n >> i & 1 == 1).collect() };
    // For each state and whether an answer is open: where scans lead, and the fairness that comes in them.
    let mut scans: Vec<Vec<(usize, u32)>> = vec![Vec::new(); 2 << latches];
    for (from, scans) in scans.iter_mut().enumerate() {
        let (state, open) = (from >> 1, from & 1 == 1);
        for given in 0..1 << inputs {
            let values = system.evaluate(&bits(state, latches), &bits(given, inputs));
            let value = |l: Lit| lanes(&values, l) & 1 == 1;
            if system.constraints.iter().all(|&c| value(c)) {
                let next: usize = system.latches.iter().enumerate().map(|(i, l)| usize::from(value(l.next)) << i).sum();
                let open = (open || value(after)) && !value(then);
                let fair = system.fair.iter().enumerate().map(|(i, f)| u32::from(value(f.holds)) << i).sum();
                scans.push((next << 1 | usize::from(open), fair));
            }
        }
    }
    let reach = |from: Vec<usize>, inside: &dyn Fn(usize) -> bool| -> BTreeSet<usize> {
        let (mut seen, mut todo): (BTreeSet<usize>, Vec<usize>) = (BTreeSet::new(), from);
        while let Some(at) = todo.pop() {
            for &(next, _) in scans[at].iter().filter(|(next, _)| inside(*next)) {
                if seen.insert(next) {
                    todo.push(next);
                }
            }
        }
        seen
    };
    let starts = |from: &usize| {
        let fits =
            |(i, l): (usize, &chartwright::verify::Latch)| l.initial.is_none_or(|v| v == (from >> 1 >> i & 1 == 1));
        from & 1 == 0 && system.latches.iter().enumerate().all(fits)
    };
    let first: Vec<usize> = (0..2 << latches).filter(starts).collect();
    let reached: BTreeSet<usize> = reach(first.clone(), &|_| true).into_iter().chain(first).collect();
    let all = (1u32 << system.fair.len()) - 1;
    let open: Vec<usize> = reached.into_iter().filter(|at| at & 1 == 1).collect();
    let ways: BTreeMap<usize, BTreeSet<usize>> =
        open.iter().map(|&at| (at, reach(vec![at], &|next| next & 1 == 1))).collect();
    !open.iter().any(|at| {
        // Those that it reaches and that reach it.
        let circle: BTreeSet<usize> = ways[at].iter().copied().filter(|to| ways[to].contains(at)).collect();
        let scans = circle.iter().flat_map(|from| scans[*from].iter().filter(|(next, _)| circle.contains(next)));
        let fair = scans.fold(None, |fair: Option<u32>, &(_, f)| Some(fair.unwrap_or(0) | f));
        fair == Some(all)
    })
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
                        Property::Eventually { .. } => unreachable!("`comes` knows these"),
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
            Property::Eventually { .. } => unreachable!("`comes` knows these"),
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
