//! BTOR2 (Niemetz, Preiner, Wolf, Biere, 2018): every bit a vector of one.

use super::super::aig::Lit;
use super::super::system::System;
use super::{Names, Told, bads, gates};
use std::fmt::Write;

struct Writer {
    text: String,
    /// The number of the last line.
    last: usize,
    /// For each node, the number of the line that it is.
    of: Vec<usize>,
    /// The same for the opposite; 0 until it is written.
    opposite: Vec<usize>,
}

impl Writer {
    fn line(&mut self, words: &str) -> usize {
        self.last += 1;
        let _ = writeln!(self.text, "{} {words}", self.last);
        self.last
    }

    fn lit(&mut self, l: Lit) -> usize {
        let node = l.node();
        if !l.is_negated() {
            return self.of[node];
        }
        if self.opposite[node] == 0 {
            self.opposite[node] = self.line(&format!("not 1 {}", self.of[node]));
        }
        self.opposite[node]
    }
}

/// As text. What is always possible cannot be said and is left out.
pub fn write(system: &System) -> String {
    let told = Told::new(system);
    let system = &told.system;
    let mut w = Writer {
        text: "; made by chartwright\n".to_owned(),
        last: 0,
        of: vec![0; system.aig.len()],
        opposite: vec![0; system.aig.len()],
    };
    w.line("sort bitvec 1");
    w.of[0] = w.line("zero 1");
    let names = Names::new(system);
    for (input, name) in system.inputs.iter().zip(&names.inputs) {
        w.of[input.leaf.node()] = w.line(&format!("input 1 {name}"));
    }
    for (latch, name) in system.latches.iter().zip(&names.latches) {
        w.of[latch.leaf.node()] = w.line(&format!("state 1 {name}"));
    }
    for latch in &system.latches {
        if let Some(value) = latch.initial {
            let value = w.lit(Lit::of(value));
            w.line(&format!("init 1 {} {value}", w.of[latch.leaf.node()]));
        }
    }
    for (n, a, b) in gates(system, &told.justice) {
        let (a, b) = (w.lit(a), w.lit(b));
        w.of[n] = w.line(&format!("and 1 {a} {b}"));
    }
    for latch in &system.latches {
        let next = w.lit(latch.next);
        w.line(&format!("next 1 {} {next}", w.of[latch.leaf.node()]));
    }
    for &c in &system.constraints {
        let c = w.lit(c);
        w.line(&format!("constraint {c}"));
    }
    for (claim, bad) in bads(system) {
        let bad = w.lit(bad);
        w.line(&format!("bad {bad} {}", names.claims[claim]));
    }
    for (fair, name) in told.fair().iter().zip(&names.fair) {
        let holds = w.lit(fair.holds);
        w.line(&format!("fair {holds} {name}"));
    }
    for (claim, recurs) in &told.justice {
        let recurs = w.lit(*recurs);
        w.line(&format!("justice 1 {recurs} {}", names.claims[*claim]));
    }
    w.text
}
