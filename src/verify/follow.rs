//! A run of a system that does more than another one to a run of the other one that does the same, if one is found.
//!
//! It goes along the run and gives the same inputs. Where something has not come as far as it has there, it waits: nothing else comes in
//! until it has, in [leaps](super::machine::clocks) where it can. What it finds is a run by itself; that it finds none tells nothing.

use super::aig::{Lit, Node, lanes};
use super::limits::Stop;
use super::system::{Giver, System, Trace};
use std::collections::HashMap;

/// Waits for one thing to come.
const PATIENCE: usize = 400;

/// The same where not all has to come.
const MOMENT: usize = 40;

/// Waits at the end, for what shows only then.
const AFTER: usize = 40;

/// What the lanes of one evaluation hold: the next inputs, those from before or the next ones while time passes, and how long.
const LANES: usize = 64;

/// A run that has been found.
pub struct Found {
    /// What it shows in its last scan, by index.
    pub bad: usize,
    /// The run.
    pub trace: Trace,
}

/// Runs of `fine` that end with one of the `bads`, along a run of `coarse`, which has latches and inputs of the same names. It ends when
/// the first one of them has shown.
pub fn follow(coarse: &System, fine: &System, trace: &Trace, bads: &[Lit], stop: Stop<'_>) -> Vec<Found> {
    let Some(along) = Along::new(coarse, fine, trace, bads) else { return Vec::new() };
    let mut found = Vec::new();
    for close in [true, false] {
        let left = if close { 20 } else { 2 } * trace.inputs.len() + PATIENCE;
        let (state, values, inputs) = (along.initial.clone(), Vec::new(), Vec::new());
        let mut walk = Walk { along: &along, close, state, values, inputs, bads, found, left, stop };
        walk.go();
        found = walk.found;
        if found.iter().any(|f| f.bad == 0) {
            break;
        }
    }
    found
}

/// A run on its way.
struct Walk<'a, 's> {
    along: &'a Along<'s>,
    /// Whether all that is remembered has to be as it is along the other run, and not only what changes there.
    close: bool,
    state: Vec<bool>,
    values: Vec<u64>,
    inputs: Vec<Vec<bool>>,
    bads: &'a [Lit],
    found: Vec<Found>,
    /// How many scans, or leaps, it may still try.
    left: usize,
    stop: Stop<'a>,
}

struct Along<'s> {
    fine: &'s System,
    initial: Vec<bool>,
    /// The inputs of each step, in the order of the fine system.
    inputs: Vec<Vec<bool>>,
    /// For each step, what is remembered after it of what both remember.
    wanted: Vec<Vec<bool>>,
    /// The latches that both have.
    common: Vec<usize>,
    /// The input that says that time passes.
    leap: Option<usize>,
    /// That one and those that say how long, each with the lanes in which it is TRUE.
    leaps: Vec<(usize, u64)>,
    /// What is evaluated.
    cone: Vec<usize>,
}

