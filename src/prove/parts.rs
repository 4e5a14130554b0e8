//! The parts of a machine and what holds each of them in a program.

use super::aig::Lit;
use super::chart_step::{ChartScan, ChartState};
use super::correspondence::Correspondence;
use super::program_step::ProgramStep;
use crate::base::{Id, iec};
use crate::ir::chart::{ConstraintId, InputId, Machine, OutputId, StateId, VariableId};
use crate::ir::iec::{Body, Project, Scope, VarId};
use std::collections::{BTreeMap, BTreeSet};

/// A part of a machine that something in the program stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Whether the state is active, as the flag says that other programs read.
    Flag(StateId),
    /// The same, as the step of the SFC has it.
    Step(StateId),
    /// What the filter lets through.
    Output(OutputId),
    /// The variable's value.
    Variable(VariableId),
    /// Whether an active state drives the output.
    Command(OutputId),
    /// Whether the constraint had to act.
    Acted(ConstraintId),
    /// Whether the plant breaks the assumption of that index.
    Broken(usize),
}

impl Part {
    /// Its value after a scan of the chart.
    pub fn after(self, scan: &ChartScan) -> Lit {
        match self {
            Part::Flag(s) | Part::Step(s) => scan.after.active[s.index()],
            Part::Output(o) => scan.after.outputs[o.index()],
            Part::Variable(v) => scan.after.variables[v.index()],
            Part::Command(o) => scan.commands[o.index()],
            Part::Acted(c) => scan.acted[c.index()],
            Part::Broken(a) => scan.broken[a],
        }
    }

    /// What it is, in the model's names.
    pub fn describe(self, machine: &Machine) -> String {
        match self {
            Part::Flag(s) | Part::Step(s) => format!("state {}", machine.state_path(s)),
            Part::Output(o) => format!("output {}", machine.outputs[o].name),
            Part::Variable(v) => format!("variable {}", machine.variables[v].name),
            Part::Command(o) => format!("command of {}", machine.outputs[o].name),
            Part::Acted(c) => format!("constraint {} acts", machine.safety.constraints[c].name),
            Part::Broken(a) => format!("assumption {} broken", machine.safety.assumptions[a].name),
        }
    }

    /// What the program has to remember of it from scan to scan, if anything.
    pub fn remembered(self) -> Option<Meaning> {
        match self {
            Part::Flag(s) | Part::Step(s) => Some(Meaning::Active(s, true)),
            Part::Output(o) => Some(Meaning::Output(o, true)),
            Part::Variable(v) => Some(Meaning::Variable(v, true)),
            Part::Command(_) | Part::Acted(_) | Part::Broken(_) => None,
        }
    }
}

/// What a latch of the program holds between scans, once the first one is over. The flag says whether
/// it is the value itself; if not, its opposite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Always the same.
    Constant(bool),
    /// Whether the state is active.
    Active(StateId, bool),
    /// The input's value in the last scan.
    Input(InputId, bool),
    /// What the filter let through in the last scan.
    Output(OutputId, bool),
    /// The variable's value.
    Variable(VariableId, bool),
}

impl Meaning {
    /// Its value when the chart remembers `state`.
    pub fn of(self, state: &ChartState) -> Lit {
        match self {
            Meaning::Constant(value) => Lit::of(value),
            Meaning::Active(s, same) => state.active[s.index()].xor(!same),
            Meaning::Input(i, same) => state.inputs[i.index()].xor(!same),
            Meaning::Output(o, same) => state.outputs[o.index()].xor(!same),
            Meaning::Variable(v, same) => state.variables[v.index()].xor(!same),
        }
    }

    /// The opposite.
    #[must_use]
    pub fn opposite(self) -> Meaning {
        match self {
            Meaning::Constant(value) => Meaning::Constant(!value),
            Meaning::Active(s, same) => Meaning::Active(s, !same),
            Meaning::Input(i, same) => Meaning::Input(i, !same),
            Meaning::Output(o, same) => Meaning::Output(o, !same),
            Meaning::Variable(v, same) => Meaning::Variable(v, !same),
        }
    }

    /// Every meaning that is no constant and not the opposite of another.
    pub fn all(machine: &Machine) -> Vec<Meaning> {
        let inputs = machine.inputs.ids().map(|i| Meaning::Input(i, true));
        let outputs = machine.outputs.ids().map(|o| Meaning::Output(o, true));
        let variables = machine.variables.ids().map(|v| Meaning::Variable(v, true));
        let states = machine.states.ids().map(|s| Meaning::Active(s, true));
        inputs.chain(outputs).chain(variables).chain(states).collect()
    }

    /// What it is, in the model's names.
    pub fn describe(self, machine: &Machine) -> String {
        let (same, what) = match self {
            Meaning::Constant(value) => return if value { "TRUE".into() } else { "FALSE".into() },
            Meaning::Active(s, same) => (same, format!("state {}", machine.state_path(s))),
            Meaning::Input(i, same) => (same, format!("prev({})", machine.inputs[i].name)),
            Meaning::Output(o, same) => (same, format!("prev({})", machine.outputs[o].name)),
            Meaning::Variable(v, same) => (same, format!("variable {}", machine.variables[v].name)),
        };
        if same { what } else { format!("not {what}") }
    }
}

/// Which latches of a program stand for which parts of a machine.
#[derive(Clone, Debug)]
pub struct Match {
    /// For each input, its latch.
    pub inputs: Vec<usize>,
    /// All parts that the program has something for, with their latches.
    pub parts: Vec<(Part, usize)>,
    /// For each latch, what it is believed to hold between scans; to be proved.
    pub meanings: Vec<Option<Meaning>>,
}

