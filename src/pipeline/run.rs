//! A run of the system to what people see of it: its scans, what happens between them, and the scenario that plays it.

use super::findings::headline;
use super::rungs;
use super::verify::{Options, Question, quoted};
use crate::base::{Span, figure};
use crate::ir::chart::{Atom, InputId, Machine, Mark, OutputId};
use crate::ir::scenario::{BitId, Condition, Doing, Given, Happening, PropertyKind, Scenario, Seen, Step, Told};
use crate::simulate::frame::{Frame, Layout};
use crate::simulate::run::Program as Runs;
use crate::simulate::scenario::play;
use crate::verify::aig::{Lit, lanes};
use crate::verify::limits::Stop;
use crate::verify::machine::clocks::Times;
use crate::verify::machine::{Program, Subject};
use crate::verify::system::{Giver, Trace};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Scans of a run that somebody may look through even if it shows no more than that something can be.
const LOOKED_THROUGH: usize = 200;

/// A run from power-up.
#[derive(Clone, Debug)]
pub struct Run {
    /// What there is to see after each scan.
    pub frames: Vec<Frame>,
    /// What happens between them in a plant that goes by steps, in order.
    pub between: Vec<Between>,
    /// Whether no shorter run shows the same.
    pub shortest: bool,
    /// The scan, counted from 1, from which on it can repeat itself for ever, if that is what it shows.
    pub repeats: Option<usize>,
    /// The run as a scenario, in the words of the language.
    pub scenario: String,
    /// Whether the chart does the same in the simulator. It does unless times are needed that a fixed cycle
    /// does not give; nothing if it is no run of the chart.
    pub replayed: Option<bool>,
    /// The rungs that drove the outputs in question in the last scan, with what every contact was; nothing if no
    /// output is in question, or the program does something else because of times.
    pub rungs: Option<String>,
}

/// Something that happens in the plant between two scans.
#[derive(Clone, Debug)]
pub struct Between {
    /// After how many scans.
    pub scans: usize,
    /// What, in words.
    pub text: String,
    /// What there is to see then: all that is not hidden as after the last scan.
    pub frame: Frame,
}

impl Run {
    /// Whether there is nothing to see: it shows what cannot come any more from the beginning.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.between.is_empty()
    }

    /// When it ends: in scan 3, or after it and before the next one.
    pub fn end(&self) -> String {
        match (self.frames.len(), self.between.last()) {
            (0, Some(_)) => "before the first scan".to_owned(),
            (scans, Some(last)) if last.scans == scans => format!("after scan {scans}"),
            (scans, _) => format!("in scan {scans}"),
        }
    }
}

/// A transition of the system.
struct Moment {
    kind: Kind,
    frame: Frame,
    /// Whether outputs wait to be written until then.
    waits: bool,
    /// The inputs that nobody but the operator gives, with their values then.
    free: Vec<(InputId, bool)>,
}

/// What a transition is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A scan.
    Reads,
    /// Outputs are written.
    Writes,
    /// Something happens: of the plant's moves the one of that index, happenings first.
    Happens(usize),
}

