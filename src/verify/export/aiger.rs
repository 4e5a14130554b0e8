//! AIGER 1.9 (Biere, Heljanko, Wieringa, 2011), as text or in its binary form.
//!
//! It can say what never is; what is always possible it cannot, and the comment says so.

use super::super::aig::Lit;
use super::super::system::{Property, System};
use super::{bads, gates, line, symbols};
use std::fmt::Write;

/// The numbers that a system's nodes have in a file.
struct Numbers {
    /// For each node, twice its number.
    of: Vec<usize>,
    gates: Vec<(usize, Lit, Lit)>,
    highest: usize,
}

impl Numbers {
    fn new(system: &System) -> Numbers {
        let gates = gates(system);
        let mut of = vec![0; system.aig.len()];
        let leaves = system.inputs.iter().map(|i| i.leaf).chain(system.latches.iter().map(|l| l.leaf));
        let nodes = leaves.map(Lit::node).chain(gates.iter().map(|g| g.0));
        let mut highest = 0;
        for node in nodes {
            highest += 1;
            of[node] = 2 * highest;
        }
        Numbers { of, gates, highest }
    }

    fn lit(&self, l: Lit) -> usize {
        self.of[l.node()] + usize::from(l.is_negated())
    }

    /// The first line, latches, bads and constraints.
    fn head(&self, system: &System, form: &str) -> String {
        let (inputs, latches, bads) = (system.inputs.len(), system.latches.len(), bads(system));
        let mut text = format!(
            "{form} {} {inputs} {latches} 0 {} {} {}\n",
            self.highest,
            self.gates.len(),
            bads.len(),
            system.constraints.len()
        );
        if form == "aag" {
            system.inputs.iter().for_each(|i| text += &format!("{}\n", self.lit(i.leaf)));
        }
        for latch in &system.latches {
            if form == "aag" {
                let _ = write!(text, "{} ", self.lit(latch.leaf));
            }
            let _ = match latch.initial {
                Some(false) => writeln!(text, "{}", self.lit(latch.next)),
                Some(true) => writeln!(text, "{} 1", self.lit(latch.next)),
                None => writeln!(text, "{} {}", self.lit(latch.next), self.lit(latch.leaf)),
            };
        }
        for (_, bad) in bads {
            let _ = writeln!(text, "{}", self.lit(bad));
        }
        for &c in &system.constraints {
            let _ = writeln!(text, "{}", self.lit(c));
        }
        text
    }

    /// Gates with what they read, greater numbers first.
    fn gates(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        self.gates.iter().map(|&(n, a, b)| {
            let (a, b) = (self.lit(a), self.lit(b));
            (self.of[n], a.max(b), a.min(b))
        })
    }
}

/// As text.
pub fn ascii(system: &System) -> String {
    let numbers = Numbers::new(system);
    let mut text = numbers.head(system, "aag");
    for (gate, a, b) in numbers.gates() {
        let _ = writeln!(text, "{gate} {a} {b}");
    }
    text + &names(system)
}

/// In the binary form.
pub fn binary(system: &System) -> Vec<u8> {
    let numbers = Numbers::new(system);
    let mut bytes = numbers.head(system, "aig").into_bytes();
    for (gate, a, b) in numbers.gates() {
        for mut difference in [gate - a, a - b] {
            while difference >= 0x80 {
                bytes.push((difference & 0x7f) as u8 | 0x80);
                difference >>= 7;
            }
            bytes.push(difference as u8);
        }
    }
    bytes.extend(names(system).into_bytes());
    bytes
}

/// The symbol table and the comment.
fn names(system: &System) -> String {
    let mut text = String::new();
    let symbols = symbols(system);
    let (inputs, latches) = symbols.split_at(system.inputs.len());
    for (kind, names) in [("i", inputs), ("l", latches)] {
        for (i, name) in names.iter().enumerate() {
            let _ = writeln!(text, "{kind}{i} {name}");
        }
    }
    for (i, (name, _)) in bads(system).into_iter().enumerate() {
        let _ = writeln!(text, "b{i} {}", line(name));
    }
    text += "c\nmade by chartwright\n";
    for claim in &system.claims {
        match claim.property {
            Property::Never(_) => {}
            Property::AlwaysPossible(_) | Property::NeverStuck | Property::Eventually { .. } => {
                let _ = writeln!(text, "left out, since AIGER cannot say it: {}", line(&claim.name));
            }
        }
    }
    text
}
