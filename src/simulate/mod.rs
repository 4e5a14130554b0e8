//! Scan cycles of a machine, and of its PLC project, to traces.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it. It knows nothing of how
//! a machine is translated, so that it can be held against the translation. [`plc`] runs a PLC project
//! as [`crate::ir::iec`] has it; all that the two share is the type of Boolean expressions.

pub mod chart;
pub mod plc;
pub mod trace;
