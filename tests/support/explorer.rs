//! All runs of a small machine in its plant, gone through state by state: what `verify` should say.
//!
//! This is written from the documentation and shares nothing with the transition system that `verify` makes. The program is
//! run by the simulator of the chart; plants, times and fairness are anew in [`plant`], [`program`] and [`graph`].

pub mod graph;
mod plant;
mod program;

use chartwright::ir::chart::{Atom, InputId, Machine, Phase, TransitionId};
use chartwright::ir::expr::Expr;
use chartwright::ir::scenario::{Condition, PropertyKind, Seen};
use chartwright::pipeline::verify::Question;
use chartwright::simulate::frame::{Frame, Layout};
use graph::{Ask, Edge, Graph};
use plant::{Moment, Plant};
use program::{Memories, Scan, Timer};
use std::collections::HashMap;

/// More states or edges than this are too many.
const STATES: usize = 1_500;
const EDGES: usize = 60_000;

/// A machine whose runs are gone through.
pub struct Explorer<'m> {
    machine: &'m Machine,
    layout: Layout,
    timers: Vec<Timer>,
    /// The inputs that nobody gives, those of times left out.
    free: Vec<InputId>,
    /// Whether there is no plant.
    open: bool,
    /// Whether times are those of the declared cycle.
    exact: bool,
    questions: &'m [Question],
}

/// Where a run is.
#[derive(Clone, PartialEq, Eq, Hash)]
struct State {
    program: usize,
    plant: Moment,
}

/// What a scan, or what happens between scans, makes of a state.
struct Course<'r> {
    frame: &'r Frame,
    before: &'r Frame,
    /// Of a scan, what the program did.
    scan: Option<&'r Scan>,
    /// Whether a scan has run by now.
    begun: bool,
}

/// A machine in which guards ask inputs instead of times, and these inputs.
pub fn without_times(machine: &Machine) -> (Machine, Vec<Timer>) {
    let mut machine = machine.clone();
    let mut timers: Vec<Timer> = Vec::new();
    for id in machine.transitions.ids() {
        let guard = machine.transitions[id].guard.clone();
        machine.transitions[id].guard = guard.map(&mut |&atom| {
            let Atom::After(state, time) = atom else { return Expr::Atom(atom) };
            let known = timers.iter().find(|t| (t.state, t.time) == (state, time)).map(|t| t.input);
            let input = known.unwrap_or_else(|| {
                let mut input = machine.inputs.values().next().expect("there is an input").clone();
                input.name = format!("Time{}", timers.len());
                let input = machine.inputs.push(input);
                timers.push(Timer { state, time, input });
                input
            });
            Expr::Atom(Atom::Input(input))
        });
    }
    (machine, timers)
}

