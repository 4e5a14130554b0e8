//! Runs what the compiler reads and what it writes, scan by scan.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it. It knows nothing of how
//! a machine is translated, so that it can be held against the translation.
//!
//! [`plc`] runs a PLC project that was read back from what is emitted; [`trace`] are tables of such runs.
//!
//! Around them, [`plant`] is how the machine's parts react, [`run`] the closed loop, [`scenario`] a
//! test that is played on it and [`record`] what is shown of a run.

pub mod chart;
pub mod frame;
pub mod plant;
pub mod plc;
pub mod record;
pub mod run;
pub mod scenario;
pub mod trace;
