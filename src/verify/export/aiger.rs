//! AIGER, as text or in its binary form: of its first version (Biere, 2007), which all tools read, or of version 1.9 (Biere,
//! Heljanko, Wieringa, 2011).
//!
//! Both can say what never is: the first by outputs that are never TRUE, in a system that is [`plain`]. Version 1.9 can
//! also say what comes eventually: as what does not come again and again in a fair run, once that run has said that no
//! answer is to come. What a file cannot say its comment names.

use super::super::aig::Lit;
use super::super::system::{Property, System};
use super::{Names, Told, bads, gates, plain};
use std::fmt::Write;

/// What a file can say.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    First,
    Latest,
}

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
    fn head(&self, told: &Told, version: Version, form: &str) -> String {
        let system = &told.system;
        let (inputs, latches, bads) = (system.inputs.len(), system.latches.len(), bads(system));
        let (most, gates) = (self.highest, self.gates.len());
        let mut text = match version {
            Version::First => format!("{form} {most} {inputs} {latches} {} {gates}", bads.len()),
            Version::Latest => {
                format!("{form} {most} {inputs} {latches} 0 {gates} {} {}", bads.len(), system.constraints.len())
            }
        };
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

/// In version 1.9, as text.
pub fn ascii(system: &System) -> String {
    text(&Told::new(system), Version::Latest)
}

/// In version 1.9, in the binary form.
pub fn binary(system: &System) -> Vec<u8> {
    bytes(&Told::new(system), Version::Latest)
}

/// In the first version, as text.
pub fn first_ascii(system: &System) -> String {
    text(&Told::without_justice(plain::of(system).system), Version::First)
}

/// In the first version, in the binary form.
pub fn first_binary(system: &System) -> Vec<u8> {
    bytes(&Told::without_justice(plain::of(system).system), Version::First)
}

fn text(told: &Told, version: Version) -> String {
    let numbers = Numbers::new(told);
    let mut text = numbers.head(told, version, "aag");
    for (gate, a, b) in numbers.gates() {
        let _ = writeln!(text, "{gate} {a} {b}");
    }
    text + &names(told, version)
}

fn bytes(told: &Told, version: Version) -> Vec<u8> {
    let numbers = Numbers::new(told);
    let mut bytes = numbers.head(told, version, "aig").into_bytes();
    for (gate, a, b) in numbers.gates() {
        for mut difference in [gate - a, a - b] {
            while difference >= 0x80 {
                bytes.push((difference & 0x7f) as u8 | 0x80);
                difference >>= 7;
            }
            bytes.push(difference as u8);
        }
    }
    bytes.extend(names(told, version).into_bytes());
    bytes
}

/// The symbol table and the comment.
fn names(told: &Told, version: Version) -> String {
    let system = &told.system;
    let mut text = String::new();
    let names = Names::new(system);
    for (kind, names) in [("i", &names.inputs), ("l", &names.latches)] {
        for (i, name) in names.iter().enumerate() {
            let _ = writeln!(text, "{kind}{i} {name}");
        }
    }
    let bad = if version == Version::First { "o" } else { "b" };
    for (i, (claim, _)) in bads(system).into_iter().enumerate() {
        let _ = writeln!(text, "{bad}{i} {}", names.claims[claim]);
    }
    for (i, (claim, _)) in told.justice.iter().enumerate() {
        let _ = writeln!(text, "j{i} {}", names.claims[*claim]);
    }
    for (i, _) in told.fair().iter().enumerate() {
        let _ = writeln!(text, "f{i} {}", names.fair[i]);
    }
    text += "c\nmade by chartwright\n";
    for (claim, name) in system.claims.iter().zip(&names.claims) {
        let cannot = match (claim.property, version) {
            (Property::Never(_), _) | (Property::Eventually { .. }, Version::Latest) => continue,
            (Property::Eventually { .. }, Version::First) => "AIGER before 1.9",
            (Property::AlwaysPossible(_) | Property::NeverStuck, _) => "AIGER",
        };
        let _ = writeln!(text, "left out, since {cannot} cannot say it: {name}");
    }
    text
}