impl<'m> Explorer<'m> {
    /// Of a machine [`without_times`].
    pub fn new(machine: &'m Machine, timers: &[Timer], open: bool, questions: &'m [Question]) -> Explorer<'m> {
        let gives = machine.plant.gives(machine.inputs.len());
        let free = |i: &InputId| (open || !gives[i.index()]) && timers.iter().all(|t| t.input != *i);
        let free = machine.inputs.ids().filter(free).collect();
        Explorer { machine, layout: Layout::of(machine), timers: timers.to_vec(), free, open, exact: false, questions }
    }

    /// The same with times as they are at the declared cycle.
    pub fn exactly(self) -> Explorer<'m> {
        Explorer { exact: true, ..self }
    }

    /// All runs, and what is asked of them; nothing if there are too many states.
    pub fn explore(&self) -> Option<Graph> {
        let machine = self.machine;
        let plant = Plant { machine, layout: self.layout, open: self.open, exact: self.exact };
        let mut memories = Memories::new(machine, self.layout, &self.timers, self.exact);
        let mut graph = Graph { asks: self.asks(), ..Graph::default() };
        let mut known: HashMap<State, usize> = HashMap::new();
        let mut states: Vec<State> = Vec::new();
        let mut number = |state: State, states: &mut Vec<State>| {
            *known.entry(state.clone()).or_insert_with(|| {
                states.push(state);
                states.len() - 1
            })
        };
        for plant in plant.beginnings() {
            let start = number(State { program: 0, plant }, &mut states);
            graph.starts.push(start);
        }
        let mut next = 0;
        let mut edges = 0;
        while next < states.len() {
            let mut out: Vec<Edge> = Vec::new();
            let state = states[next].clone();
            let memory = memories.of(state.program).clone();
            for given in 0..1usize << self.free.len() {
                let free: Vec<(InputId, bool)> =
                    self.free.iter().enumerate().map(|(i, &input)| (input, given >> i & 1 == 1)).collect();
                let surroundings = plant::Surroundings { free: &free, memory: &memory };
                for step in plant.between(&state.plant, surroundings) {
                    let frame = plant.seen(&step.then, &memory.frame);
                    let course = Course { frame: &frame, before: &frame, scan: None, begun: memory.begun };
                    let (facts, fair) = self.look(&course);
                    let to = number(State { program: state.program, plant: step.then }, &mut states);
                    out.push(Edge { to, facts, fair: fair | step.fair << self.fair_at() });
                }
                for reading in plant.readings(&state.plant, surroundings) {
                    let times = memory.times(self.layout, &self.timers, self.exact.then_some(machine.cycle));
                    for time in times {
                        let mut inputs = reading.inputs.clone();
                        self.timers.iter().zip(&time.passed).for_each(|(t, &passed)| inputs[t.input.index()] = passed);
                        let scan = memories.scan(state.program, &inputs, &time);
                        let broken = |i| scan.frame[self.layout.broken(i)];
                        if (0..machine.safety.assumptions.len()).any(broken) {
                            continue;
                        }
                        let then = plant.written(reading.then.clone(), &scan.frame);
                        let frame = plant.seen(&then, &scan.frame);
                        let mut before = plant.before(&state.plant, &memory.frame);
                        if !memory.begun {
                            // What has no past has no edge.
                            let given = self.layout.given();
                            before[given.clone()].copy_from_slice(&frame[given]);
                        }
                        let course = Course { frame: &frame, before: &before, scan: Some(&scan), begun: true };
                        let (facts, fair) = self.look(&course);
                        let owed = reading.fair | time.fair << plant.debts();
                        let to = number(State { program: scan.to, plant: then }, &mut states);
                        out.push(Edge { to, facts, fair: fair | owed << self.fair_at() });
                    }
                }
            }
            out.sort_unstable();
            out.dedup();
            edges += out.len();
            graph.edges.push(out);
            next += 1;
            if states.len() > STATES || edges > EDGES {
                return None;
            }
        }
        graph.fair = (1 << (self.fair_at() + plant.debts() + self.timers.len())) - 1;
        Some(graph)
    }

    /// How many properties say what makes a run fair.
    fn fair_at(&self) -> usize {
        self.machine.properties.iter().filter(|p| p.kind == PropertyKind::Fair).count()
    }

    /// What is asked, over the facts of [`look`](Self::look): three for each property, one for each question.
    fn asks(&self) -> Vec<Ask> {
        let properties = self.machine.properties.len();
        let asks = self.questions.iter().enumerate().map(|(q, &question)| {
            let own = 3 * properties + 1 + q;
            match question {
                Question::Declared(i) => match self.machine.properties[i].kind {
                    PropertyKind::Never | PropertyKind::Reachable => Ask::Never(3 * i),
                    PropertyKind::Always => Ask::Never(3 * i + 1),
                    PropertyKind::AlwaysPossible => Ask::Possible(3 * i),
                    PropertyKind::Eventually => Ask::Comes { after: 3 * i + 2, then: Some(3 * i) },
                    PropertyKind::Fair => unreachable!("nothing is asked of it"),
                },
                Question::Arises(i) => Ask::Comes { after: 3 * i + 2, then: None },
                Question::Assumable if self.machine.plant.by_steps && !self.open => Ask::Possible(3 * properties),
                Question::Assumable => Ask::NeverStuck,
                Question::Moves => Ask::Possible(own),
                Question::Violated(_)
                | Question::Beyond(_)
                | Question::Active(_)
                | Question::Fires(_)
                | Question::Together(..)
                | Question::Acts(_) => Ask::Never(own),
            }
        });
        asks.collect()
    }

    /// The facts, and what makes a run fair, that this shows.
    fn look(&self, course: &Course<'_>) -> (u128, u64) {
        let machine = self.machine;
        let (mut facts, mut fair, mut fairs) = (0u128, 0u64, 0);
        let mut note = |place: usize, is: bool| facts |= u128::from(is) << place;
        let holds = |condition: &Condition| self.layout.holds(machine, condition, course.frame, course.before);
        for (i, p) in machine.properties.iter().enumerate() {
            let looked = self.looked(&p.condition, course);
            let is = holds(&p.condition);
            note(3 * i, looked && is);
            note(3 * i + 1, looked && !is);
            note(3 * i + 2, p.after.as_ref().is_none_or(|after| self.looked(after, course) && holds(after)));
            if p.kind == PropertyKind::Fair {
                fair |= u64::from(looked && is) << fairs;
                fairs += 1;
            }
        }
        let properties = 3 * machine.properties.len();
        note(properties, course.scan.is_some());
        for (q, question) in self.questions.iter().enumerate() {
            let place = properties + 1 + q;
            let state = |s| course.frame[self.layout.state(s)];
            let Some(scan) = course.scan else {
                if let Question::Active(s) = question {
                    note(place, state(*s));
                }
                continue;
            };
            let is = match *question {
                Question::Violated(c) => scan.violated[c.index()],
                Question::Moves => !scan.fired.is_empty(),
                Question::Active(s) => state(s),
                Question::Fires(t) => scan.fired.contains(&t),
                Question::Together(a, b) => scan.fired.contains(&a) && scan.enabled[b.index()],
                Question::Acts(c) => course.frame[self.layout.acted(c)],
                // The simulators do not tell that an integer was held at its bound.
                Question::Declared(_) | Question::Arises(_) | Question::Assumable | Question::Beyond(_) => continue,
            };
            note(place, is);
        }
        (facts, fair)
    }

    /// Whether a condition is looked at: what reads the past or what was so in a scan only, after scans; what reads
    /// nothing but the plant, after all that happens; everything else after all that happens once a scan has run.
    fn looked(&self, condition: &Condition, course: &Course<'_>) -> bool {
        let (mut of_a_scan, mut of_the_plant) = (false, true);
        condition.for_each_atom(&mut |&seen| match seen {
            Seen::Bit(_) => {}
            Seen::Compare(c) => of_the_plant &= self.machine.plant.comparisons[c].is_hidden(),
            Seen::Machine(Atom::PrevInput(_) | Atom::PrevOutput(_) | Atom::Event(_))
            | Seen::PrevBit(_)
            | Seen::PrevIn(_)
            | Seen::Acted(_)
            | Seen::Broken(_) => of_a_scan = true,
            Seen::Machine(_) | Seen::Mark(_) => of_the_plant = false,
        });
        course.scan.is_some() || !of_a_scan && (of_the_plant || course.begun)
    }
}

/// The transitions of that phase that fired.
fn of_phase<'f>(
    machine: &'f Machine,
    fired: &'f [TransitionId],
    phase: Phase,
) -> impl Iterator<Item = TransitionId> + 'f {
    fired.iter().copied().filter(move |&t| machine.transitions[t].phase == phase)
}
