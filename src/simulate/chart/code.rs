//! Guards to flat code over words of bits.
//!
//! All that a guard can read is one bit, and the bits lie in one row of 64-bit words:
//!
//! | words | hold | in each word |
//! | --- | --- | --- |
//! | inputs | 32 inputs | low half: this scan; high half: the scan before |
//! | outputs | 32 outputs | low half: this scan; high half: the scan before |
//! | events | 32 events | low half: this scan; high half: raised for the next scan |
//! | variables | 64 variables | |
//! | comparisons | 64 comparisons of integers | |
//! | states | 64 states | 1 while active |
//!
//! Now and before stand in one word so that an edge is one comparison. A conjunction of literals of one
//! word, the form of nearly every guard, is one [`Op::Test`] whatever its length, and so is a disjunction
//! with a [`Op::Not`] behind it. What is no such thing is a sequence in postfix order over a stack of
//! bits that is itself one word.
//!
//! [`Atom::Done`] is gone: it is spelt out in final states. [`Atom::After`] is no bit but an instruction
//! of its own, because it would have to be brought up to date for every state in every scan: for each
//! state, the scan that entered it last is kept, which tells all that is asked.

use crate::ir::chart::{Atom, EventId, Guard, Machine, RegionId, StateId, StateKind, VariableId};
use crate::ir::expr::Expr;
use std::ops::Range;

/// Where each kind of value begins in the row of words.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// The first word of outputs; inputs begin at 0.
    pub outputs: usize,
    /// The first word of events.
    pub events: usize,
    /// The first word of variables.
    pub variables: usize,
    /// The first word of comparisons.
    pub comparisons: usize,
    /// The first word of states.
    pub states: usize,
    /// How many words there are.
    pub words: usize,
}

/// How many inputs or outputs share a word with their values of the scan before, and events with those
/// of the next.
pub const HALF: usize = 32;

impl Layout {
    /// The layout for all values of `machine`.
    pub fn of(machine: &Machine) -> Layout {
        let outputs = machine.inputs.len().div_ceil(HALF);
        let events = outputs + machine.outputs.len().div_ceil(HALF);
        let variables = events + machine.events.len().div_ceil(HALF);
        let comparisons = variables + machine.variables.len().div_ceil(64);
        let states = comparisons + machine.comparisons.len().div_ceil(64);
        let words = states + machine.states.len().div_ceil(64);
        Layout { outputs, events, variables, comparisons, states, words }
    }

    /// The word of a state and its bit there.
    pub fn state(&self, state: StateId) -> (usize, u64) {
        (self.states + state.index() / 64, 1 << (state.index() % 64))
    }

    /// The word of a variable and its bit there.
    pub fn variable(&self, variable: VariableId) -> (usize, u64) {
        (self.variables + variable.index() / 64, 1 << (variable.index() % 64))
    }

    /// The word of an event and its bit there, in this scan.
    pub fn event(&self, event: EventId) -> (usize, u64) {
        (self.events + event.index() / HALF, 1 << (event.index() % HALF))
    }

    /// The word of an atom and its bit there.
    fn bit(&self, atom: Atom) -> (usize, u64) {
        let half = |first: usize, i: usize, before: usize| (first + i / HALF, 1 << (i % HALF + before));
        match atom {
            Atom::Input(i) => half(0, i.index(), 0),
            Atom::PrevInput(i) => half(0, i.index(), HALF),
            Atom::Output(o) => half(self.outputs, o.index(), 0),
            Atom::PrevOutput(o) => half(self.outputs, o.index(), HALF),
            Atom::Variable(v) => self.variable(v),
            Atom::Event(e) => self.event(e),
            Atom::Compare(c) => self.comparison(c),
            Atom::In(s) => self.state(s),
            Atom::Done(_) | Atom::After(..) => unreachable!("`done` is spelt out, `after` is no bit"),
        }
    }
}

/// All that a guard can read.
#[derive(Clone, Debug)]
pub struct Memory {
    /// The row of words.
    pub words: Vec<u64>,
    /// The number of this scan, counted from 1.
    pub scan: u64,
    /// For each state, the number of the scan that entered it last.
    pub entered: Vec<u64>,
    /// The integers.
    pub integers: Vec<i64>,
}

/// One instruction. `Test` and `Waited` put a bit on the stack, the others replace one or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Op {
    Test(Test),
    /// Whether that many scans have begun in the state after the first one that did, if it has been
    /// active all the while.
    Waited {
        state: u32,
        scans: u32,
    },
    Not,
    And,
    Or,
    Xor,
}

/// Whether a word has, under a mask, exactly the wanted bits. With an empty mask it is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Test {
    word: u32,
    mask: u64,
    want: u64,
}

impl Test {
    /// Whether it holds.
    pub fn holds(&self, words: &[u64]) -> bool {
        words[self.word as usize] & self.mask == self.want
    }

