//! Constraints to the corrected filter of the paper on logical constraints, run in rounds.
//!
//! ```text
//! fc0 := 0; fc1 := 0
//! for each of as many rounds as there are combined products, and one more:
//!    o := not fs0 and (not fc0 and command or fc1) or fs1
//!    v := the combined products that are TRUE under o
//!    if there is none: o it is
//!    for each of v: the outputs that yield are added to fc0 or fc1
//! ```
//!
//! `fs0` and `fs1`, what simple products demand, do not change within a scan. What has yielded keeps
//! yielding, so each round adds a relief or is the last. All outputs that share a word are decided at
//! once.
//!
//! A checked machine whose assumptions hold always gets there. If one does not, the last `o` stands and
//! [`Filter::failed`] says so.
//!
//! With `relief in-order` there are no rounds but sweeps. `o` begins as `not fs0 and command or fs1`. A
//! sweep looks at each combined product in its turn, and if it is TRUE under `o`, the outputs that yield
//! change in `o` at once, unless a simple product holds them. After as many sweeps as the machine says,
//! `o` stands.
//!
//! A blocking filter first holds the commands themselves against all products, which says which constraints
//! act, and whether commands count as FALSE.
//!
//! A filter with a reset numbers the scans, and keeps the number of the one in which began what is noted.

use super::code::{Code, HALF, Layout, Test, append, part};
use crate::ir::chart::{
    ConstraintId, FilterMode, InputId, LAST_SCAN, Machine, Mark, OutputId, Relief, ScanNumber, outputs_of,
};
use std::ops::Range;

/// A simple product: what an output must be while the tests hold.
#[derive(Clone, Debug)]
struct Forcing {
    tests: Range<u32>,
    word: u32,
    bit: u32,
    value: bool,
    constraint: ConstraintId,
}

/// A combined product and who yields to it.
#[derive(Clone, Debug)]
struct Combined {
    tests: Range<u32>,
    reliefs: Range<u32>,
    constraint: ConstraintId,
}

/// Which outputs of one word go off and on.
#[derive(Clone, Copy, Debug, Default)]
struct Forced {
    off: u32,
    on: u32,
}

/// The tables, and what was decided in this scan.
#[derive(Clone, Debug)]
pub struct Filter {
    first: usize,
    tests: Vec<Test>,
    forcings: Vec<Forcing>,
    combined: Vec<Combined>,
    /// Words of outputs with who yields there.
    reliefs: Vec<(u32, Forced)>,
    /// For each word of outputs, what simple products demand.
    simple: Vec<Forced>,
    /// For each word of outputs, what combined products have demanded so far.
    yielded: Vec<Forced>,
    /// One bit for each constraint that had to act.
    acted: Vec<u64>,
    mode: FilterMode,
    relief: Relief,
    /// Whose rising edge is the reset.
    reset: Option<InputId>,
    /// Whether a constraint has acted since the last reset, and one bit for each that did so first.
    noted: bool,
    first_acted: Vec<u64>,
    /// The number of this scan, and of the one in which that began.
    scan: u32,
    first_scan: u32,
    /// Commands that count.
    taken: Vec<u32>,
    rounds: u32,
    failed: bool,
}

impl Filter {
    /// Tabulates the constraints of `machine`.
    pub fn of(machine: &Machine, layout: Layout, code: &Code) -> Filter {
        let words = layout.events - layout.outputs;
        let mut filter = Filter {
            first: layout.outputs,
            tests: Vec::new(),
            forcings: Vec::new(),
            combined: Vec::new(),
            reliefs: Vec::new(),
            simple: vec![Forced::default(); words],
            yielded: vec![Forced::default(); words],
            acted: vec![0; machine.safety.constraints.len().div_ceil(64)],
            mode: machine.safety.mode.unwrap_or(FilterMode::Supervisor),
            relief: machine.safety.relief,
            reset: machine.safety.reset,
            noted: false,
            first_acted: vec![0; machine.safety.constraints.len().div_ceil(64)],
            scan: 0,
            first_scan: 0,
            taken: vec![0; words],
            rounds: 0,
            failed: false,
        };
        for (id, constraint) in machine.safety.constraints.iter() {
            for product in &constraint.products {
                let outputs: Vec<(OutputId, bool)> = outputs_of(product).collect();
                let literals = product.literals().iter().map(|l| (l.atom, l.negated));
                match outputs[..] {
                    [(output, negated)] => {
                        let (word, bit) = place(output);
                        let readings = literals.filter(|&(a, _)| a != crate::ir::chart::Atom::Output(output));
                        let tests = append(&mut filter.tests, code.tests(readings));
                        // What must not be TRUE is the output as it stands there.
                        filter.forcings.push(Forcing { tests, word, bit, value: negated, constraint: id });
                    }
                    _ => {
                        let tests = append(&mut filter.tests, code.tests(literals));
                        let yielding = outputs.iter().filter(|(o, _)| constraint.yields.contains(o));
                        let reliefs = yielding.map(|&(output, negated)| {
                            let (word, bit) = place(output);
                            let (off, on) = if negated { (0, bit) } else { (bit, 0) };
                            (word, Forced { off, on })
                        });
                        let reliefs = append(&mut filter.reliefs, reliefs);
                        filter.combined.push(Combined { tests, reliefs, constraint: id });
                    }
                }
            }
        }
        filter
    }

