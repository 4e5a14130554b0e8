//! Runs a machine scan by scan, by the meaning that [`crate::ir::chart`] gives it.
//!
//! It is the reference that the translation is held against, so it shares nothing with it but the
//! machine itself. It is also meant for long runs, so all that can be known before the first scan is
//! computed in [`Chart::new`], and a scan allocates, hashes and searches nothing:
//!
//! - every value is one bit of a row of words, see [`code`]; a guard is mostly one comparison;
//! - a transition is a mask that clears bits and a mask that sets some, see [`steps`];
//! - only active regions are visited, and of their transitions only those that leave the active state;
//! - what states drive, set and reset is looked up for active states that do so: a few bits in the
//!   words of states;
//! - a comparison of integers is one more bit, see [`integers`];
//! - the filter decides all outputs of a word at once, see [`filter`].
//!
//! ```
//! # let source = "machine M inputs { Go Stop } outputs { RUN } actuator Motor onoff by RUN \
//! #   chart C controls Motor { initial state Off state On from Off to On when rise(Go) from On to Off when Stop }";
//! use chartwright::simulate::chart::Chart;
//!
//! let machine = chartwright::pipeline::check(source).0.unwrap();
//! let run = machine.outputs.ids().next().unwrap();
//! let mut chart = Chart::new(&machine);
//! chart.scan(&[true, false]); // held down at power-up: no edge
//! assert!(!chart.output(run));
//! chart.scan(&[false, false]);
//! chart.scan(&[true, false]);
//! assert!(chart.output(run));
//! ```

mod code;
mod filter;
mod integers;
mod steps;
mod ways;

use crate::ir::chart::{
    ChartKind, ConstraintId, EventId, InputId, IntegerId, Machine, Mark, OutputId, ScanNumber, StateId, TransitionId,
    VariableId,
};
use code::{Code, Condition, HALF, Layout, Memory, append, part};
use filter::{Filter, place};
use integers::Integers;
use std::ops::Range;
use steps::{Configuration, Steps};

/// A machine that runs.
#[derive(Clone, Debug)]
pub struct Chart {
    inputs: usize,
    layout: Layout,
    code: Code,
    steps: Steps,
    /// What active states do, for those that do something.
    doings: Vec<Doing>,
    /// For each state, its place in `doings`.
    place: Vec<u32>,
    /// For each word of states, those that drive and those that act.
    driving: Vec<u64>,
    acting: Vec<u64>,
    /// Outputs that are driven without a condition.
    always: Vec<(u32, u32)>,
    /// Outputs that are driven under a condition.
    sometimes: Vec<(Condition, u32, u32)>,
    actions: Vec<Action>,
    assumptions: Vec<Condition>,

    memory: Memory,
    integers: Integers,
    configuration: Configuration,
    /// For each word of variables, what actions are about to set and to reset.
    writes: Vec<(u64, u64)>,
    commands: Vec<u32>,
    filter: Filter,
    broken: Vec<bool>,
}

/// What a state does while it is active.
#[derive(Clone, Debug)]
struct Doing {
    always: Range<u32>,
    sometimes: Range<u32>,
    actions: Range<u32>,
}

/// Sets or resets a variable.
#[derive(Clone, Copy, Debug)]
struct Action {
    condition: Condition,
    /// Among the words of variables.
    word: u32,
    bit: u64,
    value: bool,
}

impl Chart {
    /// Prepares `machine` for its first scan. It must be one that
    /// [`pipeline::check`](crate::pipeline::check) found no error in.
    pub fn new(machine: &Machine) -> Chart {
        let layout = Layout::of(machine);
        let mut code = Code::new(layout, machine.cycle);
        let steps = Steps::of(machine, layout, &mut code);
        let filter = Filter::of(machine, layout, &code);
        let assumptions: Vec<Condition> =
            machine.safety.assumptions.iter().map(|a| code.add(machine, &a.never)).collect();
        let mut words = vec![0; layout.words];
        for (id, variable) in machine.variables.iter() {
            if variable.initial {
                let (word, bit) = layout.variable(id);
                words[word] |= bit;
            }
        }
        let mut memory = Memory { words, scan: 0, entered: vec![0; machine.states.len()], integers: Vec::new() };
        let integers = Integers::of(machine, layout, &mut memory);
        let mut chart = Chart {
            inputs: machine.inputs.len(),
            layout,
            steps,
            doings: Vec::new(),
            place: vec![0; machine.states.len()],
            driving: vec![0; layout.words - layout.states],
            acting: vec![0; layout.words - layout.states],
            always: Vec::new(),
            sometimes: Vec::new(),
            actions: Vec::new(),
            broken: vec![false; assumptions.len()],
            assumptions,
            memory,
            integers,
            configuration: Configuration::of(machine),
            writes: vec![(0, 0); layout.comparisons - layout.variables],
            commands: vec![0; layout.events - layout.outputs],
            filter,
            code,
        };
        chart.tabulate(machine);
        chart
    }

