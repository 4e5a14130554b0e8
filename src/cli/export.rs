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
        SystemForm::Aiger | SystemForm::AigerLatest => "aig",
        SystemForm::Aag => "aag",
        SystemForm::Btor2 => "btor2",
        SystemForm::Smv => "smv",
    };
    let out = args.out.clone().unwrap_or_else(|| args.file.with_extension(extension));
    if !files::is_standard(&out) && files::same(&out, &args.file) {
        return usage("export", "writing the system would overwrite the model");
    }
    // Tools of AIGER go by the ending.
    let ends = |ending: &str| out.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if args.form == SystemForm::Aag && ends("aig") {
        return usage("export", "`.aig` is the ending of binary AIGER, and `aag` is text");
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
    let system = &subject.system;
    let bytes = match args.form {
        SystemForm::Aiger if ends("aag") => aiger::first_ascii(system).into_bytes(),
        SystemForm::Aiger => aiger::first_binary(system),
        SystemForm::Aag => aiger::first_ascii(system).into_bytes(),
        SystemForm::AigerLatest if ends("aag") => aiger::ascii(system).into_bytes(),
        SystemForm::AigerLatest => aiger::binary(system),
        SystemForm::Btor2 => btor2::write(system).into_bytes(),
        SystemForm::Smv => smv::write(system).into_bytes(),
    };
    let size = bytes.len();
    let written = Pending::prepare(&out, bytes).and_then(Pending::commit);
    let says = if written.is_ok() && !files::is_standard(&out) {
        format!("{} written: {size} bytes\n", files::show(&out))
    } else {
        String::new()
    };
    if let Err(diagnostic) = written {
        report.files.push(FileReport::failed(files::show(&out), diagnostic));
    }
    let outcome = finish("export", Format::Human, &report, &super::Nothing {});
    say(&says);
    outcome
}
