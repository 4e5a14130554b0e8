//! A model to a transition system that other model checkers read.

use super::args::{Export as Args, Format, SystemForm};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::{Outcome, finish, read, say, usage, verify};
use crate::pipeline;
use crate::verify::export::{aiger, btor2, smv};

/// Runs `chartwright export`.
pub fn run(args: &Args) -> Outcome {
    let extension = match args.form {
        SystemForm::Aiger => "aag",
        SystemForm::Btor2 => "btor2",
        SystemForm::Smv => "smv",
    };
    let out = args.out.clone().unwrap_or_else(|| args.file.with_extension(extension));
    if !files::is_standard(&out) && files::same(&out, &args.file) {
        return usage("export", "writing the system would overwrite the model");
    }
    let mut report = Report::default();
    let machine = read(&args.file, &mut report, pipeline::check).flatten();
    let Some(machine) = machine else {
        return finish("export", Format::Human, &report, &super::Nothing {});
    };
    let subject = match pipeline::verify::system(&machine, verify::program(args.program), args.open) {
        Ok(subject) => subject,
        Err(refusal) => {
            say(&format!("error: {refusal}\n"));
            return Outcome::Wrong;
        }
    };
    let text = match args.form {
        SystemForm::Aiger => aiger::ascii(&subject.system),
        SystemForm::Btor2 => btor2::write(&subject.system),
        SystemForm::Smv => smv::write(&subject.system),
    };
    if let Err(diagnostic) = Pending::prepare(&out, text).and_then(Pending::commit) {
        report.files.push(FileReport::failed(files::show(&out), diagnostic));
    }
    finish("export", Format::Human, &report, &super::Nothing {})
}
