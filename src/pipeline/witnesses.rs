//! The scenarios of a model to runs of what is verified: what they reach is reachable.
//!
//! A scenario is played by the simulator, and the system is led along: the same comes in, and what is open to the plant goes as it went
//! there. As long as the system sees the same inputs, what shows in it shows in a run of the machine, with exact times. A scenario may do what
//! its plant or an assumption forbids, such as force a sensor: it is no witness from that scan on.

use super::exactly::{Found, shown};
use super::verify::{Options, Program, Question};
use crate::ir::chart::{InputId, Machine};
use crate::simulate::frame::{Frame, Layout};
use crate::simulate::run::Program as Runs;
use crate::simulate::scenario::watch;
use crate::verify::aig::{Lit, lanes};
use crate::verify::engine::{Choice, Engine, Finding, Progress, Verdict};
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::Times;
use crate::verify::system::{Property, Trace};

/// Gates that may be evaluated for all scenarios together: what they show is worth as much, and no more.
const GATES: u64 = 1_500_000_000;

/// The most transitions of the system that are kept of a scenario.
const LONGEST: usize = 100_000;

/// What the scenarios of a machine show.
pub struct Witnesses<'m> {
    /// The machine with exact times: what it does there it does with open ones as well.
    subject: Subject<'m>,
    /// What came in along each scenario, and how it began.
    runs: Vec<Trace>,
    /// For each question, the run that shows it soonest and how many transitions that takes, if one does.
    found: Vec<Option<(usize, usize)>>,
}

impl<'m> Witnesses<'m> {
    /// Plays all scenarios for what is asked, if all engines may be used. They are runs of the charts.
    pub fn play(
        machine: &'m Machine,
        questions: &[Question],
        options: &Options,
        stop: Stop<'_>,
        progress: &mut dyn FnMut(Progress),
    ) -> Option<Witnesses<'m>> {
        if machine.scenarios.is_empty() || options.choice != Choice::Automatic || options.program != Program::Chart {
            return None;
        }
        let subject = Subject::new(machine, options.program, options.open, Times::Exact).ok()?;
        if subject.questions != questions {
            return None;
        }
        let open = questions.len();
        let mut left = GATES;
        let mut witnesses = Witnesses { found: vec![None; open], runs: Vec::new(), subject };
        for scenario in 0..machine.scenarios.len() {
            if stop() || left == 0 {
                break;
            }
            progress(Progress { engine: Engine::Scenario, claim: None, scans: scenario + 1, open });
            let mut walk = Walk::new(&witnesses.subject, left);
            watch(machine, Runs::chart(machine), scenario, &mut |moment| match moment.happens {
                Some(what) => walk.happenings.get_or_insert_default().push(what.to_owned()),
                None => walk.go(moment.frame, machine.scenarios[scenario].tells()),
            });
            left = walk.left;
            for (found, at) in witnesses.found.iter_mut().zip(walk.shows) {
                let sooner = |at: &usize| found.is_none_or(|(_, known)| *at < known);
                *found = at.filter(sooner).map(|at| (scenario, at)).or(*found);
            }
            witnesses.runs.push(walk.run);
        }
        Some(witnesses)
    }

    /// For each question, whether it is shown.
    pub fn shown(&self) -> Vec<bool> {
        self.found.iter().map(Option::is_some).collect()
    }

    /// The answer to a question with its run, if the simulator repeats it.
    pub fn answer(&self, question: usize, options: &Options, stop: Stop<'_>) -> Option<Found> {
        let (scenario, length) = self.found[question]?;
        let run = &self.runs[scenario];
        let trace = Trace { initial: run.initial.clone(), inputs: run.inputs[..length].to_vec(), shortest: false };
        let finding = Finding { verdict: Verdict::Violated(trace), engine: Engine::Scenario };
        let options = Options { times: Times::Exact, ..options.clone() };
        let found = shown(&self.subject, self.subject.questions[question], finding, &options, stop);
        found.1.is_some().then_some(found)
    }
}

