//! Invariants of a chart that say that some configurations cannot be reached.
//!
//! An induction over single scans has to hold from every configuration, even from those that never
//! occur. Where it fails from one, this looks for a reason why that one never occurs: a few facts of
//! it that are never true together. Such a lemma is proved by induction itself, with the help of those
//! found before; where that fails from yet another configuration, this one is treated first (Bradley
//! and Manna, 2007: inductive strengthening by counterexamples to induction).

use super::chart_step::{ChartScan, ChartState};
use super::configuration;
use super::matching::Pair;
use crate::bits::aig::{Aig, Lit, lanes};
use crate::bits::sat::{Answer, Budget, Model, Sat};

/// Facts about what a chart remembers, as indices into [`ChartState::bits`] and values.
pub type Facts = Vec<(usize, bool)>;

/// How far one configuration is followed back.
const DEPTH: usize = 12;

/// Questions that may be asked in all.
const QUESTIONS: usize = 6_000;

/// A search for lemmas about one machine.
pub struct Lemmas<'a> {
    pair: Pair<'a>,
    /// Any scan.
    aig: Aig,
    before: Vec<Lit>,
    /// Inputs, and whether times have passed.
    given: Vec<Lit>,
    after: Vec<Lit>,
    /// The first scan.
    first: Aig,
    start: Vec<Lit>,
    /// What is never true together.
    never: Vec<Facts>,
    /// For each of them, that it is not true before the scan.
    known: Vec<Lit>,
    later: Sat,
    initial: Sat,
    questions: usize,
}

impl<'a> Lemmas<'a> {
    /// None yet.
    pub fn new(pair: Pair<'a>) -> Self {
        let mut aig = Aig::new();
        let state = configuration::any(&mut aig, pair.machine, pair.chart);
        let inputs: Vec<Lit> = pair.machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let clocks: Vec<Lit> = pair.chart.timers().map(|_| aig.leaf("time")).collect();
        let ChartScan { after, .. } = pair.chart.scan(&mut aig, &state, &inputs, &clocks);
        let mut first = Aig::new();
        let sampled: Vec<Lit> = pair.machine.inputs.values().map(|i| first.leaf(&i.name)).collect();
        let start = pair.chart.first(&mut first, &sampled).after.bits();
        Lemmas {
            pair,
            aig,
            before: state.bits(),
            given: inputs.into_iter().chain(clocks).collect(),
            after: after.bits(),
            first,
            start,
            never: Vec::new(),
            known: Vec::new(),
            later: Sat::new(),
            initial: Sat::new(),
            questions: 0,
        }
    }

    /// What is known to be never true together.
    pub fn never(&self) -> &[Facts] {
        &self.never
    }

    /// That all lemmas hold of `state`.
    pub fn hold(&self, aig: &mut Aig, state: &ChartState) -> Lit {
        let bits = state.bits();
        let each: Vec<Lit> = self.never.iter().map(|facts| !all(aig, &bits, facts)).collect();
        aig.all(&each)
    }

    /// Looks for a lemma that excludes what a chart remembers; says whether there is one now.
    pub fn exclude(&mut self, memory: &[bool]) -> bool {
        // Mostly it is the states alone that do not go together.
        let states = self.pair.machine.states.len();
        let active = memory[..states].iter().enumerate().filter(|(_, value)| **value).map(|(i, _)| (i, true));
        let rest = memory.iter().copied().enumerate().skip(states);
        let whole: Facts = active.clone().chain(rest).collect();
        self.block(&active.collect(), DEPTH) || self.block(&whole, DEPTH)
    }

    fn block(&mut self, facts: &Facts, depth: usize) -> bool {
        loop {
            if self.questions > QUESTIONS || self.may_start(facts) {
                return false;
            }
            match self.predecessor(facts) {
                None => return false,
                Some(Ok(core)) => {
                    let lemma = if self.may_start(&core) { facts.clone() } else { core };
                    let lemma = self.generalise(lemma);
                    // What a lemma excludes nobody looks at again: a fresh solver has to agree.
                    self.later.forget();
                    self.initial.forget();
                    if self.may_start(&lemma) || !matches!(self.predecessor(&lemma), Some(Ok(_))) {
                        return false;
                    }
                    let lit = !all(&mut self.aig, &self.before, &lemma);
                    self.known.push(lit);
                    self.never.push(lemma);
                    return true;
                }
                // Where it comes from has to be excluded first.
                Some(Err(before)) => {
                    if depth == 0 || !self.block(&before, depth - 1) {
                        return false;
                    }
                }
            }
        }
    }

