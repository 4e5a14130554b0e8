//! The words of the command line, and the help that explains them.

mod verify;

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

pub use verify::{Deny, TimeModel, Verify, VerifyEngine, VerifyProgram};

/// Compiles the statechart of a machine into a PLC program.
///
/// A .chart file describes a machine: its inputs and outputs, its actuators by technology, its
/// operating modes as a hierarchical statechart, and what must never happen. Chartwright makes
/// SFC and ladder programs of it and writes them as PLCopen XML, which a PLC IDE opens.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    after_long_help = "\
Examples:
  chartwright check door.chart     say what is wrong with a model
  chartwright build door.chart     write door.xml
  chartwright verify door.chart    say what is true of all its runs
  chartwright test door.chart      run the scenarios that it holds
  chartwright simulate door.chart  try it out
  chartwright show door.chart      show what is made of it
  chartwright explain E101         explain an error

Exit codes:
  0  done; warnings may have been given
  1  the input is wrong, or a file cannot be read or written
  2  the command line is wrong"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What can be done.
#[derive(Debug, Subcommand)]
pub enum Command {
    Check(Check),
    Build(Build),
    Prove(Prove),
    Verify(Verify),
    Export(Export),
    Replay(Replay),
    Test(Test),
    Simulate(Simulate),
    Constraints(Constraints),
    Show(Show),
    Stats(Stats),
    Explain(Explain),
}

