//! Models to the verdicts of their scenarios.

use super::args::{Format, Test as Args};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::{Outcome, finish, junit, read, say, tell, usage};
use crate::base::{LineIndex, figure};
use crate::ir::chart::Machine;
use crate::parse;
use crate::pipeline;
use crate::simulate::record::{Recording, seconds};
use crate::simulate::run::milliseconds;
use crate::simulate::scenario::{self, Expectation, Failure};
use annotate_snippets::normalize_untrusted_str;
use serde::Serialize;
use std::fmt::Write;

/// How many scans before a failure are remembered; of those, how many with changes are shown.
const REMEMBERED: usize = 2_000;
const SHOWN: usize = 8;

/// The JSON document's part.
#[derive(Serialize)]
struct Result<'a> {
    tests: &'a [Test],
    passed: usize,
    failed: usize,
}

/// One scenario, played by one program.
#[derive(Debug, Serialize)]
pub struct Test {
    /// The model, as the user named it.
    pub file: String,
    /// The scenario's name.
    pub scenario: String,
    /// What ran it.
    pub program: &'static str,
    /// How many scans ran.
    pub scans: u64,
    /// How much time of the machine that is.
    pub milliseconds: u64,
    /// What went wrong.
    pub failure: Option<Failed>,
}

/// What went wrong in a scenario.
#[derive(Debug, Serialize)]
pub struct Failed {
    /// The line that expected something else, from 1.
    pub line: usize,
    /// The same, and the column, from 1.
    pub column: usize,
    /// What the line says.
    pub step: String,
    /// The text behind it.
    pub text: String,
    /// What was the case instead.
    pub message: String,
    /// The scan, from 1.
    pub scan: u64,
    /// When it began.
    pub milliseconds: u64,
    /// What the line reads, and the values after that scan.
    pub values: Vec<(String, bool)>,
    /// What changed before.
    pub changes: String,
}

impl Failed {
    /// All of it for people, without the place.
    pub fn human(&self) -> String {
        let mut text = format!("{}\n", self.step);
        if !self.text.is_empty() {
            let _ = writeln!(text, "\"{}\"", self.text);
        }
        let _ = writeln!(text, "{}", self.message);
        let values = self.values.iter().map(|(n, v)| format!("{n} = {}", if *v { "TRUE" } else { "FALSE" }));
        let _ = writeln!(text, "{}\n", values.collect::<Vec<_>>().join(", "));
        text + &self.changes
    }
}

/// Runs `chartwright test`.
pub fn run(args: &Args) -> Outcome {
    if let Some(junit) = &args.junit {
        if args.files.iter().any(|f| !files::is_standard(junit) && files::same(f, junit)) {
            return usage("test", "writing the report would overwrite a model");
        }
        if files::is_standard(junit) && args.output.format == Format::Json {
            return usage("test", "standard output cannot take both reports");
        }
    }
    let human = args.output.format == Format::Human && !args.junit.as_deref().is_some_and(files::is_standard);
    let mut report = Report::default();
    let mut tests = Vec::new();
    let mut told = Outcome::Fine;
    for path in &args.files {
        let machine = read(path, &mut report, pipeline::check).flatten();
        let (Some(machine), Some(file)) = (machine, report.files.last()) else { continue };
        let before = tests.len();
        play(&machine, file, args.filter.as_deref(), &mut tests);
        let lines: String = tests[before..].iter().map(line).collect();
        if human && !lines.is_empty() {
            told = told.and(tell(&format!("{}\n{lines}", file.file)));
        }
    }
    let failed = tests.iter().filter(|t| t.failure.is_some()).count();
    let passed = tests.len() - failed;
    if let Some(path) = &args.junit {
        let written = Pending::prepare(path, junit::xml(&tests)).and_then(Pending::commit);
        if let Err(diagnostic) = written {
            report.files.push(FileReport::failed(files::show(path), diagnostic));
        }
    }
    if human && !tests.is_empty() {
        told = told.and(tell(&summary(&tests, passed, failed)));
    }
    let outcome = match args.output.format {
        // What the models are warned of is for `check`.
        Format::Human if report.has_errors() => {
            say(&report.human());
            Outcome::Wrong
        }
        Format::Human => Outcome::Fine,
        Format::Json => finish("test", Format::Json, &report, &Result { tests: &tests, passed, failed }),
    };
    // A filter that fits nothing any more is not a machine that has been tested.
    let nothing = tests.is_empty() && !report.has_errors();
    if nothing {
        let word = if args.allow_empty { "note" } else { "error" };
        say(&format!("{word}: no scenario was played: {}\n", why_nothing(args)));
    }
    let wrong = failed > 0 || nothing && !args.allow_empty;
    told.and(outcome).and(if wrong { Outcome::Wrong } else { Outcome::Fine })
}