    fn constant(value: bool) -> Test {
        Test { word: 0, mask: 0, want: u64::from(!value) }
    }
}

/// A condition: where its instructions stand in [`Code`]. Without instructions it is TRUE.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    from: u32,
    to: u32,
}

impl Condition {
    /// Whether it is TRUE whatever is read.
    pub fn is_empty(&self) -> bool {
        self.from == self.to
    }
}

/// The instructions of all conditions of a machine.
#[derive(Clone, Debug)]
pub struct Code {
    layout: Layout,
    /// Milliseconds from scan to scan.
    cycle: u32,
    ops: Vec<Op>,
}

impl Code {
    /// No instructions yet.
    pub fn new(layout: Layout, cycle: u32) -> Code {
        Code { layout, cycle, ops: Vec::new() }
    }

    /// Translates a guard.
    pub fn add(&mut self, machine: &Machine, guard: &Guard) -> Condition {
        let from = self.ops.len() as u32;
        let spelt_out = guard.map(&mut |&atom| match atom {
            Atom::Done(state) => done(machine, state),
            Atom::After(state, _) => Expr::And(vec![Expr::Atom(Atom::In(state)), Expr::Atom(atom)]),
            other => Expr::Atom(other),
        });
        if spelt_out != Expr::TRUE {
            self.ops.extend(self.compile(&spelt_out).ops);
        }
        Condition { from, to: self.ops.len() as u32 }
    }

    /// The tests of a conjunction of literals, one for each word.
    pub fn tests(&self, literals: impl Iterator<Item = (Atom, bool)>) -> Vec<Test> {
        let mut tests: Vec<Test> = Vec::new();
        for (atom, negated) in literals {
            let (word, bit) = self.layout.bit(atom);
            let want = if negated { 0 } else { bit };
            match tests.iter_mut().find(|t| t.word as usize == word) {
                Some(t) if t.mask & bit != 0 && t.want & bit != want => return vec![Test::constant(false)],
                Some(t) => {
                    t.mask |= bit;
                    t.want |= want;
                }
                None => tests.push(Test { word: word as u32, mask: bit, want }),
            }
        }
        tests
    }

    /// Whether the condition holds.
    pub fn holds(&self, condition: Condition, memory: &Memory) -> bool {
        // The bit below all others stays TRUE: it is what no instructions amount to.
        let mut stack = 1u64;
        for op in &self.ops[condition.from as usize..condition.to as usize] {
            match op {
                Op::Test(test) => stack = stack << 1 | u64::from(test.holds(&memory.words)),
                Op::Waited { state, scans } => {
                    let waited = memory.scan > memory.entered[*state as usize] + u64::from(*scans);
                    stack = stack << 1 | u64::from(waited);
                }
                Op::Not => stack ^= 1,
                Op::And => stack = stack >> 1 & (stack | !1),
                Op::Or => stack = stack >> 1 | stack & 1,
                Op::Xor => stack = stack >> 1 ^ stack & 1,
            }
        }
        stack & 1 == 1
    }

    fn compile(&self, guard: &Guard) -> Piece {
        match guard {
            Expr::Const(value) => Piece::test(Test::constant(*value)),
            Expr::Atom(Atom::After(state, time)) => {
                Piece::leaf(Op::Waited { state: state.index() as u32, scans: time.div_ceil(self.cycle) })
            }
            Expr::Atom(_) => self.join(std::slice::from_ref(guard), false),
            Expr::Not(e) => self.compile(e).not(),
            Expr::And(es) => self.join(es, false),
            // By De Morgan: no operand is FALSE only if not all opposites are TRUE.
            Expr::Or(es) => self.join(es, true),
            Expr::Xor(l, r) => Piece::chain(vec![self.compile(l), self.compile(r)], Op::Xor),
        }
    }

    /// The conjunction of the operands, or their disjunction.
    fn join(&self, operands: &[Guard], disjunction: bool) -> Piece {
        let mut pieces = Vec::new();
        let mut literals = Vec::new();
        for e in operands {
            match literal(e) {
                Some((atom, negated)) => literals.push((atom, negated != disjunction)),
                None => pieces.push(self.compile(e)),
            }
        }
        let tests = self.tests(literals.into_iter()).into_iter().map(Piece::test);
        if disjunction {
            pieces.extend(tests.map(Piece::not));
        } else {
            pieces.extend(tests);
        }
        if pieces.is_empty() {
            pieces.push(Piece::test(Test::constant(!disjunction)));
        }
        Piece::chain(pieces, if disjunction { Op::Or } else { Op::And })
    }
}

/// Instructions on the way to [`Code`].
struct Piece {
    ops: Vec<Op>,
    /// How many bits of the stack they use at most.
    depth: u32,
}

impl Piece {
    fn leaf(op: Op) -> Piece {
        Piece { ops: vec![op], depth: 1 }
    }

    fn test(test: Test) -> Piece {
        Piece::leaf(Op::Test(test))
    }

