//! State by state: the exact engine for what depends on a small part of a system only.
//!
//! What a claim depends on is often one counter among many, or one region. Of such a part each state is visited, breadth first, with all
//! values of its inputs at once in the [lanes] of a word: a long way costs no more than a short one, where sets
//! of states as decision diagrams take one operation for each scan of it. Parts are explored apart; a claim about several of them
//! together is left to others.
//!
//! Time passes scan by scan here, so that the runs are the shortest ones there are.

use super::aig::{Aig, Lit, Node, lanes, transpose};
use super::limits::{Limits, Stop};
use super::system::{Giver, Latch, Property, System, Trace};
use std::collections::{BTreeMap, HashMap};

/// The most inputs that a part may have.
const INPUTS: usize = 12;

/// The most bits that may begin in two ways.
const BEGINNINGS: usize = 8;

/// States that a part may have.
const STATES: usize = 1 << 21;

/// Evaluations of gates, for 64 pairs of a state and inputs at once, that a part may take for each operation on decision diagrams that
/// would be allowed.
const GATES: u64 = 15;

/// How many times as many all parts together may take.
const PARTS: u64 = 8;

/// What it costs to look one state up, in evaluations of gates.
const LOOK: u64 = 40;

/// For each claim what was found out: that it holds, or a run that shows that it does not.
pub type Verdicts = Vec<Option<Result<(), Trace>>>;

/// Explores the parts on which those claims depend that are `wanted`. `progress` is told how many parts there are still to go.
pub fn explore(
    system: &System,
    wanted: &[bool],
    limits: &Limits,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(usize),
) -> Verdicts {
    let gates = limits.steps.saturating_mul(GATES);
    let still = still(system);
    let groups = groups(&still, wanted);
    let mut verdicts: Verdicts = vec![None; system.claims.len()];
    let (mut left, mut spent) = (groups.len(), 0);
    for (part, asked) in groups {
        progress(left);
        left -= 1;
        let asked: Vec<Asked> = asked.into_iter().filter(|a| verdicts[a.claim].is_none()).collect();
        if stop() || spent > gates.saturating_mul(PARTS) {
            break;
        }
        if asked.is_empty() {
            continue;
        }
        let mut search = Search::new(&still, &part, asked, gates);
        search.run(stop);
        spent += search.spent;
        for (asked, found) in search.asked.iter().zip(search.found) {
            match found {
                Some(Err(_)) if asked.partly => {}
                Some(found) => verdicts[asked.claim] = Some(found),
                None => {}
            }
        }
    }
    verdicts
}

/// The same system without the leaps that time may make: each is one scan after the other.
fn still(system: &System) -> System {
    let leaps = system.inputs.iter().any(|i| i.giver == Giver::Wait);
    let rests = |giver| giver == Giver::Wait || leaps && giver == Giver::Clock;
    // What is not asked here belongs to the other graph.
    let none = System { aig: Aig::new(), ..System::default() };
    let (latches, inputs) = (system.latches.clone(), system.inputs.clone());
    let mut still =
        System { latches, inputs, constraints: system.constraints.clone(), claims: system.claims.clone(), ..none };
    let mut leaf: Vec<Lit> = vec![Lit::FALSE; system.aig.leaves().len()];
    for (i, l) in system.latches.iter().enumerate() {
        still.latches[i].leaf = still.aig.leaf(system.name(l.leaf));
        leaf[system.aig.number(l.leaf)] = still.latches[i].leaf;
    }
    for (i, input) in system.inputs.iter().enumerate() {
        still.inputs[i].leaf = still.aig.leaf(system.name(input.leaf));
        if !rests(input.giver) {
            leaf[system.aig.number(input.leaf)] = still.inputs[i].leaf;
        }
    }
    let nexts = system.latches.iter().map(|l| l.next);
    let claimed = system.claims.iter().flat_map(|c| c.property.literals());
    let roots: Vec<Lit> = nexts.chain(system.constraints.iter().copied()).chain(claimed).collect();
    let image = still.aig.import(&system.aig, &roots, &mut |_, n| leaf[n as usize]);
    let mut image = image.into_iter();
    let mut next = || image.next().expect("each root has an image");
    still.latches.iter_mut().for_each(|l| l.next = next());
    still.constraints.iter_mut().for_each(|c| *c = next());
    for claim in &mut still.claims {
        claim.property = match claim.property {
            Property::Never(_) => Property::Never(next()),
            Property::AlwaysPossible(_) => Property::AlwaysPossible(next()),
            Property::NeverStuck => Property::NeverStuck,
            Property::Eventually { .. } => Property::Eventually { after: next(), then: next() },
        };
    }
    still.constraints.retain(|&c| c != Lit::TRUE);
    still
}

