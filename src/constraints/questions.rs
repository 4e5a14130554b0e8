//! Questions about what a machine's filter may meet: any commands, and any readings that the declared
//! assumptions allow.
//!
//! Everything that constraints read is a bit of its own, a value and the one of the scan before
//! included; but comparisons of integers hold as the integers do that they compare. So an answer that something cannot be holds for every plant and every program. Of states, which
//! are those of observers, only so much is known that in each active region one is active.

use super::words;
use crate::bits::aig::{Aig, Lit};
use crate::bits::sat::{Answer, Budget, Model, Sat};
use crate::bits::vector::{self, Vector};
use crate::ir::chart::{Atom, ComparisonId, IntegerId, Machine, OutputId};
use crate::ir::number::{Comparison, Number, Range, Relation};
use crate::ir::sop::Product;
use std::collections::{BTreeMap, BTreeSet};

/// What is asked about, bit by bit, and who answers.
pub struct Questions<'m> {
    machine: &'m Machine,
    /// The graph in which questions are put.
    pub aig: Aig,
    sat: Sat,
    readings: BTreeMap<Atom, Lit>,
    commands: BTreeMap<OutputId, Lit>,
    integers: BTreeMap<IntegerId, Vector>,
    /// What each leaf of the graph is.
    leaves: Vec<Leaf>,
    /// No assumption is broken.
    allowed: Lit,
}

#[derive(Clone, Copy, Debug)]
enum Leaf {
    Reading(Atom),
    Command(OutputId),
    /// A bit of an integer, which is seen by its comparisons only.
    Integer,
}

/// A case in which something happens: what has to be read and commanded for it, and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Witness {
    /// What is read, with its value.
    pub readings: Vec<(Atom, bool)>,
    /// What is commanded, with its value.
    pub commands: Vec<(OutputId, bool)>,
}

impl Witness {
    /// In the words of the model.
    pub fn show(&self, machine: &Machine) -> String {
        let commands: Vec<_> = self.commands.iter().map(|&(o, value)| (Atom::Output(o), value)).collect();
        let commanded = if commands.is_empty() {
            String::new()
        } else {
            format!("{} commanded", words::literals(machine, &commands))
        };
        match (self.readings.is_empty(), commands.is_empty()) {
            (false, true) => words::literals(machine, &self.readings),
            (false, false) => format!("{}, with {commanded}", words::literals(machine, &self.readings)),
            (true, false) => format!("whatever is read, with {commanded}"),
            (true, true) => "always".to_owned(),
        }
    }
}

/// What came of a question.
pub enum Found {
    /// It cannot be.
    Never,
    /// It can, as under this assignment.
    Can(Model),
    /// The solver gave up, which is to be taken as if it could be.
    Open,
}

impl<'m> Questions<'m> {
    /// No question asked yet.
    pub fn new(machine: &'m Machine) -> Self {
        let mut questions = Questions {
            machine,
            aig: Aig::new(),
            sat: Sat::new(),
            readings: BTreeMap::new(),
            commands: BTreeMap::new(),
            integers: BTreeMap::new(),
            leaves: Vec::new(),
            allowed: Lit::TRUE,
        };
        let mut assumed: Vec<Lit> =
            machine.safety.assumptions.iter().flat_map(|a| &a.products).map(|p| !questions.condition(p)).collect();
        assumed.extend(questions.configurations());
        // What is read has said already what goes together.
        let assumed = questions.aig.all(&assumed);
        questions.allowed = questions.aig.and(questions.allowed, assumed);
        questions
    }

    /// Of each region with a state that is read, and of those around it, that one state is active if the
    /// region is, else none.
    fn configurations(&mut self) -> Vec<Lit> {
        let machine = self.machine;
        let safety = &machine.safety;
        let products = safety.constraints.values().flat_map(|c| &c.products);
        let products = products.chain(safety.assumptions.iter().flat_map(|a| &a.products));
        let mut regions = BTreeSet::new();
        for literal in products.flat_map(|p| p.literals()) {
            if let Atom::In(state) = literal.atom {
                regions.extend(machine.ancestors(state).map(|s| machine.states[s].region));
            }
        }
        let mut hold = Vec::new();
        for region in regions.into_iter().map(|r| &machine.regions[r]) {
            let states: Vec<Lit> = region.states.iter().map(|&s| self.reading(Atom::In(s))).collect();
            let active = region.parent.map_or(Lit::TRUE, |p| self.reading(Atom::In(p)));
            let (some, two) = (self.aig.any(&states), self.aig.two_or_more(&states));
            hold.extend([self.aig.equal(some, active), !two]);
        }
        hold
    }

    /// Whether nothing is assumed.
    pub fn nothing_assumed(&self) -> bool {
        self.allowed == Lit::TRUE
    }

    /// The bit of something that is read.
    pub fn reading(&mut self, atom: Atom) -> Lit {
        if let Some(&known) = self.readings.get(&atom) {
            return known;
        }
        self.leaves.push(Leaf::Reading(atom));
        let leaf = self.aig.leaf("");
        self.readings.insert(atom, leaf);
        if let Atom::Compare(comparison) = atom {
            let holds = self.comparison(comparison);
            let fits = self.aig.equal(leaf, holds);
            self.allowed = self.aig.and(self.allowed, fits);
        }
        leaf
    }

