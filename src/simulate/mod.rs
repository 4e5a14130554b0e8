//! Scan cycles of a machine or of its PLC project.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it, [`plc`] a PLC project by
//! that of [`crate::ir::iec`]. Neither knows of the other or of the translation between them, so that
//! they can be held against each other. [`trace`] is what goes into a run and comes out of it.

pub mod chart;
pub mod plc;
pub mod trace;