/// What is asked of a part.
struct Asked {
    claim: usize,
    property: Property,
    /// Whether only that it holds tells something about the claim.
    partly: bool,
}

/// A part of a system: all that something depends on, and the constraints that bear on it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    inputs: Vec<usize>,
    latches: Vec<usize>,
    constraints: Vec<usize>,
}

/// The parts on which claims depend, small ones first, with what is asked of each.
fn groups(system: &System, wanted: &[bool]) -> Vec<(Part, Vec<Asked>)> {
    let cones: Vec<(Vec<usize>, Vec<usize>)> = system.constraints.iter().map(|&c| system.cone(&[c])).collect();
    let mut groups: BTreeMap<Part, Vec<Asked>> = BTreeMap::new();
    let mut ask = |claim: usize, property: Property, partly: bool| {
        let part = part(system, &cones, property);
        if part.inputs.len() <= INPUTS {
            groups.entry(part).or_default().push(Asked { claim, property, partly });
        }
    };
    for (claim, property) in system.claims.iter().map(|c| c.property).enumerate().filter(|&(i, _)| wanted[i]) {
        match property {
            Property::Never(_) | Property::NeverStuck => ask(claim, property, false),
            Property::AlwaysPossible(goal) => {
                ask(claim, property, false);
                // Of several things of which one is to stay possible, one may by itself.
                let ways = alternatives(system, goal);
                ways.iter().for_each(|&way| ask(claim, Property::AlwaysPossible(way), true));
            }
            Property::Eventually { .. } => {}
        }
    }
    let mut groups: Vec<(Part, Vec<Asked>)> = groups.into_iter().collect();
    groups.sort_by_key(|(part, _)| part.latches.len() + part.inputs.len());
    groups
}

/// All that a property depends on. What is to stay possible depends on all constraints, for a run has to be able to go on.
fn part(system: &System, cones: &[(Vec<usize>, Vec<usize>)], property: Property) -> Part {
    let all = !matches!(property, Property::Never(_));
    let mut constraints: Vec<usize> = if all { (0..cones.len()).collect() } else { Vec::new() };
    loop {
        let roots: Vec<Lit> = constraints.iter().map(|&c| system.constraints[c]).chain(property.literals()).collect();
        let (latches, inputs) = system.cone(&roots);
        let meets = |(l, i): &(Vec<usize>, Vec<usize>)| {
            l.iter().any(|l| latches.binary_search(l).is_ok()) || i.iter().any(|i| inputs.binary_search(i).is_ok())
        };
        let bear: Vec<usize> = (0..cones.len()).filter(|&c| all || meets(&cones[c])).collect();
        if bear.len() == constraints.len() {
            return Part { inputs, latches, constraints };
        }
        constraints = bear;
    }
}

/// The literals of which the goal says that one of them is TRUE; none if it says something else.
fn alternatives(system: &System, goal: Lit) -> Vec<Lit> {
    let mut ways = Vec::new();
    let mut open = vec![!goal];
    while let Some(l) = open.pop() {
        match system.aig.node(l.node()) {
            Node::And(a, b) if !l.is_negated() => open.extend([b, a]),
            _ if l == !goal => return Vec::new(),
            _ => ways.push(!l),
        }
    }
    ways
}

/// A state by its number.
type State = u32;

struct Search<'s> {
    system: &'s System,
    part: &'s Part,
    asked: Vec<Asked>,
    found: Verdicts,
    /// Nodes to be evaluated, in order.
    cone: Vec<usize>,
    values: Vec<u64>,
    /// How many words the bits of a state take.
    words: usize,
    /// The states in the order in which they were met, each in so many words.
    states: Vec<u64>,
    numbers: HashMap<Box<[u64]>, State>,
    /// For each state, from where it was met first, and by which inputs; a state that begins comes from itself.
    from: Vec<(State, u32)>,
    /// For each state, where the states that follow it begin among `after`, if that is to be known.
    follow: Option<Vec<usize>>,
    after: Vec<State>,
    /// For what is asked, the states in which it shows that a goal can be reached at once, or that no inputs are left.
    marked: Vec<Vec<State>>,
    spent: u64,
    /// How much may be.
    gates: u64,
}

