//! The one place that knows the order of the stages.

mod exactly;
pub mod findings;
mod front;
pub mod needed;
mod refine;
pub mod replay;
mod run;
mod rungs;
mod shortest;
pub mod show;
pub mod verify;
pub mod without;
mod witnesses;

use crate::base::{Code, Diagnostic, Diagnostics, LineIndex, Severity};
use crate::constraints::Analysis;
use crate::emit::{self, Header};
use crate::ir::chart::Machine;
use crate::ir::plc::Project;
use crate::ir::scenario::Condition;
use crate::prove::{self, Doubt, Verdict};
use crate::simulate::run::Program;
use crate::{derive, lower, parse, read, resolve};
use front::Front;

pub use crate::emit::Dialect;
pub use crate::prove::Statistics;

/// Text to a machine that keeps every rule. Without errors among the diagnostics there is one.
pub fn check(source: &str) -> (Option<Machine>, Diagnostics) {
    front::front(source, |_| Diagnostics::new()).whole()
}

/// Text to what is to be known about its constraints. Where these contradict each other, or one does not say
/// who yields, there are errors among the diagnostics, and an analysis all the same.
pub fn constraints(source: &str) -> (Option<Analysis>, Diagnostics) {
    let Front { machine, resolving, checking } = front::front(source, |_| Diagnostics::new());
    let harmless = [Code::NobodyYields, Code::CannotYield];
    let whole = resolving.iter().all(|d| d.severity() == Severity::Warning || harmless.contains(&d.code));
    let analysis = machine.filter(|_| whole).map(|machine| Analysis::of(&machine));
    (analysis, front::all(resolving, checking))
}

/// Text to the constraints that can be derived from its actuators and forbidden positions, whether the model
/// asks for them or not.
pub fn derivable(source: &str) -> (Vec<derive::Derived>, Diagnostics) {
    let (tree, mut diagnostics) = parse::parse(source);
    let Some(tree) = tree else { return (Vec::new(), diagnostics) };
    let (all, found) = derive::everything(&tree, false);
    diagnostics.append(found);
    diagnostics.sort();
    (all, diagnostics)
}

/// A machine without errors to its PLC project.
pub fn lower(machine: &Machine) -> Project {
    lower::lower(machine)
}

/// What a machine without errors runs as, each with its name: the chart itself, and the PLC program that is
/// read back from its XML.
pub fn programs(machine: &Machine) -> Vec<(&'static str, Program)> {
    let project = lower(machine);
    let xml = emit::plcopen(&project, Dialect::Beremiz, &Header::default());
    let (read, diagnostics) = read::read(&xml);
    let read = read.unwrap_or_else(|| panic!("what is written can be read back: {diagnostics:?}"));
    vec![("chart", Program::chart(machine)), ("plc", Program::plc(machine, &project, &read))]
}

/// A condition that was given beside a model.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The model's machine, with the comparisons that the condition brings along. All ids that the machine has
    /// without the condition mean the same in it.
    pub machine: Machine,
    /// The condition, over that machine.
    pub condition: Condition,
}

/// A condition over the machine that `source` describes, as its scenarios write it. The places of the
/// diagnostics are those in `text`, or in `source` where the model is wrong.
pub fn condition(source: &str, text: &str) -> Result<Asked, Diagnostics> {
    let guard = parse::condition(text)?;
    let (tree, diagnostics) = parse::parse(source);
    let Some(mut tree) = tree else { return Err(diagnostics) };
    let mut diagnostics = derive::expand(&mut tree);
    let (machine, condition, found) = resolve::condition(&tree, &guard);
    diagnostics.append(found);
    if diagnostics.has_errors() { Err(diagnostics) } else { Ok(Asked { machine, condition }) }
}

/// What [`build`] is told.
#[derive(Clone, Debug)]
pub struct Options {
    /// For which family of IDEs.
    pub dialect: Dialect,
    /// When the file says that it was made, as `xsd:dateTime`; never read from a clock here.
    pub created: String,
    /// Whether to prove that the file does what the machine says. If not, the file says so.
    pub prove: bool,
}