impl<'s> Along<'s> {
    fn new(coarse: &System, fine: &'s System, trace: &Trace, bads: &[Lit]) -> Option<Along<'s>> {
        let latches: HashMap<&str, usize> =
            coarse.latches.iter().enumerate().map(|(i, l)| (coarse.name(l.leaf), i)).collect();
        let inputs: HashMap<&str, usize> =
            coarse.inputs.iter().enumerate().map(|(i, l)| (coarse.name(l.leaf), i)).collect();
        let latch = |leaf| latches.get(fine.name(leaf)).copied();
        let begins = fine.latches.iter().map(|l| {
            let there = latch(l.leaf).is_some_and(|i| trace.initial[i]);
            l.initial.unwrap_or(there)
        });
        // Active states and the like: what matters to people has a name that both share.
        let named = |l: &usize| fine.name(fine.latches[*l].leaf).starts_with("in(");
        let common: Vec<usize> =
            (0..fine.latches.len()).filter(named).filter(|&l| latch(fine.latches[l].leaf).is_some()).collect();
        let there: Vec<Lit> =
            common.iter().map(|&l| coarse.latches[latch(fine.latches[l].leaf).expect("it is there")].next).collect();
        let mut wanted: Vec<Vec<bool>> = Vec::new();
        let mut each = |values: &[u64]| wanted.push(there.iter().map(|&l| lanes(values, l) & 1 == 1).collect());
        coarse.replay(trace, &mut each).ok()?;
        let from: Vec<Option<usize>> = fine.inputs.iter().map(|i| inputs.get(fine.name(i.leaf)).copied()).collect();
        let given = trace.inputs.iter().map(|scan| from.iter().map(|i| i.is_some_and(|i| scan[i])).collect());
        let of = |giver| (0..fine.inputs.len()).filter(move |&i| fine.inputs[i].giver == giver);
        let waits: Vec<usize> = of(Giver::Wait).collect();
        // Where times are exact the clock says nothing else.
        let leap = of(Giver::Clock).next().filter(|_| !waits.is_empty());
        let lanes = |is: &dyn Fn(u64) -> bool| {
            (1..LANES).filter(|&lane| passes(lane).is_some_and(is)).fold(0, |word, lane| word | 1 << lane)
        };
        let bits = waits.iter().enumerate().map(|(i, &input)| (input, lanes(&|scans| scans >> i & 1 == 1)));
        let leaps = leap.iter().map(|&input| (input, lanes(&|_| true))).chain(bits).collect();
        let nexts = fine.latches.iter().map(|l| l.next);
        let roots: Vec<Lit> = fine.constraints.iter().copied().chain(nexts).chain(bads.iter().copied()).collect();
        let cone = fine.aig.cone(&roots);
        let (initial, inputs) = (begins.collect(), given.collect());
        Some(Along { fine, initial, inputs, wanted, common, leap, leaps, cone })
    }

    /// The words of the inputs: with the next ones as they are given in the first lane, with those from before in the rest of the
    /// first half and with the next ones in the second half, where time passes for longer and longer from lane to lane.
    fn words(&self, before: &[bool], next: &[bool]) -> Vec<u64> {
        let second = u64::MAX << (LANES / 2);
        let first = !second & !1;
        let word = |value: bool, lanes: u64| if value { lanes } else { 0 };
        let mut words: Vec<u64> =
            before.iter().zip(next).map(|(&was, &is)| word(was, first) | word(is, second | 1)).collect();
        for &(input, leaps) in &self.leaps {
            words[input] = word(next[input], 1) | leaps;
        }
        words
    }

    /// One lane of such words.
    fn lane(words: &[u64], lane: usize) -> Vec<bool> {
        words.iter().map(|word| word >> lane & 1 == 1).collect()
    }

    /// The values of all nodes that matter, with these words of the inputs.
    fn evaluate(&self, state: &[bool], words: &[u64], values: &mut Vec<u64>) {
        let fine = self.fine;
        values.resize(fine.aig.len(), 0);
        for (l, &value) in fine.latches.iter().zip(state) {
            values[l.leaf.node()] = if value { u64::MAX } else { 0 };
        }
        fine.inputs.iter().zip(words).for_each(|(i, &word)| values[i.leaf.node()] = word);
        for &n in &self.cone {
            if let Node::And(a, b) = fine.aig.node(n) {
                values[n] = lanes(values, a) & lanes(values, b);
            }
        }
    }
}

/// How long time passes in a lane beside the first scan: 1, 2, 3, 4, 6, 8, 12, 16, … in each half; nothing in its first two.
fn passes(lane: usize) -> Option<u64> {
    let leaps = lane % (LANES / 2);
    let step = leaps.checked_sub(1).filter(|&step| step > 0)?;
    let (power, more) = (step / 2, step % 2);
    Some(if power == 0 { 1 } else { (2 + more as u64) << (power - 1) })
}

impl Walk<'_, '_> {
    /// Goes along the run. Ends when the first of what is looked for has shown, or it does not get on.
    fn go(&mut self) {
        let none = vec![false; self.along.fine.inputs.len()];
        for step in 0..self.along.inputs.len() {
            let before = step.checked_sub(1).map_or(&none, |i| &self.along.inputs[i]);
            let patience = self.left.min(if self.close { PATIENCE } else { MOMENT });
            if !self.step(before, &self.along.inputs[step], Some(step), patience) || self.left == 0 {
                return;
            }
        }
        let last = self.along.inputs.last().unwrap_or(&none);
        self.step(last, last, None, AFTER);
    }

