//! A model and a program to a verdict.

use super::args::{Format, Prove as Args};
use super::report::{FileReport, Report};
use super::watch::Watch;
use super::{Outcome, files, finish, tell};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::pipeline::{self, Judgement};
use serde::Serialize;

/// The verdict, for the JSON document.
#[derive(Serialize)]
struct Result {
    verdict: &'static str,
    /// The run that refutes the program, as a table.
    trace: Option<String>,
}

/// What is found before the time is up, reading included.
fn within(args: &Args, source: &str, program: &str) -> (Judgement, Diagnostics, Diagnostics) {
    let watch = Watch::new("prove", Some(args.time), args.output.format == Format::Human);
    watch.say("one scan of the program is one scan of the chart");
    let (model, text) = (source.to_owned(), program.to_owned());
    watch.beside(move || pipeline::prove(&model, &text)).unwrap_or_else(|| {
        let message = format!("the program has neither been proved nor refuted within {} s", args.time);
        let mut open = Diagnostics::new();
        open.push(Diagnostic::new(Code::Undecided, message).help("`--time` gives it longer"));
        (Judgement::Undecided, Diagnostics::new(), open)
    })
}

/// Runs `chartwright prove`.
pub fn run(args: &Args) -> Outcome {
    let mut report = Report::default();
    let mut texts = Vec::new();
    for (path, read) in [(&args.file, files::read(&args.file)), (&args.program, files::read_program(&args.program))] {
        match read {
            Ok(text) => texts.push(text),
            Err(diagnostic) => report.files.push(FileReport::failed(files::show(path), diagnostic)),
        }
    }
    let mut result = Result { verdict: "undecided", trace: None };
    if let Ok([source, program]) = <[String; 2]>::try_from(texts) {
        let (judgement, about_source, about_program) = within(args, &source, &program);
        let file = files::show(&args.file);
        report.files.push(FileReport { file, source, diagnostics: about_source });
        let file = files::show(&args.program);
        report.files.push(FileReport { file, source: program, diagnostics: about_program });
        match judgement {
            Judgement::Proved(_) => result.verdict = "proved",
            Judgement::Refuted(trace) => result = Result { verdict: "refuted", trace: Some(trace) },
            Judgement::Undecided => {}
        }
    }
    let outcome = finish("prove", args.output.format, &report, &result);
    if args.output.format == Format::Json {
        return outcome;
    }
    let verdict = match result.verdict {
        "proved" => "proved: one scan of the program is one scan of the chart\n",
        "refuted" => "refuted: the program does something else than the chart, as the table shows\n",
        _ => "undecided: neither proved nor refuted\n",
    };
    let trace = result.trace.as_ref().map_or_else(String::new, |trace| format!("\n{trace}"));
    outcome.and(tell(&format!("{trace}{verdict}")))
}
