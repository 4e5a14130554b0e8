//! A scan to the tree of the states that are active in it.

use super::frame::{Frame, Layout};
use crate::ir::chart::{Machine, RegionId, StateId, StateKind};
use std::fmt::Write;

/// The active states, a line each, those inside a state below it and further to the right.
pub fn show(machine: &Machine, frame: &Frame) -> String {
    let mut text = String::new();
    for chart in &machine.charts {
        let _ = writeln!(text, "{}", chart.name);
        for &region in &chart.regions {
            branch(machine, frame, region, 1, &mut text);
        }
    }
    text
}

/// Depth is bounded by the nesting limit of the source.
fn branch(machine: &Machine, frame: &Frame, region: RegionId, depth: usize, text: &mut String) {
    let layout = Layout::of(machine);
    let region = &machine.regions[region];
    let active = |s: &&StateId| frame[layout.state(**s)];
    let Some(&id) = region.states.iter().find(active) else { return };
    let state = &machine.states[id];
    let name = region.name.as_ref().map(|n| format!("{n}: ")).unwrap_or_default();
    let note = match state.kind {
        StateKind::Final => " (final)",
        StateKind::Movement { .. } => " (moving)",
        StateKind::Elementary | StateKind::Composite => "",
    };
    let _ = writeln!(text, "{:1$}{name}{2}{note}", "", depth * 2, state.name);
    for &inner in &state.regions {
        branch(machine, frame, inner, depth + 1, text);
    }
}