    /// Goes on until what the other run remembers after that step is remembered, with the inputs from `before` until it can be, and
    /// then with the `next` ones. Says whether to go on.
    fn step(&mut self, before: &[bool], next: &[bool], step: Option<usize>, patience: usize) -> bool {
        let fine = self.along.fine;
        for _ in 0..patience {
            if (self.stop)() {
                return false;
            }
            self.left = self.left.saturating_sub(1);
            let words = self.along.words(before, next);
            self.along.evaluate(&self.state, &words, &mut self.values);
            let word = |l: Lit| lanes(&self.values, l);
            let valid = fine.constraints.iter().fold(u64::MAX, |all, &c| all & word(c));
            let shows = valid & word(self.bads[0]);
            let after = |lane: usize, l: usize| word(fine.latches[l].next) >> lane & 1 == 1;
            let changes = |l: usize| word(fine.latches[l].next) ^ if self.state[l] { u64::MAX } else { 0 };
            // A leap that goes too far here is none.
            let given = if valid & 1 == 0 && self.along.leap.is_some_and(|leap| next[leap]) { LANES / 2 } else { 0 };
            let is_wanted = |step: usize| {
                let wanted = &self.along.wanted[step];
                let was = |i: usize| step > 0 && self.along.wanted[step - 1][i];
                let counts = |i: &usize| self.close || wanted[*i] != was(*i);
                (0..wanted.len()).filter(counts).all(|i| after(given, self.along.common[i]) == wanted[i])
            };
            let there = step.is_some_and(|step| valid >> given & 1 == 1 && is_wanted(step));
            let moves = (0..fine.latches.len()).fold(0, |moves, l| moves | changes(l));
            let stays = self.along.common.iter().fold(u64::MAX, |stays, &l| stays & !changes(l));
            // Longest first; what came in before rather than what is to come.
            let waits = valid & stays & moves;
            let half = LANES / 2;
            let lane = if shows != 0 {
                Some(shows.trailing_zeros() as usize)
            } else if there {
                Some(given)
            } else {
                let waits = |lane: &usize| waits >> *lane & 1 == 1;
                let found = (1..half).rev().find(waits).or_else(|| (half..LANES).rev().find(waits));
                // Something else moves first, or perhaps it does not matter.
                let first = if self.close { 0 } else { 1 };
                found.or((valid >> first & 1 == 1).then_some(first))
            };
            let Some(lane) = lane else { return false };
            let moved = moves >> lane & 1 == 1;
            let state = (0..fine.latches.len()).map(|l| after(lane, l)).collect();
            let shown: Vec<usize> = (0..self.bads.len()).filter(|&b| word(self.bads[b]) >> lane & 1 == 1).collect();
            self.state = state;
            self.inputs.push(Along::lane(&words, lane));
            for bad in shown {
                if !self.found.iter().any(|f| f.bad == bad) {
                    let (initial, inputs) = (self.along.initial.clone(), self.inputs.clone());
                    self.found.push(Found { bad, trace: Trace { initial, inputs, shortest: false } });
                }
            }
            if shows != 0 {
                return false;
            }
            if there || lane == 0 {
                return true;
            }
            if !moved {
                return !self.close;
            }
        }
        !self.close || step.is_none()
    }
}
