//! Looks for a run from power-up in which chart and program differ.
//!
//! A pool of memories that have been reached is grown by running 64 input sequences at once from one of
//! them and keeping what is new: a transition that has not fired before, a configuration that has not
//! been seen. A solver helps in two ways: from memories in the pool it looks for inputs that show a
//! difference within a few scans, and where a transition has not fired yet for inputs that make it fire.
//!
//! Chance does not get far along a sequence that every other button takes back to its beginning. So the solver leads
//! from one transition that has not fired to the next, each from memories in which its source is active, and chance goes on
//! from there. At last the solver looks for a difference from memories that show all states.
//!
//! Finding nothing proves nothing. What is counted is work and not time, so that every run ends alike.

use super::ahead::ahead;
use super::joint::{Joint, Memory, Run, Stimulus};
use super::shorten::shorten;
use crate::bits::aig::Lit;
use crate::bits::random::Random;
use crate::bits::sat::{Answer, Budget, Model, Sat};
use crate::ir::iec::Time;
use std::collections::HashSet;

/// How far to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Runs of 64 input sequences.
    pub runs: usize,
    /// Scans of each.
    pub scans: usize,
    /// Memories from which a solver looks for a difference in the next scan.
    pub asked: usize,
    /// Memories from which it looks further.
    pub asked_ahead: usize,
    /// How many scans ahead it looks from there.
    pub ahead: usize,
    /// Attempts to make some transition fire that has not fired yet.
    pub led: usize,
}

impl Effort {
    /// Finds what shows up soon: some tenths of a second for a machine of some hundred states.
    pub const FIRST: Effort = Effort { runs: 120, scans: 16, asked: 240, asked_ahead: 0, ahead: 1, led: 0 };
    /// Some seconds.
    pub const USUAL: Effort = Effort { runs: 600, scans: 24, asked: 600, asked_ahead: 24, ahead: 4, led: 12_000 };
}

/// Most memories that are kept; a machine may have more configurations than atoms.
const POOL: usize = 4_000;

/// Most memories that are kept for each state which is active in them.
const PLACES: usize = 6;

/// Attempts to lead on before everything else is tried.
const LED_FIRST: usize = 600;

/// How many scans ahead a solver leads.
const LED: [usize; 2] = [2, 5];

/// How a memory has been reached.
struct Reached {
    memory: Memory,
    /// From which entry of the pool; nothing for power-up.
    from: Option<usize>,
    /// By which stimuli.
    by: Vec<Stimulus>,
}

struct Search<'a> {
    joint: &'a Joint,
    random: Random,
    pool: Vec<Reached>,
    configurations: HashSet<Vec<bool>>,
    /// For each state, entries of the pool in which it is active.
    places: Vec<Vec<usize>>,
    fired: Vec<bool>,
    /// Where a solver has been asked to make a transition fire: which, from what entry of the pool, within how many scans.
    tried: HashSet<(usize, usize, usize)>,
    /// A pause after which every time has passed.
    long: Time,
    sat: &'a mut Sat,
}

/// Stimuli from power-up on, in the last scan of which some part differs.
pub fn search(joint: &Joint, sat: &mut Sat, effort: Effort) -> Option<Vec<Stimulus>> {
    let mut search = Search {
        joint,
        random: Random::new(3),
        pool: Vec::new(),
        configurations: HashSet::new(),
        places: vec![Vec::new(); joint.states],
        fired: vec![false; joint.half(false).fires.len()],
        tried: HashSet::new(),
        long: joint.times.iter().copied().max().unwrap_or(0).max(joint.cycle),
        sat,
    };
    let mut found = search.first();
    if effort.led > 0 {
        // What lies deep is led to before much is asked.
        found = found.or_else(|| search.explore(Effort::FIRST));
        found = found.or_else(|| search.lead(LED_FIRST.min(effort.led)));
        found = found.or_else(|| search.roam(effort));
    }
    found = found.or_else(|| search.explore(effort));
    if effort.led > 0 {
        found = found.or_else(|| search.lead(effort.led));
        found = found.or_else(|| search.ask_everywhere());
    }
    let found = found?;
    Some(shorten(joint, found))
}

