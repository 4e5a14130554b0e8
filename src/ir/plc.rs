//! The PLC project: global variables, programs in SFC and ladder, one task.
//!
//! It is what IEC 61131-3 calls a configuration with one resource. Nothing in it knows of XML or of
//! any dialect; [`crate::emit`] writes it and [`crate::layout`] draws its bodies.
//!
//! # What it means
//!
//! Once per cycle the task runs its programs in the order of [`Project::programs`]. A value written
//! by one program is seen by those after it in the same cycle and by those before it in the next.
//! Each program is an [SFC](super::sfc) or a [ladder](super::ladder).

use super::ladder::Ladder;
pub use super::origin::Origin;
use super::sfc::Sfc;
use crate::base::{Arena, Id, Span};

/// Names a global variable.
pub type GlobalId = Id<Global>;

/// A whole project.
#[derive(Clone, Debug)]
pub struct Project {
    /// The machine's name.
    pub name: String,
    /// What it is.
    pub description: String,
    /// All variables that programs share. Those with an address come first.
    pub globals: Arena<Global>,
    /// The programs, in the order in which the task runs them.
    pub programs: Vec<Program>,
    /// The one task.
    pub task: Task,
    /// What the model says of that for which no name of the project stands.
    pub notes: Vec<Note>,
}

/// A text of the model on something that has no name of its own in the project, such as an actuator.
#[derive(Clone, Debug)]
pub struct Note {
    /// What kind of thing it is, in one word.
    pub kind: &'static str,
    /// Its name in the model.
    pub name: String,
    /// What the model says of it.
    pub text: String,
    /// Where it is declared.
    pub span: Span,
}

/// A global variable.
#[derive(Clone, Debug)]
pub struct Global {
    /// A legal IEC identifier, unique in the project whatever the letters' case.
    pub name: String,
    /// Its address, such as `%IX0.0`.
    pub address: Option<String>,
    /// Its value before the first cycle, which also says its type.
    pub initial: Value,
    /// What it is for.
    pub role: Role,
    /// What it means, for the reader of the PLC project.
    pub description: String,
    /// What it stands for in the model.
    pub origin: Origin,
}

/// A value of one of the types that are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// BOOL.
    Bool(bool),
    /// INT.
    Int(i16),
    /// UDINT.
    Udint(u32),
}

/// What a global variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Comes from the machine.
    Input,
    /// Goes to the machine; written by the filter only.
    Output,
    /// A variable of the model.
    Variable,
    /// An event of the model, as it is in this scan.
    Event,
    /// A value on the way to a variable.
    Interim,
    /// TRUE while a step is active; written by its N action only.
    StepFlag,
    /// Whether a state was the last one of its region; written when the chart has taken its step.
    History,
    /// A value latched at the start of the scan, or computed from such values.
    Condition,
    /// What the chart wants of an output.
    Command,
    /// Belongs to the safety filter.
    Filter,
    /// TRUE when the plant breaks an assumption or a constraint had to act.
    Alarm,
    /// TRUE when a constraint had to act, where that is normal.
    Acted,
    /// TRUE from when a constraint acts until the reset.
    Noted,
    /// TRUE while that is so, if this constraint acted in the scan in which it began.
    First,
    /// The number of this scan.
    Scan,
    /// While a constraint is noted, the number of the scan in which that began.
    FirstScan,
}

/// One program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Its type's name: a legal IEC identifier, unique in the project.
    pub name: String,
    /// The name of its only instance: likewise.
    pub instance: String,
    /// What it does.
    pub description: String,
    /// What it does, in detail.
    pub body: Body,
    /// What it stands for in the model.
    pub origin: Origin,
}

/// The body of a program.
#[derive(Clone, Debug)]
pub enum Body {
    /// A sequential function chart.
    Sfc(Sfc),
    /// A ladder diagram.
    Ladder(Ladder),
}

/// The task that runs all programs.
#[derive(Clone, Debug)]
pub struct Task {
    /// A legal IEC identifier, unique in the project.
    pub name: String,
    /// The configuration's name: likewise.
    pub configuration: String,
    /// The resource's name: likewise.
    pub resource: String,
    /// The cycle time in milliseconds.
    pub interval: u32,
}

impl Value {
    /// The name of its type.
    pub fn type_name(self) -> &'static str {
        match self {
            Value::Bool(_) => "BOOL",
            Value::Int(_) => "INT",
            Value::Udint(_) => "UDINT",
        }
    }

    /// As IEC 61131-3 writes it; nothing for the value that a variable has without being given one.
    pub fn literal(self) -> Option<String> {
        match self {
            Value::Bool(value) => value.then(|| "TRUE".to_owned()),
            Value::Int(value) => (value != 0).then(|| value.to_string()),
            Value::Udint(value) => (value != 0).then(|| value.to_string()),
        }
    }
}

impl Program {
    /// The names of the timers of the body, in order of first use, each once.
    pub fn timers(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        if let Body::Ladder(ladder) = &self.body {
            for timer in ladder.rungs.iter().filter_map(|r| r.timer.as_ref()) {
                if !names.contains(&timer.instance.as_str()) {
                    names.push(&timer.instance);
                }
            }
        }
        names
    }

    /// The globals that the body mentions, in order of declaration, each once.
    pub fn globals(&self) -> Vec<GlobalId> {
        let mut used = Vec::new();
        match &self.body {
            Body::Sfc(sfc) => sfc.for_each_global(&mut |g| used.push(g)),
            Body::Ladder(ladder) => ladder.for_each_global(&mut |g| used.push(g)),
        }
        used.sort_unstable();
        used.dedup();
        used
    }
}
