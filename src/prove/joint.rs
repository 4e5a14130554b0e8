//! Chart and program run side by side from power-up, each with its own memory.
//!
//! Nothing is assumed here: both start as they do and get the same inputs. Two graphs hold it, one for
//! the first scan and one for any later scan; they are run with 64 input sequences at once, or copied
//! scan after scan with memory put in as constants, so that a solver can look for inputs.

use super::aig::{Aig, Lit, lanes};
use super::chart_step::{ChartScan, ChartState, ChartStep};
use super::parts::{Match, Part};
use super::program_step::ProgramStep;
use crate::ir::chart::Machine;

/// Values of all that is remembered by both sides: the leaves of a later scan, without its inputs.
pub type Memory = Vec<bool>;

/// Both sides.
pub struct Joint {
    first: Half,
    later: Half,
    /// How many leaves of the later scan are memory; inputs follow.
    pub memory: usize,
    /// How many inputs there are.
    pub inputs: usize,
    /// How many of the memory leaves say which states are active; they come first.
    pub states: usize,
    /// The parts that are compared.
    pub parts: Vec<Part>,
}

/// One scan.
pub struct Half {
    /// The graph.
    pub aig: Aig,
    /// What memory becomes.
    pub next: Vec<Lit>,
    /// For each transition, whether it fires.
    pub fires: Vec<Lit>,
    /// For each part, its value in the chart.
    pub chart: Vec<Lit>,
    /// For each part, its value in the program.
    pub program: Vec<Lit>,
    /// Whether some part differs.
    pub differs: Lit,
}

impl Joint {
    /// Encodes both sides.
    pub fn new(machine: &Machine, chart: &ChartStep<'_>, program: &ProgramStep<'_>, matched: &Match) -> Joint {
        let parts: Vec<Part> = matched.parts.iter().map(|&(part, _)| part).collect();
        let written = program.written();
        // Inputs are set before they are read, and what is never written is no memory.
        let mut remembered: Vec<bool> = written;
        matched.inputs.iter().for_each(|&l| remembered[l] = false);

        let build = |aig: &mut Aig, before: Option<ChartState>, latches: Vec<Lit>, inputs: Vec<Lit>| {
            let scan = match &before {
                Some(before) => chart.scan(aig, before, &inputs),
                None => chart.first(aig, &inputs),
            };
            let given: Vec<(usize, Lit)> = matched.inputs.iter().copied().zip(inputs).collect();
            let after = program.scan(aig, &latches, &given, &mut |_, _, _| {});
            let expected: Vec<Lit> = parts.iter().map(|p| p.after(&scan)).collect();
            let found: Vec<Lit> = matched.parts.iter().map(|&(_, latch)| after[latch]).collect();
            let differ: Vec<Lit> = expected.iter().zip(&found).map(|(&a, &b)| aig.xor(a, b)).collect();
            let differs = aig.any(&differ);
            let kept = after.iter().zip(&remembered).filter(|(_, kept)| **kept).map(|(l, _)| *l);
            let ChartScan { after: ChartState { active, variables, inputs, outputs }, fires, .. } = scan;
            let next: Vec<Lit> = [active, variables, inputs, outputs].into_iter().flatten().chain(kept).collect();
            (next, fires, expected, found, differs)
        };
        let half = |mut aig: Aig, before: Option<ChartState>, latches: Vec<Lit>, inputs: Vec<Lit>| {
            let (next, fires, chart, program, differs) = build(&mut aig, before, latches, inputs);
            Half { aig, next, fires, chart, program, differs }
        };

        let mut aig = Aig::new();
        let inputs = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let first = half(aig, None, program.power_up(), inputs);

        let mut aig = Aig::new();
        let before = ChartState {
            active: machine.states.ids().map(|s| aig.leaf(machine.state_path(s))).collect(),
            variables: machine.variables.values().map(|v| aig.leaf(&v.name)).collect(),
            inputs: machine.inputs.values().map(|i| aig.leaf(format!("prev({})", i.name))).collect(),
            outputs: machine.outputs.values().map(|o| aig.leaf(format!("prev({})", o.name))).collect(),
        };
        let latches = program.latches().iter().zip(program.power_up()).zip(&remembered);
        let latches =
            latches.map(|((&l, initial), &kept)| if kept { aig.leaf(program.name(l)) } else { initial }).collect();
        let memory = aig.leaves().len();
        let inputs = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let later = half(aig, Some(before), latches, inputs);
        Joint { first, later, memory, inputs: machine.inputs.len(), states: machine.states.len(), parts }
    }

    /// The graph of the first scan or of a later one.
    pub fn half(&self, first: bool) -> &Half {
        if first { &self.first } else { &self.later }
    }

    /// One scan of 64 runs: memory before it (nothing before the first) and inputs to the values of
    /// all nodes of [`Joint::half`].
    pub fn run(&self, memory: Option<&[u64]>, inputs: &[u64], values: &mut Vec<u64>) {
        let leaves: Vec<u64> = memory.unwrap_or_default().iter().chain(inputs).copied().collect();
        values.clear();
        self.half(memory.is_none()).aig.simulate(&leaves, values);
    }

    /// The first of the scans in which a part differs when both get these inputs, counted from 0.
    pub fn first_difference(&self, inputs: &[Vec<bool>]) -> Option<usize> {
        let mut values = Vec::new();
        let mut memory: Option<Vec<u64>> = None;
        for (scan, now) in inputs.iter().enumerate() {
            let words: Vec<u64> = now.iter().map(|&b| u64::from(b)).collect();
            let half = self.half(memory.is_none());
            self.run(memory.as_deref(), &words, &mut values);
            if lanes(&values, half.differs) & 1 == 1 {
                return Some(scan);
            }
            memory = Some(half.next.iter().map(|&l| lanes(&values, l) & 1).collect());
        }
        None
    }

    /// Copies one later scan into `aig`: memory before it and its inputs to what `roots` pick.
    pub fn copy(&self, aig: &mut Aig, memory: &[Lit], inputs: &[Lit], roots: &[Lit]) -> Vec<Lit> {
        let leaves: Vec<Lit> = memory.iter().chain(inputs).copied().collect();
        aig.import(&self.later.aig, roots, &mut |_, leaf| leaves[leaf as usize])
    }
}
