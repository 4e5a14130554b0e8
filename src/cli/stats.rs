//! A model to the counts of what it consists of.

use super::args::{Format, Stats as Args};
use super::report::Report;
use super::{Outcome, finish, read, tell};
use crate::pipeline;
use crate::stats::Stats;
use serde::Serialize;

/// The counts, for the JSON document.
#[derive(Serialize)]
struct Result {
    stats: Option<Stats>,
}

/// Runs `chartwright stats`.
pub fn run(args: &Args) -> Outcome {
    let mut report = Report::default();
    let machine = read(&args.file, &mut report, pipeline::check).flatten();
    let stats = match machine {
        Some(machine) if !report.has_errors() => Some(Stats::of(&machine, &pipeline::lower(&machine))),
        _ => None,
    };
    let told = match (&stats, args.output.format) {
        (Some(stats), Format::Human) => tell(&stats.to_string()),
        _ => Outcome::Fine,
    };
    told.and(finish("stats", args.output.format, &report, &Result { stats }))
}
