//! A system to text that other tools read, and what they found back.
//!
//! Latches, inputs and claims keep their order and their names, so what another tool says about the third
//! bad of a file is said about the third claim of that kind.

pub mod aiger;
pub mod btor2;
mod plain;
pub mod smv;
pub mod witness;

use super::aig::{Lit, Node};
use super::liveness::monitor;
use super::system::{Property, System};
use std::collections::BTreeSet;

/// A system's claims that something never is, each with its index.
fn bads(system: &System) -> Vec<(usize, Lit)> {
    let bads = system.claims.iter().enumerate();
    bads.filter_map(|(i, c)| if let Property::Never(bad) = c.property { Some((i, bad)) } else { None }).collect()
}

/// A system in which a run says itself from where on an answer does not come: AIGER and BTOR2 know only what
/// comes again and again.
struct Told {
    /// The system, with an input and latches more for each claim that something comes eventually.
    system: System,
    /// For each of these claims, in order, its index and what comes again and again in a fair run that refutes it.
    justice: Vec<(usize, Lit)>,
}

impl Told {
    fn new(system: &System) -> Told {
        let mut told = Told { system: system.clone(), justice: Vec::new() };
        for (i, claim) in system.claims.iter().enumerate() {
            if let Property::Eventually { after, then } = claim.property {
                let recurs = monitor::doom(&mut told.system, &claim.name, after, then);
                told.justice.push((i, recurs));
            }
        }
        told
    }

    /// Nothing is added: what comes eventually is left out.
    fn without_justice(system: System) -> Told {
        Told { system, justice: Vec::new() }
    }

    /// What makes a run fair, where that matters.
    fn fair(&self) -> &[super::Fairness] {
        if self.justice.is_empty() { &[] } else { &self.system.fair }
    }
}

/// The gates on which anything depends, `also` included, in topological order.
fn gates(system: &System, also: &[(usize, Lit)]) -> Vec<(usize, Lit, Lit)> {
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

/// The names that a system has in a file.
struct Names {
    inputs: Vec<String>,
    latches: Vec<String>,
    /// Of all claims, whatever they say.
    claims: Vec<String>,
    fair: Vec<String>,
}

impl Names {
    /// No two are the same, whatever they name, none has white space in it, and all are ASCII: readers take each
    /// for the name of a wire, or end it at a blank.
    fn new(system: &System) -> Names {
        let mut taken = BTreeSet::new();
        let mut distinct = |name: &str| {
            let plain = symbol(name);
            let more = (2..).map(|n| format!("{plain}_{n}"));
            let mut all = std::iter::once(plain.clone()).chain(more);
            let free = all.find(|name| !taken.contains(name)).expect("numbers never run out");
            taken.insert(free.clone());
            free
        };
        // Claims come first: they are called the same in all forms, and asked for by name.
        let claims = system.claims.iter().map(|c| distinct(&c.name)).collect();
        let fair = system.fair.iter().map(|f| distinct(&f.name)).collect();
        let inputs = system.inputs.iter().map(|i| distinct(system.name(i.leaf))).collect();
        let latches = system.latches.iter().map(|l| distinct(system.name(l.leaf))).collect();
        Names { inputs, latches, claims, fair }
    }
}

/// The index of the claim that is called so, in the system or in a file.
pub fn claim_named(system: &System, name: &str) -> Option<usize> {
    let written = || Names::new(system).claims.iter().position(|c| c == name);
    system.claims.iter().position(|c| c.name == name).or_else(written)
}

/// A name as one word of ASCII that begins no comment.
fn symbol(name: &str) -> String {
    let legal = |c: char| c.is_ascii_graphic() && c != ';';
    name.chars().map(|c| if legal(c) { c } else { '_' }).collect()
}

/// A name on one line.
fn line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
