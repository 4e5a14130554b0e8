//! Which name in a PLC project stands for what in a machine.
//!
//! The names come from the project that the compiler has made, because it knows them; the program
//! that is examined is another thing, read from a file. So nothing here is assumed to be true of that
//! program: that the variable of this name does hold what the machine says is what is to be proved.

use crate::base::Span;
use crate::ir::chart::{Constraint, Machine, Mark, ScanNumber, StateId};
use crate::ir::plc::{Body, Project, Role};
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
        let mut names: BTreeMap<(u8, Span), &str> = BTreeMap::new();
        // One place of the text may declare several things, as a function does.
        let mut by_name: BTreeMap<(u8, Span, &str), &str> = BTreeMap::new();
        for global in project.globals.values() {
            if let Some(span) = global.origin.span {
                names.entry((rank(global.role), span)).or_insert(&global.name);
                if let Some((_, own)) = global.origin.what.split_once(' ') {
                    by_name.entry((rank(global.role), span, own)).or_insert(&global.name);
                }
            }
        }
        let find = |role: Role, span: Span| names.get(&(rank(role), span)).map(|n| n.to_string());
        let or_own = |role: Role, span: Span, own: &str| {
            by_name.get(&(rank(role), span, own)).map_or(own, |name| name).to_owned()
        };
        let constraint = |role: Role, c: &Constraint| {
            by_name.get(&(rank(role), c.span, c.name.as_str())).map(|name| (*name).to_owned())
        };

        let waits = |id: StateId, ms: u32| format!("after({}, {ms}ms)", machine.state_path(id));
        let mut by_span: BTreeMap<Span, Vec<StateId>> = BTreeMap::new();
        machine.states.iter().for_each(|(id, s)| by_span.entry(s.span).or_default().push(id));
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
                        let (Some(timer), Some(span)) = (&rung.timer, rung.origin.span) else { continue };
                        for &state in by_span.get(&span).into_iter().flatten() {
                            if waits(state, timer.preset) == rung.origin.what {
                                let place = (program.name.clone(), timer.instance.clone());
                                timers.insert((state, timer.preset), place);
                            }
                        }
                    }
                }
            }
        }
        let flags: Vec<String> =
            machine.states.iter().map(|(id, s)| or_own(Role::StepFlag, s.span, &machine.state_path(id))).collect();
        let acted = if machine.safety.alarms() { Role::Alarm } else { Role::Acted };
        Correspondence {
            inputs: machine.inputs.values().map(|i| or_own(Role::Input, i.span, &i.name)).collect(),
            outputs: machine.outputs.values().map(|o| or_own(Role::Output, o.span, &o.name)).collect(),
            variables: machine.variables.values().map(|v| or_own(Role::Variable, v.span, &v.name)).collect(),
            events: machine.events.values().map(|e| or_own(Role::Event, e.span, &e.name)).collect(),
            raised: machine
                .events
                .values()
                .map(|e| by_name.get(&(rank(Role::Condition), e.span, e.name.as_str())).map(|n| n.to_string()))
                .collect(),
            integers: machine.integers.values().map(|i| or_own(Role::Variable, i.span, &i.name)).collect(),
            steps: flags.iter().map(|flag| step_of.get(flag.as_str()).cloned()).collect(),
            flags,
            last: machine.states.values().map(|s| find(Role::History, s.span)).collect(),
            commands: machine.outputs.values().map(|o| find(Role::Command, o.span)).collect(),
            acted: machine.safety.constraints.values().map(|c| constraint(acted, c)).collect(),
            marks: machine
                .safety
                .marks()
                .map(|mark| match mark {
                    Mark::Noted => find(Role::Noted, machine.safety.span),
                    Mark::First(c) => constraint(Role::First, &machine.safety.constraints[c]),
                })
                .collect(),
            scans: machine
                .safety
                .scan_numbers()
                .map(|number| match number {
                    ScanNumber::This => find(Role::Scan, machine.safety.span),
                    ScanNumber::First => find(Role::FirstScan, machine.safety.span),
                })
                .collect(),
            broken: machine.safety.assumptions.iter().map(|a| find(Role::Alarm, a.span)).collect(),
            timers,
        }
    }
}

/// Roles have no order of their own.
fn rank(role: Role) -> u8 {
    match role {
        Role::Input => 0,
        Role::Output => 1,
        Role::Variable => 2,
        Role::StepFlag => 3,
        Role::Condition => 4,
        Role::Command => 5,
        Role::Filter => 6,
        Role::Alarm => 7,
        Role::Acted => 8,
        Role::Noted => 9,
        Role::First => 10,
        Role::Event => 11,
        Role::History => 12,
        Role::Interim => 13,
        Role::Scan => 14,
        Role::FirstScan => 15,
    }
}
