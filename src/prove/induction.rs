//! The two halves of an induction over scans: that a program and a chart agree after the first scan,
//! and that if they agree before a scan they agree after it.
//!
//! Both sides are encoded into one graph. What the program remembers is not a second set of free bits
//! but the chart's literal itself, through its [`Meaning`]; so the correspondence is the induction
//! hypothesis, and what has equal structure on both sides is equal at once. The rest is proved piece by
//! piece in the order in which the program computes it, and each piece that is proved is replaced by
//! the chart's literal, so that no later question has to prove it again.

use super::chart_step::{ChartScan, ChartState};
use super::configuration;
use super::lemmas::Lemmas;
use super::matching::{Match, Pair};
use super::parts::{Meaning, Part};
use super::program_step::{ProgramState, ProgramStep};
use crate::bits::aig::{Aig, Lit, lanes};
use crate::bits::random::Random;
use crate::bits::sat::{Answer, Budget, Model, Sat};
use crate::ir::chart::{IntegerId, RegionId};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// How many words of 64 random assignments are tried before a solver is asked.
const WORDS: usize = 4;

/// What has to be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// After the scan, in this region exactly one state is active, or none if its parent is not.
    Configuration(RegionId),
    /// After the scan, the last state of this region is its active one; one or none if it has none.
    History(RegionId),
    /// After the scan, the integer is within its range.
    Range(IntegerId),
    /// After the scan, the state of this timer has not both been entered and lasted for its time.
    Clock(usize),
    /// After the scan, the latch holds this part.
    Part(Part, usize),
    /// After the scan, the latch holds this for the next one.
    Memory(Meaning, usize),
}

/// A claim that could not be shown.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Which.
    pub claim: Claim,
    /// From where it fails, if that is known: the state of memory before the scan and its inputs.
    pub from: Option<Situation>,
}

/// From where a scan goes wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Situation {
    /// What the chart remembers, as [`ChartState::bits`] orders it.
    pub memory: Vec<bool>,
    /// For each input, its value in this scan.
    pub inputs: Vec<bool>,
}

/// How claims were shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// All claims.
    pub claims: usize,
    /// Those where both sides are one node of the graph, or have been compared before.
    pub by_structure: usize,
    /// Those that a solver was asked about.
    pub by_solver: usize,
    /// Nodes of the graph.
    pub nodes: usize,
}

/// Chart and program before a scan, and the chart after it, in one graph.
struct Both<'a> {
    pair: Pair<'a>,
    aig: Aig,
    before: ChartState,
    inputs: Vec<Lit>,
    clocks: Vec<Lit>,
    chart: ChartScan,
    program: ProgramState,
    /// What has been assumed on the way here.
    given: Lit,
}

/// The first `scans` scans: everything is what it is at power-up.
pub fn base(pair: Pair<'_>, matched: &Match, scans: usize, sat: &mut Sat) -> (Count, Vec<Failure>) {
    let mut both = Both::power_up(pair);
    let mut compare = Compare::new(sat);
    let mut failures = Vec::new();
    for scan in 1..=scans {
        let (state, found) = both.examine(matched, &mut compare);
        failures.extend(found);
        if scan < scans {
            both = both.next(state);
        }
    }
    compare.count.nodes = both.aig.len();
    (compare.count, failures)
}

/// Any later scan, from every configuration that `lemmas` do not exclude and every value of all that is
/// remembered, if the claims have held in as many scans before it as `history` says.
pub fn step(
    pair: Pair<'_>,
    matched: &Match,
    history: usize,
    lemmas: &Lemmas<'_>,
    sat: &mut Sat,
) -> (Count, Vec<Failure>) {
    let mut both = Both::later(pair, matched, history, lemmas);
    let mut compare = Compare::new(sat);
    let (_, failures) = both.examine(matched, &mut compare);
    compare.count.nodes = both.aig.len();
    (compare.count, failures)
}