/// A run of the system that goes along.
struct Walk<'s, 'm> {
    subject: &'s Subject<'m>,
    layout: Layout,
    /// The inputs of the machine that nobody but the operator gives, with those of the system.
    given: Vec<(InputId, usize)>,
    /// For each actuator of which it is only known how long it travels at most, by index, the two inputs that let it.
    travels: Vec<(usize, [usize; 2])>,
    run: Trace,
    state: Vec<bool>,
    /// For each question, after how many transitions it shows.
    shows: Vec<Option<usize>>,
    /// Whether outputs wait to be written.
    waits: bool,
    /// What has happened since the last scan, if the scenario tells it.
    happenings: Option<Vec<String>>,
    /// Whether the system has gone along so far.
    along: bool,
    /// Gates that may still be evaluated.
    left: u64,
    leaves: Vec<u64>,
    values: Vec<u64>,
}

impl<'s, 'm> Walk<'s, 'm> {
    fn new(subject: &'s Subject<'m>, left: u64) -> Walk<'s, 'm> {
        let (machine, system) = (subject.machine, &subject.system);
        let place = |name: &str| system.inputs.iter().position(|i| system.name(i.leaf) == name);
        let given = machine.inputs.iter().filter_map(|(id, input)| Some((id, place(&input.name)?))).collect();
        let travels = machine.plant.travels.iter().enumerate().filter_map(|(i, travel)| {
            let name = &machine.actuators[travel.actuator].name;
            Some((i, [place(&format!("{name} gets away"))?, place(&format!("{name} arrives"))?]))
        });
        let initial: Vec<bool> = system.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
        Walk {
            subject,
            layout: Layout::of(machine),
            given,
            travels: travels.collect(),
            state: initial.clone(),
            run: Trace { initial, inputs: Vec::new(), shortest: false },
            shows: vec![None; subject.questions.len()],
            waits: false,
            happenings: None,
            along: true,
            left,
            leaves: vec![0; system.aig.leaves().len()],
            values: Vec::new(),
        }
    }

    /// Goes to the next scan, in which this is seen.
    fn go(&mut self, frame: &Frame, told: bool) {
        let happenings = self.happenings.take();
        if !self.along {
            return;
        }
        if self.run.inputs.is_empty() {
            self.begin(frame);
        }
        let goes_on = self.left > 0 && self.run.inputs.len() < LONGEST;
        self.along = goes_on && self.between(frame, told, &happenings.unwrap_or_default()) && self.scan(frame);
    }

    /// What may begin in two ways begins as it is seen.
    fn begin(&mut self, frame: &Frame) {
        let Subject { machine, system, .. } = self.subject;
        for (i, latch) in system.latches.iter().enumerate().filter(|(_, l)| l.initial.is_none()) {
            let bit = machine.plant.bits.iter().find(|(_, b)| b.name == system.name(latch.leaf));
            self.state[i] = bit.is_some_and(|(id, _)| frame[self.layout.bit(id)]);
        }
        self.run.initial.clone_from(&self.state);
    }

    /// What happens before a scan in a plant that goes by steps.
    fn between(&mut self, frame: &Frame, told: bool, happenings: &[String]) -> bool {
        if self.subject.view.turn.reading == Lit::TRUE {
            return true;
        }
        for what in happenings.iter().filter(|what| *what != "outputs are written") {
            let (what, before) = match what.strip_suffix(" before writing") {
                Some(what) => (what, true),
                None => (what.as_str(), false),
            };
            if !before && self.waits && !self.write(frame) {
                return false;
            }
            let possible = self.possible(frame);
            let steps = &self.subject.machine.plant.happenings;
            let step = possible.into_iter().find(|&h| steps[h].text == what);
            if step.is_none_or(|step| self.happens(frame, step) != Some(true)) {
                return false;
            }
        }
        let begun = self.waits;
        if begun && !self.write(frame) {
            return false;
        }
        if told || !begun {
            return true;
        }
        // What another one has made impossible does not happen.
        self.possible(frame).into_iter().all(|step| self.happens(frame, step).is_some())
    }

    /// What comes in: what the operator gives, and of the choices of the plant that one, counted from 1.
    fn inputs(&self, frame: &Frame, choice: usize) -> Vec<bool> {
        let system = &self.subject.system;
        let mut inputs = vec![false; system.inputs.len()];
        self.given.iter().for_each(|&(id, i)| inputs[i] = frame[self.layout.input(id)]);
        for (i, input) in system.inputs.iter().enumerate() {
            if let Some(bit) = system.name(input.leaf).strip_prefix("choice ").and_then(|n| n.parse::<u32>().ok()) {
                inputs[i] = choice >> bit & 1 == 1;
            }
        }
        inputs
    }