impl<'s> Search<'s> {
    fn new(system: &'s System, part: &'s Part, asked: Vec<Asked>, gates: u64) -> Search<'s> {
        let literals = asked.iter().flat_map(|a| a.property.literals());
        let constraints = part.constraints.iter().map(|&c| system.constraints[c]);
        let nexts = part.latches.iter().map(|&l| system.latches[l].next);
        let roots: Vec<Lit> = literals.chain(constraints).chain(nexts).collect();
        let backward = asked.iter().any(|a| matches!(a.property, Property::AlwaysPossible(_)));
        let (found, marked) = (vec![None; asked.len()], vec![Vec::new(); asked.len()]);
        Search {
            system,
            part,
            asked,
            found,
            cone: system.aig.cone(&roots),
            values: vec![0; system.aig.len()],
            words: part.latches.len().div_ceil(64).max(1),
            states: Vec::new(),
            numbers: HashMap::new(),
            from: Vec::new(),
            follow: backward.then(|| vec![0]),
            after: Vec::new(),
            marked,
            spent: 0,
            gates,
        }
    }

    /// Visits all states, and says what is so if that comes to an end.
    fn run(&mut self, stop: Stop<'_>) {
        if !self.begin() {
            return;
        }
        let inputs = 1usize << self.part.inputs.len();
        let together = (64 / inputs).max(1);
        let mut first = 0;
        while first < self.from.len() {
            if self.from.len() > STATES || self.spent > self.gates || stop() {
                return;
            }
            let last = (first + together).min(self.from.len());
            let mut follows: Vec<Vec<State>> = vec![Vec::new(); last - first];
            for chunk in 0..inputs.div_ceil(64) {
                self.visit(first..last, chunk, &mut follows);
            }
            self.keep(first, follows);
            first = last;
            if self.found.iter().all(Option::is_some) {
                return;
            }
        }
        self.conclude();
    }

    /// The states in which runs begin. Says whether they are few.
    fn begin(&mut self) -> bool {
        let open = |l: &&usize| self.system.latches[**l].initial.is_none();
        let open: Vec<usize> = self.part.latches.iter().filter(open).copied().collect();
        if open.len() > BEGINNINGS {
            return false;
        }
        for beginning in 0..1usize << open.len() {
            let value = |l: &usize| match open.iter().position(|o| o == l) {
                Some(i) => beginning >> i & 1 == 1,
                None => self.system.latches[*l].initial == Some(true),
            };
            let mut state = vec![0; self.words];
            for (i, l) in self.part.latches.iter().enumerate() {
                state[i / 64] |= u64::from(value(l)) << (i % 64);
            }
            let number = self.from.len() as State;
            self.meet(&state, number, 0);
        }
        true
    }

    /// The number of a state, which is a new one if it is met for the first time.
    fn meet(&mut self, state: &[u64], from: State, inputs: u32) -> State {
        if let Some(&known) = self.numbers.get(state) {
            return known;
        }
        let number = self.from.len() as State;
        self.numbers.insert(state.into(), number);
        self.states.extend_from_slice(state);
        self.from.push((from, inputs));
        number
    }

    /// One scan from each of some states, with 64 values of the inputs or all if they are fewer.
    fn visit(&mut self, states: std::ops::Range<usize>, chunk: usize, follows: &mut [Vec<State>]) {
        let bits = self.part.inputs.len().min(6);
        let width = 1usize << bits;
        let (first, count) = (states.start, states.len());
        let here = if count * width == 64 { u64::MAX } else { (1 << (count * width)) - 1 };
        self.evaluate(states, chunk);
        let word = |l: Lit| lanes(&self.values, l);
        let valid = self.part.constraints.iter().fold(here, |all, &c| all & word(self.system.constraints[c]));
        let of = |lane: usize| (first + lane / width, (chunk * 64 + lane % width) as u32);
        for i in 0..self.asked.len() {
            let shows = match self.asked[i].property {
                Property::Never(l) | Property::AlwaysPossible(l) => valid & word(l),
                // What is marked here has inputs left.
                Property::NeverStuck => valid,
                Property::Eventually { .. } => 0,
            };
            if shows == 0 || self.found[i].is_some() {
                continue;
            }
            if let Property::Never(_) = self.asked[i].property {
                let (state, inputs) = of(shows.trailing_zeros() as usize);
                self.found[i] = Some(Err(self.trace(state, Some(inputs))));
                continue;
            }
            for offset in 0..count {
                let state = (first + offset) as State;
                let own = (shows >> (offset * width)) & (u64::MAX >> (64 - width));
                if own != 0 && self.marked[i].last() != Some(&state) {
                    self.marked[i].push(state);
                }
            }
        }
        self.spent += self.cone.len() as u64 + LOOK * u64::from(valid.count_ones());
        let next: Vec<u64> = self.part.latches.iter().map(|&l| word(self.system.latches[l].next)).collect();
        let mut rows: Vec<[u64; 64]> = Vec::with_capacity(self.words);
        for block in next.chunks(64) {
            let mut row = [0; 64];
            row[..block.len()].copy_from_slice(block);
            transpose(&mut row);
            rows.push(row);
        }
        let mut state = vec![0; self.words];
        let mut left = valid;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            state.iter_mut().zip(&rows).for_each(|(word, row)| *word = row[lane]);
            let (from, inputs) = of(lane);
            let number = self.meet(&state, from as State, inputs);
            let follows = &mut follows[from - first];
            if self.follow.is_some() && follows.last() != Some(&number) {
                follows.push(number);
            }
        }
    }

    fn evaluate(&mut self, states: std::ops::Range<usize>, chunk: usize) {
        /// The values of an input in all lanes: each is TRUE in half of them.
        const HALVES: [u64; 6] = [
            0xaaaa_aaaa_aaaa_aaaa,
            0xcccc_cccc_cccc_cccc,
            0xf0f0_f0f0_f0f0_f0f0,
            0xff00_ff00_ff00_ff00,
            0xffff_0000_ffff_0000,
            0xffff_ffff_0000_0000,
        ];
        let width = 1usize << self.part.inputs.len().min(6);
        for (i, &l) in self.part.latches.iter().enumerate() {
            let mut word = 0;
            for (offset, state) in states.clone().enumerate() {
                let value = self.states[state * self.words + i / 64] >> (i % 64) & 1;
                word |= (value * (u64::MAX >> (64 - width))) << (offset * width);
            }
            self.values[self.system.latches[l].leaf.node()] = word;
        }
        for (i, &input) in self.part.inputs.iter().enumerate() {
            let word = match HALVES.get(i) {
                Some(&half) => half,
                None if chunk >> (i - 6) & 1 == 1 => u64::MAX,
                None => 0,
            };
            self.values[self.system.inputs[input].leaf.node()] = word;
        }
        for &n in &self.cone {
            if let Node::And(a, b) = self.system.aig.node(n) {
                self.values[n] = lanes(&self.values, a) & lanes(&self.values, b);
            }
        }
    }

    /// Keeps what follows each of the states from the first one on.
    fn keep(&mut self, first: usize, follows: Vec<Vec<State>>) {
        let Some(follow) = &mut self.follow else { return };
        debug_assert_eq!(follow.len(), first + 1);
        for mut states in follows {
            states.sort_unstable();
            states.dedup();
            self.after.extend(states);
            follow.push(self.after.len());
        }
    }

    /// All states are known: what has not been found is not so.
    fn conclude(&mut self) {
        for i in 0..self.asked.len() {
            if self.found[i].is_some() {
                continue;
            }
            let lost = match self.asked[i].property {
                Property::Never(_) => None,
                Property::NeverStuck => {
                    (0..self.from.len() as State).find(|s| self.marked[i].binary_search(s).is_err())
                }
                Property::AlwaysPossible(_) => self.lost(&self.marked[i]),
                Property::Eventually { .. } => continue,
            };
            self.found[i] = Some(lost.map_or(Ok(()), |state| Err(self.trace(state as usize, None))));
        }
    }

    /// The first state from which none of the goals can be reached.
    fn lost(&self, goals: &[State]) -> Option<State> {
        let follow = self.follow.as_ref().expect("it is kept where it is asked for");
        let states = self.from.len();
        // The same arrows the other way round.
        let mut begins = vec![0usize; states + 1];
        self.after.iter().for_each(|&to| begins[to as usize + 1] += 1);
        (0..states).for_each(|s| begins[s + 1] += begins[s]);
        let mut place = begins.clone();
        let mut before = vec![0; self.after.len()];
        for from in 0..states {
            for &to in &self.after[follow[from]..follow[from + 1]] {
                before[place[to as usize]] = from as State;
                place[to as usize] += 1;
            }
        }
        let mut saved = vec![false; states];
        let mut open: Vec<State> = goals.to_vec();
        open.iter().for_each(|&s| saved[s as usize] = true);
        while let Some(state) = open.pop() {
            for &from in &before[begins[state as usize]..begins[state as usize + 1]] {
                if !std::mem::replace(&mut saved[from as usize], true) {
                    open.push(from);
                }
            }
        }
        saved.iter().position(|&saved| !saved).map(|s| s as State)
    }

    /// The run to a state, and one scan more if there are inputs for it. Nothing comes in elsewhere.
    fn trace(&self, state: usize, inputs: Option<u32>) -> Trace {
        let mut given: Vec<u32> = inputs.into_iter().collect();
        let mut at = state;
        while self.from[at].0 as usize != at {
            given.push(self.from[at].1);
            at = self.from[at].0 as usize;
        }
        given.reverse();
        let mut initial: Vec<bool> = self.system.latches.iter().map(|l: &Latch| l.initial.unwrap_or(false)).collect();
        for (i, &l) in self.part.latches.iter().enumerate() {
            initial[l] = self.states[at * self.words + i / 64] >> (i % 64) & 1 == 1;
        }
        let scan = |values: &u32| {
            let mut scan = vec![false; self.system.inputs.len()];
            self.part.inputs.iter().enumerate().for_each(|(i, &input)| scan[input] = values >> i & 1 == 1);
            scan
        };
        Trace { initial, inputs: given.iter().map(scan).collect(), shortest: true }
    }
}
