//! PLC project to a table of its names: what each stands for in the model, and where.
//!
//! The table is CSV as RFC 4180 has it, but with plain line feeds. It has a row for every global, then
//! for each program a row for itself, its instance, its steps and those of its transitions of which the
//! model says something, all in the order of the project, and last a row for each text of the model on
//! something else that the project has no name for:
//!
//! | column | holds |
//! | --- | --- |
//! | `name` | the name in the PLC project, if it has one |
//! | `kind` | `input`, `output`, … for a global; `program`, `instance`, `step`, `transition`; `machine`, `chart`, `observer`, `actuator`, `position`, `property` |
//! | `program` | the program that it belongs to, if it belongs to one |
//! | `model` | what it stands for, in the model's names; empty for what only the compiler needs |
//! | `line`, `column` | where that is declared, counted from 1; empty if nowhere |
//! | `description` | what it means |

use crate::base::{LineIndex, Span};
use crate::ir::chart::Machine;
use crate::ir::plc::{Body, Origin, Project, Role};

/// Writes the table of names of `project`, which was made from `machine`, whose text `lines` was made from.
pub fn table(project: &Project, machine: &Machine, lines: &LineIndex) -> String {
    let mut table = Table { csv: String::from("name,kind,program,model,line,column,description\n"), machine, lines };
    for global in project.globals.values() {
        table.part((&global.name, role(global.role), ""), global.origin, &global.description);
    }
    for program in &project.programs {
        table.part((&program.name, "program", ""), program.origin, &program.description);
        table.part((&program.instance, "instance", &program.name), program.origin, &program.description);
        match &program.body {
            Body::Sfc(sfc) => {
                for step in sfc.steps.values() {
                    table.part((&step.name, "step", &program.name), step.origin, &step.description);
                }
                for t in sfc.transitions.iter().filter(|t| !t.description.is_empty()) {
                    table.part(("", "transition", &program.name), t.origin, &t.description);
                }
            }
            Body::Ladder(ladder) => {
                // A timer may be called by several rungs; it is one thing.
                let mut seen: Vec<&str> = Vec::new();
                for (rung, timer) in ladder.rungs.iter().filter_map(|r| Some((r, r.timer.as_ref()?))) {
                    if !seen.contains(&timer.instance.as_str()) {
                        seen.push(&timer.instance);
                        table.part((&timer.instance, "timer", &program.name), rung.origin, &rung.comment);
                    }
                }
            }
        }
    }
    if !project.description.is_empty() {
        table.row(("", "machine", ""), &format!("machine {}", project.name), None, &project.description);
    }
    for note in &project.notes {
        table.row(("", note.kind, ""), &format!("{} {}", note.kind, note.name), Some(note.span), &note.text);
    }
    table.csv
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Input => "input",
        Role::Output => "output",
        Role::Variable => "variable",
        Role::Event => "event",
        Role::Interim => "interim value",
        Role::StepFlag => "step flag",
        Role::History => "history",
        Role::Condition => "condition",
        Role::Command => "command",
        Role::Filter => "filter",
        Role::Alarm => "alarm",
        Role::Acted => "acted",
        Role::Noted => "noted",
        Role::First => "first",
        Role::Scan => "scan",
        Role::FirstScan => "first scan",
    }
}

struct Table<'a> {
    csv: String,
    machine: &'a Machine,
    lines: &'a LineIndex,
}

impl Table<'_> {
    /// A row for something that stands for a part of the model: its name, kind and program.
    fn part(&mut self, what: (&str, &str, &str), origin: Origin, description: &str) {
        self.row(what, &origin.says(self.machine), origin.span(self.machine), description);
    }

    fn row(&mut self, (name, kind, program): (&str, &str, &str), model: &str, span: Option<Span>, description: &str) {
        let (line, column) = match span {
            Some(span) => {
                let (line, column) = self.lines.position(span.start);
                (line.to_string(), column.to_string())
            }
            None => Default::default(),
        };
        for (i, field) in [name, kind, program, model, &line, &column, description].into_iter().enumerate() {
            if i > 0 {
                self.csv.push(',');
            }
            self.field(field);
        }
        self.csv.push('\n');
    }

    fn field(&mut self, text: &str) {
        if !text.contains([',', '"', '\n', '\r']) {
            self.csv.push_str(text);
            return;
        }
        self.csv.push('"');
        self.csv.push_str(&text.replace('"', "\"\""));
        self.csv.push('"');
    }
}
