//! Chart and program side by side from power-up, each with its own memory.
//!
//! Nothing is assumed here: both start as they do and get the same inputs at the same times. Two graphs
//! hold it, one for the first scan and one for any later scan. A [`Run`] executes them with 64
//! sequences of inputs at once; copied with memory put in as constants they are what a solver is asked.

use super::chart_step::{ChartScan, ChartState};
use super::matching::{Match, Pair};
use super::parts::{Part, SCAN_WIDTH, WIDTH};
use crate::bits::aig::{Aig, Lit, lanes};
use crate::ir::iec::Time;

/// What the machine gets for one scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stimulus {
    /// The time since the scan before, in microseconds.
    pub pause: Time,
    /// The value of each input.
    pub inputs: Vec<bool>,
}

/// Both sides.
///
/// The leaves of the first scan are its inputs. Those of a later one are, in this order: memory, inputs,
/// for each timer of the chart whether its time has passed, the same for each timer of the program.
pub struct Joint {
    first: Half,
    later: Half,
    /// How many leaves of a later scan are memory.
    pub memory: usize,
    /// How many inputs there are.
    pub inputs: usize,
    /// How many of the memory leaves say which states are active; they come first.
    pub states: usize,
    /// For each transition, the number of its source.
    pub sources: Vec<usize>,
    /// The cycle time.
    pub cycle: Time,
    /// The times of the chart's timers and then of the program's.
    pub times: Vec<Time>,
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
    /// For each timer, whether it starts in this scan.
    pub begins: Vec<Lit>,
}

impl Joint {
    /// Encodes both sides.
    pub fn new(pair: Pair<'_>, matched: &Match) -> Joint {
        let Pair { machine, chart, program } = pair;
        // Inputs are set before they are read, and what is never written is no memory.
        let mut remembered = program.written();
        matched.inputs.iter().for_each(|&l| remembered[l] = false);
        let presets = program.presets();
        let timers: Vec<usize> = (0..presets.len()).filter(|&b| presets[b].is_some()).collect();

        let half = |mut aig: Aig, scan: ChartScan, latches: Vec<Lit>, inputs: &[Lit], clocks: &[Lit]| {
            let mut by_block = vec![Lit::FALSE; presets.len()];
            timers.iter().zip(clocks).for_each(|(&b, &clock)| by_block[b] = clock);
            let given: Vec<(usize, Lit)> = matched.inputs.iter().copied().zip(inputs.iter().copied()).collect();
            let after = program.scan(&mut aig, &latches, &given, &by_block, &mut |_, _, _| {});
            let expected: Vec<Lit> = matched.parts.iter().map(|(part, _)| part.after(&scan)).collect();
            let found: Vec<Lit> = matched.parts.iter().map(|&(_, latch)| after[latch]).collect();
            // When a timer starts is a matter of proof, not of what the program does.
            let visible = matched.parts.iter().map(|(part, _)| !matches!(part, Part::Begins(_)));
            let pairs: Vec<(Lit, Lit)> = expected.iter().copied().zip(found.iter().copied()).collect();
            let differ: Vec<Lit> =
                pairs.into_iter().zip(visible).filter(|(_, v)| *v).map(|((a, b), _)| aig.xor(a, b)).collect();
            let differs = aig.any(&differ);
            let kept = after.iter().zip(&remembered).filter(|(_, kept)| **kept).map(|(l, _)| *l);
            let next = scan.after.bits().into_iter().chain(kept).collect();
            let starts = timers.iter().map(|&b| after[program.block(crate::base::Id::from_index(b)) + 3]);
            let begins = scan.begins.into_iter().chain(starts).collect();
            Half { aig, next, fires: scan.fires, chart: expected, program: found, differs, begins }
        };

        let mut aig = Aig::new();
        let inputs: Vec<Lit> = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let scan = chart.first(&mut aig, &inputs);
        let first = half(aig, scan, program.power_up(), &inputs, &vec![Lit::FALSE; timers.len()]);

        let mut aig = Aig::new();
        let before = ChartState {
            active: machine.states.ids().map(|s| aig.leaf(machine.state_path(s))).collect(),
            variables: machine.variables.values().map(|v| aig.leaf(&v.name)).collect(),
            inputs: machine.inputs.values().map(|i| aig.leaf(format!("prev({})", i.name))).collect(),
            outputs: machine.outputs.values().map(|o| aig.leaf(format!("prev({})", o.name))).collect(),
            raised: machine.events.values().map(|e| aig.leaf(format!("raised({})", e.name))).collect(),
            fresh: chart.timers().map(|(s, _)| aig.leaf(format!("{} is fresh", machine.state_path(s)))).collect(),
            past: chart.timers().map(|(s, ms)| aig.leaf(format!("{} {ms} ms", machine.state_path(s)))).collect(),
            marks: machine.safety.marks().map(|mark| aig.leaf(machine.mark(mark))).collect(),
            last: machine
                .states
                .ids()
                .map(|s| chart.remembers(s).then(|| aig.leaf(format!("last {}", machine.state_path(s)))))
                .collect(),
            integers: machine
                .integers
                .values()
                .map(|i| (0..WIDTH).map(|bit| aig.leaf(format!("{}.{bit}", i.name))).collect())
                .collect(),
            scans: (0..chart.scans())
                .map(|n| (0..SCAN_WIDTH).map(|bit| aig.leaf(format!("scan {n}.{bit}"))).collect())
                .collect(),
        };
        let latches = program.latches().iter().zip(program.power_up()).zip(&remembered);
        let latches =
            latches.map(|((&l, initial), &kept)| if kept { aig.leaf(program.name(l)) } else { initial }).collect();
        let memory = aig.leaves().len();
        let inputs: Vec<Lit> = machine.inputs.values().map(|i| aig.leaf(&i.name)).collect();
        let clocks: Vec<Lit> = chart.timers().map(|(_, ms)| aig.leaf(format!("{ms} ms"))).collect();
        let program_clocks: Vec<Lit> = timers.iter().map(|b| aig.leaf(format!("timer {b}"))).collect();
        let scan = chart.scan(&mut aig, &before, &inputs, &clocks);
        let later = half(aig, scan, latches, &inputs, &program_clocks);

        let of_chart = chart.timers().map(|(_, ms)| Time::from(ms) * 1000);
        let times = of_chart.chain(timers.iter().filter_map(|&b| presets[b])).collect();
        Joint {
            first,
            later,
            memory,
            inputs: machine.inputs.len(),
            states: machine.states.len(),
            sources: machine.transitions.values().map(|t| t.source.index()).collect(),
            cycle: Time::from(machine.cycle) * 1000,
            times,
        }
    }

