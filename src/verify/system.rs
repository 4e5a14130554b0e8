//! A machine as bits: memory, what comes in, and what is claimed about both.
//!
//! A run is a sequence of scans. The first scan begins with the latches at their initial values, where
//! they have one; in each scan all inputs take any values under which the constraints hold, and the
//! next scan begins with the latches' next values. This is the meaning of AIGER 1.9 (Biere, Heljanko,
//! Wieringa, 2011), so a system can be written for other tools and come to the same verdicts.

use super::aig::{Aig, Lit, Node};

/// A transition system over the nodes of one graph.
///
/// All leaves of the graph that matter are leaves of latches or of inputs.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// The graph that all literals belong to.
    pub aig: Aig,
    /// What is remembered from scan to scan, in an order in which neighbours belong together.
    pub latches: Vec<Latch>,
    /// What comes in anew in each scan.
    pub inputs: Vec<Input>,
    /// What holds in each scan.
    pub constraints: Vec<Lit>,
    /// What is TRUE in infinitely many scans of those runs of which [`Property::Eventually`] is claimed, and of
    /// no others.
    pub fair: Vec<Fairness>,
    /// What is claimed, in order of declaration.
    pub claims: Vec<Claim>,
    /// What a scan may be, if there are several kinds of which each touches little: each scan is exactly one of these. An engine may look
    /// at each by itself.
    pub alternatives: Vec<Alternative>,
    /// What, beside claims, tells apart states from which to go on by chance.
    pub notable: Vec<Lit>,
    /// Numbers that are remembered, as they are after a scan, lowest bit first and the sign last. Far ways lead along them.
    pub numbers: Vec<Vec<Lit>>,
}

/// One of the kinds of scans that there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alternative {
    /// Whether the scan is of this kind.
    pub is: Lit,
    /// When it can be: a function of latches.
    pub when: Lit,
    /// The values of inputs that make it so where it can be. They matter to nothing but which kind it is.
    pub choice: Vec<(Lit, bool)>,
}

/// Something that comes again and again in a run that is called fair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fairness {
    /// How it is called in other tools.
    pub name: String,
    /// When it has come.
    pub holds: Lit,
}

/// One bit of memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latch {
    /// Its value when a scan begins: a leaf, not negated.
    pub leaf: Lit,
    /// Its value when the first scan begins; nothing if it can be either.
    pub initial: Option<bool>,
    /// Its value when the next scan begins.
    pub next: Lit,
}

/// One bit that comes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its value in a scan: a leaf, not negated.
    pub leaf: Lit,
    /// Who chooses it.
    pub giver: Giver,
}

/// Who chooses the value of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Giver {
    /// Persons and neighbouring machines.
    Operator,
    /// The machine's own parts.
    Plant,
    /// A program of which nothing is known.
    Controller,
    /// The course of time.
    Clock,
    /// How long nothing happens but that time passes, bit by bit, the lowest first.
    Wait,
}

/// Something that is said of all runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// How it is called in reports and other tools.
    pub name: String,
    /// What it says.
    pub property: Property,
}

/// What a claim says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// The literal is TRUE in no scan of any run.
    Never(Lit),
    /// Every run can be continued to a scan in which the literal is TRUE: AG EF of branching time logic.
    AlwaysPossible(Lit),
    /// Every run can be continued by one more scan.
    NeverStuck,
    /// In every infinite run that is fair, each scan in which `after` is TRUE is one in which `then` is, or is followed
    /// by one. A run that cannot go on is no infinite one.
    Eventually {
        /// What has to be answered.
        after: Lit,
        /// The answer.
        then: Lit,
    },
}

impl Property {
    /// All that it speaks of.
    pub fn literals(self) -> Vec<Lit> {
        match self {
            Property::Never(l) | Property::AlwaysPossible(l) => vec![l],
            Property::NeverStuck => Vec::new(),
            Property::Eventually { after, then } => vec![after, then],
        }
    }

