//! Names to the latches of one program, and what those are believed to hold.

use super::chart_step::ChartStep;
use super::correspondence::Correspondence;
use super::parts::{Meaning, Part, SCAN_WIDTH, Timer, WIDTH, said};
use super::program_step::ProgramStep;
use super::wiring;
use crate::base::iec;
use crate::ir::chart::{Machine, StateId};
use crate::ir::iec::{BlockId, Body, Kind, Project, Scope, VarId};
use std::collections::BTreeMap;

/// The type of integers.
const INT: Kind = Kind::Int { bits: WIDTH, signed: true };
/// The type of the numbers of scans.
const UDINT: Kind = Kind::Int { bits: SCAN_WIDTH, signed: false };

/// Which latches of a program stand for which parts of a machine.
#[derive(Clone, Debug)]
pub struct Match {
    /// For each input, its latch.
    pub inputs: Vec<usize>,
    /// All parts that the program has something for, with their latches.
    pub parts: Vec<(Part, usize)>,
    /// For each latch, what it is believed to hold between scans; to be proved.
    pub meanings: Vec<Option<Meaning>>,
    /// For each latch, whether the belief is no more than a guess.
    pub guessed: Vec<bool>,
    /// For each block of the program, the time that it is believed to measure.
    pub timers: Vec<Option<Timer>>,
    /// Timers of other times than the chart's; with them it can be refuted but not proved.
    pub missing: Vec<String>,
}

/// The two sides and what joins them.
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Its step.
    pub chart: &'a ChartStep<'a>,
    /// The program's step.
    pub program: &'a ProgramStep<'a>,
}

impl Match {
    /// Looks names up; says which ones the program does not have.
    pub fn of(pair: Pair<'_>, names: &Correspondence, project: &Project) -> Result<Match, String> {
        let Pair { machine, program, .. } = pair;
        let globals: BTreeMap<String, VarId> = project
            .variables
            .iter()
            .filter(|(_, v)| v.scope == Scope::Global)
            .map(|(id, v)| (iec::fold(&v.name), id))
            .collect();
        let mut matched = Match {
            inputs: Vec::new(),
            parts: Vec::new(),
            meanings: Vec::new(),
            guessed: vec![false; program.latches().len()],
            timers: vec![None; project.blocks.len()],
            missing: Vec::new(),
        };
        let mut add = |part: Part, name: &String| {
            let what = || part.describe(machine);
            let id = globals.get(&iec::fold(name)).ok_or_else(|| missing(name, &what()))?;
            let latch = program.variable(*id);
            let latch = latch.ok_or_else(|| format!("`{name}`, which stands for {}, is not BOOL", what()))?;
            matched.parts.push((part, latch));
            Ok::<usize, String>(latch)
        };
        for (id, name) in machine.inputs.ids().zip(&names.inputs) {
            matched.inputs.push(add(Part::Input(id), name)?);
        }
        for (id, name) in machine.states.ids().zip(&names.flags) {
            add(Part::Flag(id), name)?;
        }
        for (id, name) in machine.outputs.ids().zip(&names.outputs) {
            add(Part::Output(id), name)?;
        }
        for (id, name) in machine.variables.ids().zip(&names.variables) {
            add(Part::Variable(id), name)?;
        }
        for (id, name) in machine.events.ids().zip(&names.events) {
            add(Part::Event(id), name)?;
        }
        let raised = machine.events.ids().map(Part::Raised).zip(&names.raised);
        let commands = machine.outputs.ids().map(Part::Command).zip(&names.commands);
        let acted = machine.safety.constraints.ids().map(Part::Acted).zip(&names.acted);
        let broken = (0..names.broken.len()).map(Part::Broken).zip(&names.broken);
        let marks = machine.safety.marks().enumerate().map(|(i, mark)| Part::Mark(mark, i)).zip(&names.marks);
        for (part, name) in raised.chain(commands).chain(acted).chain(broken).chain(marks) {
            if let Some(name) = name {
                add(part, name)?;
            }
        }
        let number = |name: &String, what: &str, kind: Kind, type_name: &str| {
            let variable = globals.get(&iec::fold(name)).ok_or_else(|| missing(name, what))?;
            let latches = program.integer(*variable).filter(|_| project.variables[*variable].kind == kind);
            latches.ok_or_else(|| format!("`{name}`, which stands for {what}, is not {type_name}"))
        };
        for (id, name) in machine.integers.ids().zip(&names.integers) {
            let latches = number(name, &format!("integer {}", machine.integers[id].name), INT, "INT")?;
            matched.parts.extend((0..WIDTH).map(|bit| Part::Bit(id, bit)).zip(latches));
        }
        for (which, name) in machine.safety.scan_numbers().zip(&names.scans) {
            if let Some(name) = name {
                let latches = number(name, said(which), UDINT, "UDINT")?;
                matched.parts.extend((0..SCAN_WIDTH).map(|bit| Part::Scan(which, bit)).zip(latches));
            }
        }
        let mut absent = matched.steps(pair, names, project);
        absent.extend(matched.timers(pair, names, project));
        if let [first, rest @ ..] = absent.as_slice() {
            let more = if rest.is_empty() { String::new() } else { format!(", and {} more", rest.len()) };
            return Err(format!("{first}{more}"));
        }
        wiring::compare(machine, names, project)?;
        matched.by_construction(pair, project);
        for (state, name) in machine.states.ids().zip(&names.last) {
            let name = name.as_ref().filter(|_| pair.chart.remembers(state));
            let latch = name.and_then(|n| globals.get(&iec::fold(n))).and_then(|v| program.variable(*v));
            if let Some(latch) = latch {
                matched.meanings[latch] = Some(Meaning::Last(state, true));
            }
        }
        Ok(matched)
    }

