//! The words of the command line, and the help that explains them.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

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

    #[command(flatten)]
    pub output: Output,
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

/// How a command reports.
#[derive(Args, Debug)]
pub struct Output {
    /// How to report: for people on standard error, or as one JSON document on standard output.
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
