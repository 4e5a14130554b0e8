//! A run that shows something, as people read it.

use crate::ir::chart::Machine;
use crate::pipeline::verify::Run;
use crate::simulate::record::Recording;
use crate::simulate::scenario::Moment;
use crate::simulate::tree;
use serde::Serialize;
use std::fmt::Write;

/// Something that happens between scans, for JSON.
#[derive(Serialize)]
pub struct Between {
    /// After that many scans.
    after: usize,
    happens: String,
}

/// All that happens between scans in a run.
pub fn between(run: &Run) -> Vec<Between> {
    run.between.iter().map(|b| Between { after: b.scans, happens: b.text.clone() }).collect()
}

/// The scans of a run, and what happens between them.
pub fn recording(run: &Run) -> Recording {
    let mut recording = Recording::all();
    let mut between = run.between.iter().peekable();
    for scan in 0..=run.frames.len() {
        if let Some(frame) = scan.checked_sub(1).and_then(|i| run.frames.get(i)) {
            recording.push(scan as u64, frame);
        }
        while let Some(moment) = between.next_if(|m| m.scans == scan) {
            let (scan, happens) = (scan as u64, Some(&*moment.text));
            recording.take(Moment { scan, happens, frame: &moment.frame });
        }
    }
    recording
}

/// What the run shows, in words and scan by scan: what changes, then the active states and the rungs of the last scan.
pub fn human(machine: &Machine, shows: &str, run: &Run) -> String {
    let mut text = shows.to_owned();
    if run.frames.is_empty() && run.between.is_empty() {
        return text + "\nfrom the beginning\n";
    }
    let scans = run.frames.len();
    let _ = write!(text, "\n{}", recording(run).outline(machine));
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
    let Some(last) = run.frames.last() else { return text };
    if run.replayed.is_some() {
        let _ = write!(text, "\nActive in scan {scans}:\n{}", tree::show(machine, last));
    }
    if let Some(rungs) = &run.rungs {
        let _ = write!(text, "\nWhat drove the outputs in scan {scans}:\n{rungs}");
    }
    text
}
