//! Which name in a PLC project stands for what in a machine.
//!
//! The names come from the project that the compiler has made, because it knows them; the program
//! that is examined is another thing, read from a file. So nothing here is assumed to be true of that
//! program: that the variable of this name does hold what the machine says is what is to be proved.

use crate::ir::chart::{Machine, Mark, ScanNumber, StateId};
use crate::ir::plc::{Body, Origin, Project, Role};
use std::collections::BTreeMap;

/// The names that stand for the parts of a machine, each list in the order of the machine's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Correspondence {
    /// The global for each input.
    pub inputs: Vec<String>,
    /// The global for each output.
    pub outputs: Vec<String>,
    /// The global for each variable.
    pub variables: Vec<String>,
    /// The global for each event.
    pub events: Vec<String>,
    /// The global for each event that is TRUE when it is raised for the next scan.
    pub raised: Vec<Option<String>>,
    /// The global for each integer.
    pub integers: Vec<String>,
    /// The global for each state that is TRUE while it is active.
    pub flags: Vec<String>,
    /// For each state, the program that holds its step, and the step; nothing where no step of its own
    /// stands for it.
    pub steps: Vec<Option<(String, String)>>,
    /// For each state, the global that is TRUE if the state was the last one of its region; nothing
    /// where no history asks for it.
    pub last: Vec<Option<String>>,
    /// The global for each output's command.
    pub commands: Vec<Option<String>>,
    /// The global for each constraint that is TRUE when it had to act.
    pub acted: Vec<Option<String>>,
    /// The global for each thing that the filter remembers, in the order of
    /// [`Safety::marks`](crate::ir::chart::Safety::marks).
    pub marks: Vec<Option<String>>,
    /// The global for each number that the filter keeps, in the order of
    /// [`Safety::scan_numbers`](crate::ir::chart::Safety::scan_numbers).
    pub scans: Vec<Option<String>>,
    /// The global for each assumption that is TRUE when the plant breaks it.
    pub broken: Vec<Option<String>>,
    /// For each state and time in milliseconds that a guard waits for, the program that holds its timer,
    /// and the timer.
    pub timers: BTreeMap<(StateId, u32), (String, String)>,
}

impl Correspondence {
    /// The names that `project` gives to the parts of `machine`, from which it was made. Where it has
    /// no name for an input, output, variable or state, their own names stand.
    pub fn of(machine: &Machine, project: &Project) -> Correspondence {
        let mut names: BTreeMap<(Role, Origin), &str> = BTreeMap::new();
        for global in project.globals.values() {
            names.entry((global.role, global.origin)).or_insert(&global.name);
        }
        let find = |role: Role, origin: Origin| names.get(&(role, origin)).map(|name| (*name).to_owned());
        let or_own =
            |role: Role, origin: Origin, own: &str| names.get(&(role, origin)).map_or(own, |name| name).to_owned();
        let mut timers = BTreeMap::new();
        let mut step_of: BTreeMap<&str, (String, String)> = BTreeMap::new();
        for program in &project.programs {
            match &program.body {
                Body::Sfc(sfc) => {
                    for step in sfc.steps.values() {
                        if let Some(flag) = step.flag {
                            let place = (program.name.clone(), step.name.clone());
                            step_of.insert(&project.globals[flag].name, place);
                        }
                    }
                }
                Body::Ladder(ladder) => {
                    for rung in &ladder.rungs {
                        if let (Some(timer), Origin::After(state, ms)) = (&rung.timer, rung.origin) {
                            timers.insert((state, ms), (program.name.clone(), timer.instance.clone()));
                        }
                    }
                }
            }
        }
        let flags: Vec<String> =
            machine.states.ids().map(|id| or_own(Role::StepFlag, Origin::State(id), &machine.state_path(id))).collect();
        let acted = if machine.safety.alarms() { Role::Alarm } else { Role::Acted };
        Correspondence {
            inputs: machine.inputs.iter().map(|(id, i)| or_own(Role::Input, Origin::Input(id), &i.name)).collect(),
            outputs: machine.outputs.iter().map(|(id, o)| or_own(Role::Output, Origin::Output(id), &o.name)).collect(),
            variables: machine
                .variables
                .iter()
                .map(|(id, v)| or_own(Role::Variable, Origin::Variable(id), &v.name))
                .collect(),
            events: machine.events.iter().map(|(id, e)| or_own(Role::Event, Origin::Event(id), &e.name)).collect(),
            raised: machine.events.ids().map(|id| find(Role::Condition, Origin::Event(id))).collect(),
            integers: machine
                .integers
                .iter()
                .map(|(id, i)| or_own(Role::Variable, Origin::Integer(id), &i.name))
                .collect(),
            steps: flags.iter().map(|flag| step_of.get(flag.as_str()).cloned()).collect(),
            flags,
            last: machine.states.ids().map(|id| find(Role::History, Origin::Last(id))).collect(),
            commands: machine.outputs.ids().map(|id| find(Role::Command, Origin::Output(id))).collect(),
            acted: machine.safety.constraints.ids().map(|id| find(acted, Origin::Constraint(id))).collect(),
            marks: machine
                .safety
                .marks()
                .map(|mark| match mark {
                    Mark::Noted => find(Role::Noted, Origin::Filter),
                    Mark::First(c) => find(Role::First, Origin::Constraint(c)),
                })
                .collect(),
            scans: machine
                .safety
                .scan_numbers()
                .map(|number| match number {
                    ScanNumber::This => find(Role::Scan, Origin::Filter),
                    ScanNumber::First => find(Role::FirstScan, Origin::Filter),
                })
                .collect(),
            broken: (0..machine.safety.assumptions.len()).map(|i| find(Role::Alarm, Origin::Assumption(i))).collect(),
            timers,
        }
    }
}