/// A run of the system as people see it, played once more by the simulator.
pub(super) fn show(subject: &Subject<'_>, question: Question, trace: &Trace, options: &Options, stop: Stop<'_>) -> Run {
    // What people look at is worth the time to make it calm: of what one hopes for they see that it comes.
    let claim = subject.questions.iter().position(|q| *q == question).expect("it was asked");
    let property = subject.system.claims[claim].property;
    let seen = !question.hopes_for_a_run(subject.machine) || trace.inputs.len() < LOOKED_THROUGH;
    let calm = (seen && options.demands(question)).then(|| subject.system.calm(trace, property, stop));
    // Scan by scan, as it is in the simulator.
    let trace = &subject.stretched(calm.as_ref().unwrap_or(trace), property);
    let begin = subject.system.repeats(trace, property);
    let end = trace.inputs.len();
    // What repeats itself is played twice.
    let mut longer = trace.clone();
    longer.inputs.extend_from_slice(&trace.inputs[begin.unwrap_or(end)..]);
    let moments = moments(subject, &longer);
    let scans_in = |moments: &[Moment]| moments.iter().filter(|m| m.kind == Kind::Reads).count();
    let scans = scans_in(&moments[..end]);
    let repeats = begin.map(|begin| scans_in(&moments[..begin]));

    let machine = subject.machine;
    let layout = Layout::of(machine);
    let player = Player::new(machine, options);
    let hidden = unknown(subject, trace);
    let doings = player.doings(&moments, &hidden);
    let mut frames: Vec<Frame> = moments.iter().filter(|m| m.kind == Kind::Reads).map(|m| m.frame.clone()).collect();
    let still = {
        // Where nothing comes in anew, the answer does not come however long one waits.
        let inputs = layout.inputs();
        let given = frames[repeats.unwrap_or(scans)..].windows(2).all(|w| w[0][inputs.clone()] == w[1][inputs.clone()]);
        given && moments[begin.unwrap_or(end)..].iter().all(|m| !matches!(m.kind, Kind::Happens(_)))
    };
    let scenario = scenario(machine, question, options, &doings, still.then(|| scans.max(100)));
    let replayed = (options.program == Program::Chart).then(|| player.repeats(&doings, &moments));
    frames.truncate(scans);
    let wrong = !question.hopes_for_a_run(machine);
    let outputs = if replayed == Some(true) && wrong { outputs(machine, question) } else { Vec::new() };
    let rungs = if outputs.is_empty() { None } else { rungs::show(machine, &frames, &outputs) };
    let between = between(subject, &moments[..end], &hidden);
    Run { frames, between, shortest: trace.shortest, repeats: repeats.map(|scan| scan + 1), scenario, replayed, rungs }
}

/// The transitions of a run.
fn moments(subject: &Subject<'_>, trace: &Trace) -> Vec<Moment> {
    let (view, turn) = (subject.view.frame(), &subject.view.turn);
    let free: Vec<(InputId, Lit)> = subject
        .system
        .inputs
        .iter()
        .filter(|i| i.giver == Giver::Operator)
        .filter_map(|i| {
            let name = subject.system.name(i.leaf);
            let found = subject.machine.inputs.iter().find(|(_, input)| input.name == name);
            found.map(|(id, _)| (id, i.leaf))
        })
        .collect();
    let mut waits = false;
    let mut moments = Vec::new();
    let replayed = subject.system.replay(trace, &mut |values| {
        let is = |l: Lit| lanes(values, l) & 1 == 1;
        let kind = match turn.moves.iter().position(|(happens, _)| is(*happens)) {
            Some(step) => Kind::Happens(step),
            None if is(turn.writing) => Kind::Writes,
            None => Kind::Reads,
        };
        let frame = view.iter().map(|&l| is(l)).collect();
        moments.push(Moment { kind, frame, waits, free: free.iter().map(|&(id, l)| (id, is(l))).collect() });
        waits = match kind {
            Kind::Reads => true,
            Kind::Writes => false,
            Kind::Happens(_) => waits,
        };
    });
    replayed.expect("the engines replay what they return");
    if let Some(reset) = subject.machine.safety.reset {
        number_scans(subject.machine, reset, &mut moments);
    }
    moments
}

/// Keeps the number of the scan in which began what the filter notes, which the system does not count.
fn number_scans(machine: &Machine, reset: InputId, moments: &mut [Moment]) {
    let layout = Layout::of(machine);
    let (noted, reset) = (layout.mark(Mark::Noted), layout.input(reset));
    let (mut scan, mut number) = (0, 0);
    let mut before: Option<(bool, bool)> = None;
    for moment in moments {
        let now = (moment.frame[noted], moment.frame[reset]);
        if moment.kind == Kind::Reads {
            scan += 1;
            let held = before.is_some_and(|(noted, reset)| noted && (reset || !now.1));
            number = match (now.0, held) {
                (false, _) => 0,
                (true, true) => number,
                (true, false) => scan,
            };
            before = Some(now);
        }
        moment.frame.resize(layout.frame().len(), false);
        layout.put_first_scan(number, &mut moment.frame);
    }
}

/// The hidden bits of which nobody knows the value to begin with, with what it is in this run.
fn unknown(subject: &Subject<'_>, trace: &Trace) -> Vec<(BitId, bool)> {
    let plant = &subject.machine.plant;
    let latches = subject.system.latches.iter().zip(&trace.initial).filter(|(latch, _)| latch.initial.is_none());
    let named = latches.filter_map(|(latch, &value)| {
        let name = subject.system.name(latch.leaf);
        plant.unknown.iter().find(|b| plant.bits[**b].name == name).map(|&bit| (bit, value))
    });
    named.collect()
}

