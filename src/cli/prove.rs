//! A model and a program to a verdict.

use super::args::{Format, Prove as Args};
use super::report::{FileReport, Report};
use super::{Outcome, files, finish, tell};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::pipeline::{self, Judgement};
use serde::Serialize;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// The verdict, for the JSON document.
#[derive(Serialize)]
struct Result {
    verdict: &'static str,
    /// The run that refutes the program, as a table.
    trace: Option<String>,
}

/// The stack of the thread that proves.
const STACK: usize = 256 << 20;

/// What is found within so many seconds. All of it is bounded, reading included, so it runs beside the clock; the end of the
/// process ends it.
fn within(seconds: u64, source: &str, program: &str) -> (Judgement, Diagnostics, Diagnostics) {
    let (say, hear) = mpsc::channel();
    let (model, text) = (source.to_owned(), program.to_owned());
    let worker = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Where nobody listens any more, nobody wants to know.
        let _ = say.send(pipeline::prove(&model, &text));
    });
    match worker.map(|worker| (worker, hear.recv_timeout(Duration::from_secs(seconds)))) {
        Ok((_, Ok(found))) => found,
        Ok((_, Err(mpsc::RecvTimeoutError::Timeout))) => {
            let message = format!("the program has neither been proved nor refuted within {seconds} s");
            let mut open = Diagnostics::new();
            open.push(Diagnostic::new(Code::Undecided, message).help("`--time` gives it longer"));
            (Judgement::Undecided, Diagnostics::new(), open)
        }
        Ok((worker, Err(mpsc::RecvTimeoutError::Disconnected))) => match worker.join() {
            Ok(()) => unreachable!("a worker that ends well says what it has found"),
            Err(panic) => std::panic::resume_unwind(panic),
        },
        // Without a thread there is no clock, and an answer all the same.
        Err(_) => pipeline::prove(source, program),
    }
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
        let (judgement, about_source, about_program) = within(args.time, &source, &program);
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