/// What [`build`] makes.
#[derive(Clone, Debug)]
pub struct Output {
    /// The machine.
    pub machine: Machine,
    /// Its PLC project.
    pub project: Project,
    /// The project as PLCopen XML.
    pub xml: String,
    /// What each name in the project stands for, as CSV.
    pub names: String,
    /// How it was proved, if that was asked for.
    pub proof: Option<Statistics>,
}

/// Text to PLCopen XML. Without errors among the diagnostics there is an output.
///
/// The proof is about the file: the XML is read back, by a reader that shares nothing with the writer,
/// and one scan of what it says is proved equal to one scan of the machine.
pub fn build(source: &str, options: &Options) -> (Option<Output>, Diagnostics) {
    let (machine, mut diagnostics) = check(source);
    let Some(machine) = machine else { return (None, diagnostics) };
    let project = lower(&machine);
    let remark = (!options.prove).then(|| "not proved: built with --no-proof".to_owned());
    let header = Header { created: options.created.clone(), remark, ..Header::default() };
    let xml = emit::plcopen(&project, options.dialect, &header);
    let mut proof = None;
    if options.prove {
        let (judgement, found) = examine(&machine, &project, &xml);
        diagnostics.append(found);
        match judgement {
            Judgement::Proved(statistics) => proof = Some(statistics),
            Judgement::Refuted(_) | Judgement::Undecided => return (None, diagnostics),
        }
    }
    let names = emit::names::table(&project, &machine, &LineIndex::new(source));
    (Some(Output { machine, project, xml, names, proof }), diagnostics)
}

/// What an examination of a program says.
#[derive(Clone, Debug)]
pub enum Judgement {
    /// It does what the machine says.
    Proved(Statistics),
    /// It does not; the run that shows it, as a table.
    Refuted(String),
    /// It cannot be read or compared, or the question stays open; the diagnostics say why.
    Undecided,
}

/// Text of a model and PLCopen XML of any origin to whether the program does what the machine says,
/// with what there is to say about each of the two.
pub fn prove(source: &str, xml: &str) -> (Judgement, Diagnostics, Diagnostics) {
    let (machine, about_source) = check(source);
    let Some(machine) = machine else { return (Judgement::Undecided, about_source, Diagnostics::new()) };
    let (judgement, about_program) = examine(&machine, &lower(&machine), xml);
    (judgement, about_source, about_program)
}

/// Whether the program in `xml` does what the machine says; `project` says what the names in it stand
/// for.
fn examine(machine: &Machine, project: &Project, xml: &str) -> (Judgement, Diagnostics) {
    let (program, mut diagnostics) = read::read(xml);
    let Some(program) = program else { return (Judgement::Undecided, diagnostics) };
    let names = prove::Correspondence::of(machine, project);
    match prove::equivalence(machine, &names, &program) {
        Verdict::Proved(statistics) => (Judgement::Proved(statistics), diagnostics),
        Verdict::Refuted(trace) => {
            let scans = trace.scans.len();
            let different = trace.said(3).join(", ");
            diagnostics.push(
                Diagnostic::new(
                    Code::Different,
                    format!("in scan {scans} the program does not do what the chart says: {different}"),
                )
                .help("the table shows the run that leads there, chart beside program"),
            );
            (Judgement::Refuted(trace.to_string()), diagnostics)
        }
        Verdict::Unknown(doubt) if matches!(*doubt, Doubt::Unsafe(_)) => {
            diagnostics.push(
                Diagnostic::new(Code::UnsafeFilter, doubt.to_string())
                    .help("the program does what the chart says, and its filter is weaker than the constraints"),
            );
            (Judgement::Undecided, diagnostics)
        }
        Verdict::Unknown(doubt) => {
            let (message, help) = match *doubt {
                Doubt::Incomparable(why) => {
                    let message = format!("the program cannot be compared with the chart: {why}");
                    (message, "a program that was made by `chartwright build` from this model can be")
                }
                open => {
                    let message = format!("the program has neither been proved nor refuted: {open}");
                    (message, "a program that was made by `chartwright build` from this model is proved")
                }
            };
            diagnostics.push(Diagnostic::new(Code::Undecided, message).help(help));
            (Judgement::Undecided, diagnostics)
        }
    }
}
