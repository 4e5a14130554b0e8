//! Machine and PLC project to a verdict: whether one scan of the program is one scan of the chart.
//!
//! | module | does |
//! | --- | --- |
//! | [`chart_step`] | one scan of a chart as Boolean functions ([`bits`](crate::bits)), from the chart's own meaning |
//! | [`chart_numbers`] | what it counts |
//! | [`program_step`] | one scan of a PLC project as such functions, from the project's own meaning |
//! | [`correspondence`], [`parts`], [`matching`] | which variable or step of a program stands for what |
//! | [`configuration`] | every configuration of a chart, decoded from free bits |
//! | [`induction`] | first scan and any later scan, claim by claim |
//! | [`guard`] | what the program's filter lets through, whatever is commanded |
//! | [`sums`] | whether its numbers stay within their types |
//! | [`lemmas`] | what a chart can never reach, where the induction asks for it |
//! | [`joint`], [`search`], [`ahead`], [`shorten`] | chart and program side by side from power-up, and a hunt for a difference |
//! | [`wiring`] | addresses and the time between two scans |
//! | [`trace`] | the run that shows it, as a table |
//! | [`mod@equivalence`] | all of it, in order |
//!
//! Nothing here knows of the passes that made the program or of the writer that wrote it: [`lower`](crate::lower)
//! and [`emit`](crate::emit) are what is on trial.

pub mod ahead;
pub mod chart_filter;
pub mod chart_numbers;
pub mod chart_step;
pub mod configuration;
pub mod correspondence;
pub mod equivalence;
pub mod guard;
pub mod induction;
pub mod joint;
pub mod lemmas;
pub mod matching;
pub mod parts;
pub mod program_step;
pub mod search;
pub mod shorten;
pub mod sums;
pub mod trace;
pub mod wiring;

pub use correspondence::Correspondence;
pub use equivalence::{Doubt, Statistics, Verdict, equivalence, equivalence_within};
