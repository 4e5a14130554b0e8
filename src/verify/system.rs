//! A machine as bits: memory, what comes in, and what is claimed about both.
//!
//! A run is a sequence of scans. The first scan begins with the latches at their initial values, where
//! they have one; in each scan all inputs take any values under which the constraints hold, and the
//! next scan begins with the latches' next values. This is the meaning of AIGER 1.9 (Biere, Heljanko,
//! Wieringa, 2011), so a system can be written for other tools and come to the same verdicts.

use super::aig::{Aig, Lit, Node, lanes};

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

/// What a run does, scan by scan.
pub struct Replay {
    /// For each scan, the words of [`Aig::simulate`]; a value is in lane 0.
    pub values: Vec<Vec<u64>>,
    /// The latches when the last scan has ended.
    pub last: Vec<bool>,
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

    /// What a run does; nothing if it breaks a constraint or begins with a wrong value.
    pub fn replay(&self, trace: &Trace) -> Option<Replay> {
        let initial_fits =
            self.latches.iter().zip(&trace.initial).all(|(l, &value)| l.initial.is_none_or(|i| i == value));
        if !initial_fits || trace.initial.len() != self.latches.len() {
            return None;
        }
        let mut replay = Replay { values: Vec::new(), last: trace.initial.clone() };
        for inputs in &trace.inputs {
            let values = self.evaluate(&replay.last, inputs);
            if self.constraints.iter().any(|&c| lanes(&values, c) & 1 == 0) {
                return None;
            }
            replay.last = self.latches.iter().map(|l| lanes(&values, l.next) & 1 == 1).collect();
            replay.values.push(values);
        }
        Some(replay)
    }

    /// Whether the run is one and, for what never must be, its last scan shows it; for what comes eventually, it
    /// ends in a loop that shows that it does not.
    pub fn shows(&self, trace: &Trace, property: Property) -> bool {
        self.replay(trace).is_some_and(|replay| match property {
            Property::Never(bad) => replay.values.last().is_some_and(|values| lanes(values, bad) & 1 == 1),
            Property::AlwaysPossible(_) | Property::NeverStuck => true,
            Property::Eventually { after, then } => self.loop_in(&replay, after, then).is_some(),
        })
    }

    /// In a run that shows that `then` need not come `after`, the scan, counted from 0, from which on it can
    /// repeat itself for ever: all that matters is as it was when that scan began.
    pub fn repeats(&self, trace: &Trace, property: Property) -> Option<usize> {
        let Property::Eventually { after, then } = property else { return None };
        self.loop_in(&self.replay(trace)?, after, then)
    }

    fn loop_in(&self, replay: &Replay, after: Lit, then: Lit) -> Option<usize> {
        let scans = &replay.values;
        let is = |scan: usize, l: Lit| lanes(&scans[scan], l) & 1 == 1;
        // What was asked after the last answer, or ever, is still open at the end.
        let open = (0..scans.len()).rev().find(|&scan| is(scan, then)).map_or(0, |answer| answer + 1);
        if !(open..scans.len()).any(|scan| is(scan, after)) {
            return None;
        }
        let (latches, _) = self.cone(&self.roots_of(after, then));
        // The shortest loop that will do.
        (open..scans.len()).rev().find(|&begin| {
            let same = |&l: &usize| is(begin, self.latches[l].leaf) == replay.last[l];
            let comes = |f: &Fairness| (begin..scans.len()).any(|scan| is(scan, f.holds));
            self.fair.iter().all(comes) && latches.iter().all(same)
        })
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

    /// The same run with as few changes of inputs as can be found by trying: each input keeps its value from
    /// the scan before where the run still shows the same. A calm run is easier to read.
    pub fn calm(&self, trace: &Trace, property: Property) -> Trace {
        let mut calm = trace.clone();
        if matches!(property, Property::AlwaysPossible(_) | Property::NeverStuck) {
            return calm;
        }
        // Whole inputs first, then shorter and shorter stretches.
        let mut stretch = calm.inputs.len();
        while stretch > 0 {
            for input in 0..self.inputs.len() {
                for start in (0..calm.inputs.len()).step_by(stretch) {
                    let value = start > 0 && calm.inputs[start - 1][input];
                    let end = (start + stretch).min(calm.inputs.len());
                    if (start..end).all(|scan| calm.inputs[scan][input] == value) {
                        continue;
                    }
                    let mut tried = calm.clone();
                    (start..end).for_each(|scan| tried.inputs[scan][input] = value);
                    if self.changes(&tried, input) < self.changes(&calm, input) && self.shows(&tried, property) {
                        calm = tried;
                    }
                }
            }
            stretch /= 2;
        }
        calm
    }

    /// How often an input changes in a run; TRUE in the first scan is a change.
    fn changes(&self, trace: &Trace, input: usize) -> usize {
        let mut before = false;
        let mut count = 0;
        for scan in &trace.inputs {
            count += usize::from(scan[input] != before);
            before = scan[input];
        }
        count
    }
}