    /// Evaluates a transition, with several values of the inputs at once, up to 64.
    fn evaluate(&mut self, inputs: &[Vec<bool>]) {
        let system = &self.subject.system;
        for (latch, &value) in system.latches.iter().zip(&self.state) {
            self.leaves[system.aig.number(latch.leaf)] = if value { u64::MAX } else { 0 };
        }
        for (i, input) in system.inputs.iter().enumerate() {
            let word = inputs.iter().enumerate().fold(0, |word, (lane, inputs)| word | u64::from(inputs[i]) << lane);
            self.leaves[system.aig.number(input.leaf)] = word;
        }
        self.values.clear();
        system.aig.simulate(&self.leaves, &mut self.values);
        self.left = self.left.saturating_sub(self.values.len() as u64);
    }

    fn is(&self, l: Lit, lane: usize) -> bool {
        lanes(&self.values, l) >> lane & 1 == 1
    }

    /// What may happen now.
    fn possible(&mut self, frame: &Frame) -> Vec<usize> {
        let mut possible = Vec::new();
        let all: Vec<usize> = (0..self.subject.machine.plant.happenings.len()).collect();
        for some in all.chunks(64) {
            let tried: Vec<Vec<bool>> = some.iter().map(|&h| self.inputs(frame, h + 1)).collect();
            self.evaluate(&tried);
            let moves = &self.subject.view.turn.moves;
            possible.extend(some.iter().enumerate().filter(|&(lane, &h)| self.is(moves[h].0, lane)).map(|(_, &h)| h));
        }
        possible
    }

    /// Lets something happen, and says whether it could; nothing if the system does not go along.
    fn happens(&mut self, frame: &Frame, happening: usize) -> Option<bool> {
        let inputs = self.inputs(frame, happening + 1);
        self.evaluate(std::slice::from_ref(&inputs));
        let happens = self.is(self.subject.view.turn.moves[happening].0, 0);
        (!happens || self.step(inputs)).then_some(happens)
    }

    fn write(&mut self, frame: &Frame) -> bool {
        let inputs = self.inputs(frame, 0);
        self.waits = false;
        self.evaluate(std::slice::from_ref(&inputs));
        self.is(self.subject.view.turn.writing, 0) && self.step(inputs)
    }

    /// The program's scan. What an actuator of unknown speed does is what its sensors tell.
    fn scan(&mut self, frame: &Frame) -> bool {
        let (machine, view) = (self.subject.machine, &self.subject.view);
        let mut inputs = self.inputs(frame, 0);
        if !self.travels.is_empty() {
            let mut tried = vec![inputs.clone(); 4];
            for (lane, inputs) in tried.iter_mut().enumerate() {
                self.travels.iter().for_each(|(_, bits)| (0..2).for_each(|b| inputs[bits[b]] = lane >> b & 1 == 1));
            }
            self.evaluate(&tried);
            for (travel, bits) in &self.travels {
                let sensors = &machine.plant.travels[*travel].sensors;
                let seen =
                    |lane: usize, i: InputId| self.is(view.inputs[i.index()], lane) == frame[self.layout.input(i)];
                let lane = (0..4).find(|&lane| sensors.iter().all(|s| seen(lane, s.input)));
                let Some(lane) = lane else { return false };
                (0..2).for_each(|b| inputs[bits[b]] = lane >> b & 1 == 1);
            }
        }
        self.waits = true;
        self.evaluate(std::slice::from_ref(&inputs));
        let same = |i: InputId| self.is(view.inputs[i.index()], 0) == frame[self.layout.input(i)];
        self.is(view.turn.reading, 0) && machine.inputs.ids().all(same) && self.step(inputs)
    }

    /// Takes the transition that has just been evaluated, if the constraints allow it, and notes what shows in it.
    fn step(&mut self, inputs: Vec<bool>) -> bool {
        let system = &self.subject.system;
        if system.constraints.iter().any(|&c| !self.is(c, 0)) {
            return false;
        }
        self.run.inputs.push(inputs);
        for (claim, shows) in system.claims.iter().zip(&mut self.shows) {
            if let Property::Never(bad) = claim.property
                && shows.is_none()
                && lanes(&self.values, bad) & 1 == 1
            {
                *shows = Some(self.run.inputs.len());
            }
        }
        self.state = system.latches.iter().map(|l| lanes(&self.values, l.next) & 1 == 1).collect();
        true
    }
}
