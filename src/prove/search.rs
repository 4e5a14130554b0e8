//! Looks for a run from power-up in which chart and program differ.
//!
//! A pool of memories that have been reached is grown by running 64 input sequences at once from one of
//! them and keeping what is new: a transition that has not fired before, a configuration that has not
//! been seen. A solver helps in two ways: from each memory in the pool it looks for inputs that show a
//! difference within a few scans, and where a transition has not fired yet for inputs that make it fire.
//!
//! Finding nothing proves nothing. What is counted is work and not time, so that every run ends alike.

use super::aig::{Aig, Lit, lanes};
use super::joint::{Joint, Memory};
use super::random::Random;
use super::sat::{Answer, Budget, Model, Sat};
use std::collections::HashSet;

/// How far to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Runs of 64 input sequences.
    pub runs: usize,
    /// Scans of each.
    pub scans: usize,
    /// Memories from which a solver looks for a difference.
    pub asked: usize,
    /// How many scans ahead it looks from there.
    pub ahead: usize,
}

impl Effort {
    /// A few seconds for a machine of some hundred states.
    pub const USUAL: Effort = Effort { runs: 400, scans: 24, asked: 400, ahead: 6 };
}

/// How a memory has been reached.
struct Reached {
    memory: Memory,
    /// From which entry of the pool; nothing for power-up.
    from: Option<usize>,
    /// By which inputs, scan by scan.
    by: Vec<Vec<bool>>,
}

struct Search<'a> {
    joint: &'a Joint,
    random: Random,
    pool: Vec<Reached>,
    configurations: HashSet<Vec<bool>>,
    fired: Vec<bool>,
    sat: &'a mut Sat,
}

/// Inputs, scan by scan, at the end of which some part differs.
pub fn search(joint: &Joint, sat: &mut Sat, effort: Effort) -> Option<Vec<Vec<bool>>> {
    let transitions = joint.half(false).fires.len();
    let mut search = Search {
        joint,
        random: Random::new(3),
        pool: Vec::new(),
        configurations: HashSet::new(),
        fired: vec![false; transitions],
        sat,
    };
    let found = search.first().or_else(|| search.explore(effort))?;
    Some(shorten(joint, found))
}

