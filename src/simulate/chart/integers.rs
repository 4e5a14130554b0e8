//! Assignments and comparisons to sums of multiples.
//!
//! Guards never see an integer: each comparison is one bit in the row of words, see
//! [`code`](super::code), and the bits are brought up to date when an integer has changed. So a scan
//! in which nothing is counted costs nothing, and guards read comparisons, too, as they were before
//! the step.

use super::code::{Layout, Memory, append, part};
use super::steps::{Configuration, Deed};
use crate::ir::chart::{ComparisonId, Deeds, IntegerId, Machine};
use crate::ir::number::{Number, Range as Bounds, Relation};
use std::ops::Range;

/// A sum of multiples of integers. No part of an expression of a checked machine leaves its type, so
/// the order of its operands does not matter.
#[derive(Clone, Debug, Default)]
struct Sum {
    constant: i64,
    /// Factors with places in [`Memory::integers`].
    terms: Vec<(i64, u32)>,
}

/// What becomes of an integer.
#[derive(Clone, Debug)]
struct Assignment {
    integer: u32,
    value: Sum,
    bounds: Bounds,
}

/// How a difference compares with 0, and where the answer goes.
#[derive(Clone, Debug)]
struct Comparison {
    difference: Sum,
    relation: Relation,
    word: usize,
    bit: u64,
}

/// All assignments and comparisons of a machine.
#[derive(Clone, Debug)]
pub struct Integers {
    assignments: Vec<Assignment>,
    /// Of each state that is left, each transition and each state that is entered.
    of_exit: Vec<Range<u32>>,
    of_transition: Vec<Range<u32>>,
    of_entry: Vec<Range<u32>>,
    comparisons: Vec<Comparison>,
    /// What was assigned in this scan; written when all of it has been read.
    pending: Vec<(u32, i64)>,
}

impl Integers {
    /// The tables for `machine`; the initial values go into `memory`.
    pub fn of(machine: &Machine, layout: Layout, memory: &mut Memory) -> Integers {
        memory.integers = machine.integers.values().map(|i| i.initial).collect();
        let mut all = Integers {
            assignments: Vec::new(),
            of_exit: Vec::new(),
            of_transition: Vec::new(),
            of_entry: Vec::new(),
            comparisons: Vec::new(),
            pending: Vec::with_capacity(machine.integers.len()),
        };
        if machine.integers.is_empty() {
            return all;
        }
        let mut add = |deeds: &Deeds| {
            let assignments = deeds.assignments.iter().map(|a| {
                let integer = a.integer.index() as u32;
                Assignment { integer, value: Sum::of(&a.value), bounds: machine.integers[a.integer].range }
            });
            append(&mut all.assignments, assignments)
        };
        all.of_exit = machine.states.values().map(|s| add(&s.exit)).collect();
        all.of_transition = machine.transitions.values().map(|t| add(&t.deeds)).collect();
        all.of_entry = machine.states.values().map(|s| add(&s.entry)).collect();
        for (id, comparison) in machine.comparisons.iter() {
            let mut difference = Sum::default();
            difference.add(&comparison.left, 1);
            difference.add(&comparison.right, -1);
            let (word, bit) = layout.comparison(id);
            all.comparisons.push(Comparison { difference, relation: comparison.relation, word, bit });
        }
        all.compare(memory);
        all
    }

    /// Assigns what has happened since the last time, of which the last wins: all values are read before one
    /// is written.
    pub fn assign(&mut self, configuration: &mut Configuration, memory: &mut Memory) {
        if self.assignments.is_empty() {
            return;
        }
        self.pending.clear();
        for deed in configuration.happened() {
            let range = match deed {
                Deed::Exit(state) => &self.of_exit[state.index()],
                Deed::Fire(transition) => &self.of_transition[transition.index()],
                Deed::Entry(state) => &self.of_entry[state.index()],
            };
            for assignment in part(&self.assignments, range) {
                let Bounds { lowest, highest } = assignment.bounds;
                let value = assignment.value.of_memory(memory).clamp(lowest, highest);
                self.pending.push((assignment.integer, value));
            }
        }
        if self.pending.is_empty() {
            return;
        }
        for &(integer, value) in &self.pending {
            memory.integers[integer as usize] = value;
        }
        self.compare(memory);
    }

    /// Brings the bits of all comparisons up to date.
    fn compare(&self, memory: &mut Memory) {
        for comparison in &self.comparisons {
            let difference = comparison.difference.of_memory(memory);
            let holds = match comparison.relation {
                Relation::Equal => difference == 0,
                Relation::Unequal => difference != 0,
                Relation::Less => difference < 0,
                Relation::LessOrEqual => difference <= 0,
                Relation::Greater => difference > 0,
                Relation::GreaterOrEqual => difference >= 0,
            };
            let word = &mut memory.words[comparison.word];
            *word = if holds { *word | comparison.bit } else { *word & !comparison.bit };
        }
    }
}

impl Sum {
    fn of(number: &Number<IntegerId>) -> Sum {
        let mut sum = Sum::default();
        sum.add(number, 1);
        sum
    }

    /// Adds that many times the number; recursion is bounded by the nesting limit of the source.
    fn add(&mut self, number: &Number<IntegerId>, factor: i64) {
        match number {
            Number::Const(n) => self.constant += factor * n,
            Number::Value(integer) => {
                let place = integer.index() as u32;
                match self.terms.iter_mut().find(|(_, p)| *p == place) {
                    Some((total, _)) => *total += factor,
                    None => self.terms.push((factor, place)),
                }
            }
            Number::Sum(operands) => {
                operands.iter().for_each(|o| self.add(&o.value, if o.negative { -factor } else { factor }));
            }
        }
    }

    fn of_memory(&self, memory: &Memory) -> i64 {
        self.terms.iter().fold(self.constant, |sum, &(factor, place)| sum + factor * memory.integers[place as usize])
    }
}

impl Layout {
    /// The word of a comparison and its bit there.
    pub fn comparison(&self, comparison: ComparisonId) -> (usize, u64) {
        (self.comparisons + comparison.index() / 64, 1 << (comparison.index() % 64))
    }
}
