//! Runs by chance, 64 at once: finds what is reachable, proves nothing.
//!
//! A run that does something new is remembered, and others go on from there, seldom visited ones first; so the walk gets
//! deep where blind chance would not. What counts as new is which claims show together that speak of what is remembered, such as
//! active states. Half of the runs climb: they go on from where a number is as large or as small as it has ever been, so that
//! a counter comes to its end although each of its values looks like the one before. The same seed always: the same walk.

use super::aig::{Lit, Node, transpose};
use super::limits::Stop;
use super::system::{Giver, System, Trace};
use std::collections::{HashMap, HashSet};

/// Scans between two looks at where to go on.
const STRETCH: usize = 100;

/// Places to go on from.
const PLACES: usize = 4_096;

/// Places that are found even if no run is wanted.
const ENOUGH: usize = 500;

/// Places that look the same.
const TIMES: u8 = 4;

/// Attempts to find inputs under which the constraints hold.
const ATTEMPTS: usize = 12;

/// The same where there are runs enough to begin from.
const FEW_ATTEMPTS: usize = 4;

/// Rounds without anything new after which it ends.
const PATIENCE: usize = 200;

/// Scans that a run goes on from where another one has been.
const NEAR: usize = 8;

/// What the walk has found.
pub struct Walk {
    /// For each claim of the form never, a run that shows the opposite, if one came up.
    pub runs: Vec<Option<Trace>>,
    /// States that were reached, one for each new thing.
    pub states: Vec<Vec<bool>>,
}

/// Walks until `gates` evaluations of gates are spent, `stop` says so, or nothing new comes up any more.
pub fn wander(system: &System, wanted: &[bool], gates: u64, stop: Stop<'_>) -> Walk {
    let bads: Vec<Option<Lit>> = system.claims.iter().map(|c| c.property.never()).collect();
    let mut walker = Walker::new(system, bads, wanted);
    walker.walk(gates, stop);
    let runs = walker.runs.iter().map(|place| place.map(|p| walker.trace(p))).collect();
    Walk { runs, states: walker.places.into_iter().map(|p| p.state).collect() }
}

/// Walks that begin where runs have been.
pub struct Around<'s> {
    walker: Walker<'s>,
    /// The places before that one have been begun from.
    next: usize,
}

impl<'s> Around<'s> {
    /// Around no runs yet, in search of all that never is claimed to be.
    pub fn new(system: &'s System) -> Around<'s> {
        let bads: Vec<Option<Lit>> = system.claims.iter().map(|c| c.property.never()).collect();
        let all = vec![true; bads.len()];
        let mut walker = Walker::new(system, bads, &all);
        walker.attempts = FEW_ATTEMPTS;
        // It does not go far.
        walker.records.clear();
        Around { walker, next: 0 }
    }

    /// Around this one, too.
    pub fn follow(&mut self, run: &Trace) {
        self.walker.follow(run);
    }

    /// Goes on from the states that are new since it did so last, not far, or from all of them if it begins `anew`. Returns runs that
    /// show the opposite of claims that are `wanted`.
    pub fn near(&mut self, wanted: &[bool], anew: bool, stop: Stop<'_>) -> Vec<(usize, Trace)> {
        self.walker.want(wanted);
        self.next = if anew { 0 } else { self.next };
        while self.next < self.walker.places.len() && self.walker.open.contains(&true) && !stop() {
            let places = self.walker.places.len();
            let near = (0..64).map(|i| (self.next + i) % places).collect();
            self.walker.stretch(near, NEAR);
            self.next += 64;
        }
        let claims = (0..wanted.len()).filter(|&c| wanted[c]);
        claims.filter_map(|c| Some((c, self.walker.trace(self.walker.runs[c]?)))).collect()
    }
}

/// A state to go on from.
struct Place {
    /// Where it was reached from, and by which inputs.
    from: Option<usize>,
    inputs: Vec<Vec<bool>>,
    state: Vec<bool>,
    visits: u32,
    /// What comes in next in a run that is followed.
    next: Option<Vec<bool>>,
}

struct Walker<'s> {
    system: &'s System,
    bads: Vec<Option<Lit>>,
    /// For each claim, whether a run is wanted.
    open: Vec<bool>,
    /// For each claim, the place to which its run leads.
    runs: Vec<Option<usize>>,
    places: Vec<Place>,
    /// What is remembered, as far as claims speak of it.
    features: Vec<Lit>,
    /// How often each was kept.
    seen: HashMap<u64, u8>,
    /// The places of runs that are followed.
    known: HashMap<Vec<bool>, usize>,
    /// Nodes to be evaluated, in order.
    cone: Vec<usize>,
    values: Vec<u64>,
    attempts: usize,
    /// The lanes in which a time may be longer than what has been chosen of it.
    waits: u64,
    chance: u64,
    /// For each number, and for all of them together, the places where it is largest and smallest so far, with what it is there.
    records: Vec<[Option<(i64, usize)>; 2]>,
    /// Which record to go on from next.
    turn: usize,
}

