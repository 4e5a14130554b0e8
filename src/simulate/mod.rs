//! Runs what the compiler reads and what it writes, scan by scan.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it. It knows nothing of how
//! a machine is translated, so that it can be held against the translation.
//!
//! Around it, [`plant`] is how the machine's parts react, [`run`] the closed loop of both, [`scenario`] a
//! test that is played on it and [`record`] what is shown of a run.

pub mod chart;
pub mod frame;
pub mod plant;
pub mod record;
pub mod run;
pub mod scenario;
