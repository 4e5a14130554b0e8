//! Parts of a relation to the order in which a set meets them.

use super::super::bdd::{Bdd, Edge, Var};
use super::super::limits::Limit;
use std::collections::{HashMap, HashSet};

/// Parts are put together up to this many nodes.
const CLUSTER: usize = 2_000;

/// In which order a set meets the parts, and what is quantified with each.
pub struct Schedule {
    /// What no part reads, quantified before all.
    pub before: Edge,
    pub parts: Vec<(Edge, Edge)>,
}

impl Schedule {
    /// Greedy: next comes the part after which most can be quantified, and that brings in the least.
    pub fn new(bdd: &mut Bdd<'_>, parts: &[Edge], quantify: &[Var]) -> Result<Schedule, Limit> {
        let quantify: HashSet<Var> = quantify.iter().copied().collect();
        let support: Vec<Vec<Var>> = parts.iter().map(|&p| bdd.support(p)).collect();
        let mut readers = vec![0usize; bdd.variables() as usize];
        support.iter().flatten().for_each(|&v| readers[v as usize] += 1);
        let mut unread: Vec<Var> = quantify.iter().copied().filter(|&v| readers[v as usize] == 0).collect();
        unread.sort_unstable();
        let before = bdd.cube(&unread)?;
        let mut seen: HashSet<Var> = HashSet::new();
        let mut left: Vec<usize> = (0..parts.len()).collect();
        let mut schedule = Schedule { before, parts: Vec::new() };
        while !left.is_empty() {
            let cost = |&p: &usize| -> (i64, usize) {
                let ends = |v: &&Var| quantify.contains(v) && readers[**v as usize] == 1;
                let fresh = |v: &&Var| !quantify.contains(v) && !seen.contains(v);
                let ends = support[p].iter().filter(ends).count() as i64;
                let fresh = support[p].iter().filter(fresh).count() as i64;
                let open = support[p].iter().filter(|v| quantify.contains(v) && !seen.contains(v)).count() as i64;
                (fresh * 2 + open - ends * 3, p)
            };
            let next = *left.iter().min_by_key(|p| cost(p)).expect("there is one left");
            left.retain(|&p| p != next);
            support[next].iter().for_each(|&v| readers[v as usize] -= 1);
            seen.extend(&support[next]);
            let ended: Vec<Var> =
                support[next].iter().copied().filter(|&v| quantify.contains(&v) && readers[v as usize] == 0).collect();
            let cube = bdd.cube(&ended)?;
            schedule.parts.push((parts[next], cube));
        }
        Ok(schedule)
    }

    /// What is left of `set` when it has met all parts. Makes room where it has to; `keep` stays.
    pub fn meet(&self, bdd: &mut Bdd<'_>, set: Edge, keep: &[Edge]) -> Result<Edge, Limit> {
        let mut set = bdd.exists(set, self.before)?;
        for &(part, cube) in &self.parts {
            set = match bdd.and_exists(set, part, cube) {
                Err(Limit::Nodes) if !keep.is_empty() => {
                    bdd.collect(keep.iter().copied().chain([set]));
                    bdd.and_exists(set, part, cube)?
                }
                other => other?,
            };
        }
        Ok(set)
    }
}

/// The parts, and the definitions of what they read.
pub fn with_definitions(bdd: &Bdd<'_>, mut parts: Vec<Edge>, definitions: &[(Var, Edge)]) -> Vec<Edge> {
    let mut open: HashMap<Var, Edge> = definitions.iter().copied().collect();
    let mut at = 0;
    while at < parts.len() {
        for var in bdd.support(parts[at]) {
            parts.extend(open.remove(&var));
        }
        at += 1;
    }
    parts
}

/// Puts neighbouring parts together while they stay small.
pub fn cluster(bdd: &mut Bdd<'_>, mut parts: Vec<Edge>) -> Result<Vec<Edge>, Limit> {
    parts.retain(|&p| p != Edge::TRUE);
    // Parts that begin at similar levels share variables.
    let mut keyed: Vec<(u32, usize, Edge)> = Vec::new();
    for (i, &part) in parts.iter().enumerate() {
        let lowest = bdd.support(part).iter().map(|&v| bdd.level(v)).max().unwrap_or(0);
        keyed.push((lowest, i, part));
    }
    keyed.sort_unstable();
    let mut clusters: Vec<Edge> = Vec::new();
    for (_, _, part) in keyed {
        if let Some(last) = clusters.last_mut()
            && bdd.size(*last, CLUSTER) + bdd.size(part, CLUSTER) < CLUSTER
        {
            let both = bdd.and(*last, part)?;
            if bdd.size(both, CLUSTER) < CLUSTER {
                *last = both;
                continue;
            }
        }
        clusters.push(part);
    }
    Ok(clusters)
}