impl Search<'_> {
    /// The first scan, with 64 assignments of the inputs and with what a solver finds.
    fn first(&mut self) -> Option<Vec<Vec<bool>>> {
        let half = self.joint.half(true);
        self.sat.forget();
        if let Answer::Sometimes(model) = self.sat.ask(&half.aig, &[half.differs], Budget::PROOF) {
            return Some(vec![self.inputs_of(&model, 0)]);
        }
        let inputs: Vec<u64> = (0..self.joint.inputs).map(|_| self.random.next()).collect();
        // Lane 0 begins with everything FALSE, lane 1 with everything TRUE.
        let inputs: Vec<u64> = inputs.into_iter().map(|w| w & !1 | 2).collect();
        let mut values = Vec::new();
        self.joint.run(None, &inputs, &mut values);
        for lane in 0..64 {
            let memory = half.next.iter().map(|&l| lanes(&values, l) >> lane & 1 == 1).collect();
            self.keep(memory, None, vec![inputs.iter().map(|w| w >> lane & 1 == 1).collect()]);
        }
        None
    }

    fn explore(&mut self, effort: Effort) -> Option<Vec<Vec<bool>>> {
        let mut asked = 0;
        for run in 0..effort.runs {
            // Mostly from what was reached last, and from anywhere as well.
            let start = if run % 3 == 0 {
                self.random.below(self.pool.len())
            } else {
                self.pool.len() - 1 - self.random.below(self.pool.len().min(8 + self.pool.len() / 4))
            };
            if let Some(found) = self.run(start, effort.scans) {
                return Some(found);
            }
            // The solver keeps step with what the runs reach.
            for _ in 0..2 {
                if asked < effort.asked && asked < self.pool.len() {
                    if let Some(found) = self.ask(asked, 1) {
                        return Some(found);
                    }
                    asked += 1;
                }
            }
            if run % 4 == 3 {
                self.fire_more();
            }
        }
        for entry in (asked..self.pool.len()).take(effort.asked.saturating_sub(asked)) {
            if let Some(found) = self.ask(entry, 1) {
                return Some(found);
            }
        }
        for ahead in 2..=effort.ahead {
            let every = (self.pool.len() / (effort.asked / 8).max(1)).max(1);
            for entry in (0..self.pool.len()).step_by(every) {
                if let Some(found) = self.ask(entry, ahead) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Runs 64 input sequences from an entry of the pool.
    fn run(&mut self, start: usize, scans: usize) -> Option<Vec<Vec<bool>>> {
        let half = self.joint.half(false);
        let spread = |b: &bool| if *b { u64::MAX } else { 0 };
        let mut memory: Vec<u64> = self.pool[start].memory.iter().map(spread).collect();
        // Every input in every lane has a habit of its own.
        let habits: Vec<[u64; 2]> = (0..self.joint.inputs).map(|_| [self.random.next(), self.random.next()]).collect();
        let mut inputs: Vec<u64> = (0..self.joint.inputs).map(|_| self.random.next()).collect();
        let mut history: Vec<Vec<u64>> = Vec::new();
        let mut values = Vec::new();
        for _ in 0..scans {
            for (word, [a, b]) in inputs.iter_mut().zip(&habits) {
                let (x, y, z) = (self.random.next(), self.random.next(), self.random.next());
                let rarely = x & y & z;
                let changes = *word ^ rarely;
                *word = !a & !b & changes | !a & b & x | a & !b & !rarely | a & b & rarely;
            }
            self.joint.run(Some(&memory), &inputs, &mut values);
            history.push(inputs.clone());
            let path = |lane: u32| -> Vec<Vec<bool>> {
                history.iter().map(|words| words.iter().map(|w| w >> lane & 1 == 1).collect()).collect()
            };
            let differ = lanes(&values, half.differs);
            if differ != 0 {
                let mut inputs = self.path(start);
                inputs.extend(path(differ.trailing_zeros()));
                return Some(inputs);
            }
            memory = half.next.iter().map(|&l| lanes(&values, l)).collect();
            let mut news = 0u64;
            for (fired, &l) in self.fired.iter_mut().zip(&half.fires) {
                let word = lanes(&values, l);
                if word != 0 && !*fired {
                    *fired = true;
                    news |= word & word.wrapping_neg();
                }
            }
            for lane in 0..64 {
                let active: Vec<bool> = memory[..self.joint.states].iter().map(|w| w >> lane & 1 == 1).collect();
                if news >> lane & 1 == 1 || !self.configurations.contains(&active) {
                    let memory = memory.iter().map(|w| w >> lane & 1 == 1).collect();
                    self.keep(memory, Some(start), path(lane));
                }
            }
        }
        None
    }

    fn keep(&mut self, memory: Memory, from: Option<usize>, by: Vec<Vec<bool>>) {
        // Enough for a good spread; a machine may have more configurations than atoms.
        const POOL: usize = 4_000;
        self.configurations.insert(memory[..self.joint.states].to_vec());
        if self.pool.len() < POOL {
            self.pool.push(Reached { memory, from, by });
        }
    }

    /// Inputs from power-up to an entry of the pool.
    fn path(&self, entry: usize) -> Vec<Vec<bool>> {
        let chain = std::iter::successors(Some(entry), |&e| self.pool[e].from);
        let mut parts: Vec<&Vec<Vec<bool>>> = chain.map(|e| &self.pool[e].by).collect();
        parts.reverse();
        parts.into_iter().flatten().cloned().collect()
    }

    /// Looks for inputs that show a difference at the end of `ahead` scans from an entry of the pool.
    fn ask(&mut self, entry: usize, ahead: usize) -> Option<Vec<Vec<bool>>> {
        let differs = self.joint.half(false).differs;
        let by = self.solve(entry, ahead, differs)?;
        let mut inputs = self.path(entry);
        inputs.extend(by);
        Some(inputs)
    }

    /// Makes transitions fire that have not fired yet.
    fn fire_more(&mut self) {
        let fires = self.joint.half(false).fires.clone();
        let mut budget = 8;
        for (t, &l) in fires.iter().enumerate() {
            if self.fired[t] || l == Lit::FALSE {
                continue;
            }
            if budget == 0 {
                return;
            }
            budget -= 1;
            // From what was reached last, from the youngest on, one scan ahead and then two.
            let count = self.pool.len();
            for k in 0..6 {
                let entry = if k < 3 { count - 1 - self.random.below(count.min(16)) } else { self.random.below(count) };
                let Some(by) = (1..=2).find_map(|ahead| self.solve(entry, ahead, l)) else { continue };
                let mut memory: Vec<u64> = self.pool[entry].memory.iter().map(|&b| u64::from(b)).collect();
                let mut values = Vec::new();
                for now in &by {
                    let words: Vec<u64> = now.iter().map(|&b| u64::from(b)).collect();
                    self.joint.run(Some(&memory), &words, &mut values);
                    memory = self.joint.half(false).next.iter().map(|&l| lanes(&values, l) & 1).collect();
                }
                self.fired[t] = true;
                self.keep(memory.into_iter().map(|w| w == 1).collect(), Some(entry), by);
                break;
            }
        }
    }

    /// Inputs for `ahead` scans from an entry of the pool, in the last of which `goal` is TRUE.
    fn solve(&mut self, entry: usize, ahead: usize, goal: Lit) -> Option<Vec<Vec<bool>>> {
        let next = &self.joint.half(false).next;
        let mut aig = Aig::new();
        let mut memory: Vec<Lit> = self.pool[entry].memory.iter().map(|&b| Lit::of(b)).collect();
        for scan in 1..=ahead {
            let inputs: Vec<Lit> = (0..self.joint.inputs).map(|i| aig.leaf(format!("{scan}.{i}"))).collect();
            if scan < ahead {
                memory = self.joint.copy(&mut aig, &memory, &inputs, next);
                continue;
            }
            let goal = self.joint.copy(&mut aig, &memory, &inputs, &[goal])[0];
            self.sat.forget();
            return match self.sat.ask(&aig, &[goal], Budget::ATTEMPT) {
                Answer::Sometimes(model) => Some((0..ahead).map(|s| self.inputs_of(&model, s)).collect()),
                Answer::Never | Answer::GaveUp => None,
            };
        }
        None
    }

    /// The inputs of a scan in a model of scans one after the other.
    fn inputs_of(&self, model: &Model, scan: usize) -> Vec<bool> {
        (0..self.joint.inputs).map(|i| model.leaf((scan * self.joint.inputs + i) as u32)).collect()
    }
}

/// Leaves out scans and quietens inputs as long as a difference remains.
fn shorten(joint: &Joint, mut inputs: Vec<Vec<bool>>) -> Vec<Vec<bool>> {
    // A step of work is one scan of the pair; the bound keeps long traces from costing minutes.
    let mut work = 200_000usize;
    let mut attempt = |candidate: Vec<Vec<bool>>, best: &mut Vec<Vec<bool>>| {
        if work < candidate.len() {
            return false;
        }
        work -= candidate.len();
        match joint.first_difference(&candidate) {
            Some(scan) => {
                *best = candidate;
                best.truncate(scan + 1);
                true
            }
            None => false,
        }
    };
    let whole = inputs.clone();
    attempt(whole, &mut inputs);
    let mut block = inputs.len() / 2;
    while block > 0 {
        let mut at = 0;
        while at + block < inputs.len() {
            let mut candidate = inputs.clone();
            candidate.drain(at..at + block);
            if !attempt(candidate, &mut inputs) {
                at += block;
            }
        }
        block /= 2;
    }
    // An input that keeps the value of the scan before is one thing less to read.
    for i in 0..joint.inputs {
        for value in [false, true] {
            let mut candidate = inputs.clone();
            candidate.iter_mut().for_each(|scan| scan[i] = value);
            if candidate != inputs && attempt(candidate, &mut inputs) {
                break;
            }
        }
        for scan in 0..inputs.len() {
            if scan >= inputs.len() {
                break;
            }
            let before = scan > 0 && inputs[scan - 1][i];
            if inputs[scan][i] != before {
                let mut candidate = inputs.clone();
                candidate[scan][i] = before;
                attempt(candidate, &mut inputs);
            }
        }
    }
    inputs
}
