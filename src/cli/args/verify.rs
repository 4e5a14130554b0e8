//! The words of `chartwright verify`.

use super::Output;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Says what is true of all runs of a machine.
///
/// Reads FILE and asks, for all inputs that its assumptions allow and everything that its plant can do: the properties that it declares; whether its outputs ever violate a constraint;
/// whether some transition can always fire sooner or later. These are demands. It also finds, for people
/// to judge, which states are never active, which transitions never fire, which ones are enabled
/// together so that only their order decides, which integers stop at a bound, and where the filter has
/// to act.
///
/// A violated demand is shown as a run from power-up, as short as can be.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  chartwright verify door.chart
  chartwright verify door.chart --program any           the filter alone, behind any program
  chartwright verify door.chart --open                  without the plant: all inputs are free
  chartwright verify door.chart --scenario found.chart  write the first counterexample as a scenario
  chartwright verify door.chart --deny overlap,acts     what is found of these kinds is an error
  chartwright verify door.chart --needed                what happens without each constraint
  chartwright verify door.chart --program any --without S1,S2

Exit codes:
  0  all demands hold; with --needed, it is known of each constraint whether it is needed
  1  a demand is violated; with --needed, something stays open; the model has errors, or a file cannot be read or written
  2  the command line is wrong
  3  no demand is violated, and a property, a constraint or what is denied stays open, or anything after Ctrl-C

Ctrl-C, or a request to terminate, prints what is known so far; the second one ends at once.")]
pub struct Verify {
    /// The model.
    pub file: PathBuf,

    /// What runs in front of the filter [default: chart; any with --needed].
    #[arg(long, value_enum)]
    pub program: Option<VerifyProgram>,

    /// Leaves one constraint out at a time, and says which property is violated then, if one is.
    ///
    /// Asked are the declared properties that hold with all constraints. A constraint has to do its part
    /// whatever the program commands, so any program is assumed; with `--program chart` a constraint is
    /// needed only if these charts need it.
    #[arg(long)]
    pub needed: bool,

    /// Leaves these constraints out, as if they had not been written.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub without: Vec<String>,

    /// Makes an error of findings that are left to people to judge otherwise.
    #[arg(long, value_enum, value_name = "KIND,…", value_delimiter = ',')]
    pub deny: Vec<Deny>,

    /// Leaves the plant out: all inputs are free, under the assumptions only.
    #[arg(long)]
    pub open: bool,

    /// How times are taken: those of guards, of actuators that travel and of rules of the plant.
    #[arg(long, value_enum, default_value_t = TimeModel::Exact)]
    pub time_model: TimeModel,

    /// Which engine answers.
    #[arg(long, value_enum, default_value_t = VerifyEngine::Auto)]
    pub engine: VerifyEngine,

    /// After how many seconds to end.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub time: u64,

    /// How much memory sets of situations may take, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub memory: u32,

    /// How many scans a bounded search looks ahead.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub scans: u32,

    /// Where to write the first counterexample as a value change dump.
    #[arg(long, value_name = "VCD")]
    pub vcd: Option<PathBuf>,

    /// Where to write all counterexamples as scenarios, to be put into the model.
    #[arg(long, value_name = "OUT")]
    pub scenario: Option<PathBuf>,

    #[command(flatten)]
    pub output: Output,
}

/// What runs in front of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VerifyProgram {
    /// The charts of the model.
    Chart,
    /// Any: each scan any command.
    Any,
}

/// A kind of finding, which is left to people to judge unless it is denied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Deny {
    /// A property that says nothing, since what it speaks of happens in no fair run.
    Void,
    /// A state that is active in no run.
    Unreachable,
    /// A transition that fires in no run.
    Silent,
    /// Two transitions of one source that only their order separates.
    Overlap,
    /// An integer to which a value beyond its range is assigned, so that it stops at the bound.
    Saturates,
    /// A constraint for which the filter acts.
    Acts,
    /// An `accept` in the model whose finding is not found any more.
    Stale,
    /// A constraint that is not needed; asked with --needed.
    Needless,
    /// All of these.
    All,
}

/// How times are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TimeModel {
    /// In scans of the declared cycle, as they are simulated.
    Exact,
    /// They pass when they will: covers every cycle, however late its scans are.
    Free,
}

/// An engine that verifies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VerifyEngine {
    /// Each where it is best.
    Auto,
    /// The exact set of situations that can come.
    Exact,
    /// The first scans, one by one; proves nothing.
    Bounded,
    /// Property directed reachability.
    Proof,
}
