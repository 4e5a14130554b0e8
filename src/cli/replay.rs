//! A run that another tool found to what it shows on the model.

use super::args::{Format, Replay as Args};
use super::counterexample::{self, Between};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::verify::{JsonPlace, places};
use super::{Outcome, finish, tell, usage, verify};
use crate::pipeline::findings::Findings;
use crate::pipeline::replay::{Replayed, replay};
use crate::pipeline::verify::Options;
use crate::simulate::vcd;
use serde::Serialize;

/// The JSON document's part.
#[derive(Serialize)]
struct Result {
    /// What it is about.
    kind: &'static str,
    /// What the run shows, in words.
    says: String,
    /// What it speaks of.
    places: Vec<JsonPlace>,
    /// How many scans it takes.
    scans: usize,
    /// What happens between scans on the way, in order; left out where there is nothing of the kind.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    between: Vec<Between>,
    /// The scan from which on it can repeat itself for ever, if that is what it shows.
    repeats: Option<usize>,
    replayed: Option<bool>,
    scenario: String,
}

/// Runs `chartwright replay`.
pub fn run(args: &Args) -> Outcome {
    let outs: Vec<_> = [&args.vcd, &args.scenario].into_iter().flatten().collect();
    let overwrites = |out: &&std::path::PathBuf| {
        !files::is_standard(out) && (files::same(out, &args.file) || files::same(out, &args.witness))
    };
    if outs.into_iter().any(|out| overwrites(&out)) {
        return usage("replay", "writing the run would overwrite what is read");
    }
    let mut report = Report::default();
    let mut texts = Vec::new();
    for (path, read) in [(&args.file, files::read(&args.file)), (&args.witness, files::read_program(&args.witness))] {
        match read {
            Ok(text) => texts.push(text),
            Err(diagnostic) => report.files.push(FileReport::failed(files::show(path), diagnostic)),
        }
    }
    let mut replayed = None;
    if let Ok([source, witness]) = <[String; 2]>::try_from(texts) {
        let options = Options { program: verify::program(args.program), open: args.open, ..Options::default() };
        let (found, about_source, about_run) = replay(&source, &witness, args.property.as_deref(), &options);
        report.files.push(FileReport { file: files::show(&args.file), source, diagnostics: about_source });
        report.files.push(FileReport { file: files::show(&args.witness), source: witness, diagnostics: about_run });
        replayed = found;
    }
    if let Some(Replayed { machine, run, .. }) = &replayed {
        let vcd = args.vcd.as_ref().map(|path| (path, vcd::write(machine, &counterexample::recording(run))));
        let scenario = args.scenario.as_ref().map(|path| (path, run.scenario.clone()));
        for (path, text) in [vcd, scenario].into_iter().flatten() {
            if let Err(diagnostic) = Pending::prepare(path, text).and_then(Pending::commit) {
                report.files.push(FileReport::failed(files::show(path), diagnostic));
            }
        }
    }
    let source = report.files.first().map_or("", |file| &file.source);
    let result = replayed.as_ref().map(|Replayed { machine, question, run }| Result {
        kind: question.word(),
        says: Findings::new(machine, source).shown(*question, run),
        places: places(source, Findings::new(machine, source).places(*question)),
        scans: run.frames.len(),
        between: counterexample::between(run),
        repeats: run.repeats,
        replayed: run.replayed,
        scenario: run.scenario.clone(),
    });
    let outcome = finish("replay", args.output.format, &report, &result);
    if args.output.format == Format::Human
        && let Some(Replayed { machine, question, run }) = &replayed
    {
        let shows = Findings::new(machine, source).shown(*question, run);
        return outcome.and(tell(&counterexample::human(machine, &shows, run)));
    }
    outcome
}