    /// What a comparison makes of its integers.
    fn comparison(&mut self, comparison: ComparisonId) -> Lit {
        let Comparison { left, relation, right } = &self.machine.comparisons[comparison];
        let (left, right) = (self.number(left), self.number(right));
        let less = vector::less(&mut self.aig, &left, &right);
        let equal = vector::equal(&mut self.aig, &left, &right);
        let at_most = self.aig.or(less, equal);
        match relation {
            Relation::Equal => equal,
            Relation::Unequal => !equal,
            Relation::Less => less,
            Relation::LessOrEqual => at_most,
            Relation::Greater => !at_most,
            Relation::GreaterOrEqual => !less,
        }
    }

    fn number(&mut self, number: &Number<IntegerId>) -> Vector {
        match number {
            Number::Const(n) => vector::constant(*n),
            Number::Value(i) => self.integer(*i),
            Number::Sum(operands) => operands.iter().fold(vector::constant(0), |sum, operand| {
                let value = self.number(&operand.value);
                if operand.negative {
                    vector::subtract(&mut self.aig, &sum, &value)
                } else {
                    vector::add(&mut self.aig, &sum, &value)
                }
            }),
        }
    }

    /// The bits of an integer, which is within its range.
    fn integer(&mut self, id: IntegerId) -> Vector {
        if let Some(known) = self.integers.get(&id) {
            return known.clone();
        }
        let Range { lowest, highest } = self.machine.integers[id].range;
        let (lowest, highest) = (vector::constant(lowest), vector::constant(highest));
        let width = lowest.len().max(highest.len());
        self.leaves.extend((0..width).map(|_| Leaf::Integer));
        let value: Vector = (0..width).map(|_| self.aig.leaf("")).collect();
        let below = vector::less(&mut self.aig, &value, &lowest);
        let above = vector::less(&mut self.aig, &highest, &value);
        let beyond = self.aig.or(below, above);
        self.allowed = self.aig.and(self.allowed, !beyond);
        self.integers.insert(id, value.clone());
        value
    }

    /// The bit of an output's command.
    pub fn command(&mut self, output: OutputId) -> Lit {
        let (aig, leaves) = (&mut self.aig, &mut self.leaves);
        *self.commands.entry(output).or_insert_with(|| {
            leaves.push(Leaf::Command(output));
            aig.leaf("")
        })
    }

    /// A product, in which `output` says what outputs of this scan are.
    pub fn product(&mut self, product: &Product<Atom>, output: &mut impl FnMut(&mut Self, OutputId) -> Lit) -> Lit {
        let literals: Vec<Lit> = product
            .literals()
            .iter()
            .map(|l| {
                let value = match l.atom {
                    Atom::Output(o) => output(self, o),
                    other => self.reading(other),
                };
                value.xor(l.negated)
            })
            .collect();
        self.aig.all(&literals)
    }

    /// A product that names no output of this scan.
    pub fn condition(&mut self, product: &Product<Atom>) -> Lit {
        self.product(product, &mut |_, output| unreachable!("{output:?} is decided in this scan"))
    }

    /// Whether `goals` can all be TRUE while no assumption is broken.
    pub fn ask(&mut self, goals: &[Lit]) -> Found {
        let goals: Vec<Lit> = goals.iter().copied().chain([self.allowed]).collect();
        match self.sat.ask(&self.aig, &goals, Budget::PROOF) {
            Answer::Never => Found::Never,
            Answer::Sometimes(model) => Found::Can(model),
            Answer::GaveUp => Found::Open,
        }
    }

    /// After [`Found::Never`]: whether this goal is among those that exclude each other already.
    pub fn was_needed(&self, goal: Lit) -> bool {
        self.sat.was_needed(goal)
    }

    /// What of an assignment already makes `goal` TRUE: what is left open may be anything.
    pub fn witness(&mut self, model: &Model, goal: Lit) -> Witness {
        let leaves: Vec<Lit> = self.aig.leaves().collect();
        let mut chosen: Vec<Lit> = model.iter().map(|(leaf, value)| leaves[leaf as usize].xor(!value)).collect();
        // With all of it the goal cannot be FALSE; what that does not rest on is dropped, while it helps.
        let all = self.aig.and(goal, self.allowed);
        while let Answer::Never =
            self.sat.ask(&self.aig, &chosen.iter().copied().chain([!all]).collect::<Vec<_>>(), Budget::ATTEMPT)
        {
            let needed: Vec<Lit> = chosen.iter().copied().filter(|&l| self.sat.was_needed(l)).collect();
            if needed.len() == chosen.len() {
                break;
            }
            chosen = needed;
        }
        let mut witness = Witness::default();
        for (lit, leaf) in leaves.iter().zip(&self.leaves) {
            for value in chosen.iter().filter(|l| l.node() == lit.node()).map(|l| !l.is_negated()) {
                match *leaf {
                    Leaf::Reading(atom) => witness.readings.push((atom, value)),
                    Leaf::Command(output) => witness.commands.push((output, value)),
                    Leaf::Integer => {}
                }
            }
        }
        witness.readings.sort_by_key(|&(atom, _)| order(atom));
        witness.commands.sort();
        witness
    }

    /// The machine that is asked about.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }
}

/// Inputs before outputs, each beside its value of the scan before.
fn order(atom: Atom) -> (u8, usize, Atom) {
    match atom {
        Atom::Input(i) | Atom::PrevInput(i) => (0, i.index(), atom),
        Atom::PrevOutput(o) | Atom::Output(o) => (1, o.index(), atom),
        _ => (2, 0, atom),
    }
}