    /// Returns what is absent.
    fn steps(&mut self, pair: Pair<'_>, names: &Correspondence, project: &Project) -> Vec<String> {
        let Pair { machine, program, .. } = pair;
        let mut absent = Vec::new();
        let mut places = BTreeMap::new();
        for (p, instance) in project.programs.iter().enumerate() {
            if let Body::Sfc(sfc) = &instance.body {
                for (id, step) in sfc.steps.iter() {
                    places.insert((iec::fold(&instance.kind), iec::fold(&step.name)), program.step(p, id));
                }
            }
        }
        for (id, place) in machine.states.ids().zip(&names.steps) {
            let Some((program, step)) = place else { continue };
            match places.get(&(iec::fold(program), iec::fold(step))) {
                Some(&latch) => self.parts.push((Part::Step(id), latch)),
                None => {
                    let what = Part::Step(id).describe(machine);
                    absent.push(format!("the program has no step `{program}.{step}` that is reached, for {what}"));
                }
            }
        }
        absent
    }

    /// Returns what is absent.
    fn timers(&mut self, pair: Pair<'_>, names: &Correspondence, project: &Project) -> Vec<String> {
        let Pair { machine, chart, program } = pair;
        let mut absent = Vec::new();
        let places: BTreeMap<(String, String), BlockId> = project
            .blocks
            .iter()
            .filter_map(|(id, block)| match block.scope {
                Scope::Global => None,
                Scope::Program(p) => Some(((iec::fold(&project.programs[p].kind), iec::fold(&block.name)), id)),
            })
            .collect();
        for (index, (state, ms)) in chart.timers().enumerate() {
            let timer = Timer { index, state, ms };
            let what = Part::Begins(timer).describe(machine);
            let Some((place, name)) = names.timers.get(&(state, ms)) else {
                absent.push(format!("nothing is known to stand for {what}"));
                continue;
            };
            let found = places.get(&(iec::fold(place), iec::fold(name)));
            // With another preset time it does not measure this one.
            let fits = |id: &&BlockId| program.presets()[id.index()] == Some(i64::from(ms) * 1000);
            match (found, found.filter(fits)) {
                (_, Some(&id)) => {
                    self.timers[id.index()] = Some(timer);
                    self.parts.push((Part::Begins(timer), program.block(id) + 3));
                }
                (Some(_), None) => self.missing.push(format!("`{place}.{name}` measures another time than {what}")),
                (None, None) => absent.push(missing(&format!("{place}.{name}"), &what)),
            }
        }
        absent
    }

    /// What latches hold by the way in which a program is made: parts hold themselves, the bits of a
    /// timer whether its state has just been entered and whether its time has passed, the idle step of
    /// a region's SFC, which stands for no state, is active exactly while the region's parent is not,
    /// and what nothing writes keeps its initial value.
    fn by_construction(&mut self, Pair { machine, program, .. }: Pair<'_>, project: &Project) {
        let mut meanings: Vec<Option<Meaning>> = vec![None; program.latches().len()];
        let mut state_of: BTreeMap<usize, StateId> = BTreeMap::new();
        for &(part, latch) in &self.parts {
            meanings[latch] = meanings[latch].or(part.remembered());
            if let Part::Step(s) = part {
                state_of.insert(latch, s);
            }
        }
        for (block, timer) in project.blocks.ids().zip(&self.timers) {
            if let Some(timer) = *timer {
                let first = program.block(block);
                meanings[first] = Some(Meaning::Fresh(timer, false));
                meanings[first + 1] = Some(Meaning::Past(timer, true));
                meanings[first + 2] = Some(Meaning::Fresh(timer, false));
            }
        }
        let written = program.written();
        for (latch, value) in program.power_up().into_iter().enumerate() {
            if !written[latch] && meanings[latch].is_none() {
                meanings[latch] = value.constant().map(Meaning::Constant);
            }
        }
        for (p, instance) in project.programs.iter().enumerate() {
            let Body::Sfc(sfc) = &instance.body else { continue };
            let some = sfc.steps.ids().find_map(|s| state_of.get(&program.step(p, s)));
            let Some(region) = some.map(|&s| machine.states[s].region) else { continue };
            for latch in sfc.steps.ids().map(|id| program.step(p, id)).filter(|l| !state_of.contains_key(l)) {
                meanings[latch] = Some(match machine.regions[region].parent {
                    Some(parent) => Meaning::Active(parent, false),
                    None => Meaning::Constant(false),
                });
            }
        }
        self.meanings = meanings;
    }
}

fn missing(name: &str, what: &str) -> String {
    format!("the program has nothing named `{name}` for {what}")
}