impl<'s> Walker<'s> {
    fn new(system: &'s System, bads: Vec<Option<Lit>>, wanted: &[bool]) -> Self {
        let roots: Vec<Lit> = system.constraints.iter().copied().chain(bads.iter().flatten().copied()).collect();
        let nexts = system.latches.iter().map(|l| l.next);
        let noted = system.notable.iter().chain(system.numbers.iter().flatten()).copied();
        let roots: Vec<Lit> = roots.into_iter().chain(nexts).chain(noted).collect();
        let cone = system.aig.cone(&roots);
        let open = bads.iter().zip(wanted).map(|(bad, &wanted)| bad.is_some() && wanted).collect();
        let remembered: HashSet<Lit> = system.latches.iter().flat_map(|l| [l.next, l.leaf]).collect();
        let mut features: Vec<Lit> = bads.iter().flatten().copied().filter(|l| remembered.contains(l)).collect();
        features.extend(&system.notable);
        if features.is_empty() {
            features = bads.iter().flatten().copied().collect();
        }
        let runs = vec![None; bads.len()];
        let values = vec![0; system.aig.len()];
        let mut walker = Walker {
            system,
            bads,
            open,
            runs,
            places: Vec::new(),
            features,
            seen: HashMap::new(),
            known: HashMap::new(),
            cone,
            values,
            attempts: ATTEMPTS,
            waits: u64::MAX,
            chance: 0x9e37_79b9_7f4a_7c15,
            records: vec![[None; 2]; if system.numbers.is_empty() { 0 } else { system.numbers.len() + 1 }],
            turn: 0,
        };
        // Some beginnings, where there is more than one.
        let beginnings = if system.latches.iter().all(|l| l.initial.is_some()) { 1 } else { 16 };
        for _ in 0..beginnings {
            let state = system.latches.iter().map(|l| l.initial.unwrap_or_else(|| walker.word() & 1 == 1)).collect();
            walker.places.push(Place { from: None, inputs: Vec::new(), state, visits: 0, next: None });
        }
        walker
    }