/// One scan of both, the program cut before its filter.
pub struct Cut {
    /// The graph.
    pub aig: Aig,
    /// What the chart remembers from before.
    pub before: ChartState,
    /// The inputs.
    pub inputs: Vec<Lit>,
    /// The chart's scan, which knows nothing of the cut.
    pub chart: ChartScan,
    /// For each output, its command: free, unless nothing ever commands it.
    pub commands: Vec<Lit>,
    /// For each output, what the program makes of these commands.
    pub outputs: Vec<Lit>,
    /// What is known of what is remembered.
    pub given: Lit,
}

/// Where numbers are computed in one scan.
pub struct Sums {
    /// The graph.
    pub aig: Aig,
    /// What is known of what is remembered.
    pub given: Lit,
    /// What is made of them, and whether it leaves its type.
    pub leave: Vec<(String, Lit)>,
}

/// What holds once the claims have been shown: in the first scan, and with what the proof of [`step`] rests on in any
/// later one.
#[derive(Clone, Copy)]
pub struct Shown<'s, 'a> {
    /// The two sides.
    pub pair: Pair<'a>,
    /// What joins them.
    pub matched: &'s Match,
    /// How many scans back the proof has looked.
    pub history: usize,
    /// What it has learned.
    pub lemmas: &'s Lemmas<'s>,
}

impl<'a> Shown<'_, 'a> {
    fn scans(self) -> [Both<'a>; 2] {
        [Both::power_up(self.pair), Both::later(self.pair, self.matched, self.history, self.lemmas)]
    }

    /// Both scans, in which the program reads whatever commands there may be instead of those that it has computed.
    pub fn cut(self) -> [Cut; 2] {
        self.scans().map(|mut both| {
            let (commands, outputs) = both.cut(self.matched);
            let Both { aig, before, inputs, chart, given, .. } = both;
            Cut { aig, before, inputs, chart, commands, outputs, given }
        })
    }

    /// Where numbers are computed in both scans.
    pub fn sums(self) -> [Sums; 2] {
        self.scans().map(|mut both| {
            let (inputs, clocks) = both.given_to_program(self.matched);
            let sums = self.pair.program.sums(&mut both.aig, &both.program, &inputs, &clocks);
            Sums { aig: both.aig, given: both.given, leave: sums }
        })
    }
}

/// Looks for meanings of those latches whose values before a scan matter but whose meaning is not
/// known by construction; returns how many were found. What is found is a guess and becomes a claim.
/// Latches that `hopeless` names are left alone. With `any_commands` those matter, too, that do so only for commands which the
/// chart never gives.
pub fn guess(pair: Pair<'_>, matched: &mut Match, hopeless: &BTreeSet<usize>, any_commands: bool) -> usize {
    let mut both = Both::anywhere(pair, matched);
    let before = both.program.clone();
    let after = both.run(matched, &mut |_, _, _| {});
    let mut claimed: Vec<Lit> = claims(pair.program, matched).iter().map(|c| after[c.latch()]).collect();
    if any_commands {
        claimed.extend(both.cut(matched).1);
    }
    let unknown: BTreeMap<usize, usize> = (0..matched.meanings.len())
        .filter(|l| matched.meanings[*l].is_none() && !hopeless.contains(l))
        .map(|l| (before[l].node(), l))
        .collect();
    let mut matter: Vec<usize> = both.aig.cone(&claimed).into_iter().filter_map(|n| unknown.get(&n).copied()).collect();
    matter.sort_unstable();

    let mut by_structure: HashMap<Lit, Meaning> = HashMap::new();
    let mut by_values: HashMap<[u64; WORDS], Meaning> = HashMap::new();
    let samples = samples(&both.aig);
    for meaning in Meaning::all(pair.machine) {
        for meaning in [meaning, meaning.opposite()] {
            let lit = meaning.of(&both.chart.after);
            by_structure.entry(lit).or_insert(meaning);
            by_values.entry(signature(&samples, lit)).or_insert(meaning);
        }
    }
    let power_up = pair.program.power_up();
    let mut found = 0;
    for latch in matter {
        let lit = after[latch];
        let signature = signature(&samples, lit);
        // Values that never change say nothing: what they would hint at happens too rarely.
        let varies = signature.iter().any(|w| *w != 0 && *w != u64::MAX);
        let alike = || by_values.get(&signature).filter(|_| varies).copied();
        let meaning = match lit.constant() {
            Some(value) => Some(Meaning::Constant(value)),
            None => by_structure.get(&lit).copied().or_else(alike),
        };
        // Or nothing ever changes it, such as a coil that only resets.
        let kept = || power_up[latch].constant().map(Meaning::Constant);
        let meaning = meaning.or_else(kept);
        found += usize::from(meaning.is_some());
        matched.guessed[latch] = meaning.is_some();
        matched.meanings[latch] = meaning;
    }
    found
}