    fn not(mut self) -> Piece {
        if self.ops.last() == Some(&Op::Not) {
            self.ops.pop();
        } else {
            self.ops.push(Op::Not);
        }
        self
    }

    /// Joins pieces with an operator that does not care for their order. Those that use most of the
    /// stack go first: then a stack of n bits serves any expression of fewer than 2^n operands.
    fn chain(mut pieces: Vec<Piece>, op: Op) -> Piece {
        pieces.sort_by_key(|p| std::cmp::Reverse(p.depth));
        let mut pieces = pieces.into_iter();
        let mut all = pieces.next().expect("an operator has operands");
        for p in pieces {
            all.depth = all.depth.max(p.depth + 1);
            all.ops.extend(p.ops);
            all.ops.push(op);
        }
        debug_assert!(all.depth < 64);
        all
    }
}

/// The atom and whether it stands negated, if the expression is a literal over one bit.
fn literal(e: &Guard) -> Option<(Atom, bool)> {
    match e {
        Expr::Atom(Atom::After(..)) => None,
        Expr::Atom(atom) => Some((*atom, false)),
        Expr::Not(inner) => literal(inner).map(|(atom, negated)| (atom, !negated)),
        Expr::Const(_) | Expr::And(_) | Expr::Or(_) | Expr::Xor(..) => None,
    }
}

/// `done`, spelt out: in each region of the state, one of the final states is active. A state without
/// regions has nothing that could end; a checked machine does not ask for it.
fn done(machine: &Machine, state: StateId) -> Guard {
    let regions = &machine.states[state].regions;
    if regions.is_empty() {
        return Expr::FALSE;
    }
    let ended = |&region: &RegionId| {
        let states = machine.regions[region].states.iter().copied();
        Expr::any(states.filter(|&s| machine.states[s].kind == StateKind::Final).map(|s| Expr::Atom(Atom::In(s))))
    };
    Expr::all(regions.iter().map(ended))
}

/// Appends `items` to a list that many share and says where they are.
pub fn append<T>(list: &mut Vec<T>, items: impl IntoIterator<Item = T>) -> Range<u32> {
    let from = list.len() as u32;
    list.extend(items);
    from..list.len() as u32
}

/// The part of a shared list that [`append`] put there.
pub fn part<'a, T>(list: &'a [T], range: &Range<u32>) -> &'a [T] {
    &list[range.start as usize..range.end as usize]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::chart::{InputId, OutputId, VariableId};
    use proptest::prelude::*;

    fn atoms() -> impl Strategy<Value = Guard> {
        let atom = (0usize..40, 0u8..5).prop_map(|(i, kind)| match kind {
            0 => Atom::Input(InputId::from_index(i)),
            1 => Atom::PrevInput(InputId::from_index(i)),
            2 => Atom::PrevOutput(OutputId::from_index(i)),
            3 => Atom::Variable(VariableId::from_index(i)),
            _ => Atom::In(StateId::from_index(i)),
        });
        prop_oneof![8 => atom.prop_map(Expr::Atom), 1 => any::<bool>().prop_map(Expr::Const)]
    }

    fn guards() -> impl Strategy<Value = Guard> {
        atoms().prop_recursive(6, 60, 4, |inner| {
            prop_oneof![
                inner.clone().prop_map(|e| Expr::Not(Box::new(e))),
                prop::collection::vec(inner.clone(), 0..5).prop_map(Expr::And),
                prop::collection::vec(inner.clone(), 0..5).prop_map(Expr::Or),
                (inner.clone(), inner).prop_map(|(a, b)| Expr::Xor(Box::new(a), Box::new(b))),
            ]
        })
    }

    proptest! {
        #[test]
        fn code_means_what_the_guard_means(guard in guards(), words in prop::collection::vec(any::<u64>(), 6)) {
            let layout = Layout { outputs: 2, events: 4, variables: 4, comparisons: 5, states: 5, words: 6 };
            let mut code = Code::new(layout, 10);
            let condition = code.add(&Machine::default(), &guard);
            let value = |atom: &Atom| {
                let (word, bit) = layout.bit(*atom);
                words[word] & bit != 0
            };
            let memory = Memory { words: words.clone(), scan: 1, entered: Vec::new(), integers: Vec::new() };
            prop_assert_eq!(code.holds(condition, &memory), guard.eval(&mut |a| value(a)));
        }
    }

    #[test]
    fn a_conjunction_over_one_word_is_one_instruction() {
        let input = |i| Expr::Atom(Atom::Input(InputId::from_index(i)));
        let before = |i| Expr::Atom(Atom::PrevInput(InputId::from_index(i)));
        let mut code =
            Code::new(Layout { outputs: 1, events: 1, variables: 1, comparisons: 1, states: 1, words: 1 }, 10);
        code.add(&Machine::default(), &Expr::all([input(0), before(0).not(), input(3), input(4).not()]));
        assert_eq!(code.ops.len(), 1);
    }
}
