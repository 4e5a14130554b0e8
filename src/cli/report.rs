//! Diagnostics to what a person or a program reads.

use crate::base::{Code, Diagnostic, Diagnostics, LineIndex, Severity, Span, count, limits};
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str};
use serde::Serialize;
use std::ops::Range;

/// Longest line that is shown, in bytes: the renderer measures every character of a line, for each
/// diagnostic anew, before it cuts out the part concerned.
const SHOWN_LINE: usize = 10_000;

/// What a run has to say about one file.
#[derive(Debug)]
pub struct FileReport {
    /// The file as the user named it.
    pub file: String,
    /// Its text; empty where there is none.
    pub source: String,
    /// What there is to say, in order.
    pub diagnostics: Diagnostics,
}

impl FileReport {
    /// Reports one failure of a file without text.
    pub fn failed(file: String, diagnostic: Diagnostic) -> FileReport {
        let mut diagnostics = Diagnostics::new();
        diagnostics.push(diagnostic);
        FileReport { file, source: String::new(), diagnostics }
    }
}

/// What a run has to say.
#[derive(Debug, Default)]
pub struct Report {
    /// File by file.
    pub files: Vec<FileReport>,
}

/// How many diagnostics there are, and how many of them are not shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Errors, shown or not.
    pub errors: usize,
    /// Warnings, shown or not.
    pub warnings: usize,
    /// Errors and warnings beyond the stated limit.
    pub omitted: usize,
}

/// A file in the JSON document.
#[derive(Debug, Serialize)]
pub struct JsonFile<'a> {
    file: &'a str,
    diagnostics: Vec<JsonDiagnostic<'a>>,
}

#[derive(Debug, Serialize)]
struct JsonDiagnostic<'a> {
    code: Code,
    severity: Severity,
    title: &'static str,
    message: &'a str,
    labels: Vec<JsonLabel<'a>>,
    help: &'a [String],
}

/// A place: lines and columns from 1, columns in characters; `start` and `end` in bytes from 0; ends
/// exclusive.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct JsonLabel<'a> {
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
    start: usize,
    end: usize,
    text: &'a str,
}

impl Report {
    /// Whether there is an error.
    pub fn has_errors(&self) -> bool {
        self.files.iter().any(|f| f.diagnostics.has_errors())
    }

    /// The files with those diagnostics that are shown, at most the stated limit of errors and of
    /// warnings, and the counts.
    fn shown(&self) -> (Vec<(&FileReport, Vec<&Diagnostic>)>, Counts) {
        let mut counts = Counts::default();
        let mut files = Vec::new();
        for file in &self.files {
            let mut shown = Vec::new();
            for d in &file.diagnostics {
                let count = match d.severity() {
                    Severity::Error => &mut counts.errors,
                    Severity::Warning => &mut counts.warnings,
                };
                *count += 1;
                if *count <= limits::REPORTED_ERRORS {
                    shown.push(d);
                } else {
                    counts.omitted += 1;
                }
            }
            files.push((file, shown));
        }
        (files, counts)
    }

    /// The report for people, with terminal colours, and a last line that counts.
    pub fn human(&self) -> String {
        let (files, counts) = self.shown();
        let renderer = Renderer::styled();
        let mut text = String::new();
        let mut explained = None;
        for (file, diagnostics) in files {
            for d in diagnostics {
                text += &renderer.render(&[group(file, d)]);
                text += "\n\n";
                if explained.is_none_or(|code: Code| code.severity() > d.severity()) {
                    explained = Some(d.code);
                }
            }
        }
        text += &format!("{}, {}", count(counts.errors, "error"), count(counts.warnings, "warning"));
        if counts.omitted > 0 {
            text += &format!(" ({} of them not shown)", counts.omitted);
        }
        if let Some(code) = explained {
            text += &format!("; `chartwright explain {code}` says more");
        }
        text.push('\n');
        text
    }

    /// The report for programs.
    pub fn json(&self) -> (Vec<JsonFile<'_>>, Counts) {
        let (files, counts) = self.shown();
        let files = files
            .into_iter()
            .map(|(report, diagnostics)| {
                let lines = LineIndex::new(&report.source);
                let diagnostics = diagnostics.into_iter().map(|d| json(&report.source, &lines, d)).collect();
                JsonFile { file: &report.file, diagnostics }
            })
            .collect();
        (files, counts)
    }
}

fn json<'a>(source: &str, lines: &LineIndex, d: &'a Diagnostic) -> JsonDiagnostic<'a> {
    let labels = d.labels.iter().map(|label| {
        let Range { start, end } = within(source, label.span);
        let (line, column) = lines.character(source, start);
        let (end_line, end_column) = lines.character(source, end);
        JsonLabel { line, column, end_line, end_column, start, end, text: &label.text }
    });
    JsonDiagnostic {
        code: d.code,
        severity: d.severity(),
        title: d.code.title(),
        message: &d.message,
        labels: labels.collect(),
        help: &d.help,
    }
}

/// The span as a range of whole characters of the text.
fn within(source: &str, span: Span) -> Range<usize> {
    let mut start = span.range().start.min(source.len());
    let mut end = span.range().end.clamp(start, source.len());
    while !source.is_char_boundary(start) {
        start -= 1;
    }
    while !source.is_char_boundary(end) {
        end += 1;
    }
    start..end
}

/// The diagnostic with the lines it speaks of. Only these are handed to the renderer, because it
/// reads all it is given, for each diagnostic anew.
fn group<'a>(file: &'a FileReport, d: &'a Diagnostic) -> Group<'a> {
    let level = match d.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let mut group = Group::with_title(level.primary_title(&d.message).id(d.code.number()));
    let source = &file.source;
    let places: Vec<_> = d.labels.iter().map(|label| within(source, label.span)).collect();
    let first = places.iter().map(|p| p.start).min();
    let last = places.iter().map(|p| p.end).max();
    if let (Some(first), Some(last)) = (first, last) {
        let from = source[..first].rfind('\n').map_or(0, |i| i + 1);
        let to = source[last..].find('\n').map_or(source.len(), |i| last + i);
        if source[from..to].split('\n').any(|line| line.len() > SHOWN_LINE) {
            group = without_lines(group, file, d, &places);
        } else {
            let line = 1 + source[..from].matches('\n').count();
            let annotations = places.iter().zip(&d.labels).enumerate().map(|(i, (place, label))| {
                let kind = if i == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
                let annotation = kind.span(place.start - from..place.end - from);
                if label.text.is_empty() { annotation } else { annotation.label(&label.text) }
            });
            let snippet = Snippet::source(&source[from..to]).line_start(line).path(&file.file);
            group = group.element(snippet.annotations(annotations));
        }
    } else {
        group = group.element(Origin::path(&file.file));
    }
    for help in &d.help {
        group = group.element(Level::HELP.message(normalize_untrusted_str(help)));
    }
    group
}

/// Adds the places of the labels in numbers, for text with lines that nobody reads.
fn without_lines<'a>(
    mut group: Group<'a>,
    file: &'a FileReport,
    d: &'a Diagnostic,
    places: &[Range<usize>],
) -> Group<'a> {
    let lines = LineIndex::new(&file.source);
    for (i, (place, label)) in places.iter().zip(&d.labels).enumerate() {
        let (line, column) = lines.character(&file.source, place.start);
        if i == 0 {
            group = group.element(Origin::path(&file.file).line(line).char_column(column));
        }
        if !label.text.is_empty() {
            let text = normalize_untrusted_str(&label.text);
            group = group.element(Level::NOTE.message(format!("{line}:{column}: {text}")));
        }
    }
    group
}