    fn tabulate(&mut self, machine: &Machine) {
        for (id, state) in machine.states.iter() {
            if state.drives.is_empty() && state.actions.is_empty() {
                continue;
            }
            let (mut always, mut sometimes): (Vec<(u32, u32)>, Vec<_>) = (Vec::new(), Vec::new());
            for drive in &state.drives {
                let (word, bit) = place(drive.output);
                let condition = self.code.add(machine, &drive.condition);
                if condition.is_empty() {
                    always.push((word, bit));
                } else {
                    sometimes.push((condition, word, bit));
                }
            }
            let actions: Vec<Action> = state
                .actions
                .iter()
                .map(|a| {
                    let condition = self.code.add(machine, &a.condition);
                    let (word, bit) = self.layout.variable(a.variable);
                    Action { condition, word: (word - self.layout.variables) as u32, bit, value: a.value }
                })
                .collect();
            let (word, bit) = self.layout.state(id);
            let word = word - self.layout.states;
            if !state.drives.is_empty() {
                self.driving[word] |= bit;
            }
            if !actions.is_empty() {
                self.acting[word] |= bit;
            }
            self.place[id.index()] = self.doings.len() as u32;
            self.doings.push(Doing {
                always: append(&mut self.always, always),
                sometimes: append(&mut self.sometimes, sometimes),
                actions: append(&mut self.actions, actions),
            });
        }
    }

    /// Runs one scan with these inputs, in order of declaration. From scan to scan the machine's cycle
    /// time goes by.
    ///
    /// # Panics
    ///
    /// If there are more or fewer inputs than the machine has.
    pub fn scan(&mut self, inputs: &[bool]) {
        self.memory.scan += 1;
        self.sample(inputs);
        self.configuration.forget();
        for kind in [ChartKind::Observer, ChartKind::Control] {
            if self.memory.scan == 1 {
                self.steps.begin(kind, &self.code, &mut self.memory, &mut self.configuration);
            } else {
                self.steps.step(kind, &self.code, &mut self.memory, &mut self.configuration);
            }
            self.integers.assign(&mut self.configuration, &mut self.memory);
        }
        self.act();
        self.drive();
        self.filter.decide(&mut self.memory.words, &self.commands);
        for (broken, never) in self.broken.iter_mut().zip(&self.assumptions) {
            *broken = self.code.holds(*never, &self.memory);
        }
        self.steps.end(&self.code, &mut self.memory, &mut self.configuration);
        self.integers.assign(&mut self.configuration, &mut self.memory);
    }

    /// Takes the inputs in; what was now becomes what was before.
    fn sample(&mut self, inputs: &[bool]) {
        let first = self.memory.scan == 1;
        let words = self.layout.outputs;
        assert_eq!(inputs.len(), self.inputs, "a scan takes as many inputs as the machine has");
        for (word, values) in self.memory.words[..words].iter_mut().zip(inputs.chunks(HALF)) {
            let now = values.iter().rev().fold(0, |bits, &value| bits << 1 | u64::from(value));
            let before = if first { now } else { *word };
            *word = now | before << HALF;
        }
        for word in &mut self.memory.words[words..self.layout.events] {
            *word <<= HALF;
        }
        for word in &mut self.memory.words[self.layout.events..self.layout.variables] {
            *word >>= HALF;
        }
    }

