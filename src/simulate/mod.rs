//! Scan cycles of a machine or of its PLC project.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it, [`plc`] a PLC project by
//! that of [`crate::ir::iec`]. Neither knows of the other or of the translation between them, so that
//! they can be held against each other. [`trace`] is what goes into a run and comes out of it.
//!
//! Around either, [`plant`] is how the machine's parts react, [`run`] the closed loop, [`scenario`] a
//! test that is played on it, [`record`] and [`vcd`] what is shown of a run.

pub mod chance;
pub mod chart;
pub mod frame;
pub mod plant;
pub mod plc;
pub mod record;
pub mod run;
pub mod scenario;
pub mod trace;
pub mod tree;
pub mod vcd;
