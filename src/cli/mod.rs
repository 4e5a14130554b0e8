//! Command line to files, messages and an exit code: the only place that prints or touches files.

mod args;
mod build;
mod constraints;
mod counterexample;
mod explain;
mod export;
mod files;
mod junit;
mod needed;
mod prove;
mod replay;
mod report;
mod session;
mod show;
mod simulate;
mod stats;
mod test;
mod time;
mod verify;
mod watch;

use crate::pipeline;
use args::{Cli, Command, Format};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use report::{Counts, FileReport, JsonFile, Report};
use serde::Serialize;
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// 0: done.
    Fine,
    /// 1: the input is wrong, or a file cannot be read or written.
    Wrong,
    /// 2: the command line is wrong.
    Usage,
    /// 3: nothing is known to be wrong, and something that was asked stays open.
    Open,
}

impl Outcome {
    /// The graver of both.
    fn and(self, other: Outcome) -> Outcome {
        match (self, other) {
            (Outcome::Usage, _) | (_, Outcome::Usage) => Outcome::Usage,
            (Outcome::Wrong, _) | (_, Outcome::Wrong) => Outcome::Wrong,
            (Outcome::Open, _) | (_, Outcome::Open) => Outcome::Open,
            (Outcome::Fine, Outcome::Fine) => Outcome::Fine,
        }
    }
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> ExitCode {
        ExitCode::from(match outcome {
            Outcome::Fine => 0,
            Outcome::Wrong => 1,
            Outcome::Usage => 2,
            Outcome::Open => 3,
        })
    }
}

/// The one JSON document of a run.
#[derive(Serialize)]
struct Document<'a, T> {
    command: &'a str,
    files: Vec<JsonFile<'a>>,
    #[serde(flatten)]
    counts: Counts,
    #[serde(flatten)]
    result: T,
}

/// The result of a command that only reports.
#[derive(Serialize)]
struct Nothing {}

/// Runs the command line, the program's name first, and returns the exit code.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let outcome = match Cli::try_parse_from(args) {
        Ok(cli) => match cli.command {
            Command::Check(args) => check(&args),
            Command::Build(args) => build::run(&args),
            Command::Prove(args) => prove::run(&args),
            Command::Verify(args) => verify::run(&args),
            Command::Export(args) => export::run(&args),
            Command::Replay(args) => replay::run(&args),
            Command::Test(args) => test::run(&args),
            Command::Simulate(args) => simulate::run(&args),
            Command::Constraints(args) => constraints::run(&args),
            Command::Show(args) => show::run(&args),
            Command::Stats(args) => stats::run(&args),
            Command::Explain(args) => explain::run(&args),
        },
        Err(message) => {
            // Help that was asked for arrives here too.
            let printed = message.print();
            if message.use_stderr() { Outcome::Usage } else { told(printed) }
        }
    };
    outcome.into()
}

fn check(args: &args::Check) -> Outcome {
    let mut report = Report::default();
    for path in &args.files {
        read(path, &mut report, |source| ((), pipeline::check(source).1));
    }
    finish("check", args.output.format, &report, &Nothing {})
}

/// Reads a file, hands its text to `stage` and files what that has to say.
fn read<T>(path: &Path, report: &mut Report, stage: impl FnOnce(&str) -> (T, crate::base::Diagnostics)) -> Option<T> {
    let file = files::show(path);
    match files::read(path) {
        Ok(source) => {
            let (result, diagnostics) = stage(&source);
            report.files.push(FileReport { file, source, diagnostics });
            Some(result)
        }
        Err(diagnostic) => {
            report.files.push(FileReport::failed(file, diagnostic));
            None
        }
    }
}

/// Says what there is to say of the files; `result` goes into the JSON document.
fn finish(command: &str, format: Format, report: &Report, result: &impl Serialize) -> Outcome {
    let given = match format {
        Format::Human => {
            say(&report.human());
            Outcome::Fine
        }
        Format::Json => {
            let (files, counts) = report.json();
            let document = Document { command, files, counts, result };
            let text = serde_json::to_string_pretty(&document).expect("the document has no maps with odd keys");
            tell(&(text + "\n"))
        }
    };
    given.and(if report.has_errors() { Outcome::Wrong } else { Outcome::Fine })
}

/// Gives a report, or a part of one, on standard output.
fn tell(text: &str) -> Outcome {
    told(files::print(text.as_bytes()))
}

/// How a report ends that has been given like that: a reader that has gone has seen what it wanted, and all
/// else that keeps it from being written is an error.
fn told(printed: std::io::Result<()>) -> Outcome {
    match printed {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            let mut report = Report::default();
            report.files.push(FileReport::failed(files::STANDARD.to_owned(), files::not_printed(&error)));
            say(&report.human());
            Outcome::Wrong
        }
        _ => Outcome::Fine,
    }
}

/// Writes messages to standard error, in colour where that is wanted. Where it cannot be written, there is
/// nobody to tell.
fn say(text: &str) {
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// Says what is wrong with the command line of `command`, in the form of the argument parser.
fn usage(command: &str, message: &str) -> Outcome {
    let mut cli = Cli::command();
    cli.build();
    let command = cli.find_subcommand_mut(command).expect("the command is one of ours");
    let _ = command.error(ErrorKind::ArgumentConflict, message).print();
    Outcome::Usage
}