/// What is to be said of what happens between scans. That outputs are written is worth a word where something hidden follows.
fn between(subject: &Subject<'_>, moments: &[Moment], unknown: &[(BitId, bool)]) -> Vec<Between> {
    let machine = subject.machine;
    let layout = Layout::of(machine);
    let hidden = [layout.inputs().end..layout.given().end, layout.counts()];
    let mut last = layout.frame();
    for &(given, value) in &machine.plant.initially {
        if let Given::Bit(bit) = given {
            last[layout.bit(bit)] = value;
        }
    }
    unknown.iter().for_each(|&(bit, value)| last[layout.bit(bit)] = value);
    for (id, count) in machine.plant.counts.iter() {
        layout.put_count(id, count.initial, &mut last);
    }
    let mut between = Vec::new();
    let mut scans = 0;
    for moment in moments {
        let text = match moment.kind {
            Kind::Reads => {
                scans += 1;
                last.clone_from(&moment.frame);
                continue;
            }
            Kind::Writes => "outputs are written".to_owned(),
            Kind::Happens(step) => {
                let when = if moment.waits { " before writing" } else { "" };
                format!("{}{when}", subject.view.turn.moves[step].1)
            }
        };
        let mut frame = last.clone();
        hidden.iter().cloned().for_each(|places| frame[places.clone()].copy_from_slice(&moment.frame[places]));
        if moment.kind == Kind::Writes && frame == last {
            continue;
        }
        if between.is_empty() && scans == 0 && unknown.iter().any(|(_, value)| *value) {
            between.push(Between { scans, text: "to begin with".to_owned(), frame: last.clone() });
        }
        between.push(Between { scans, text, frame: frame.clone() });
        last = frame;
    }
    between
}

/// The outputs of which a demand speaks.
fn outputs(machine: &Machine, question: Question) -> Vec<OutputId> {
    let mut outputs = BTreeSet::new();
    let mut note = |atom: &Atom| {
        if let Atom::Output(o) | Atom::PrevOutput(o) = atom {
            outputs.insert(*o);
        }
    };
    match question {
        Question::Declared(i) => {
            let p = &machine.properties[i];
            for condition in p.after.iter().chain([&p.condition]) {
                condition.for_each_atom(&mut |seen| {
                    if let Seen::Machine(atom) = seen {
                        note(atom);
                    }
                });
            }
        }
        Question::Violated(c) => machine.safety.constraints[c].never.for_each_atom(&mut note),
        _ => {}
    }
    outputs.into_iter().collect()
}

/// How a scenario plays runs.
struct Player<'m> {
    machine: &'m Machine,
    /// Whether it tells what happens in the plant.
    tells: bool,
    /// Whether the plant goes its own way, so that it matters how it begins.
    lives: bool,
    /// For each input, who gives it.
    gives: Vec<Gives>,
}

/// Who gives an input its value in a scenario.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gives {
    /// The scenario sets it.
    Scenario,
    /// The plant would, and the scenario forces it: when an actuator arrives, and when times have passed, is not in a
    /// fixed cycle's power where times are open, or an actuator may be faster than it says.
    Forced,
    /// The plant, to whom the scenario tells what happens.
    Plant,
}