impl Match {
    /// Looks names up; says which one the program does not have.
    pub fn of(
        machine: &Machine,
        names: &Correspondence,
        project: &Project,
        program: &ProgramStep<'_>,
    ) -> Result<Match, String> {
        let globals: BTreeMap<String, VarId> = project
            .variables
            .iter()
            .filter(|(_, v)| v.scope == Scope::Global)
            .map(|(id, v)| (iec::fold(&v.name), id))
            .collect();
        let global = |name: &str, what: &dyn Fn() -> String| {
            let id = globals.get(&iec::fold(name)).ok_or_else(|| missing(name, &what()))?;
            program.variable(*id).ok_or_else(|| format!("`{name}`, which stands for {}, is not BOOL", what()))
        };
        let mut inputs = Vec::new();
        for (input, name) in machine.inputs.values().zip(&names.inputs) {
            inputs.push(global(name, &|| format!("input {}", input.name))?);
        }
        let mut parts = Vec::new();
        let mut add = |part: Part, name: &str| {
            parts.push((part, global(name, &|| part.describe(machine))?));
            Ok::<(), String>(())
        };
        for (id, name) in machine.states.ids().zip(&names.flags) {
            add(Part::Flag(id), name)?;
        }
        for (id, name) in machine.outputs.ids().zip(&names.outputs) {
            add(Part::Output(id), name)?;
        }
        for (id, name) in machine.variables.ids().zip(&names.variables) {
            add(Part::Variable(id), name)?;
        }
        for (id, name) in machine.outputs.ids().zip(&names.commands) {
            name.iter().try_for_each(|n| add(Part::Command(id), n))?;
        }
        for (id, name) in machine.safety.constraints.ids().zip(&names.acted) {
            name.iter().try_for_each(|n| add(Part::Acted(id), n))?;
        }
        for (index, name) in names.broken.iter().enumerate() {
            name.iter().try_for_each(|n| add(Part::Broken(index), n))?;
        }
        steps(machine, names, project, program, &mut parts)?;
        foreign_inputs(project, program, &inputs)?;
        let mut matched = Match { inputs, parts, meanings: Vec::new() };
        matched.meanings = matched.by_construction(machine, project, program);
        Ok(matched)
    }

    /// What latches hold by the way in which a program is made: parts hold themselves, an input its
    /// value of the last scan, what nothing writes its initial value, and the initial step of a
    /// region's SFC, if it stands for no state, is active exactly while the region's parent is not.
    fn by_construction(
        &self,
        machine: &Machine,
        project: &Project,
        program: &ProgramStep<'_>,
    ) -> Vec<Option<Meaning>> {
        let mut meanings: Vec<Option<Meaning>> = vec![None; program.latches().len()];
        for (i, &latch) in self.inputs.iter().enumerate() {
            meanings[latch] = Some(Meaning::Input(Id::from_index(i), true));
        }
        let mut state_of = BTreeMap::new();
        for &(part, latch) in &self.parts {
            meanings[latch] = meanings[latch].or(part.remembered());
            if let Part::Step(s) = part {
                state_of.insert(latch, s);
            }
        }
        let written = program.written();
        for (latch, value) in program.power_up().into_iter().enumerate() {
            if !written[latch] && meanings[latch].is_none() {
                meanings[latch] = value.constant().map(Meaning::Constant);
            }
        }
        for (p, body) in project.programs.iter().enumerate().map(|(p, program)| (p, &program.body)) {
            let Body::Sfc(sfc) = body else { continue };
            let region = sfc.steps.ids().find_map(|s| state_of.get(&program.step(p, s)));
            let Some(region) = region.map(|&s| machine.states[s].region) else { continue };
            for (id, step) in sfc.steps.iter() {
                let latch = program.step(p, id);
                if step.initial && !state_of.contains_key(&latch) {
                    meanings[latch] = Some(match machine.regions[region].parent {
                        Some(parent) => Meaning::Active(parent, false),
                        None => Meaning::Constant(false),
                    });
                }
            }
        }
        meanings
    }
}

fn steps(
    machine: &Machine,
    names: &Correspondence,
    project: &Project,
    program: &ProgramStep<'_>,
    parts: &mut Vec<(Part, usize)>,
) -> Result<(), String> {
    let mut places = BTreeMap::new();
    for (p, instance) in project.programs.iter().enumerate() {
        if let Body::Sfc(sfc) = &instance.body {
            for (id, step) in sfc.steps.iter() {
                places.insert((iec::fold(&instance.name), iec::fold(&step.name)), program.step(p, id));
            }
        }
    }
    for (id, place) in machine.states.ids().zip(&names.steps) {
        let Some((instance, step)) = place else { continue };
        let latch = places
            .get(&(iec::fold(instance), iec::fold(step)))
            .ok_or_else(|| missing(&format!("{instance}.{step}"), &Part::Step(id).describe(machine)))?;
        parts.push((Part::Step(id), *latch));
    }
    Ok(())
}

/// A program that reads what the machine does not have is no program of this machine.
fn foreign_inputs(project: &Project, program: &ProgramStep<'_>, inputs: &[usize]) -> Result<(), String> {
    let known: BTreeSet<usize> = inputs.iter().copied().collect();
    for (id, variable) in project.variables.iter() {
        let located = variable.address.as_deref().is_some_and(|a| a.to_ascii_uppercase().starts_with("%I"));
        if located && !program.variable(id).is_some_and(|latch| known.contains(&latch)) {
            return Err(format!("the program has an input `{}` that the machine does not have", variable.name));
        }
    }
    Ok(())
}

fn missing(name: &str, what: &str) -> String {
    format!("the program has nothing named `{name}` for {what}")
}
