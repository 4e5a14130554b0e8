//! Texts of the model on what the program has no name for: charts of several regions, actuators, their
//! positions, forbidden positions that are left to other constraints, properties.

use crate::base::Span;
use crate::ir::chart::{ChartKind, Machine};
use crate::ir::plc::Note;

pub fn of(machine: &Machine) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut note = |kind: &'static str, name: &str, text: &str, span: Span| {
        if !text.is_empty() {
            notes.push(Note { kind, name: name.to_owned(), text: text.to_owned(), span });
        }
    };
    // The only region of a chart is a program of its own, which has the text.
    for chart in machine.charts.iter().filter(|c| c.regions.len() > 1) {
        let kind = if chart.kind == ChartKind::Observer { "observer" } else { "chart" };
        note(kind, &chart.name, &chart.description, chart.span);
    }
    for actuator in machine.actuators.values() {
        note("actuator", &actuator.name, &actuator.description, actuator.span);
        for position in &actuator.positions {
            let name = format!("{} of {}", position.name, actuator.name);
            note("position", &name, &position.description, position.span);
        }
    }
    for forbidden in &machine.safety.unkept {
        note("forbid", &forbidden.name, &forbidden.text, forbidden.span);
    }
    for property in &machine.properties {
        note("property", &property.name, &property.text, property.span);
    }
    notes
}
