//! A model to an analysis of its constraints.

use super::args::{Constraints as Args, Form, Format};
use super::report::Report;
use super::{Outcome, files, finish, read};
use crate::constraints::Analysis;
use crate::pipeline;
use serde::Serialize;

/// The analysis, for the JSON document.
#[derive(Serialize)]
struct Result {
    constraints: Option<Analysis>,
}

/// Runs `chartwright constraints`.
pub fn run(args: &Args) -> Outcome {
    let mut report = Report::default();
    let analysis = read(&args.file, &mut report, pipeline::constraints).flatten();
    let (text, format) = match args.format {
        Form::Text => (analysis.as_ref().map(Analysis::to_string), Format::Human),
        Form::Dot => (analysis.as_ref().map(Analysis::dot), Format::Human),
        Form::Json => (None, Format::Json),
    };
    if let Some(text) = text {
        // Where it cannot be printed, nobody reads.
        let _ = files::print(&text);
    }
    finish("constraints", format, &report, &Result { constraints: analysis })
}
