//! A system to text that other tools read, and what they found back.
//!
//! Latches, inputs and claims keep their order and their names, so what another tool says about the third
//! bad of a file is said about the third claim of that kind.

pub mod aiger;
pub mod btor2;
pub mod smv;
pub mod witness;

use super::aig::{Lit, Node};
use super::liveness::monitor;
use super::system::{Property, System};
use std::collections::BTreeMap;

/// A system's claims that something never is, each with its name.
fn bads(system: &System) -> Vec<(&str, Lit)> {
    let bads =
        system.claims.iter().map(|c| if let Property::Never(bad) = c.property { Some((&*c.name, bad)) } else { None });
    bads.flatten().collect()
}

/// A system in which a run says itself from where on an answer does not come: AIGER and BTOR2 know only what
/// comes again and again.
struct Told {
    /// The system, with an input and latches more for each claim that something comes eventually.
    system: System,
    /// For each of these claims, in order, its name and what comes again and again in a fair run that refutes it.
    justice: Vec<(String, Lit)>,
}

impl Told {
    fn new(system: &System) -> Told {
        let mut told = Told { system: system.clone(), justice: Vec::new() };
        for claim in &system.claims {
            if let Property::Eventually { after, then } = claim.property {
                let recurs = monitor::doom(&mut told.system, &claim.name, after, then);
                told.justice.push((claim.name.clone(), recurs));
            }
        }
        told
    }

    /// What makes a run fair, where that matters.
    fn fair(&self) -> &[super::Fairness] {
        if self.justice.is_empty() { &[] } else { &self.system.fair }
    }
}

/// The gates on which anything depends, `also` included, in topological order.
fn gates(system: &System, also: &[(String, Lit)]) -> Vec<(usize, Lit, Lit)> {
    let mut roots = system.constraints.clone();
    roots.extend(also.iter().map(|(_, l)| *l));
    roots.extend(system.latches.iter().map(|l| l.next));
    roots.extend(system.fair.iter().map(|f| f.holds));
    roots.extend(system.claims.iter().flat_map(|c| match c.property {
        Property::Never(l) | Property::AlwaysPossible(l) => vec![l],
        Property::Eventually { after, then } => vec![after, then],
        Property::NeverStuck => Vec::new(),
    }));
    let cone = system.aig.cone(&roots);
    let gate = |n: usize| if let Node::And(a, b) = system.aig.node(n) { Some((n, a, b)) } else { None };
    cone.into_iter().filter_map(gate).collect()
}

/// The names of inputs and then of latches, each on one line; a repeated one is numbered, since readers
/// want to tell them apart.
fn symbols(system: &System) -> Vec<String> {
    let leaves = system.inputs.iter().map(|i| i.leaf).chain(system.latches.iter().map(|l| l.leaf));
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    let mut symbols = Vec::new();
    for leaf in leaves {
        let name = line(system.name(leaf));
        let number = count.entry(name.clone()).or_default();
        *number += 1;
        symbols.push(if *number == 1 { name } else { format!("{name} #{number}") });
    }
    symbols
}

/// A name on one line.
fn line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