    /// Actions of the active states. Each reads variables as the transitions left them, so they are
    /// gathered first.
    fn act(&mut self) {
        if self.actions.is_empty() {
            return;
        }
        self.writes.fill((0, 0));
        for (i, &acting) in self.acting.iter().enumerate() {
            for state in bits(self.memory.words[self.layout.states + i] & acting, i) {
                let doing = &self.doings[self.place[state] as usize];
                for action in part(&self.actions, &doing.actions) {
                    if self.code.holds(action.condition, &self.memory) {
                        let (set, reset) = &mut self.writes[action.word as usize];
                        *(if action.value { set } else { reset }) |= action.bit;
                    }
                }
            }
        }
        for (i, &(set, reset)) in self.writes.iter().enumerate() {
            let word = &mut self.memory.words[self.layout.variables + i];
            *word = (*word | set) & !reset;
        }
    }

    /// Commands from the active states.
    fn drive(&mut self) {
        self.commands.fill(0);
        for (i, &driving) in self.driving.iter().enumerate() {
            for state in bits(self.memory.words[self.layout.states + i] & driving, i) {
                let doing = &self.doings[self.place[state] as usize];
                for &(word, bit) in part(&self.always, &doing.always) {
                    self.commands[word as usize] |= bit;
                }
                for &(condition, word, bit) in part(&self.sometimes, &doing.sometimes) {
                    if self.code.holds(condition, &self.memory) {
                        self.commands[word as usize] |= bit;
                    }
                }
            }
        }
    }

    /// How many scans have run.
    pub fn scans(&self) -> u64 {
        self.memory.scan
    }

    /// Whether the state is active.
    pub fn is_active(&self, state: StateId) -> bool {
        let (word, bit) = self.layout.state(state);
        self.memory.words[word] & bit != 0
    }

    /// The active states, in order of declaration.
    pub fn active(&self) -> impl Iterator<Item = StateId> + '_ {
        let words = self.memory.words[self.layout.states..].iter().enumerate();
        words.flat_map(|(i, &word)| bits(word, i)).map(StateId::from_index)
    }

    /// The transitions that fired in the last scan, in the order in which they did: those of observers, of
    /// the other charts, and of observers after the filter.
    pub fn fired(&self) -> &[TransitionId] {
        self.configuration.fired()
    }

    /// The input's value in the last scan.
    pub fn input(&self, input: InputId) -> bool {
        self.memory.words[input.index() / HALF] >> (input.index() % HALF) & 1 == 1
    }

    /// The variable's value after the last scan.
    pub fn variable(&self, variable: VariableId) -> bool {
        let (word, bit) = self.layout.variable(variable);
        self.memory.words[word] & bit != 0
    }

    /// Whether the event was TRUE in the last scan.
    pub fn event(&self, event: EventId) -> bool {
        let (word, bit) = self.layout.event(event);
        self.memory.words[word] & bit != 0
    }

    /// The integer's value after the last scan.
    pub fn integer(&self, integer: IntegerId) -> i64 {
        self.memory.integers[integer.index()]
    }

    /// What the chart wanted of the output in the last scan.
    pub fn command(&self, output: OutputId) -> bool {
        let (word, bit) = place(output);
        self.commands[word as usize] & bit != 0
    }

    /// What the filter let through in the last scan.
    pub fn output(&self, output: OutputId) -> bool {
        let (word, bit) = place(output);
        self.memory.words[self.layout.outputs + word as usize] & u64::from(bit) != 0
    }

    /// Whether the constraint had to act in the last scan: what was commanded, or what other
    /// constraints made of it, would have violated it.
    pub fn acted(&self, constraint: ConstraintId) -> bool {
        self.filter.acted(constraint)
    }

    /// What the filter remembers after the last scan.
    pub fn mark(&self, mark: Mark) -> bool {
        self.filter.mark(mark)
    }

    /// A number that a filter with a reset keeps after the last scan.
    pub fn scan_number(&self, number: ScanNumber) -> u32 {
        self.filter.scan_number(number)
    }

    /// Whether the assumption of that index was broken in the last scan.
    pub fn broken(&self, assumption: usize) -> bool {
        self.broken[assumption]
    }

    /// In how many rounds the filter decided in the last scan; 1 when no combined constraint acted.
    pub fn filter_rounds(&self) -> usize {
        self.filter.count()
    }

    /// Whether the filter found no way to keep all constraints in the last scan. That takes a broken
    /// assumption.
    pub fn filter_failed(&self) -> bool {
        self.filter.failed()
    }
}

/// The places of the bits of the word of that index, counted over all words.
fn bits(mut word: u64, index: usize) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize)?;
        word &= word - 1;
        Some(index * 64 + bit)
    })
}