/// Why there was nothing to play.
fn why_nothing(args: &Args) -> String {
    let files = if args.files.len() == 1 { "the model has" } else { "the models have" };
    match &args.filter {
        Some(filter) => format!("{files} none whose name holds `{}`", normalize_untrusted_str(filter)),
        None => format!("{files} none"),
    }
}

/// Plays the scenarios of one model, each by every program.
fn play(machine: &Machine, file: &FileReport, filter: Option<&str>, tests: &mut Vec<Test>) {
    let programs = pipeline::programs(machine);
    for (i, scenario) in machine.scenarios.iter().enumerate() {
        if filter.is_some_and(|f| !scenario.name.contains(f)) {
            continue;
        }
        for (name, program) in &programs {
            let mut recording = Recording::last(REMEMBERED);
            let verdict = scenario::watch(machine, program.clone(), i, &mut |moment| recording.take(moment));
            tests.push(Test {
                file: file.file.clone(),
                scenario: scenario.name.clone(),
                program: name,
                scans: verdict.scans,
                milliseconds: verdict.scans * u64::from(machine.cycle),
                failure: verdict.failure.map(|f| failed(machine, &file.source, &f, &recording)),
            });
        }
    }
}

fn failed(machine: &Machine, source: &str, failure: &Failure, recording: &Recording) -> Failed {
    let (line, column) = LineIndex::new(source).position(failure.span.range().start as u32);
    let when = milliseconds(machine, failure.scan);
    let scan = format!("scan {}, {}", failure.scan, seconds(when));
    // In what happens between two scans, after the one and before the other.
    let (at, at_end) = match (failure.between, failure.scan) {
        (true, 0) => ("before the first scan".to_owned(), "before the first scan".to_owned()),
        (true, _) => (format!("after {scan}"), format!("between scans, after {scan}")),
        (false, _) => (format!("in {scan}"), format!("after {scan}")),
    };
    let message = match failure.kind {
        Expectation::Now => format!("the condition is FALSE {at_end}"),
        Expectation::Within(n) => {
            format!(
                "the condition has not become TRUE within {}, up to {scan}",
                seconds(u64::from(n) * u64::from(machine.cycle))
            )
        }
        Expectation::Always => format!("the condition is FALSE {at}"),
        Expectation::Never => format!("the condition is TRUE {at}"),
        Expectation::Happens => format!("this step of the plant cannot happen {at}"),
        Expectation::BeforeWriting => {
            format!("this step of the plant comes too late {at}: no outputs wait to be written")
        }
    };
    Failed {
        line,
        column,
        step: parse::on_one_line(&source[failure.span.range()]),
        text: failure.text.clone(),
        message,
        scan: failure.scan,
        milliseconds: when,
        values: failure.values.clone(),
        changes: recording.table(machine, SHOWN),
    }
}

fn line(test: &Test) -> String {
    let word = if test.failure.is_some() { "FAILED" } else { "ok    " };
    let (name, program) = (normalize_untrusted_str(&test.scenario), test.program);
    let time = seconds(test.milliseconds);
    format!("  {word}  {name} ({program}, {}, {time})\n", figure(test.scans, "scan"))
}

fn summary(tests: &[Test], passed: usize, failed: usize) -> String {
    let mut text = String::new();
    for test in tests {
        let Some(failure) = &test.failure else { continue };
        let (file, line, column) = (&test.file, failure.line, failure.column);
        let name = normalize_untrusted_str(&test.scenario);
        let _ = writeln!(text, "\n{file}:{line}:{column}: {name} ({})", test.program);
        for line in failure.human().lines() {
            let _ = writeln!(text, "{}", format!("  {}", normalize_untrusted_str(line)).trim_end());
        }
    }
    let _ = writeln!(text, "\n{passed} passed, {failed} failed");
    text
}
