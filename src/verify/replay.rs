//! A run to what it does, scan by scan: whether it is one, what it shows, and a calmer one that shows the same.
//!
//! A run may be long, so no more is kept of it than is asked for, and the work is linear in its scans. What takes longer is given
//! so much and no more.

use super::aig::{Lit, Node, lanes};
use super::limits::Stop;
use super::system::{Latch, Property, System, Trace};

/// Gates that may be evaluated to calm a run, where it is no more than a few replays anyway.
const CALM: u64 = 1_000_000_000;

/// Replays that may be spent on calming a run, however long it is.
const TRIES: u64 = 4;

/// What has to be looked at of a run for what some literals say of it.
struct Course {
    latches: Vec<usize>,
    /// The nodes that matter, in order.
    nodes: Vec<usize>,
}

impl System {
    /// What matters to some literals, and to whether a run is one.
    fn course(&self, literals: &[Lit]) -> Course {
        let roots: Vec<Lit> = self.constraints.iter().chain(literals).copied().collect();
        let (latches, _) = self.cone(&roots);
        let nexts = latches.iter().map(|&l| self.latches[l].next);
        let nodes = self.aig.cone(&roots.iter().copied().chain(nexts).collect::<Vec<_>>());
        Course { latches, nodes }
    }

    /// Whether it is a run that shows the literal in its last scan, and how the latches of the course are in the end.
    fn runs(&self, trace: &Trace, course: &Course, shown: Lit) -> Option<(bool, Vec<bool>)> {
        let begins = |(l, &value): (&Latch, &bool)| l.initial.is_none_or(|i| i == value);
        if trace.initial.len() != self.latches.len() || !self.latches.iter().zip(&trace.initial).all(begins) {
            return None;
        }
        let word = |value: bool| if value { u64::MAX } else { 0 };
        let mut values = vec![0; self.aig.len()];
        let mut state: Vec<bool> = course.latches.iter().map(|&l| trace.initial[l]).collect();
        let mut last = false;
        for inputs in &trace.inputs {
            for (&l, &value) in course.latches.iter().zip(&state) {
                values[self.latches[l].leaf.node()] = word(value);
            }
            self.inputs.iter().zip(inputs).for_each(|(i, &value)| values[i.leaf.node()] = word(value));
            for &n in &course.nodes {
                if let Node::And(a, b) = self.aig.node(n) {
                    values[n] = lanes(&values, a) & lanes(&values, b);
                }
            }
            let is = |l: Lit| lanes(&values, l) & 1 == 1;
            if !self.constraints.iter().all(|&c| is(c)) {
                return None;
            }
            last = is(shown);
            state.iter_mut().zip(&course.latches).for_each(|(bit, &l)| *bit = is(self.latches[l].next));
        }
        Some((last, state))
    }

    /// Lets a run happen; `each` sees the words of [`Aig::simulate`](super::aig::Aig::simulate) in each scan, with its values in lane 0.
    /// Returns the latches when the last scan has ended, or else the scan, counted from 1, that breaks a constraint: 0 if the run begins
    /// with a wrong value.
    pub fn replay(&self, trace: &Trace, each: &mut dyn FnMut(&[u64])) -> Result<Vec<bool>, usize> {
        let begins = |(l, &value): (&Latch, &bool)| l.initial.is_none_or(|i| i == value);
        if trace.initial.len() != self.latches.len() || !self.latches.iter().zip(&trace.initial).all(begins) {
            return Err(0);
        }
        let word = |value: bool| if value { u64::MAX } else { 0 };
        let mut words = vec![0; self.aig.leaves().len()];
        let mut values = Vec::new();
        let mut state = trace.initial.clone();
        for (inputs, scan) in trace.inputs.iter().zip(1..) {
            self.latches.iter().zip(&state).for_each(|(l, &value)| words[self.aig.number(l.leaf)] = word(value));
            self.inputs.iter().zip(inputs).for_each(|(i, &value)| words[self.aig.number(i.leaf)] = word(value));
            values.clear();
            self.aig.simulate(&words, &mut values);
            if self.constraints.iter().any(|&c| lanes(&values, c) & 1 == 0) {
                return Err(scan);
            }
            state.iter_mut().zip(&self.latches).for_each(|(bit, l)| *bit = lanes(&values, l.next) & 1 == 1);
            each(&values);
        }
        Ok(state)
    }

