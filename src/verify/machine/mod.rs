//! A machine to a transition system, and to the questions that are worth asking of it.
//!
//! | module | does |
//! | --- | --- |
//! | this one | the program: chart and filter, scan by scan from power-up |
//! | [`plant`] | what the plant gives it |
//! | [`questions`] | what is claimed |
//!
//! One scan of the program is that of [`chart_step`](crate::prove::chart_step), the same that every build is proved
//! equal to. What is left open, and so is verified for all ways in which it can go: the inputs that no
//! plant gives, under the declared assumptions; when a time that a guard waits for has passed, except that of one
//! state a shorter one passes no later than a longer one; and what [`plant`] says.

pub mod plant;
pub mod questions;

use super::aig::{Aig, Lit};
use super::sat::Sat;
use super::system::{Giver, System};
use crate::ir::chart::{Atom, ChartKind, Machine};
use crate::prove::chart_filter;
use crate::prove::chart_step::{ChartScan, ChartState, ChartStep};
use questions::Question;
use std::collections::BTreeMap;
use std::fmt;

/// What runs in front of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// The charts of the machine.
    Chart,
    /// Nobody knows: each scan any command.
    Any,
}

/// Why a machine cannot be verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The solver cannot say how many rounds the filter takes.
    Rounds,
    /// The filter is asked for alone, but reads observers, which would have to run.
    Observers,
    /// The filter is asked for alone, but reads events or integers of the program.
    Memory,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Refusal::Rounds => "nobody knows how many rounds the filter takes",
            Refusal::Observers => "behind any program, a machine with observers cannot be verified yet",
            Refusal::Memory => "behind any program, a filter that reads events or integers cannot be verified yet",
        })
    }
}

/// A machine as a transition system.
pub struct Subject<'m> {
    /// The machine.
    pub machine: &'m Machine,
    /// The system. Its claims belong to the questions, one by one.
    pub system: System,
    /// What is asked.
    pub questions: Vec<Question>,
    /// What there is to see of it.
    pub view: View,
    /// Whether guards wait for times, so that not every run goes by the clock.
    pub timed: bool,
}

/// The values at the end of a scan.
#[derive(Clone, Debug)]
pub struct View {
    /// For each input, its value.
    pub inputs: Vec<Lit>,
    /// For each input, its value in the scan before.
    pub past_inputs: Vec<Lit>,
    /// For each hidden bit of the plant, its value.
    pub bits: Vec<Lit>,
    /// For each hidden bit of the plant, its value in the scan before.
    pub past_bits: Vec<Lit>,
    /// For each output, its value in the scan before.
    pub past_outputs: Vec<Lit>,
    /// What happens in the scan.
    pub scan: ChartScan,
}

impl View {
    /// What can be seen, in this order: inputs, hidden bits, outputs, variables, events, states, alarms of
    /// constraints, alarms of assumptions, what the filter remembers, the bits of integers.
    pub fn frame(&self) -> Vec<Lit> {
        let ChartScan { after, events, acted, broken, .. } = &self.scan;
        let ChartState { outputs, variables, active, marks, .. } = after;
        let lists = [&self.inputs, &self.bits, outputs, variables, events, active, acted, broken, marks];
        lists.into_iter().flatten().chain(after.integers.iter().flatten()).copied().collect()
    }
}

