//! The two halves of an induction over scans: that a program and a chart agree after the first scan,
//! and that if they agree before a scan they agree after it.
//!
//! Both sides are encoded into one graph. What the program remembers is not a second set of free bits
//! but the chart's literal itself, through its [`Meaning`]; so the correspondence is the induction
//! hypothesis, and what has equal structure on both sides is equal at once. The rest is proved piece by
//! piece in the order in which the program computes it, and each piece that is proved is replaced by
//! the chart's literal, so that no later question has to prove it again.

use super::aig::{Aig, Lit, lanes};
use super::chart_step::{ChartScan, ChartState, ChartStep};
use super::configuration;
use super::parts::{Match, Meaning, Part};
use super::program_step::{ProgramState, ProgramStep};
use super::random::Random;
use super::sat::{Answer, Budget, Model, Sat};
use crate::ir::chart::{Machine, RegionId};
use std::collections::{BTreeMap, HashMap, HashSet};

/// How many words of 64 random assignments are tried before a solver is asked.
const WORDS: usize = 4;

/// What has to be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// After the scan, in this region exactly one state is active, or none if its parent is not.
    Configuration(RegionId),
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

/// Memory of the chart and inputs, with values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Situation {
    /// For each state, whether it is active.
    pub active: Vec<bool>,
    /// For each variable, its value.
    pub variables: Vec<bool>,
    /// For each input, its value in the last scan.
    pub previous: Vec<bool>,
    /// For each output, its value in the last scan.
    pub outputs: Vec<bool>,
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

/// Both sides, encoded into one graph.
struct Both<'a> {
    aig: Aig,
    before: ChartState,
    inputs: Vec<Lit>,
    chart: ChartScan,
    program: ProgramState,
    machine: &'a Machine,
}

/// The first scan: everything is what it is at power-up.
pub fn base(
    machine: &Machine,
    chart: &ChartStep<'_>,
    program: &ProgramStep<'_>,
    matched: &Match,
    sat: &mut Sat,
) -> (Count, Vec<Failure>) {
    let mut aig = Aig::new();
    let inputs: Vec<Lit> = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
    let scan = chart.first(&mut aig, &inputs);
    let before = ChartState {
        active: vec![Lit::FALSE; machine.states.len()],
        variables: machine.variables.values().map(|v| Lit::of(v.initial)).collect(),
        inputs: inputs.clone(),
        outputs: vec![Lit::FALSE; machine.outputs.len()],
    };
    Both { aig, before, inputs, chart: scan, program: program.power_up(), machine }.examine(program, matched, sat)
}

/// Any later scan, from every configuration and every value of all that is remembered.
pub fn step(
    machine: &Machine,
    chart: &ChartStep<'_>,
    program: &ProgramStep<'_>,
    matched: &Match,
    sat: &mut Sat,
) -> (Count, Vec<Failure>) {
    Both::assumed(machine, chart, program, matched).examine(program, matched, sat)
}

/// Looks for meanings of those latches whose values before a scan matter but whose meaning is not
/// known by construction; returns how many were found. What is found is a guess and becomes a claim.
pub fn guess(
    machine: &Machine,
    chart: &ChartStep<'_>,
    program: &ProgramStep<'_>,
    matched: &mut Match,
) -> usize {
    let mut both = Both::assumed(machine, chart, program, matched);
    let inputs: Vec<(usize, Lit)> = matched.inputs.iter().copied().zip(both.inputs.iter().copied()).collect();
    let after = program.scan(&mut both.aig, &both.program, &inputs, &mut |_, _, _| {});
    let claimed: Vec<Lit> = claims(program, matched).iter().map(|c| after[c.latch()]).collect();
    let unknown: BTreeMap<usize, usize> = (0..matched.meanings.len())
        .filter(|&l| matched.meanings[l].is_none())
        .map(|l| (both.program[l].node(), l))
        .collect();
    let mut matter: Vec<usize> =
        both.aig.cone(&claimed).into_iter().filter_map(|n| unknown.get(&n).copied()).collect();
    matter.sort_unstable();

    let mut by_structure: HashMap<Lit, Meaning> = HashMap::new();
    let mut by_values: HashMap<[u64; WORDS], Meaning> = HashMap::new();
    let samples = samples(&both.aig);
    for meaning in Meaning::all(machine) {
        for meaning in [meaning, meaning.opposite()] {
            let lit = meaning.of(&both.chart.after);
            by_structure.entry(lit).or_insert(meaning);
            by_values.entry(signature(&samples, lit)).or_insert(meaning);
        }
    }
    let mut found = 0;
    for latch in matter {
        let lit = after[latch];
        let signature = signature(&samples, lit);
        let meaning = match lit.constant() {
            Some(value) => Some(Meaning::Constant(value)),
            // Values that never change say nothing: what they would hint at happens too rarely.
            None => by_structure
                .get(&lit)
                .or_else(|| by_values.get(&signature).filter(|_| !signature.iter().all(|w| *w == 0 || *w == u64::MAX)))
                .copied(),
        };
        found += usize::from(meaning.is_some());
        matched.meanings[latch] = meaning;
    }
    found
}

