//! Runs what the compiler reads and what it writes, scan by scan.
//!
//! [`chart`] runs a machine by the meaning that [`crate::ir::chart`] gives it. It knows nothing of how
//! a machine is translated, so that it can be held against the translation.

pub mod chart;