    /// The graph of the first scan or of a later one.
    pub fn half(&self, first: bool) -> &Half {
        if first { &self.first } else { &self.later }
    }

    /// Copies one later scan into `aig`: memory before it, its inputs and whether its timers' times have
    /// passed, to what `roots` pick.
    pub fn copy(&self, aig: &mut Aig, memory: &[Lit], inputs: &[Lit], passed: &[Lit], roots: &[Lit]) -> Vec<Lit> {
        let leaves: Vec<Lit> = memory.iter().chain(inputs).chain(passed).copied().collect();
        aig.import(&self.later.aig, roots, &mut |_, leaf| leaves[leaf as usize])
    }

    /// The first of the scans in which a part differs, counted from 0.
    pub fn first_difference(&self, stimuli: &[Stimulus]) -> Option<usize> {
        let mut run = Run::new(self);
        stimuli.iter().position(|s| {
            run.scan(&spread(&s.inputs), s.pause);
            run.word(run.half().differs) & 1 == 1
        })
    }
}

/// The same value in all 64 runs.
fn spread(values: &[bool]) -> Vec<u64> {
    values.iter().map(|&b| if b { u64::MAX } else { 0 }).collect()
}

/// What is remembered in one of 64 runs.
#[derive(Clone, Debug)]
pub struct Memory {
    /// The leaves of a later scan that are memory.
    pub bits: Vec<bool>,
    /// For each timer, when it started.
    pub started: Vec<Time>,
    /// When the last scan was.
    pub now: Time,
}

/// 64 runs side by side, at the same times.
pub struct Run<'j> {
    joint: &'j Joint,
    /// Nothing before the first scan.
    memory: Option<Vec<u64>>,
    started: Vec<[Time; 64]>,
    now: Time,
    first: bool,
    values: Vec<u64>,
}

impl<'j> Run<'j> {
    /// At power-up.
    pub fn new(joint: &'j Joint) -> Self {
        let started = vec![[0; 64]; joint.times.len()];
        Run { joint, memory: None, started, now: 0, first: true, values: Vec::new() }
    }

    /// All 64 from there.
    pub fn from(joint: &'j Joint, memory: &Memory) -> Self {
        Run {
            joint,
            memory: Some(spread(&memory.bits)),
            started: memory.started.iter().map(|&t| [t; 64]).collect(),
            now: memory.now,
            first: false,
            values: Vec::new(),
        }
    }

    /// One scan; the pause before the first one means nothing.
    pub fn scan(&mut self, inputs: &[u64], pause: Time) {
        self.first = self.memory.is_none();
        let mut leaves = self.memory.take().unwrap_or_default();
        leaves.extend_from_slice(inputs);
        if !self.first {
            self.now += pause;
            for (started, time) in self.started.iter().zip(&self.joint.times) {
                let word = (0..64).fold(0, |w, lane| w | u64::from(self.now >= started[lane] + time) << lane);
                leaves.push(word);
            }
        }
        let half = self.joint.half(self.first);
        self.values.clear();
        half.aig.simulate(&leaves, &mut self.values);
        for (started, &begins) in self.started.iter_mut().zip(&half.begins) {
            let mut word = lanes(&self.values, begins);
            while word != 0 {
                started[word.trailing_zeros() as usize] = self.now;
                word &= word - 1;
            }
        }
        self.memory = Some(half.next.iter().map(|&l| lanes(&self.values, l)).collect());
    }

    /// The graph of the last scan.
    pub fn half(&self) -> &'j Half {
        self.joint.half(self.first)
    }

    /// The 64 values that a literal of that graph had in it.
    pub fn word(&self, l: Lit) -> u64 {
        lanes(&self.values, l)
    }

    /// Which states are active in one of the runs.
    pub fn active(&self, lane: usize) -> Vec<bool> {
        let memory = self.memory.as_deref().unwrap_or_default();
        memory.iter().take(self.joint.states).map(|w| w >> lane & 1 == 1).collect()
    }

    /// What one of the runs remembers.
    pub fn memory(&self, lane: usize) -> Memory {
        Memory {
            bits: self.memory.iter().flatten().map(|w| w >> lane & 1 == 1).collect(),
            started: self.started.iter().map(|s| s[lane]).collect(),
            now: self.now,
        }
    }
}