impl Search<'_> {
    /// The first scan, with what a solver finds and with 64 assignments of the inputs.
    fn first(&mut self) -> Option<Vec<Stimulus>> {
        let half = self.joint.half(true);
        self.sat.forget();
        if let Answer::Sometimes(model) = self.sat.ask(&half.aig, &[half.differs], Budget::PROOF) {
            return Some(vec![self.stimulus(&model, 0, self.joint.cycle)]);
        }
        // Lane 0 begins with everything FALSE, lane 1 with everything TRUE.
        let inputs: Vec<u64> = (0..self.joint.inputs).map(|_| self.random.word() & !1 | 2).collect();
        let mut run = Run::new(self.joint);
        run.scan(&inputs, self.joint.cycle);
        for lane in 0..64 {
            let by = vec![Stimulus { pause: self.joint.cycle, inputs: bits(&inputs, lane) }];
            self.keep(run.memory(lane), None, by);
        }
        None
    }

    fn explore(&mut self, effort: Effort) -> Option<Vec<Stimulus>> {
        let mut asked = 0;
        for run in 0..effort.runs {
            // Mostly from what was reached last, and from anywhere as well.
            let count = self.pool.len();
            let start = if run % 3 == 0 {
                self.random.below(count)
            } else {
                count - 1 - self.random.below(count.min(8 + count / 4))
            };
            if let Some(found) = self.run(start, effort.scans) {
                return Some(found);
            }
            // The solver keeps step with what the runs reach.
            let due = (run + 1) * effort.asked / effort.runs;
            while asked < due.min(self.pool.len()) {
                if let Some(found) = self.ask(asked, 1) {
                    return Some(found);
                }
                asked += 1;
            }
            if run % 4 == 3
                && let Some(found) = self.fire_more()
            {
                return Some(found);
            }
        }
        for ahead in 2..=effort.ahead {
            let every = (self.pool.len() / effort.asked_ahead.max(1)).max(1);
            for entry in (0..self.pool.len()).step_by(every) {
                if let Some(found) = self.ask(entry, ahead) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Runs 64 input sequences from an entry of the pool.
    fn run(&mut self, start: usize, scans: usize) -> Option<Vec<Stimulus>> {
        let mut run = Run::from(self.joint, &self.pool[start].memory);
        // Every input in every lane has a habit of its own.
        let habits: Vec<[u64; 2]> = (0..self.joint.inputs).map(|_| [self.random.word(), self.random.word()]).collect();
        let mut inputs: Vec<u64> = (0..self.joint.inputs).map(|_| self.random.word()).collect();
        let mut history: Vec<(Time, Vec<u64>)> = Vec::new();
        for _ in 0..scans {
            for (word, [a, b]) in inputs.iter_mut().zip(&habits) {
                let (x, y, z) = (self.random.word(), self.random.word(), self.random.word());
                let rarely = x & y & z;
                let changes = *word ^ rarely;
                *word = !a & !b & changes | !a & b & x | a & !b & !rarely | a & b & rarely;
            }
            let pause = self.pause();
            run.scan(&inputs, pause);
            history.push((pause, inputs.clone()));
            let path = |lane: usize| -> Vec<Stimulus> {
                history.iter().map(|(pause, words)| Stimulus { pause: *pause, inputs: bits(words, lane) }).collect()
            };
            let differ = run.word(run.half().differs);
            if differ != 0 {
                let mut stimuli = self.path(start);
                stimuli.extend(path(differ.trailing_zeros() as usize));
                return Some(stimuli);
            }
            let mut news = 0u64;
            for (fired, &l) in self.fired.iter_mut().zip(&run.half().fires) {
                let word = run.word(l);
                if word != 0 && !*fired {
                    *fired = true;
                    news |= word & word.wrapping_neg();
                }
            }
            for lane in 0..64 {
                if news >> lane & 1 == 1 || !self.configurations.contains(&run.active(lane)) {
                    self.keep(run.memory(lane), Some(start), path(lane));
                }
            }
        }
        None
    }

    /// Mostly the cycle time, now and then long enough for some timer to end.
    fn pause(&mut self) -> Time {
        if self.joint.times.is_empty() || self.random.below(4) > 0 {
            return self.joint.cycle;
        }
        match self.random.below(3) {
            0 => self.long,
            _ => {
                let any = self.joint.times[self.random.below(self.joint.times.len())];
                // Just before, exactly and just after.
                (any + (self.random.below(3) as Time - 1) * self.joint.cycle).max(self.joint.cycle)
            }
        }
    }

    fn keep(&mut self, memory: Memory, from: Option<usize>, by: Vec<Stimulus>) {
        let active = memory.bits[..self.joint.states].to_vec();
        let entry = self.pool.len();
        let unseen = active.iter().zip(&self.places).any(|(&active, places)| active && places.is_empty());
        if entry < POOL || unseen {
            for (places, _) in self.places.iter_mut().zip(&active).filter(|(_, active)| **active) {
                if places.len() < PLACES {
                    places.push(entry);
                } else {
                    // Who comes late has come far, mostly.
                    places[self.random.below(PLACES)] = entry;
                }
            }
            self.pool.push(Reached { memory, from, by });
        }
        self.configurations.insert(active);
    }

    /// From power-up to an entry of the pool.
    fn path(&self, entry: usize) -> Vec<Stimulus> {
        let chain = std::iter::successors(Some(entry), |&e| self.pool[e].from);
        let mut parts: Vec<&Vec<Stimulus>> = chain.map(|e| &self.pool[e].by).collect();
        parts.reverse();
        parts.into_iter().flatten().cloned().collect()
    }

    /// Looks for a difference within `ahead` scans from an entry of the pool.
    fn ask(&mut self, entry: usize, ahead: usize) -> Option<Vec<Stimulus>> {
        let differs = self.joint.half(false).differs;
        for pause in self.pauses() {
            if let Some(by) = self.solve(entry, ahead, pause, differs) {
                let mut stimuli = self.path(entry);
                stimuli.extend(by);
                return Some(stimuli);
            }
        }
        None
    }

    fn pauses(&self) -> Vec<Time> {
        if self.joint.times.is_empty() { vec![self.joint.cycle] } else { vec![self.joint.cycle, self.long] }
    }

    /// Makes transitions fire that have not fired yet.
    fn fire_more(&mut self) -> Option<Vec<Stimulus>> {
        let fires = &self.joint.half(false).fires;
        let mut patience = 8;
        for (t, &goal) in fires.iter().enumerate() {
            if self.fired[t] || goal == Lit::FALSE {
                continue;
            }
            if patience == 0 {
                return None;
            }
            patience -= 1;
            for k in 0..6 {
                let count = self.pool.len();
                let places = &self.places[self.joint.sources[t]];
                let entry = if k < 3 || places.is_empty() {
                    count - 1 - self.random.below(count.min(16))
                } else {
                    places[self.random.below(places.len())]
                };
                let mut pauses = self.pauses().into_iter();
                let Some(by) = pauses.find_map(|pause| self.solve(entry, 2, pause, goal)) else { continue };
                if let Some(found) = self.follow(entry, by) {
                    return Some(found);
                }
                break;
            }
        }
        None
    }

    /// Goes on from an entry of the pool and keeps what is reached where a transition fires for the first time.
    fn follow(&mut self, entry: usize, by: Vec<Stimulus>) -> Option<Vec<Stimulus>> {
        let mut run = Run::from(self.joint, &self.pool[entry].memory);
        for (scan, s) in by.iter().enumerate() {
            let words: Vec<u64> = s.inputs.iter().map(|&b| u64::from(b)).collect();
            run.scan(&words, s.pause);
            if run.word(run.half().differs) & 1 == 1 {
                let mut stimuli = self.path(entry);
                stimuli.extend_from_slice(&by[..=scan]);
                return Some(stimuli);
            }
            let mut news = false;
            for (fired, &l) in self.fired.iter_mut().zip(&run.half().fires) {
                news |= !*fired && run.word(l) & 1 == 1;
                *fired |= run.word(l) & 1 == 1;
            }
            if news {
                self.keep(run.memory(0), Some(entry), by[..=scan].to_vec());
            }
        }
        None
    }

    /// Leads along transitions that have not fired yet, with so many attempts.
    fn lead(&mut self, mut left: usize) -> Option<Vec<Stimulus>> {
        let mut goes_on = true;
        while std::mem::take(&mut goes_on) {
            for t in 0..self.fired.len() {
                let goal = self.joint.half(false).fires[t];
                for (entry, scans) in self.ways(self.joint.sources[t]) {
                    if self.fired[t] || goal == Lit::FALSE || left == 0 || !self.tried.insert((t, entry, scans)) {
                        continue;
                    }
                    left -= 1;
                    let mut pauses = self.pauses().into_iter();
                    if let Some(by) = pauses.find_map(|pause| self.solve(entry, scans, pause, goal)) {
                        goes_on = true;
                        if let Some(found) = self.follow(entry, by) {
                            return Some(found);
                        }
                    }
                }
            }
        }
        None
    }

    /// Goes on by chance from where it was led to, from each state as often as from another one.
    fn roam(&mut self, effort: Effort) -> Option<Vec<Stimulus>> {
        let states: Vec<usize> = (0..self.joint.states).filter(|&s| !self.places[s].is_empty()).collect();
        (0..effort.runs).find_map(|_| {
            let places = &self.places[states[self.random.below(states.len())]];
            let start = places[self.random.below(places.len())];
            self.run(start, effort.scans)
        })
    }

    /// Looks for a difference wherever it has come. Who was led far is asked first.
    fn ask_everywhere(&mut self) -> Option<Vec<Stimulus>> {
        let mut asked = HashSet::new();
        let mut ways: Vec<(usize, usize)> = (0..self.joint.states).flat_map(|s| self.ways(s)).collect();
        ways.sort_by_key(|&(entry, scans)| (scans, std::cmp::Reverse(entry)));
        ways.into_iter().filter(|way| asked.insert(*way)).find_map(|(entry, scans)| self.ask(entry, scans))
    }

    /// From where, and how far, a solver looks for what begins in a state.
    fn ways(&self, state: usize) -> Vec<(usize, usize)> {
        LED.into_iter().flat_map(|scans| self.places[state].iter().map(move |&entry| (entry, scans))).collect()
    }

    /// Stimuli for `scans` scans from an entry of the pool, each after the same pause, in one of which `goal` is TRUE.
    fn solve(&mut self, entry: usize, scans: usize, pause: Time, goal: Lit) -> Option<Vec<Stimulus>> {
        ahead(self.joint, &self.pool[entry].memory, &vec![pause; scans], goal, self.sat)
    }

    /// A scan in a model of scans one after the other.
    fn stimulus(&self, model: &Model, scan: usize, pause: Time) -> Stimulus {
        let inputs = (0..self.joint.inputs).map(|i| model.leaf((scan * self.joint.inputs + i) as u32)).collect();
        Stimulus { pause, inputs }
    }
}

fn bits(words: &[u64], lane: usize) -> Vec<bool> {
    words.iter().map(|w| w >> lane & 1 == 1).collect()
}
