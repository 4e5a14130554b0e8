//! A run that shows something, as people read it.

use crate::ir::chart::Machine;
use crate::pipeline::verify::{Question, Run, words};
use crate::simulate::record::Recording;
use crate::simulate::tree;
use std::fmt::Write;

/// The scans of a run.
pub fn recording(run: &Run) -> Recording {
    let mut recording = Recording::all();
    run.frames.iter().zip(1..).for_each(|(frame, scan)| recording.push(scan, frame));
    recording
}

/// What the run shows: scan by scan what changes, then the active states and the rungs of the last scan.
pub fn human(machine: &Machine, question: Question, run: &Run) -> String {
    let mut text = words(machine, question);
    let Some(last) = run.frames.last() else { return text + "\nfrom the beginning\n" };
    let scans = run.frames.len();
    let _ = write!(text, "\n{}", recording(run).table(machine, usize::MAX));
    if let Some(begin) = run.repeats {
        let _ = match scans - begin {
            0 => writeln!(text, "Scan {scans} can repeat itself for ever."),
            _ => writeln!(text, "Scans {begin} to {scans} can repeat themselves for ever."),
        };
    }
    if run.replayed == Some(false) {
        text +=
            "The simulator does not repeat this run: it needs a time to pass sooner or later than at a fixed cycle.\n";
    }
    if run.replayed.is_some() {
        let _ = write!(text, "\nActive in scan {scans}:\n{}", tree::show(machine, last));
    }
    if let Some(rungs) = &run.rungs {
        let _ = write!(text, "\nWhat drove the outputs in scan {scans}:\n{rungs}");
    }
    text
}