impl<'m> Subject<'m> {
    /// The machine in its plant, if it has one, as a system. With `open` the plant gives nothing, and all inputs are
    /// free.
    pub fn new(machine: &'m Machine, program: Program, open: bool) -> Result<Subject<'m>, Refusal> {
        if program == Program::Any && machine.charts.iter().any(|c| c.kind == ChartKind::Observer) {
            return Err(Refusal::Observers);
        }
        if program == Program::Any && reads_memory(machine) {
            return Err(Refusal::Memory);
        }
        let rounds = chart_filter::rounds(machine, &mut Sat::new()).ok_or(Refusal::Rounds)?;
        let step = ChartStep::new(machine, rounds).without_scans();
        let mut system = System::default();
        let started = system.latch("started", Some(false));
        system.latches[0].next = Lit::TRUE;
        let first_latch = system.latches.len();
        let before = remembered(&mut system, machine, &step);
        let memory = first_latch..system.latches.len();
        let given = plant::give(&mut system, machine, started, &before, open);
        // In the first scan inputs have no other past than themselves.
        let past_inputs = before.inputs.iter().zip(&given.inputs);
        let past_inputs: Vec<Lit> = past_inputs.map(|(&was, &is)| system.aig.select(started, was, is)).collect();
        let mut timed = false;
        let scan = match program {
            Program::Chart => {
                let clocks = clocks(&mut system, machine, &step, &before);
                timed = !clocks.is_empty();
                let later = step.scan(&mut system.aig, &before, &given.inputs, &clocks);
                let first = step.first(&mut system.aig, &given.inputs);
                either(&mut system.aig, started, &later, &first)
            }
            Program::Any => filter(&mut system, machine, &before, &given.inputs, &past_inputs, rounds),
        };
        for (latch, next) in memory.zip(scan.after.bits()) {
            system.latches[latch].next = next;
        }
        system.constraints.extend(scan.broken.iter().map(|&b| !b));
        let plant::Terminals { inputs, bits, past_bits } = given;
        let view = View { inputs, past_inputs, bits, past_bits, past_outputs: before.outputs, scan };
        let mut subject = Subject { machine, system, questions: Vec::new(), view, timed };
        subject.ask_about_outputs(program);
        if program == Program::Chart {
            subject.ask_about_chart();
        }
        Ok(subject)
    }

    fn ask(&mut self, question: Question, name: String, property: super::Property) {
        self.system.claim(name, property);
        self.questions.push(question);
    }
}

/// Whether constraints or assumptions read what only a known program has.
fn reads_memory(machine: &Machine) -> bool {
    let constraints = machine.safety.constraints.values().map(|c| &c.never);
    let mut reads = false;
    for never in constraints.chain(machine.safety.assumptions.iter().map(|a| &a.never)) {
        never.for_each_atom(&mut |atom| reads |= matches!(atom, Atom::Event(_) | Atom::Compare(_)));
    }
    reads
}

/// A scan of the filter behind a program of which nothing is known: any commands, any values of variables.
fn filter(
    system: &mut System,
    machine: &Machine,
    before: &ChartState,
    inputs: &[Lit],
    past_inputs: &[Lit],
    rounds: usize,
) -> ChartScan {
    let mut free = |name: String| system.input(name, Giver::Controller);
    let commands: Vec<Lit> = machine.outputs.values().map(|o| free(format!("command {}", o.name))).collect();
    let variables: Vec<Lit> = machine.variables.values().map(|v| free(v.name.clone())).collect();
    let atom = |atom: Atom| match atom {
        Atom::Input(i) => inputs[i.index()],
        Atom::PrevInput(i) => past_inputs[i.index()],
        Atom::PrevOutput(o) => before.outputs[o.index()],
        Atom::Variable(v) => variables[v.index()],
        Atom::Output(_) | Atom::Event(_) | Atom::Compare(_) | Atom::In(_) | Atom::Done(_) | Atom::After(..) => {
            unreachable!("a filter reads signals and their past")
        }
    };
    let aig = &mut system.aig;
    let broken = machine.safety.assumptions.iter().map(|a| aig.expression(&a.never, &mut |_, &a| atom(a))).collect();
    let filtered = chart_filter::filter(aig, machine, &commands, &before.marks, &mut |_, a| atom(a), rounds);
    let no = |lits: &[Lit]| vec![Lit::FALSE; lits.len()];
    let after = ChartState {
        active: no(&before.active),
        variables: variables.clone(),
        inputs: inputs.to_vec(),
        outputs: filtered.outputs,
        fresh: no(&before.fresh),
        past: no(&before.past),
        marks: filtered.marks,
        raised: no(&before.raised),
        last: before.last.iter().map(|l| l.map(|_| Lit::FALSE)).collect(),
        integers: before.integers.iter().map(|i| no(i)).collect(),
        scans: Vec::new(),
    };
    let fires = vec![Lit::FALSE; machine.transitions.len()];
    let enabled = fires.clone();
    let events = no(&before.raised);
    ChartScan {
        after,
        events,
        fires,
        enabled,
        commands,
        acted: filtered.acted,
        broken,
        begins: Vec::new(),
        readings: BTreeMap::new(),
    }
}

/// Latches for what the chart remembers. All is FALSE before the first scan, which does not look at it.
fn remembered(system: &mut System, machine: &Machine, step: &ChartStep<'_>) -> ChartState {
    // Once over literals that mean nothing, to know which bit is what.
    let mut aig = Aig::new();
    let inputs: Vec<Lit> = machine.inputs.values().map(|_| Lit::FALSE).collect();
    let shape = map(&step.first(&mut aig, &inputs).after, &mut |_| aig.leaf(""));
    let mut names = BTreeMap::new();
    let mut name = |lits: &[Lit], words: Vec<String>| names.extend(lits.iter().copied().zip(words));
    name(&shape.active, machine.states.ids().map(|s| format!("in({})", machine.state_path(s))).collect());
    name(&shape.variables, machine.variables.values().map(|v| v.name.clone()).collect());
    name(&shape.inputs, machine.inputs.values().map(|i| format!("prev({})", i.name)).collect());
    name(&shape.raised, machine.events.values().map(|e| e.name.clone()).collect());
    name(&shape.outputs, machine.outputs.values().map(|o| format!("prev({})", o.name)).collect());
    let mut number = 0;
    map(&shape, &mut |l| {
        number += 1;
        let name = names.get(&l).cloned().unwrap_or_else(|| format!("memory {number}"));
        system.latch(name, Some(false))
    })
}

/// For each timer, whether its time has passed by now, if it runs.
fn clocks(system: &mut System, machine: &Machine, step: &ChartStep<'_>, before: &ChartState) -> Vec<Lit> {
    let timers: Vec<_> = step.timers().collect();
    let name =
        |&(s, ms): &(crate::ir::chart::StateId, u32)| format!("{ms} ms of {} have passed", machine.state_path(s));
    let clocks: Vec<Lit> = timers.iter().map(|t| system.input(name(t), Giver::Clock)).collect();
    for (i, t) in timers.iter().enumerate() {
        // A time that runs for ever passes.
        let runs = system.aig.and(before.active[t.0.index()], !before.fresh[i]);
        let passed = system.aig.or(before.past[i], clocks[i]);
        let passed = system.aig.or(!runs, passed);
        system.fairness(name(t), passed);
    }
    for i in 1..timers.len() {
        // They are in order of state and time.
        if timers[i].0 == timers[i - 1].0 {
            let shorter_first = system.aig.or(!clocks[i], clocks[i - 1]);
            system.constraints.push(shorter_first);
        }
    }
    clocks
}

/// `then` if `condition`, else `otherwise`, bit by bit.
fn either(aig: &mut Aig, condition: Lit, then: &ChartScan, otherwise: &ChartScan) -> ChartScan {
    let mut pick =
        |a: &[Lit], b: &[Lit]| -> Vec<Lit> { a.iter().zip(b).map(|(&a, &b)| aig.select(condition, a, b)).collect() };
    let bits = pick(&then.after.bits(), &otherwise.after.bits());
    let mut bits = bits.into_iter();
    ChartScan {
        events: pick(&then.events, &otherwise.events),
        fires: pick(&then.fires, &otherwise.fires),
        enabled: pick(&then.enabled, &otherwise.enabled),
        commands: pick(&then.commands, &otherwise.commands),
        acted: pick(&then.acted, &otherwise.acted),
        broken: pick(&then.broken, &otherwise.broken),
        begins: pick(&then.begins, &otherwise.begins),
        // They are there to judge a program's filter, and here is none.
        readings: BTreeMap::new(),
        after: map(&then.after, &mut |_| bits.next().expect("both remember the same")),
    }
}

/// The same memory with other bits, made in the order of [`ChartState::bits`].
fn map(state: &ChartState, f: &mut impl FnMut(Lit) -> Lit) -> ChartState {
    let mut each = |lits: &[Lit]| -> Vec<Lit> { lits.iter().map(|&l| f(l)).collect() };
    ChartState {
        active: each(&state.active),
        variables: each(&state.variables),
        inputs: each(&state.inputs),
        outputs: each(&state.outputs),
        raised: each(&state.raised),
        fresh: each(&state.fresh),
        past: each(&state.past),
        marks: each(&state.marks),
        last: state.last.iter().map(|l| l.map(|l| each(&[l])[0])).collect(),
        integers: state.integers.iter().map(|i| each(i)).collect(),
        scans: state.scans.iter().map(|n| each(n)).collect(),
    }
}