impl<'m> Player<'m> {
    fn new(machine: &'m Machine, options: &Options) -> Player<'m> {
        let plant = &machine.plant;
        let tells = plant.by_steps && !options.open && options.program == Program::Chart;
        let given = if options.open { vec![true; machine.inputs.len()] } else { plant.gives(machine.inputs.len()) };
        // With exact times the simulator's plant does the same by itself, except where less is known of it or it is left out.
        let exact = options.times == Times::Exact && options.program == Program::Chart && !options.open;
        let mut forced = vec![!tells && !exact; machine.inputs.len()];
        let unknown = plant.travels.iter().filter(|t| !exact || t.at_most);
        unknown.flat_map(|t| &t.sensors).for_each(|s| forced[s.input.index()] = true);
        for rule in plant.rules.iter().filter(|r| r.delay > 0 && !exact) {
            if let Given::Input(input) = rule.target {
                forced[input.index()] = true;
            }
        }
        let gives = given.iter().zip(forced).map(|(&given, forced)| match (given, forced) {
            (false, _) => Gives::Scenario,
            (true, true) => Gives::Forced,
            (true, false) => Gives::Plant,
        });
        Player { machine, tells, lives: tells || exact, gives: gives.collect() }
    }

    /// What to do, so that the program samples in each scan what stands in the frames.
    fn doings(&self, moments: &[Moment], unknown: &[(BitId, bool)]) -> Vec<Doing> {
        let machine = self.machine;
        let layout = Layout::of(machine);
        let mut now: Vec<Option<bool>> = vec![Some(false); machine.inputs.len()];
        for &(given, value) in &machine.plant.initially {
            if let Given::Input(i) = given {
                now[i.index()] = Some(value);
            }
        }
        for (now, gives) in now.iter_mut().zip(&self.gives) {
            if *gives == Gives::Forced {
                *now = None;
            }
        }
        let mut doings: Vec<Doing> = Vec::new();
        let begin: Vec<(Given, bool)> =
            unknown.iter().filter(|(_, value)| *value && self.lives).map(|&(bit, _)| (Given::Bit(bit), true)).collect();
        if !begin.is_empty() {
            doings.push(Doing::Set(begin));
        }
        let happens = |m: &Moment| matches!(m.kind, Kind::Happens(step) if step < machine.plant.happenings.len());
        if self.tells && !moments.iter().any(happens) {
            doings.push(Doing::Happens(None));
        }
        for moment in moments {
            match moment.kind {
                Kind::Reads => {
                    let values = machine.inputs.ids().map(|i| (i, moment.frame[layout.input(i)]));
                    self.give(values, &mut now, &mut doings);
                    match doings.last_mut() {
                        Some(Doing::Wait(scans)) => *scans += 1,
                        _ => doings.push(Doing::Wait(1)),
                    }
                }
                Kind::Happens(step) if self.tells && step < machine.plant.happenings.len() => {
                    let read = reads(&machine.plant.happenings[step]);
                    self.give(moment.free.iter().copied().filter(|(i, _)| read.contains(i)), &mut now, &mut doings);
                    doings.push(Doing::Happens(Some(Told { happening: step, before_writing: moment.waits })));
                }
                // Actuators that travel are seen in what is forced; outputs are written before what comes next.
                Kind::Happens(_) | Kind::Writes => {}
            }
        }
        if self.tells && moments.last().is_some_and(|m| m.kind == Kind::Writes) {
            doings.push(Doing::Wait(1));
        }
        doings
    }

    /// Gives inputs their values as far as they have others.
    fn give(&self, values: impl Iterator<Item = (InputId, bool)>, now: &mut [Option<bool>], doings: &mut Vec<Doing>) {
        let changed: Vec<(InputId, bool)> = values.filter(|(i, value)| now[i.index()] != Some(*value)).collect();
        for wanted in [true, false] {
            let set: Vec<(Given, bool)> = changed
                .iter()
                .filter(|(i, value)| self.gives[i.index()] == Gives::Scenario && *value == wanted)
                .map(|&(i, value)| (Given::Input(i), value))
                .collect();
            if !set.is_empty() {
                doings.push(Doing::Set(set));
            }
        }
        let forced: Vec<(InputId, bool)> =
            changed.iter().copied().filter(|(i, _)| self.gives[i.index()] == Gives::Forced).collect();
        if !forced.is_empty() {
            doings.push(Doing::Force(forced));
        }
        changed.iter().for_each(|&(i, value)| now[i.index()] = Some(value));
    }

    /// Whether the simulator, which shares nothing with the system, sees the same in every scan. What the plant hides is
    /// left out where nobody tells it what happens: it goes its own way while inputs are forced.
    fn repeats(&self, doings: &[Doing], moments: &[Moment]) -> bool {
        let mut machine = self.machine.clone();
        let span = Span::default();
        let steps = doings.iter().map(|d| Step { doing: d.clone(), text: String::new(), span });
        machine.scenarios.push(Scenario { name: String::new(), after: None, steps: steps.collect(), span });
        let layout = Layout::of(&machine);
        let mut seen: Vec<Frame> = Vec::new();
        let program = Runs::chart(&machine);
        let verdict = play(&machine, program, machine.scenarios.len() - 1, &mut |_, frame| seen.push(frame.clone()));
        let hidden = [layout.inputs().end..layout.given().end, layout.counts()];
        let visible = |frame: &Frame| -> Frame {
            let is_seen = |i: &usize| self.tells || !hidden.iter().any(|places| places.contains(i));
            frame.iter().enumerate().filter(|(i, _)| is_seen(i)).map(|(_, &v)| v).collect()
        };
        let scans = moments.iter().filter(|m| m.kind == Kind::Reads);
        let (wanted, writes) = (scans.clone().count(), moments.last().is_some_and(|m| m.kind == Kind::Writes));
        seen.truncate(wanted);
        // At the end, what is hidden is what has come of all that has happened.
        let same =
            |last: &Moment| hidden.iter().all(|places| verdict.last[places.clone()] == last.frame[places.clone()]);
        let ends = !self.tells || writes || moments.last().is_none_or(same);
        verdict.failure.is_none() && ends && seen.iter().map(visible).eq(scans.map(|m| visible(&m.frame)))
    }
}

/// The inputs that something that may happen looks at.
fn reads(happening: &Happening) -> BTreeSet<InputId> {
    let mut inputs = BTreeSet::new();
    let mut look = |condition: &Condition| {
        condition.for_each_atom(&mut |seen| {
            if let Seen::Machine(Atom::Input(i)) = seen {
                inputs.insert(*i);
            }
        });
    };
    look(&happening.condition);
    happening.outcomes.iter().for_each(|o| look(&o.condition));
    inputs
}

/// The scenario in the words of the language. With `wait`, an answer that never comes is waited for so many scans.
fn scenario(machine: &Machine, question: Question, options: &Options, doings: &[Doing], wait: Option<usize>) -> String {
    let without = match options.without.as_slice() {
        [] => String::new(),
        names => format!(" without {}", names.join(", ")),
    };
    let name = format!("found by verification{without}: {}", headline(machine, question));
    let condition = |i: usize| &machine.properties[i].written;
    let (mut watch, mut end) = (String::new(), String::new());
    if let Question::Acts(c) = question {
        watch = format!("  never acts({})\n", machine.safety.constraints[c].name);
    }
    if let Question::Declared(i) = question {
        match machine.properties[i].kind {
            PropertyKind::Never => watch = format!("  never {}\n", condition(i)),
            PropertyKind::Always => watch = format!("  always {}\n", condition(i)),
            PropertyKind::Reachable => end = format!("  expect {}\n", condition(i)),
            PropertyKind::Eventually => {
                end = match wait {
                    Some(n) => format!("  wait until {} within {}\n", condition(i), figure(n, "scan")),
                    None => format!("  expect {}\n", condition(i)),
                }
            }
            // What it takes to come there once it is possible again only the author knows.
            PropertyKind::AlwaysPossible => {
                let words: Vec<&str> = condition(i).split_whitespace().collect();
                end = format!("  // from here on it cannot come any more: {}\n", words.join(" "));
            }
            PropertyKind::Fair => {}
        }
    }
    match question {
        Question::Moves => end = "  // from here on no transition can fire any more\n".to_owned(),
        Question::Assumable => end = "  // from here on the assumptions leave no inputs\n".to_owned(),
        _ => {}
    }
    let mut scenario = format!("scenario {} {{\n{watch}", quoted(&name));
    doings.iter().for_each(|d| write_doing(machine, d, &mut scenario));
    scenario + &end + "}\n"
}

fn write_doing(machine: &Machine, doing: &Doing, out: &mut String) {
    let _ = match doing {
        Doing::Set(given) => {
            let names: Vec<&str> = given.iter().map(|&(g, _)| machine.given(g)).collect();
            let word = if given[0].1 { "set" } else { "reset" };
            writeln!(out, "  {word} {}", names.join(", "))
        }
        Doing::Force(forced) => {
            let name = |&(i, value): &(InputId, bool)| {
                format!("{}{}", if value { "" } else { "not " }, machine.inputs[i].name)
            };
            let names: Vec<String> = forced.iter().map(name).collect();
            writeln!(out, "  force {}", names.join(", "))
        }
        Doing::Happens(None) => writeln!(out, "  happens nothing"),
        Doing::Happens(Some(told)) => {
            let when = if told.before_writing { " before writing" } else { "" };
            writeln!(out, "  happens {}{when}", quoted(&machine.plant.happenings[told.happening].text))
        }
        Doing::Wait(n) => writeln!(out, "  wait {}", figure(n, "scan")),
        other => unreachable!("{other:?} is not among what a run needs"),
    };
}
