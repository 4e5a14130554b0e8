//! A model to an analysis of its constraints, or to those that can be derived.

use super::args::{Constraints as Args, Form, Format};
use super::report::Report;
use super::watch::Watch;
use super::{Outcome, finish, read, tell, usage};
use crate::constraints::Analysis;
use crate::derive::Derived;
use crate::ir::source;
use crate::pipeline;
use serde::Serialize;

/// The analysis, for the JSON document.
#[derive(Serialize)]
struct Result {
    constraints: Option<Analysis>,
}

/// What can be derived, for the JSON document.
#[derive(Serialize)]
struct Derivable {
    derived: Vec<Item>,
}

/// One derived constraint.
#[derive(Serialize)]
struct Item {
    name: String,
    /// What it is derived from.
    from: Vec<String>,
    /// As a model writes it.
    source: String,
}

/// Runs `chartwright constraints`.
pub fn run(args: &Args) -> Outcome {
    if args.derive {
        return derive(args);
    }
    let mut report = Report::default();
    let watch = Watch::new("constraints", None, args.format == Form::Text);
    watch.say("what the constraints allow");
    let analyse = |source: &str| {
        let source = source.to_owned();
        watch.beside(move || pipeline::constraints(&source)).expect("there is no limit")
    };
    let analysis = read(&args.file, &mut report, analyse).flatten();
    drop(watch);
    let (text, format) = match args.format {
        Form::Text => (analysis.as_ref().map(Analysis::to_string), Format::Human),
        Form::Dot => (analysis.as_ref().map(Analysis::dot), Format::Human),
        Form::Json => (None, Format::Json),
    };
    let told = text.map_or(Outcome::Fine, |text| tell(&text));
    told.and(finish("constraints", format, &report, &Result { constraints: analysis }))
}

fn derive(args: &Args) -> Outcome {
    let format = match args.format {
        Form::Text => Format::Human,
        Form::Json => Format::Json,
        Form::Dot => return usage("constraints", "there is no graph of what can be derived"),
    };
    let mut report = Report::default();
    let all = read(&args.file, &mut report, pipeline::derivable).unwrap_or_default();
    let told = if format == Format::Human && !all.is_empty() { tell(&text(&all)) } else { Outcome::Fine };
    let item = |d: Derived| Item {
        name: d.constraint.name.text.clone(),
        source: source::constraint(&d.constraint),
        from: d.sources(),
    };
    told.and(finish("constraints", format, &report, &Derivable { derived: all.into_iter().map(item).collect() }))
}

/// The constraints, each group below what it is derived from.
fn text(all: &[Derived]) -> String {
    let mut text = String::new();
    let mut last = None;
    for d in all {
        let from = d.sources();
        if last.as_ref() != Some(&from) {
            text += &format!("// from {}\n", from.join(", "));
            last = Some(from);
        }
        text += &source::constraint(&d.constraint);
        text.push('\n');
    }
    text
}