    /// What never may be, if it says so.
    pub fn never(self) -> Option<Lit> {
        if let Property::Never(bad) = self { Some(bad) } else { None }
    }
}

/// A run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trace {
    /// The latches when the first scan begins.
    pub initial: Vec<bool>,
    /// The inputs of each scan. A run that shows what cannot come any more may have no scan at all.
    pub inputs: Vec<Vec<bool>>,
    /// Whether no shorter run shows the same.
    pub shortest: bool,
}

impl System {
    /// A new latch; its next value is to be set later, and FALSE until then.
    pub fn latch(&mut self, name: impl Into<String>, initial: Option<bool>) -> Lit {
        let leaf = self.aig.leaf(name);
        self.latches.push(Latch { leaf, initial, next: Lit::FALSE });
        leaf
    }

    /// A new input.
    pub fn input(&mut self, name: impl Into<String>, giver: Giver) -> Lit {
        let leaf = self.aig.leaf(name);
        self.inputs.push(Input { leaf, giver });
        leaf
    }

    /// A new claim.
    pub fn claim(&mut self, name: impl Into<String>, property: Property) {
        self.claims.push(Claim { name: name.into(), property });
    }

    /// A new fairness.
    pub fn fairness(&mut self, name: impl Into<String>, holds: Lit) {
        self.fair.push(Fairness { name: name.into(), holds });
    }

    /// The name of a leaf.
    pub fn name(&self, leaf: Lit) -> &str {
        self.aig.name(self.aig.number(leaf) as u32)
    }

    /// All that says whether a run is fair and `then` comes `after`.
    pub fn roots_of(&self, after: Lit, then: Lit) -> Vec<Lit> {
        let fair = self.fair.iter().map(|f| f.holds);
        self.constraints.iter().copied().chain(fair).chain([after, then]).collect()
    }

    /// Every node's value in a scan, in all lanes alike.
    pub fn evaluate(&self, latches: &[bool], inputs: &[bool]) -> Vec<u64> {
        let words = |values: &[bool]| values.iter().map(|&value| if value { u64::MAX } else { 0 }).collect::<Vec<_>>();
        self.lanes(&words(latches), &words(inputs))
    }

    /// Every node's values in the scans of 64 runs at once.
    pub fn lanes(&self, latches: &[u64], inputs: &[u64]) -> Vec<u64> {
        let mut words = vec![0; self.aig.leaves().len()];
        self.latches.iter().zip(latches).for_each(|(l, &word)| words[self.aig.number(l.leaf)] = word);
        self.inputs.iter().zip(inputs).for_each(|(i, &word)| words[self.aig.number(i.leaf)] = word);
        let mut values = Vec::new();
        self.aig.simulate(&words, &mut values);
        values
    }

    /// The indices of those latches and inputs on which the literals depend, in this scan or through
    /// latches in earlier ones.
    pub fn cone(&self, roots: &[Lit]) -> (Vec<usize>, Vec<usize>) {
        let mut in_cone = vec![false; self.aig.len()];
        let mut latch_of = vec![usize::MAX; self.aig.len()];
        self.latches.iter().enumerate().for_each(|(i, l)| latch_of[l.leaf.node()] = i);
        let mut open: Vec<usize> = roots.iter().map(|l| l.node()).collect();
        while let Some(n) = open.pop() {
            if std::mem::replace(&mut in_cone[n], true) {
                continue;
            }
            match self.aig.node(n) {
                Node::And(a, b) => open.extend([a.node(), b.node()]),
                Node::Leaf(_) if latch_of[n] != usize::MAX => open.push(self.latches[latch_of[n]].next.node()),
                Node::Leaf(_) | Node::False => {}
            }
        }
        let latches = (0..self.latches.len()).filter(|&i| in_cone[self.latches[i].leaf.node()]).collect();
        let inputs = (0..self.inputs.len()).filter(|&i| in_cone[self.inputs[i].leaf.node()]).collect();
        (latches, inputs)
    }
}