/// Says what is wrong with models.
///
/// Reads each FILE, checks everything that `build` checks, and writes nothing. Several errors are
/// reported in one run. Errors and warnings go to standard error with the lines they speak of;
/// each has a code, and `chartwright explain CODE` says more about it.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright check door.chart
  chartwright check models/*.chart
  chartwright check --format json door.chart

Exit codes:
  0  no errors; warnings may have been given
  1  a model has errors, or a file cannot be read
  2  the command line is wrong")]
pub struct Check {
    /// The models.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    #[command(flatten)]
    pub output: Output,
}

/// Compiles a model into a PLC program.
///
/// Reads FILE, checks it and writes the program as PLCopen XML. Where the model has errors,
/// nothing is written, and an existing file stays as it is. A file is written whole or not at all.
///
/// Before anything is written, the XML is read back and proved: one scan of the program equals one
/// scan of the chart, for all inputs and everything that can be reached.
///
/// The same model always gives the same bytes. The XML has to carry a time of creation: it is that
/// of the environment variable SOURCE_DATE_EPOCH (seconds since 1970), else 1970-01-01T00:00:00.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright build door.chart                        writes door.xml
  chartwright build door.chart -o plc/door.xml
  chartwright build door.chart --dialect codesys
  chartwright build door.chart --names door.csv       also a table of what each PLC name stands for
  chartwright build door.chart -o - | xmllint -

Exit codes:
  0  written; warnings may have been given
  1  the model has errors, or a file cannot be read or written
  2  the command line is wrong, for example OUT would overwrite FILE")]
pub struct Build {
    /// The model.
    pub file: PathBuf,

    /// Where to write the XML; `-` is standard output [default: FILE with the extension .xml].
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,

    /// For which family of IDEs.
    #[arg(long, value_enum, default_value_t = Dialect::Beremiz)]
    pub dialect: Dialect,

    /// Where to write the table of names as CSV: each name in the PLC, what it is for and what it
    /// stands for in the model; `-` is standard output.
    #[arg(long, value_name = "NAMES")]
    pub names: Option<PathBuf>,

    /// Write the program without proving that it does what the chart says. The file says so, too.
    #[arg(long)]
    pub no_proof: bool,

    #[command(flatten)]
    pub output: Output,
}

/// Proves that a program does what a model says.
///
/// Reads PROGRAM, PLCopen XML of either family of IDEs, and shows that one scan of it equals one scan
/// of the chart in FILE, for all inputs and everything that can be reached: steps, variables, commands,
/// outputs and alarms. If it does not, a table shows a run from power-up to the difference. Use it on a
/// program that was edited, imported and exported again, or built long ago.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright prove door.chart door.xml
  chartwright prove --format json door.chart exported.xml

Exit codes:
  0  proved
  1  refuted or undecided, or a file has errors or cannot be read
  2  the command line is wrong")]
pub struct Prove {
    /// The model.
    pub file: PathBuf,

    /// The program as PLCopen XML.
    pub program: PathBuf,

    /// After how many seconds to end.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub time: u64,

    #[command(flatten)]
    pub output: Output,
}

/// Runs the scenarios of models.
///
/// Reads and checks each FILE and plays every scenario in it, in the plant that the model
/// describes. A scenario fails at the first expectation that is not met; what is shown then is the
/// scan, the values concerned and what changed in the scans before.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright test models/*.chart
  chartwright test door.chart --filter \"somebody comes\"
  chartwright test door.chart --junit report.xml

Exit codes:
  0  every scenario that was played went as expected
  1  a scenario failed or none was played, a model has errors, or a file cannot be read or written
  2  the command line is wrong")]
pub struct Test {
    /// The models.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// Only scenarios whose name holds this text.
    #[arg(long, value_name = "NAME")]
    pub filter: Option<String>,

    /// Take it as right that no scenario is played, as when the models have none or none fits NAME.
    #[arg(long)]
    pub allow_empty: bool,

    /// Where to write a report as JUnit XML, for CI; `-` is standard output.
    #[arg(long, value_name = "REPORT")]
    pub junit: Option<PathBuf>,

    #[command(flatten)]
    pub output: Output,
}

/// Runs a model and shows what happens.
///
/// Reads and checks FILE and runs it in the plant that it describes: by a scenario, by a table of
/// inputs, by chance, or by itself for some scans. Without any of these it takes commands from
/// standard input, one a line; `help` lists them.
///
/// A table of inputs is CSV with the columns `scan` and names of inputs. A value (0 or 1) holds from
/// its scan on; an empty cell changes nothing. What the table names, it takes from the plant.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright simulate door.chart
  chartwright simulate door.chart --scenario \"somebody comes\"
  chartwright simulate door.chart --inputs door.csv --output csv -o run.csv
  chartwright simulate door.chart --seed 7 --scans 10000 --output vcd -o run.vcd

Exit codes:
  0  run
  1  the scenario failed, the model has errors, or a file cannot be read or written
  2  the command line is wrong")]
pub struct Simulate {
    /// The model.
    pub file: PathBuf,

    /// Plays the scenario of that name.
    #[arg(long, value_name = "NAME", group = "stimulus")]
    pub scenario: Option<String>,

    /// Gives inputs by a table.
    #[arg(long, value_name = "CSV", group = "stimulus")]
    pub inputs: Option<PathBuf>,

    /// Gives by chance those inputs that the plant does not give; the same seed gives the same run.
    #[arg(long, value_name = "SEED", group = "stimulus")]
    pub seed: Option<u64>,

    /// How many scans to run [default: as many as the scenario or the table has, 1000 by chance].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=u64::from(crate::base::limits::SCENARIO_SCANS)))]
    pub scans: Option<u64>,

    /// What runs.
    #[arg(long, value_enum, default_value_t = Program::Chart)]
    pub program: Program,

    /// How to show the run.
    #[arg(long, value_enum, default_value_t = Trace::Table)]
    pub output: Trace,

    /// Where to write it; `-` is standard output [default: -].
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
}

/// What runs a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Program {
    /// The chart itself.
    Chart,
    /// The PLC program that it is compiled to.
    Plc,
}

impl Program {
    /// Its name among the programs of the pipeline.
    pub fn name(self) -> &'static str {
        match self {
            Program::Chart => "chart",
            Program::Plc => "plc",
        }
    }
}

/// How a run is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Trace {
    /// The scans in which something changed, with what changed.
    Table,
    /// All values of all scans.
    Csv,
    /// A value change dump, for GTKWave or Surfer.
    Vcd,
}

/// Says what is to be known about the safety constraints of a model.
///
/// Reads FILE and shows, for each constraint, its products: simple (CSs) or combined (CSc), static,
/// combinatory or sequential, and what they force. For each output, what forces it off and on; for combined
/// products, the matrices MX and MC and the graphs G and GO; whether properties 0 to 4 hold, each violation
/// with a case in which it happens; constraints that others imply, and outputs that none touches. Models
/// whose constraints contradict each other are analysed, too.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright constraints door.chart
  chartwright constraints --derive door.chart
  chartwright constraints --format json door.chart
  chartwright constraints --format dot door.chart | dot -Tsvg -O

Exit codes:
  0  analysed, and no error was found
  1  the model has errors, or the file cannot be read
  2  the command line is wrong")]
pub struct Constraints {
    /// The model.
    pub file: PathBuf,

    /// Print the constraints that follow from actuators and forbidden positions, as a model would write
    /// them, instead of the analysis.
    #[arg(long)]
    pub derive: bool,

    /// How to show the analysis, on standard output.
    #[arg(long, value_enum, default_value_t = Form::Text)]
    pub format: Form,
}

/// How an analysis is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// Text for people; errors and warnings go to standard error.
    Text,
    /// One JSON document with all of it, matrices included.
    Json,
    /// The graphs G and GO, for Graphviz.
    Dot,
}

/// Shows a stage of a model on its way to a program, as text.
///
/// Reads FILE and prints what the compiler has made of it: `tree` is the text as it was understood,
/// `chart` the machine with all names resolved, constraints derived and the laws of actuators worked
/// out, `sfc` and `ladder` the programs, `names` a table of what each name in the PLC stands for.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright show door.chart
  chartwright show door.chart --stage ladder
  chartwright show door.chart --stage names > door.csv

Exit codes:
  0  shown; warnings may have been given
  1  the model has errors, or the file cannot be read
  2  the command line is wrong")]
pub struct Show {
    /// The model.
    pub file: PathBuf,

    /// Which stage.
    #[arg(long, value_enum, default_value_t = ShowStage::Chart)]
    pub stage: ShowStage,

    #[command(flatten)]
    pub output: Output,
}

/// A stage of a model on its way to a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShowStage {
    /// The text as it was understood.
    Tree,
    /// The machine with all names resolved.
    Chart,
    /// The SFC programs.
    Sfc,
    /// The ladder programs.
    Ladder,
    /// The table of names in the PLC, with their meanings, as CSV.
    Names,
}

/// Counts what a model and its program consist of.
///
/// Reads FILE and checks it. Macro states are charts, composite states and named regions;
/// elementary states are all others, movements and final states included. A chart is level 1; each
/// composite state and each named region is one level below what contains it. Of the program,
/// steps, rungs and variables are counted as they will stand in the PLC.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright stats door.chart
  chartwright stats --format json door.chart

Exit codes:
  0  counted
  1  the model has errors, or the file cannot be read
  2  the command line is wrong")]
pub struct Stats {
    /// The model.
    pub file: PathBuf,

    #[command(flatten)]
    pub output: Output,
}

/// Explains an error or a warning.
///
/// Prints the page of CODE: what it means, why it matters on a PLC, a wrong model and the same
/// mended. Without CODE, lists all codes with what they say.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright explain E101
  chartwright explain w502
  chartwright explain

Exit codes:
  0  printed
  2  there is no such code")]
pub struct Explain {
    /// The code, such as E101; capitals or not.
    pub code: Option<String>,
}

/// Writes a machine as a transition system for other model checkers.
///
/// Reads FILE and writes what `verify` verifies, with the names of the model. AIGER takes what never is,
/// AIGER 1.9 and BTOR2 also what comes eventually, SMV also what is always possible.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright export door.chart --format aiger      writes door.aig
  chartwright export door.chart --format aiger-1.9 -o door.aag
  chartwright export door.chart --format smv -o -

Exit codes:
  0  written
  1  the model has errors, or a file cannot be read or written
  2  the command line is wrong")]
pub struct Export {
    /// The model.
    pub file: PathBuf,

    /// In which form.
    #[arg(long = "format", value_enum)]
    pub form: SystemForm,

    /// What runs in front of the filter.
    #[arg(long, value_enum, default_value_t = VerifyProgram::Chart)]
    pub program: VerifyProgram,

    /// Leaves the plant out.
    #[arg(long)]
    pub open: bool,

    /// Where to write; `-` is standard output [default: FILE with the extension of the form].
    #[arg(short, long, value_name = "OUT")]
    pub out: Option<PathBuf>,
}

/// Replays a run that another model checker found.
///
/// Reads FILE and a run of what `export` writes of it: a witness of AIGER or of BTOR2, or what ABC's `write_cex -a` writes. The run is tried on the model and
/// played by the simulator, then shown as `verify` shows its own.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright replay door.chart door.witness
  chartwright replay door.chart found.txt --property P1 --scenario found.chart

Exit codes:
  0  the run shows what it says
  1  it cannot be read, or shows nothing; or the model has errors
  2  the command line is wrong")]
pub struct Replay {
    /// The model.
    pub file: PathBuf,

    /// The run.
    pub witness: PathBuf,

    /// What the run is about, by its name in the exported file, if the other tool was given that alone.
    #[arg(long, value_name = "NAME")]
    pub property: Option<String>,

    /// What runs in front of the filter, as for the export.
    #[arg(long, value_enum, default_value_t = VerifyProgram::Chart)]
    pub program: VerifyProgram,

    /// The plant was left out of the export.
    #[arg(long)]
    pub open: bool,

    /// Where to write the run as a value change dump.
    #[arg(long, value_name = "VCD")]
    pub vcd: Option<PathBuf>,

    /// Where to write the run as a scenario, to be put into the model.
    #[arg(long, value_name = "OUT")]
    pub scenario: Option<PathBuf>,

    #[command(flatten)]
    pub output: Output,
}

/// A form of transition systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SystemForm {
    /// AIGER as all its tools read it, in the binary form, or as text if OUT ends in .aag.
    Aiger,
    /// The same as text.
    Aag,
    /// AIGER 1.9, in the binary form, or as text if OUT ends in .aag.
    #[value(name = "aiger-1.9")]
    AigerLatest,
    /// BTOR2.
    Btor2,
    /// SMV, for NuSMV and nuXmv.
    Smv,
}

/// How a command reports.
#[derive(Args, Debug)]
pub struct Output {
    /// How to report on standard output: for people, with errors, warnings and what has been written on standard error, or
    /// as one JSON document.
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

/// Who reads the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Text with the lines concerned; in colour on a terminal unless NO_COLOR is set.
    Human,
    /// One JSON document for the whole run.
    Json,
}

/// A family of IDEs that agree on a form of PLCopen XML.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Dialect {
    /// Beremiz, OpenPLC Editor.
    Beremiz,
    /// CODESYS, TwinCAT and relatives.
    Codesys,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }
}