impl Claim {
    /// The latch that it is about.
    fn latch(&self) -> usize {
        match self {
            Claim::Part(_, latch) | Claim::Memory(_, latch) => *latch,
            Claim::Configuration(_) | Claim::History(_) | Claim::Range(_) | Claim::Clock(_) => {
                unreachable!("they are about the chart alone")
            }
        }
    }

    /// The latch, if the claim is only a guess about it.
    pub fn guess(&self, matched: &Match) -> Option<usize> {
        match self {
            Claim::Memory(_, latch) if matched.guessed[*latch] => Some(*latch),
            Claim::Memory(..)
            | Claim::Part(..)
            | Claim::Configuration(_)
            | Claim::History(_)
            | Claim::Range(_)
            | Claim::Clock(_) => None,
        }
    }

    /// What the latch should hold, and when.
    fn expects(&self, chart: &ChartScan) -> (Lit, Lit) {
        match self {
            Claim::Part(part, _) => (part.after(chart), Lit::TRUE),
            Claim::Memory(meaning, _) => (meaning.of(&chart.after), meaning.matters(&chart.after)),
            Claim::Configuration(_) | Claim::History(_) | Claim::Range(_) | Claim::Clock(_) => {
                unreachable!("they are about the chart alone")
            }
        }
    }
}

/// All claims about latches, each latch's own first.
fn claims(program: &ProgramStep<'_>, matched: &Match) -> Vec<Claim> {
    let mut claims: Vec<Claim> = matched.parts.iter().map(|&(part, latch)| Claim::Part(part, latch)).collect();
    // Said already by the claim about the part.
    let said: BTreeMap<usize, Meaning> =
        matched.parts.iter().filter_map(|&(part, latch)| Some((latch, part.remembered()?))).collect();
    let written = program.written();
    for (latch, meaning) in matched.meanings.iter().enumerate() {
        let Some(meaning) = *meaning else { continue };
        // What is not written holds what it held.
        let constant = matches!(meaning, Meaning::Constant(_)) && !written[latch];
        if !constant && said.get(&latch) != Some(&meaning) {
            claims.push(Claim::Memory(meaning, latch));
        }
    }
    claims
}

