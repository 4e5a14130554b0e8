//! A model and a run that another tool found to the run as it is in the simulator.

use super::check;
use super::run::{Run, show};
use super::verify::{Options, Question};
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::Machine;
use crate::verify::export::{claim_named, witness};
use crate::verify::machine::Subject;
use crate::verify::machine::clocks::Times;

/// A run that shows what it says that it shows.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The machine.
    pub machine: Machine,
    /// What it answers.
    pub question: Question,
    /// The run.
    pub run: Run,
}

/// Text of a model, and of a run of the system that `export` makes with the same options, to what the run shows; with
/// what there is to say about each of the two. `claim` is the name of what it is about, where the run does not tell.
pub fn replay(
    source: &str,
    text: &str,
    claim: Option<&str>,
    options: &Options,
) -> (Option<Replayed>, Diagnostics, Diagnostics) {
    let (machine, about_source) = check(source);
    let Some(machine) = machine else { return (None, about_source, Diagnostics::new()) };
    let mut about_run = Diagnostics::new();
    match judge(&machine, text, claim, options) {
        Ok((question, run)) => (Some(Replayed { machine, question, run }), about_source, about_run),
        Err(diagnostic) => {
            about_run.push(*diagnostic);
            (None, about_source, about_run)
        }
    }
}

fn judge(
    machine: &Machine,
    text: &str,
    claim: Option<&str>,
    options: &Options,
) -> Result<(Question, Run), Box<Diagnostic>> {
    let wrong = |code, message: String, help: &str| Box::new(Diagnostic::new(code, message).help(help));
    let subject = Subject::new(machine, options.program, options.open, Times::Free)
        .map_err(|refusal| wrong(Code::BadWitness, refusal.to_string(), "no system of this model was exported"))?;
    let unreadable = |why: String| {
        let message = format!("the run cannot be read: {why}");
        wrong(Code::BadWitness, message, "`--program` and `--open` have to be what they were for `chartwright export`")
    };
    let mut named = None;
    if let Some(name) = claim {
        let found = claim_named(&subject.system, name);
        named = Some(found.ok_or_else(|| unreadable(format!("the model claims nothing by the name `{name}`")))?);
    }
    let found = witness::read(&subject.system, text, named).map_err(unreadable)?;
    let trace = witness::judge(&subject.system, &found).map_err(|why| {
        let name = &subject.system.claims[found.claim].name;
        let message = format!("the run does not show what it says about `{name}`: {why}");
        wrong(Code::NotShown, message, "the run may belong to another version of the model")
    })?;
    let question = subject.questions[found.claim];
    // The system that was exported leaves times open.
    let options = Options { times: Times::Free, ..options.clone() };
    Ok((question, show(&subject, question, &trace, &options, &|| false)))
}