    /// 64 tosses of a coin (xorshift, Marsaglia, 2003).
    fn word(&mut self) -> u64 {
        self.chance ^= self.chance << 13;
        self.chance ^= self.chance >> 7;
        self.chance ^= self.chance << 17;
        self.chance.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn walk(&mut self, gates: u64, stop: Stop<'_>) {
        let mut left = gates;
        let mut idle = 0;
        while (self.open.contains(&true) || self.places.len() < ENOUGH) && idle < PATIENCE && left > 0 && !stop() {
            let before = (self.places.len(), self.records.clone());
            let base = (0..64).map(|lane| self.record(lane).unwrap_or_else(|| self.choose())).collect();
            let spent = self.stretch(base, STRETCH);
            left = left.saturating_sub(spent);
            idle = if self.places.len() > before.0 || self.records != before.1 { 0 } else { idle + 1 };
        }
    }

    /// Looks for runs of these claims only.
    fn want(&mut self, wanted: &[bool]) {
        for (claim, &wanted) in wanted.iter().enumerate() {
            self.open[claim] = wanted && self.bads[claim].is_some() && self.runs[claim].is_none();
        }
    }

    /// Makes places of all states of a run.
    fn follow(&mut self, run: &Trace) {
        let system = self.system;
        let mut states = vec![run.initial.clone()];
        let next = |values: &[u64]| system.latches.iter().map(|l| super::aig::lanes(values, l.next) & 1 == 1).collect();
        if system.replay(run, &mut |values| states.push(next(values))).is_err() {
            return;
        }
        let mut from = None;
        for (i, state) in states.into_iter().enumerate() {
            let place = self.known.get(&state).copied().unwrap_or_else(|| {
                let inputs = i.checked_sub(1).map(|i| run.inputs[i].clone()).into_iter().collect();
                self.known.insert(state.clone(), self.places.len());
                self.places.push(Place { from, inputs, state, visits: 0, next: run.inputs.get(i).cloned() });
                self.places.len() - 1
            });
            from = Some(place);
        }
    }

    /// Lets 64 runs go on for a while, each from a place. Returns how many gates were evaluated.
    fn stretch(&mut self, mut base: Vec<usize>, scans: usize) -> u64 {
        let system = self.system;
        let mut since = [0usize; 64];
        let mut state = vec![0u64; system.latches.len()];
        for (lane, &place) in base.iter().enumerate() {
            self.places[place].visits += 1;
            for (word, &value) in state.iter_mut().zip(&self.places[place].state) {
                *word |= u64::from(value) << lane;
            }
        }
        let mut now = vec![0u64; system.inputs.len()];
        let hints = self.word();
        for (lane, &place) in base.iter().enumerate() {
            let Place { next, inputs, .. } = &self.places[place];
            let hint = next.as_ref().filter(|_| hints >> lane & 1 == 1);
            let last = hint.or(inputs.last()).into_iter().flatten();
            now.iter_mut().zip(last).for_each(|(word, &value)| *word |= u64::from(value) << lane);
        }
        // Some inputs keep their values for a while.
        let free: Vec<u64> = system.inputs.iter().map(|_| self.word()).collect();
        let mut history: Vec<Vec<u64>> = Vec::new();
        let mut alive = u64::MAX;
        let mut spent = 0;
        for _ in 0..scans {
            let kept = self.constrain(&state, &mut now, &free, alive, &mut spent);
            alive &= kept;
            if alive == 0 {
                break;
            }
            history.push(now.clone());
            let nexts: Vec<u64> = system.latches.iter().map(|l| self.lanes(l.next)).collect();
            let mut interesting = self.novel(alive);
            for claim in 0..self.bads.len() {
                if self.open[claim]
                    && let Some(bad) = self.bads[claim]
                {
                    let shows = self.lanes(bad) & alive;
                    if shows != 0 {
                        interesting |= 1 << shows.trailing_zeros();
                    }
                }
            }
            while interesting != 0 {
                let lane = interesting.trailing_zeros() as usize;
                interesting &= interesting - 1;
                let shows = (0..self.bads.len())
                    .filter(|&c| self.open[c] && self.bads[c].is_some_and(|bad| self.lanes(bad) >> lane & 1 == 1));
                let shows: Vec<usize> = shows.collect();
                if shows.is_empty() && self.places.len() >= PLACES {
                    continue;
                }
                let inputs = history[since[lane]..].iter();
                let inputs = inputs.map(|scan| scan.iter().map(|w| w >> lane & 1 == 1).collect()).collect();
                let state = nexts.iter().map(|w| w >> lane & 1 == 1).collect();
                self.places.push(Place { from: Some(base[lane]), inputs, state, visits: 0, next: None });
                base[lane] = self.places.len() - 1;
                since[lane] = history.len();
                for claim in shows {
                    self.open[claim] = false;
                    self.runs[claim] = Some(base[lane]);
                }
            }
            state = nexts;
        }
        self.climb(&base, &since, &history, &state, alive);
        spent
    }

    /// Every other lane goes on from a record, if there are any.
    fn record(&mut self, lane: usize) -> Option<usize> {
        let records: Vec<usize> = self.records.iter().flatten().flatten().map(|r| r.1).collect();
        if lane.is_multiple_of(2) || records.is_empty() {
            return None;
        }
        self.turn += 1;
        Some(records[self.turn % records.len()])
    }

    /// Notes where numbers are larger or smaller than ever at the end of a stretch.
    fn climb(&mut self, base: &[usize], since: &[usize], history: &[Vec<u64>], state: &[u64], alive: u64) {
        if alive == 0 || history.is_empty() || self.records.is_empty() {
            return;
        }
        let mut values: Vec<[i64; 64]> = Vec::new();
        for number in &self.system.numbers {
            let mut value = [0i64; 64];
            for (i, &bit) in number.iter().enumerate() {
                let word = self.lanes(bit);
                let weight = if i + 1 == number.len() { -(1i64 << i) } else { 1 << i };
                (0..64).for_each(|lane| value[lane] += weight * (word >> lane & 1) as i64);
            }
            values.push(value);
        }
        values.push(std::array::from_fn(|lane| values.iter().map(|v| v[lane]).sum()));
        let mut kept: HashMap<usize, usize> = HashMap::new();
        for (number, value) in values.iter().enumerate() {
            for (end, sign) in [1, -1].into_iter().enumerate() {
                let lanes = (0..64).filter(|lane| alive >> lane & 1 == 1);
                let Some(lane) = lanes.max_by_key(|&lane| (sign * value[lane], std::cmp::Reverse(lane))) else {
                    continue;
                };
                if self.records[number][end].is_some_and(|(known, _)| sign * known >= sign * value[lane]) {
                    continue;
                }
                let place = *kept.entry(lane).or_insert_with(|| {
                    let inputs = history[since[lane]..].iter();
                    let inputs = inputs.map(|scan| scan.iter().map(|w| w >> lane & 1 == 1).collect()).collect();
                    let state = state.iter().map(|w| w >> lane & 1 == 1).collect();
                    self.places.push(Place { from: Some(base[lane]), inputs, state, visits: 0, next: None });
                    self.places.len() - 1
                });
                self.records[number][end] = Some((value[lane], place));
            }
        }
    }

    /// The less visited one of two places.
    fn choose(&mut self) -> usize {
        let count = self.places.len() as u64;
        let (a, b) = ((self.word() % count) as usize, (self.word() % count) as usize);
        if self.places[a].visits <= self.places[b].visits { a } else { b }
    }

    /// New inputs, and the values of all gates with them. Returns the lanes in which the constraints hold.
    fn constrain(&mut self, state: &[u64], now: &mut [u64], free: &[u64], alive: u64, spent: &mut u64) -> u64 {
        let before = now.to_vec();
        let mut fits = 0;
        for _ in 0..self.attempts {
            self.waits = u64::MAX;
            for (i, word) in now.iter_mut().enumerate() {
                *word = (*word & fits) | (self.input(i, before[i], free[i]) & !fits);
            }
            self.evaluate(state, now);
            *spent += self.cone.len() as u64;
            fits = self.system.constraints.iter().fold(u64::MAX, |all, &c| all & self.lanes(c));
            if fits & alive == alive {
                break;
            }
        }
        fits
    }

    /// The next value of an input: in some runs often another one, in others seldom.
    fn input(&mut self, input: usize, was: u64, free: u64) -> u64 {
        let any = self.word();
        match self.system.inputs[input].giver {
            // What the machine and its clocks do is not up to anybody.
            Giver::Plant | Giver::Clock => any,
            // Long times and short ones alike.
            Giver::Wait => {
                let word = any & self.waits;
                self.waits &= self.word() | self.word() | self.word();
                word
            }
            Giver::Operator | Giver::Controller => {
                let quarter = any & self.word();
                let sixteenth = quarter & self.word() & self.word();
                let seldom = sixteenth & self.word() & self.word();
                let changes = 0xffff & any | 0xffff_0000 & quarter | 0xffff_0000_0000 & sixteenth | seldom;
                was ^ changes & free
            }
        }
    }

    fn evaluate(&mut self, state: &[u64], inputs: &[u64]) {
        let system = self.system;
        system.latches.iter().zip(state).for_each(|(l, &word)| self.values[l.leaf.node()] = word);
        system.inputs.iter().zip(inputs).for_each(|(i, &word)| self.values[i.leaf.node()] = word);
        for &n in &self.cone {
            if let Node::And(a, b) = system.aig.node(n) {
                self.values[n] = self.lanes(a) & self.lanes(b);
            }
        }
    }

    fn lanes(&self, l: Lit) -> u64 {
        super::aig::lanes(&self.values, l)
    }

    /// The lanes in which something is remembered that has not been so before.
    fn novel(&mut self, alive: u64) -> u64 {
        let mut hash = [0u64; 64];
        let words: Vec<u64> = self.features.iter().map(|&l| self.lanes(l)).collect();
        for block in words.chunks(64) {
            let mut rows = [0u64; 64];
            rows[..block.len()].copy_from_slice(block);
            transpose(&mut rows);
            for (hash, row) in hash.iter_mut().zip(rows) {
                *hash = (*hash ^ row).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
            }
        }
        // What else is remembered may matter as well, so that a few more come in time.
        let again = self.word() & self.word() & self.word();
        let mut novel = 0;
        for (lane, &hash) in hash.iter().enumerate() {
            if alive >> lane & 1 == 0 || self.seen.len() >= 64 * PLACES {
                continue;
            }
            let times = self.seen.entry(hash).or_default();
            if *times == 0 || *times < TIMES && again >> lane & 1 == 1 {
                *times += 1;
                novel |= 1 << lane;
            }
        }
        novel
    }

    /// The run to a place.
    fn trace(&self, place: usize) -> Trace {
        let mut way = vec![place];
        while let Some(from) = self.places[way[way.len() - 1]].from {
            way.push(from);
        }
        way.reverse();
        let inputs = way.iter().flat_map(|&p| self.places[p].inputs.iter().cloned()).collect();
        Trace { initial: self.places[way[0]].state.clone(), inputs, shortest: false }
    }
}

#[cfg(test)]
mod tests {
    use super::super::system::Property;
    use super::*;