    /// Whether all of it can be true after the first scan.
    fn may_start(&mut self, facts: &Facts) -> bool {
        self.questions += 1;
        let goals: Vec<Lit> = facts.iter().map(|&(i, value)| self.start[i].xor(!value)).collect();
        !matches!(self.initial.ask(&self.first, &goals, Budget::ATTEMPT), Answer::Never)
    }

    /// What leads in one scan to all of `facts` where they do not hold already; if nothing does, those of
    /// the facts that are reason enough: they make a lemma, too, since they are not reached from where
    /// they do not hold already. Nothing if the solver gave up.
    fn predecessor(&mut self, facts: &Facts) -> Option<Result<Facts, Facts>> {
        self.questions += 1;
        let not_yet = !all(&mut self.aig, &self.before, facts);
        let then: Vec<Lit> = facts.iter().map(|&(i, value)| self.after[i].xor(!value)).collect();
        let goals: Vec<Lit> = self.known.iter().copied().chain([not_yet]).chain(then.iter().copied()).collect();
        match self.later.ask(&self.aig, &goals, Budget::ATTEMPT) {
            Answer::Never => {
                let core = facts.iter().zip(&then).filter(|(_, l)| self.later.was_needed(**l));
                Some(Ok(core.map(|(&fact, _)| fact).collect()))
            }
            Answer::Sometimes(model) => Some(Err(self.reason(&model, &then))),
            Answer::GaveUp => None,
        }
    }

    /// Those facts before the scan that suffice, with the same inputs, for all of `then`.
    fn reason(&mut self, model: &Model, then: &[Lit]) -> Facts {
        let values = model.evaluate(&self.aig);
        let value = |l: Lit| lanes(&values, l) & 1 == 1;
        let states = self.pair.machine.states.len();
        let all = self.before.iter().map(|&l| value(l)).enumerate();
        let facts: Facts = all.filter(|&(i, value)| i >= states || value).collect();
        let of_facts: Vec<Lit> = facts.iter().map(|&(i, value)| self.before[i].xor(!value)).collect();
        let given: Vec<Lit> = self.given.iter().map(|&l| l.xor(!value(l))).collect();
        let otherwise = !self.aig.all(then);
        let goals: Vec<Lit> = of_facts.iter().copied().chain(given).chain([otherwise]).collect();
        self.questions += 1;
        match self.later.ask(&self.aig, &goals, Budget::ATTEMPT) {
            Answer::Never => {
                let needed = facts.iter().zip(&of_facts).filter(|(_, l)| self.later.was_needed(**l));
                needed.map(|(&fact, _)| fact).collect()
            }
            Answer::Sometimes(_) | Answer::GaveUp => facts,
        }
    }

    /// Leaves out what the lemma can do without: the less it says, the more it excludes.
    fn generalise(&mut self, facts: Facts) -> Facts {
        let states = self.pair.machine.states.len();
        // Signals first, states last, of these the outer ones last: they are implied by the inner ones.
        let depth =
            |i: usize| if i < states { self.pair.machine.states.values().nth(i).map(|s| s.depth) } else { None };
        let mut order: Vec<(usize, bool)> = facts.clone();
        order.sort_by_key(|&(i, _)| (i < states, std::cmp::Reverse(depth(i)), std::cmp::Reverse(i)));
        let mut kept = facts;
        for fact in order {
            if kept.len() == 1 || !kept.contains(&fact) {
                continue;
            }
            let fewer: Facts = kept.iter().copied().filter(|f| *f != fact).collect();
            if !self.may_start(&fewer)
                && let Some(Ok(core)) = self.predecessor(&fewer)
            {
                kept = if self.may_start(&core) { fewer } else { core };
            }
        }
        kept
    }
}

fn all(aig: &mut Aig, bits: &[Lit], facts: &Facts) -> Lit {
    let lits: Vec<Lit> = facts.iter().map(|&(i, value)| bits[i].xor(!value)).collect();
    aig.all(&lits)
}
