//! A model to one of the stages on its way to a program.

use super::args::{Format, Show, ShowStage};
use super::report::Report;
use super::{Outcome, finish, read, tell};
use crate::pipeline::show::{self, Stage};
use serde::Serialize;

/// The stage, for the JSON document.
#[derive(Serialize)]
struct Result {
    text: Option<String>,
}

/// Runs `chartwright show`.
pub fn run(args: &Show) -> Outcome {
    let stage = match args.stage {
        ShowStage::Tree => Stage::Tree,
        ShowStage::Chart => Stage::Chart,
        ShowStage::Sfc => Stage::Sfc,
        ShowStage::Ladder => Stage::Ladder,
        ShowStage::Names => Stage::Names,
    };
    let mut report = Report::default();
    let text = read(&args.file, &mut report, |source| show::show(source, stage)).flatten();
    let told = match (&text, args.output.format) {
        (Some(text), Format::Human) => tell(text),
        _ => Outcome::Fine,
    };
    told.and(finish("show", args.output.format, &report, &Result { text }))
}
