//! AIGER 1.9 (Biere, Heljanko, Wieringa, 2011), as text or in its binary form.
//!
//! It can say what never is, and what comes eventually: as what does not come again and again in a fair run, once
//! that run has said that no answer is to come. What is always possible it cannot say, and the comment says so.

use super::super::aig::Lit;
use super::super::system::{Property, System};
use super::{Told, bads, gates, line, symbols};
use std::fmt::Write;

/// The numbers that a system's nodes have in a file.
struct Numbers {
    /// For each node, twice its number.
    of: Vec<usize>,
    gates: Vec<(usize, Lit, Lit)>,
    highest: usize,
}

impl Numbers {
    fn new(told: &Told) -> Numbers {
        let system = &told.system;
        let gates = gates(system, &told.justice);
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
    fn head(&self, told: &Told, form: &str) -> String {
        let system = &told.system;
        let (inputs, latches, bads) = (system.inputs.len(), system.latches.len(), bads(system));
        let mut text = format!(
            "{form} {} {inputs} {latches} 0 {} {} {}",
            self.highest,
            self.gates.len(),
            bads.len(),
            system.constraints.len()
        );
        if !told.justice.is_empty() {
            let _ = write!(text, " {} {}", told.justice.len(), told.fair().len());
        }
        text.push('\n');
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
        // First how many literals each has, then all of them.
        told.justice.iter().for_each(|_| text += "1\n");
        let justice = told.justice.iter().map(|(_, l)| *l);
        for l in justice.chain(told.fair().iter().map(|f| f.holds)) {
            let _ = writeln!(text, "{}", self.lit(l));
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
    let told = Told::new(system);
    let numbers = Numbers::new(&told);
    let mut text = numbers.head(&told, "aag");
    for (gate, a, b) in numbers.gates() {
        let _ = writeln!(text, "{gate} {a} {b}");
    }
    text + &names(&told)
}

/// In the binary form.
pub fn binary(system: &System) -> Vec<u8> {
    let told = Told::new(system);
    let numbers = Numbers::new(&told);
    let mut bytes = numbers.head(&told, "aig").into_bytes();
    for (gate, a, b) in numbers.gates() {
        for mut difference in [gate - a, a - b] {
            while difference >= 0x80 {
                bytes.push((difference & 0x7f) as u8 | 0x80);
                difference >>= 7;
            }
            bytes.push(difference as u8);
        }
    }
    bytes.extend(names(&told).into_bytes());
    bytes
}

/// The symbol table and the comment.
fn names(told: &Told) -> String {
    let system = &told.system;
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
    for (i, (name, _)) in told.justice.iter().enumerate() {
        let _ = writeln!(text, "j{i} {}", line(name));
    }
    for (i, fair) in told.fair().iter().enumerate() {
        let _ = writeln!(text, "f{i} {}", line(&fair.name));
    }
    text += "c\nmade by chartwright\n";
    for claim in &system.claims {
        match claim.property {
            Property::Never(_) | Property::Eventually { .. } => {}
            Property::AlwaysPossible(_) | Property::NeverStuck => {
                let _ = writeln!(text, "left out, since AIGER cannot say it: {}", line(&claim.name));
            }
        }
    }
    text
}
