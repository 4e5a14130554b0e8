//! Scan cycles of a machine or of its PLC project.

pub mod plc;
pub mod trace;