    /// Whether the run is one and, for what never must be, its last scan shows it; for what comes eventually, it
    /// ends in a loop that shows that it does not.
    pub fn shows(&self, trace: &Trace, property: Property) -> bool {
        match property {
            Property::Never(bad) => self.runs(trace, &self.course(&[bad]), bad).is_some_and(|(last, _)| last),
            Property::AlwaysPossible(_) | Property::NeverStuck => {
                self.runs(trace, &self.course(&[]), Lit::TRUE).is_some()
            }
            Property::Eventually { .. } => self.repeats(trace, property).is_some(),
        }
    }

    /// In a run that shows that `then` need not come `after`, the scan, counted from 0, from which on it can
    /// repeat itself for ever: all that matters is as it was when that scan began.
    pub fn repeats(&self, trace: &Trace, property: Property) -> Option<usize> {
        let Property::Eventually { after, then } = property else { return None };
        let (latches, _) = self.cone(&self.roots_of(after, then));
        // The last scan of each.
        let (mut asked, mut answered) = (None, None);
        let mut came = vec![None; self.fair.len()];
        let mut states: Vec<Vec<bool>> = Vec::new();
        let last = self.replay(trace, &mut |values| {
            let scan = states.len();
            let is = |l: Lit| lanes(values, l) & 1 == 1;
            asked = if is(after) { Some(scan) } else { asked };
            answered = if is(then) { Some(scan) } else { answered };
            for (came, fairness) in came.iter_mut().zip(&self.fair) {
                *came = if is(fairness.holds) { Some(scan) } else { *came };
            }
            states.push(latches.iter().map(|&l| is(self.latches[l].leaf)).collect());
        });
        let last: Vec<bool> = last.ok().map(|last| latches.iter().map(|&l| last[l]).collect())?;
        // What was asked after the last answer, or ever, is still open at the end.
        let open = answered.map_or(0, |answer| answer + 1);
        asked.filter(|&asked| asked >= open)?;
        // The shortest loop that will do.
        let latest =
            came.into_iter().try_fold(trace.inputs.len().checked_sub(1)?, |latest, came| Some(latest.min(came?)))?;
        (open..=latest).rev().find(|&begin| states[begin] == last)
    }

    /// The same run with as few changes of inputs as can be found by trying: each input keeps its value from
    /// the scan before where the run still shows the same. A calm run is easier to read. What this may cost is bounded.
    pub fn calm(&self, trace: &Trace, property: Property, stop: Stop<'_>) -> Trace {
        let mut calm = trace.clone();
        let literals = property.literals();
        let course = self.course(&literals);
        // What cannot come any more, cannot come from the end of the run on: it has to end there.
        let ends = match property {
            Property::AlwaysPossible(_) | Property::NeverStuck => self.runs(trace, &course, Lit::TRUE),
            Property::Never(_) | Property::Eventually { .. } => None,
        };
        let shows = |calm: &Trace| match property {
            Property::Never(bad) => self.runs(calm, &course, bad).is_some_and(|(last, _)| last),
            Property::AlwaysPossible(_) | Property::NeverStuck => self.runs(calm, &course, Lit::TRUE) == ends,
            Property::Eventually { .. } => self.shows(calm, property),
        };
        let replay = trace.inputs.len() as u64 * course.nodes.len() as u64;
        let mut left = CALM.max(TRIES.saturating_mul(replay));
        // Whole inputs first, then shorter and shorter stretches.
        let mut stretch = calm.inputs.len();
        while stretch > 0 {
            for input in 0..self.inputs.len() {
                for start in (0..calm.inputs.len()).step_by(stretch) {
                    let value = start > 0 && calm.inputs[start - 1][input];
                    let end = (start + stretch).min(calm.inputs.len());
                    let behind = calm.inputs.get(end).map(|scan| scan[input]);
                    let stretched = &mut calm.inputs[start..end];
                    let was: Vec<bool> = stretched.iter().map(|scan| scan[input]).collect();
                    // Changes before, inside and behind the stretch; with its new values there is one behind it at most.
                    let ends = [Some(value)].into_iter().chain(was.iter().copied().map(Some)).chain([behind]);
                    let ends: Vec<bool> = ends.flatten().collect();
                    let changes = ends.windows(2).filter(|w| w[0] != w[1]).count();
                    if changes <= usize::from(behind.is_some_and(|behind| behind != value)) {
                        continue;
                    }
                    if left < replay || stop() {
                        return calm;
                    }
                    left -= replay;
                    stretched.iter_mut().for_each(|scan| scan[input] = value);
                    if !shows(&calm) {
                        calm.inputs[start..end].iter_mut().zip(was).for_each(|(scan, was)| scan[input] = was);
                    }
                }
            }
            stretch /= 2;
        }
        calm
    }
}