    #[test]
    fn columns_are_rows() {
        let mut rows: [u64; 64] = std::array::from_fn(|i| (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let before = rows;
        transpose(&mut rows);
        for (i, row) in rows.iter().enumerate() {
            for (j, was) in before.iter().enumerate() {
                assert_eq!(row >> j & 1, was >> i & 1);
            }
        }
    }

    #[test]
    fn a_counter_comes_to_its_end() {
        // Counts rising edges, and stops at its end.
        let mut system = System::default();
        let part = system.input("part", Giver::Operator);
        let was = system.latch("was", Some(false));
        system.latches[0].next = part;
        let bits: Vec<Lit> = (0..12).map(|i| system.latch(format!("bit {i}"), Some(false))).collect();
        let full = system.aig.all(&bits);
        let mut carry = system.aig.all(&[part, !was, !full]);
        for (i, &bit) in bits.iter().enumerate() {
            system.latches[i + 1].next = system.aig.xor(bit, carry);
            carry = system.aig.and(carry, bit);
        }
        system.claim("full", Property::Never(full));
        let gates = 200_000_000;
        assert!(wander(&system, &[true], gates, &|| false).runs[0].is_none(), "by chance alone it does not get there");
        system.numbers = vec![bits.iter().copied().chain([Lit::FALSE]).collect()];
        let walk = wander(&system, &[true], gates, &|| false);
        assert!(system.shows(walk.runs[0].as_ref().expect("it gets there"), system.claims[0].property));
    }

    #[test]
    fn a_lock_of_many_digits_is_opened() {
        // Each right digit is something new; blind chance would need some 2^30 scans.
        let mut system = System::default();
        let digits: Vec<Lit> = (0..3).map(|i| system.input(format!("digit {i}"), Giver::Operator)).collect();
        let mut open = Lit::TRUE;
        for place in 0..10 {
            let right: Vec<Lit> = digits.iter().enumerate().map(|(i, &d)| d.xor(place >> i & 1 == 0)).collect();
            let right = system.aig.all(&right);
            let latch = system.latch(format!("place {place}"), Some(false));
            let next = system.aig.and(open, right);
            system.latches[place].next = next;
            system.claim(format!("place {place}"), Property::Never(next));
            open = latch;
        }
        let walk = wander(&system, &[true; 10], 10_000_000, &|| false);
        for (claim, run) in system.claims.iter().zip(walk.runs) {
            assert!(system.shows(&run.expect("it opens"), claim.property));
        }
    }
}
