//! SMV, as NuSMV and nuXmv read it: the one form that can say what is always possible. What comes eventually is
//! said with what makes a run fair, so that no other claim is about fair runs only.
//!
//! Inputs are variables as well, so that a claim can speak of them; SMV asks that no run ends, which
//! [`Property::NeverStuck`] says of a system.

use super::super::aig::{Lit, Node};
use super::super::order;
use super::super::system::{Property, System};
use super::{gates, line};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Words for leaves, by node.
fn words(system: &System) -> Vec<String> {
    let mut words = vec![String::new(); system.aig.len()];
    let mut taken = BTreeSet::new();
    let inputs = system.inputs.iter().map(|i| ("i", i.leaf));
    for (kind, leaf) in inputs.chain(system.latches.iter().map(|l| ("m", l.leaf))) {
        let name: String = system.name(leaf).chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let base = format!("{kind}_{name}");
        let mut word = base.clone();
        let mut number = 2;
        while !taken.insert(word.clone()) {
            word = format!("{base}_{number}");
            number += 1;
        }
        words[leaf.node()] = word;
    }
    words
}

/// A module `main`.
pub fn write(system: &System) -> String {
    let words = words(system);
    let lit = |l: Lit| {
        let word = match system.aig.node(l.node()) {
            Node::False => return if l.is_negated() { "TRUE" } else { "FALSE" }.to_owned(),
            Node::Leaf(_) => words[l.node()].clone(),
            Node::And(..) => format!("g{}", l.node()),
        };
        if l.is_negated() { format!("!{word}") } else { word }
    };
    let mut text = "-- made by chartwright\nMODULE main\nVAR\n".to_owned();
    let leaves = system.inputs.iter().map(|i| i.leaf).chain(system.latches.iter().map(|l| l.leaf));
    for leaf in leaves {
        let _ = writeln!(text, "  {} : boolean; -- {}", lit(leaf), line(system.name(leaf)));
    }
    let gates = gates(system, &[]);
    if !gates.is_empty() {
        text += "DEFINE\n";
    }
    for (n, a, b) in gates {
        let _ = writeln!(text, "  g{n} := {} & {};", lit(a), lit(b));
    }
    if !system.latches.is_empty() {
        text += "ASSIGN\n";
    }
    for latch in &system.latches {
        if let Some(value) = latch.initial {
            let _ = writeln!(text, "  init({}) := {};", lit(latch.leaf), lit(Lit::of(value)));
        }
        let _ = writeln!(text, "  next({}) := {};", lit(latch.leaf), lit(latch.next));
    }
    for &c in &system.constraints {
        let _ = writeln!(text, "INVAR {};", lit(c));
    }
    for claim in &system.claims {
        let _ = match claim.property {
            Property::Never(bad) => writeln!(text, "SPEC AG {}; -- {}", lit(!bad), line(&claim.name)),
            Property::AlwaysPossible(goal) => writeln!(text, "SPEC AG EF {}; -- {}", lit(goal), line(&claim.name)),
            Property::Eventually { after, then } => {
                let fair: String = system.fair.iter().map(|f| format!("G F {} & ", lit(f.holds))).collect();
                let comes = format!("G ({} -> F {})", lit(after), lit(then));
                writeln!(text, "LTLSPEC ({fair}TRUE) -> {comes}; -- {}", line(&claim.name))
            }
            Property::NeverStuck => writeln!(text, "-- ask `check_fsm`: {}", line(&claim.name)),
        };
    }
    text
}

/// The variables in an order in which decision diagrams stay small, a line each, for NuSMV's `-i`.
pub fn order(system: &System) -> String {
    let words = words(system);
    let all: Vec<usize> = (0..system.latches.len()).collect();
    let nodes: Vec<usize> = (0..system.aig.len()).collect();
    let rank = order::force(system, &all, &nodes);
    let mut leaves: Vec<usize> = nodes.into_iter().filter(|&n| !words[n].is_empty()).collect();
    leaves.sort_by_key(|&n| rank[n]);
    leaves.iter().map(|&n| format!("{}\n", words[n])).collect()
}