    /// Decides the outputs in `words`; `commands` has a word of 32 for each word of outputs.
    pub fn decide(&mut self, words: &mut [u64], commands: &[u32]) {
        self.scan = if self.scan == LAST_SCAN { 1 } else { self.scan + 1 };
        self.acted.fill(0);
        self.force(words, commands);
        self.failed = self.simple.iter().any(|f| f.off & f.on != 0);
        let edge = |i: InputId| words[i.index() / HALF] >> (i.index() % HALF) & (1 | 1 << HALF) == 1;
        let held = self.noted && !self.reset.is_some_and(edge);
        self.taken.copy_from_slice(commands);
        if self.mode == FilterMode::Blocking {
            self.judge(words);
            if held || self.acted.iter().any(|&a| a != 0) {
                self.taken.fill(0);
            }
        }
        let by_commands = self.acted.clone();
        match self.relief {
            Relief::Together => self.rounds(words),
            Relief::InOrder { sweeps } => self.sweeps(words, sweeps),
        }
        if self.mode == FilterMode::Blocking {
            self.acted = by_commands;
        }
        if self.reset.is_some() && !held {
            self.noted = self.acted.iter().any(|&a| a != 0);
            self.first_acted.copy_from_slice(&self.acted);
            self.first_scan = if self.noted { self.scan } else { 0 };
        }
    }

    /// What simple products demand, and which of them the commands violate.
    fn force(&mut self, words: &[u64], commands: &[u32]) {
        self.simple.fill(Forced::default());
        for f in &self.forcings {
            if part(&self.tests, &f.tests).iter().all(|t| t.holds(words)) {
                let forced = &mut self.simple[f.word as usize];
                *(if f.value { &mut forced.on } else { &mut forced.off }) |= f.bit;
                if (commands[f.word as usize] & f.bit != 0) != f.value {
                    mark(&mut self.acted, f.constraint);
                }
            }
        }
    }

    /// Which combined products the commands violate.
    fn judge(&mut self, words: &mut [u64]) {
        for (word, &taken) in words[self.first..].iter_mut().zip(&self.taken) {
            put(word, taken);
        }
        for c in &self.combined {
            if part(&self.tests, &c.tests).iter().all(|t| t.holds(words)) {
                mark(&mut self.acted, c.constraint);
            }
        }
    }

    fn sweeps(&mut self, words: &mut [u64], sweeps: usize) {
        for ((word, s), &taken) in words[self.first..].iter_mut().zip(&self.simple).zip(&self.taken) {
            put(word, !s.off & taken | s.on);
        }
        self.rounds = 1;
        let mut violated = !self.combined.is_empty();
        while violated && self.rounds as usize <= sweeps {
            violated = false;
            for c in &self.combined {
                if part(&self.tests, &c.tests).iter().all(|t| t.holds(words)) {
                    violated = true;
                    mark(&mut self.acted, c.constraint);
                    for &(i, relief) in part(&self.reliefs, &c.reliefs) {
                        let (word, s) = (&mut words[self.first + i as usize], self.simple[i as usize]);
                        put(word, (*word as u32 | relief.on & !s.off) & !(relief.off & !s.on));
                    }
                }
            }
            self.rounds += u32::from(violated);
        }
        self.failed |= self.combined.iter().any(|c| part(&self.tests, &c.tests).iter().all(|t| t.holds(words)));
    }

    fn rounds(&mut self, words: &mut [u64]) {
        self.yielded.fill(Forced::default());
        self.rounds = 0;
        loop {
            self.rounds += 1;
            for (i, word) in words[self.first..][..self.taken.len()].iter_mut().enumerate() {
                let (s, c) = (self.simple[i], self.yielded[i]);
                put(word, !s.off & (!c.off & self.taken[i] | c.on) | s.on);
            }
            let mut violated = false;
            for c in &self.combined {
                if part(&self.tests, &c.tests).iter().all(|t| t.holds(words)) {
                    violated = true;
                    mark(&mut self.acted, c.constraint);
                    for &(word, relief) in part(&self.reliefs, &c.reliefs) {
                        let yielded = &mut self.yielded[word as usize];
                        yielded.off |= relief.off;
                        yielded.on |= relief.on;
                    }
                }
            }
            if !violated {
                return;
            }
            if self.rounds as usize > self.combined.len() {
                self.failed = true;
                return;
            }
        }
    }

    /// Whether the constraint had to act in this scan.
    pub fn acted(&self, constraint: ConstraintId) -> bool {
        self.acted[constraint.index() / 64] >> (constraint.index() % 64) & 1 == 1
    }

    /// What is remembered after this scan.
    pub fn mark(&self, mark: Mark) -> bool {
        match mark {
            Mark::Noted => self.noted,
            Mark::First(c) => self.first_acted[c.index() / 64] >> (c.index() % 64) & 1 == 1,
        }
    }

    /// A number that is kept after this scan.
    pub fn scan_number(&self, number: ScanNumber) -> u32 {
        match number {
            ScanNumber::This => self.scan,
            ScanNumber::First => self.first_scan,
        }
    }

    /// How many rounds this scan took; 1 when no combined product was violated.
    pub fn count(&self) -> usize {
        self.rounds as usize
    }

    /// Whether the outputs of this scan violate a constraint, because none of the assignments that the
    /// reliefs lead to does not.
    pub fn failed(&self) -> bool {
        self.failed
    }
}

/// Replaces the outputs of this scan in a word that also holds those of the scan before.
fn put(word: &mut u64, outputs: u32) {
    *word = *word & !u64::from(u32::MAX) | u64::from(outputs);
}

/// The word of an output among those of outputs, and its bit there.
pub fn place(output: OutputId) -> (u32, u32) {
    ((output.index() / HALF) as u32, 1 << (output.index() % HALF))
}

fn mark(bits: &mut [u64], constraint: ConstraintId) {
    bits[constraint.index() / 64] |= 1 << (constraint.index() % 64);
}