impl<'a> Both<'a> {
    fn power_up(pair: Pair<'a>) -> Both<'a> {
        let mut aig = Aig::new();
        let inputs = leaves(&mut aig, pair);
        let chart = pair.chart.first(&mut aig, &inputs);
        let none = |n: usize| vec![Lit::FALSE; n];
        let timers = pair.chart.timers().len();
        let before = ChartState {
            active: none(pair.machine.states.len()),
            variables: pair.machine.variables.values().map(|v| Lit::of(v.initial)).collect(),
            inputs: inputs.clone(),
            outputs: none(pair.machine.outputs.len()),
            raised: none(pair.machine.events.len()),
            fresh: none(timers),
            past: none(timers),
            marks: none(pair.machine.safety.marks().count()),
            last: pair.machine.states.ids().map(|s| pair.chart.remembers(s).then_some(Lit::FALSE)).collect(),
            integers: super::chart_numbers::initial(pair.machine),
            scans: vec![super::chart_numbers::no_scan(); pair.chart.scans()],
        };
        let program = pair.program.power_up();
        Both { pair, aig, before, inputs, clocks: none(timers), chart, program, given: Lit::TRUE }
    }

    fn anywhere(pair: Pair<'a>, matched: &Match) -> Both<'a> {
        let mut aig = Aig::new();
        let before = configuration::any(&mut aig, pair.machine, pair.chart);
        let mut program = Vec::new();
        for (&latch, meaning) in pair.program.latches().iter().zip(&matched.meanings) {
            let value = meaning.map_or((Lit::FALSE, Lit::FALSE), |m| (m.of(&before), m.matters(&before)));
            program.push(match value {
                (value, Lit::TRUE) => value,
                (value, matters) => {
                    let anything = aig.leaf(pair.program.name(latch));
                    aig.select(matters, value, anything)
                }
            });
        }
        Both::before(pair, aig, before, program, Lit::TRUE)
    }

    /// Any later scan, if the claims have held in as many scans before it as `history` says.
    fn later(pair: Pair<'a>, matched: &Match, history: usize, lemmas: &Lemmas<'_>) -> Both<'a> {
        let mut both = Both::anywhere(pair, matched);
        both.given = lemmas.hold(&mut both.aig, &both.before);
        for _ in 0..history {
            let state = both.presume(matched);
            both = both.next(state);
            let hold = lemmas.hold(&mut both.aig, &both.before);
            both.given = both.aig.and(both.given, hold);
        }
        both
    }

    /// A later scan from what is remembered.
    fn before(pair: Pair<'a>, mut aig: Aig, before: ChartState, program: ProgramState, given: Lit) -> Both<'a> {
        let inputs = leaves(&mut aig, pair);
        let clock = |(s, ms)| aig.leaf(format!("{} for {ms} ms", pair.machine.state_path(s)));
        let clocks: Vec<Lit> = pair.chart.timers().map(clock).collect();
        let chart = pair.chart.scan(&mut aig, &before, &inputs, &clocks);
        Both { pair, aig, before, inputs, clocks, chart, program, given }
    }

    /// The scan after this one.
    fn next(self, program: ProgramState) -> Both<'a> {
        Both::before(self.pair, self.aig, self.chart.after, program, self.given)
    }

    /// Runs the program's scan.
    fn run(&mut self, matched: &Match, after: &mut impl FnMut(&mut Aig, usize, &mut ProgramState)) -> ProgramState {
        let (inputs, clocks) = self.given_to_program(matched);
        self.pair.program.scan(&mut self.aig, &self.program, &inputs, &clocks, after)
    }

    /// The inputs of the program, and whether the times of its timers have passed.
    fn given_to_program(&mut self, matched: &Match) -> (Vec<(usize, Lit)>, Vec<Lit>) {
        let inputs: Vec<(usize, Lit)> = matched.inputs.iter().copied().zip(self.inputs.iter().copied()).collect();
        // A timer of which nothing is known may end whenever it likes. One that measures a time of the
        // chart ends when that does: they start together, which is among the claims.
        let mut clocks = Vec::new();
        for (timer, preset) in matched.timers.iter().zip(self.pair.program.presets()) {
            clocks.push(match (timer, preset) {
                (Some(timer), _) => self.clocks[timer.index],
                (None, Some(_)) => self.aig.leaf("a timer"),
                (None, None) => Lit::FALSE,
            });
        }
        (inputs, clocks)
    }

    /// Runs the program's scan with free commands in place of those that it computes; returns them, and what it lets through.
    fn cut(&mut self, matched: &Match) -> (Vec<Lit>, Vec<Lit>) {
        let of = |wanted: fn(&Part) -> Option<usize>| {
            let mut latches: Vec<(usize, usize)> =
                matched.parts.iter().filter_map(|(part, latch)| Some((wanted(part)?, *latch))).collect();
            latches.sort_unstable();
            latches
        };
        let commands = of(|part| if let Part::Command(o) = part { Some(o.index()) } else { None });
        let outputs = of(|part| if let Part::Output(o) = part { Some(o.index()) } else { None });
        let last = self.pair.program.last_writers();
        let mut free = vec![Lit::FALSE; self.pair.machine.outputs.len()];
        let chart = self.chart.clone();
        let state = self.run(matched, &mut |aig, program, state| {
            // Of these it is known what they are.
            for &(part, latch) in matched.parts.iter().filter(|(_, latch)| last[*latch] == Some(program)) {
                if matches!(part, Part::Flag(_) | Part::Step(_) | Part::Variable(_) | Part::Bit(..)) {
                    state[latch] = part.after(&chart);
                }
            }
            for &(output, latch) in commands.iter().filter(|(_, latch)| last[*latch] == Some(program)) {
                free[output] = aig.leaf(format!("command {output}"));
                state[latch] = free[output];
            }
        });
        (free, outputs.iter().map(|&(_, latch)| state[latch]).collect())
    }

    /// Assumes all claims and returns what the program remembers then.
    fn presume(&mut self, matched: &Match) -> ProgramState {
        let mut state = self.run(matched, &mut |_, _, _| {});
        for claim in claims(self.pair.program, matched) {
            let (expected, matters) = claim.expects(&self.chart);
            let found = state[claim.latch()];
            let equal = self.aig.equal(found, expected);
            let holds = self.aig.or(equal, !matters);
            self.given = self.aig.and(self.given, holds);
            state[claim.latch()] = self.aig.select(matters, expected, found);
        }
        state
    }

    /// Examines all claims; returns what the program remembers if they hold, and those that do not.
    fn examine(&mut self, matched: &Match, compare: &mut Compare<'_>) -> (ProgramState, Vec<Failure>) {
        let mut failures = Vec::new();
        for region in self.pair.machine.regions.ids() {
            let broken = configuration::broken(&mut self.aig, self.pair.machine, region, &self.chart.after.active);
            if let Outcome::Differs(model) = compare.same(&mut self.aig, broken, Lit::FALSE, self.given) {
                failures.push((Claim::Configuration(region), model));
            }
        }
        for (region, _) in self.pair.machine.regions.iter().filter(|(_, r)| self.pair.chart.remembers(r.initial)) {
            let confused = configuration::confused(&mut self.aig, self.pair.machine, region, &self.chart.after);
            if let Outcome::Differs(model) = compare.same(&mut self.aig, confused, Lit::FALSE, self.given) {
                failures.push((Claim::History(region), model));
            }
        }
        for (id, integer) in self.pair.machine.integers.iter() {
            let beyond = configuration::beyond(&mut self.aig, integer, &self.chart.after.integers[id.index()]);
            if let Outcome::Differs(model) = compare.same(&mut self.aig, beyond, Lit::FALSE, self.given) {
                failures.push((Claim::Range(id), model));
            }
        }
        for index in 0..self.clocks.len() {
            let fresh = self.aig.and(self.chart.after.fresh[index], self.given);
            let past = self.chart.after.past[index];
            if let Outcome::Differs(model) = compare.same(&mut self.aig, past, Lit::FALSE, fresh) {
                failures.push((Claim::Clock(index), model));
            }
        }
        // Each claim is examined when the last program that writes its latch has run.
        let last = self.pair.program.last_writers();
        let mut due: Vec<Vec<Claim>> = vec![Vec::new(); last.iter().flatten().max().map_or(0, |p| p + 1)];
        let mut unwritten = Vec::new();
        for claim in claims(self.pair.program, matched) {
            match last[claim.latch()] {
                Some(p) => due[p].push(claim),
                None => unwritten.push(claim),
            }
        }
        let (chart, given) = (self.chart.clone(), self.given);
        let mut settle = |aig: &mut Aig, claims: &[Claim], state: &mut ProgramState| {
            for &claim in claims {
                let (expected, matters) = claim.expects(&chart);
                let assumed = aig.and(given, matters);
                let found = state[claim.latch()];
                match compare.same(aig, found, expected, assumed) {
                    // Where it does not matter the latch holds what it holds, and others may read it.
                    Outcome::Same => state[claim.latch()] = aig.select(matters, expected, found),
                    Outcome::Differs(model) => failures.push((claim, model)),
                }
            }
        };
        let mut state = self.run(matched, &mut |aig, p, state| {
            if let Some(claims) = due.get(p) {
                settle(aig, claims, state);
            }
        });
        settle(&mut self.aig, &unwritten, &mut state);
        let failures = failures.into_iter().map(|(claim, model)| Failure { claim, from: model.map(|m| self.read(&m)) });
        (state, failures.collect())
    }

    fn read(&self, model: &Model) -> Situation {
        let values = model.evaluate(&self.aig);
        let read = |lits: &[Lit]| lits.iter().map(|&l| lanes(&values, l) & 1 == 1).collect();
        Situation { memory: read(&self.before.bits()), inputs: read(&self.inputs) }
    }
}

fn leaves(aig: &mut Aig, pair: Pair<'_>) -> Vec<Lit> {
    pair.machine.inputs.values().map(|i| aig.leaf(&i.name)).collect()
}

/// What came of a comparison; a difference without a model means that the solver gave up.
enum Outcome {
    Same,
    Differs(Option<Model>),
}

/// Compares literals of one growing graph: by structure, by random values, by a solver.
struct Compare<'s> {
    sat: &'s mut Sat,
    random: Random,
    leaves: Vec<Vec<u64>>,
    samples: Vec<Vec<u64>>,
    /// What has been proved, and where: a step and its flag are two claims about one literal.
    proved: HashSet<(Lit, Lit, Lit)>,
    count: Count,
}