impl Claim {
    /// The latch that it is about.
    fn latch(&self) -> usize {
        match self {
            Claim::Part(_, latch) | Claim::Memory(_, latch) => *latch,
            Claim::Configuration(_) => unreachable!("it is about the chart alone"),
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
    fn assumed(
        machine: &'a Machine,
        chart: &ChartStep<'_>,
        program: &ProgramStep<'_>,
        matched: &Match,
    ) -> Both<'a> {
        let mut aig = Aig::new();
        let before = configuration::any(&mut aig, machine);
        let inputs: Vec<Lit> = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let scan = chart.scan(&mut aig, &before, &inputs);
        let latches = program.latches().iter().zip(&matched.meanings);
        let state = latches.map(|(latch, meaning)| match meaning {
            Some(meaning) => meaning.of(&before),
            None => aig.leaf(program.name(*latch)),
        });
        let state = state.collect();
        Both { aig, before, inputs, chart: scan, program: state, machine }
    }

    fn examine(mut self, program: &ProgramStep<'_>, matched: &Match, sat: &mut Sat) -> (Count, Vec<Failure>) {
        let mut count = Count::default();
        let mut failures = Vec::new();
        let mut compare = Compare::new(sat);
        for region in self.machine.regions.ids() {
            let broken = configuration::broken(&mut self.aig, self.machine, region, &self.chart.after.active);
            if let Outcome::Differs(model) = compare.same(&mut self.aig, broken, Lit::FALSE, &mut count) {
                failures.push((Claim::Configuration(region), model));
            }
        }
        // Each claim is examined when the last program that writes its latch has run.
        let last = program.last_writers();
        let mut due: Vec<Vec<Claim>> = vec![Vec::new(); last.iter().flatten().max().map_or(0, |p| p + 1)];
        let mut unwritten = Vec::new();
        for claim in claims(program, matched) {
            match last[claim.latch()] {
                Some(p) => due[p].push(claim),
                None => unwritten.push(claim),
            }
        }
        let inputs: Vec<(usize, Lit)> = matched.inputs.iter().copied().zip(self.inputs.iter().copied()).collect();
        let chart = &self.chart;
        let mut settle = |aig: &mut Aig, claims: &[Claim], state: &mut ProgramState| {
            for &claim in claims {
                let expected = match claim {
                    Claim::Part(part, _) => part.after(chart),
                    Claim::Memory(meaning, _) => meaning.of(&chart.after),
                    Claim::Configuration(_) => unreachable!("it is about the chart alone"),
                };
                match compare.same(aig, state[claim.latch()], expected, &mut count) {
                    Outcome::Same => state[claim.latch()] = expected,
                    Outcome::Differs(model) => failures.push((claim, model)),
                }
            }
        };
        let mut state = program.scan(&mut self.aig, &self.program, &inputs, &mut |aig, p, state| {
            if let Some(claims) = due.get(p) {
                settle(aig, claims, state);
            }
        });
        settle(&mut self.aig, &unwritten, &mut state);
        count.nodes = self.aig.len();
        let failures = failures.into_iter().map(|(claim, model)| Failure { claim, from: model.map(|m| self.read(&m)) });
        (count, failures.collect())
    }

    fn read(&self, model: &Model) -> Situation {
        let values = model.evaluate(&self.aig);
        let read = |lits: &[Lit]| lits.iter().map(|&l| lanes(&values, l) & 1 == 1).collect();
        Situation {
            active: read(&self.before.active),
            variables: read(&self.before.variables),
            previous: read(&self.before.inputs),
            outputs: read(&self.before.outputs),
            inputs: read(&self.inputs),
        }
    }
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
    /// What has been proved: a step and its flag are two claims about one literal.
    proved: HashSet<(Lit, Lit)>,
}

impl<'s> Compare<'s> {
    fn new(sat: &'s mut Sat) -> Self {
        let empty = || vec![Vec::new(); WORDS];
        Compare { sat, random: Random::new(1), leaves: empty(), samples: empty(), proved: HashSet::new() }
    }

    fn same(&mut self, aig: &mut Aig, a: Lit, b: Lit, count: &mut Count) -> Outcome {
        count.claims += 1;
        if a == b || self.proved.contains(&(a, b)) {
            count.by_structure += 1;
            return Outcome::Same;
        }
        let differ = aig.xor(a, b);
        for (leaves, values) in self.leaves.iter_mut().zip(&mut self.samples) {
            while leaves.len() < aig.leaves().len() {
                leaves.push(self.random.next());
            }
            aig.simulate(leaves, values);
            let word = lanes(values, differ);
            if word != 0 {
                let lane = word.trailing_zeros();
                let bits = leaves.iter().enumerate().map(|(i, w)| (i as u32, w >> lane & 1 == 1));
                return Outcome::Differs(Some(bits.collect()));
            }
        }
        count.by_solver += 1;
        self.sat.forget();
        match self.sat.ask(aig, &[differ], Budget::PROOF) {
            Answer::Never => {
                self.proved.insert((a, b));
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
        let leaves: Vec<u64> = aig.leaves().map(|_| random.next()).collect();
        let mut values = Vec::new();
        aig.simulate(&leaves, &mut values);
        values
    };
    (0..WORDS).map(word).collect()
}

fn signature(samples: &[Vec<u64>], l: Lit) -> [u64; WORDS] {
    std::array::from_fn(|i| lanes(&samples[i], l))
}