impl<'s> Compare<'s> {
    fn new(sat: &'s mut Sat) -> Self {
        let empty = || vec![Vec::new(); WORDS];
        let count = Count::default();
        Compare { sat, random: Random::new(1), leaves: empty(), samples: empty(), proved: HashSet::new(), count }
    }

    /// Whether `a` and `b` are the same wherever `given` holds.
    fn same(&mut self, aig: &mut Aig, a: Lit, b: Lit, given: Lit) -> Outcome {
        self.count.claims += 1;
        if a == b || given == Lit::FALSE || self.proved.contains(&(a, b, given)) {
            self.count.by_structure += 1;
            return Outcome::Same;
        }
        let differ = aig.xor(a, b);
        let differ = aig.and(differ, given);
        for (leaves, values) in self.leaves.iter_mut().zip(&mut self.samples) {
            while leaves.len() < aig.leaves().len() {
                leaves.push(self.random.word());
            }
            aig.simulate(leaves, values);
            let word = lanes(values, differ);
            if word != 0 {
                let lane = word.trailing_zeros();
                let bits = leaves.iter().enumerate().map(|(i, w)| (i as u32, w >> lane & 1 == 1));
                return Outcome::Differs(Some(bits.collect()));
            }
        }
        self.count.by_solver += 1;
        self.sat.forget();
        match self.sat.ask(aig, &[differ], Budget::PROOF) {
            Answer::Never => {
                self.proved.insert((a, b, given));
                Outcome::Same
            }
            Answer::Sometimes(model) => Outcome::Differs(Some(model)),
            Answer::GaveUp => Outcome::Differs(None),
        }
    }
}

fn samples(aig: &Aig) -> Vec<Vec<u64>> {
    let mut random = Random::new(2);
    let word = |_| {
        let leaves: Vec<u64> = aig.leaves().map(|_| random.word()).collect();
        let mut values = Vec::new();
        aig.simulate(&leaves, &mut values);
        values
    };
    (0..WORDS).map(word).collect()
}

fn signature(samples: &[Vec<u64>], l: Lit) -> [u64; WORDS] {
    std::array::from_fn(|i| lanes(&samples[i], l))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_the_same_under_an_assumption_is_not_taken_for_the_same_without_it() {
        let mut aig = Aig::new();
        let (left, right) = (aig.leaf("left"), aig.leaf("right"));
        let both = aig.and(left, right);
        let mut sat = Sat::new();
        let mut compare = Compare::new(&mut sat);
        assert!(matches!(compare.same(&mut aig, both, left, right), Outcome::Same));
        assert!(matches!(compare.same(&mut aig, both, left, Lit::TRUE), Outcome::Differs(Some(_))));
        assert!(matches!(compare.same(&mut aig, both, left, right), Outcome::Same));
        assert_eq!((compare.count.claims, compare.count.by_structure, compare.count.by_solver), (3, 1, 1));
    }
}
