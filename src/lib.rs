//! Chartwright compiles the statechart of a machine into a PLC program.
//!
//! A `.chart` file describes a machine: its inputs and outputs, its actuators by technology, its
//! operating modes as a hierarchical statechart, and what must never happen. [`pipeline`] knows the
//! order of the stages that lead from there to PLCopen XML:
//!
//! | stage | from | to |
//! | --- | --- | --- |
//! | [`parse`] | text | syntax tree |
//! | [`mod@derive`] | syntax tree | syntax tree with derived constraints |
//! | [`resolve`] | syntax tree | machine |
//! | [`check`] | machine | diagnostics |
//! | [`lower`] | machine | PLC project |
//! | [`layout`] | SFC, ladder | drawing |
//! | [`emit`] | PLC project, drawings | PLCopen XML, table of names |
//!
//! Two more check what came out: [`read`] turns PLCopen XML of any origin into a PLC project as it
//! is executed, [`simulate`] executes it scan by scan, and the machine that it was made from, in its
//! plant and with its scenarios.
//!
//! [`verify`] says what is true of all runs of a machine.
//!
//! [`ir`] holds the forms in between and says what they mean; [`bits`] Boolean functions and a solver for
//! them; [`base`] what all layers share.
//! Nothing below [`cli`] prints, reads files or ends the process.

// The documentation is for those who work on the compiler: it is built with private items.
#![allow(rustdoc::private_intra_doc_links)]

pub mod base;
pub mod bits;
pub mod check;
pub mod cli;
pub mod constraints;
pub mod derive;
pub mod emit;
pub mod ir;
pub mod layout;
pub mod lower;
pub mod parse;
pub mod pipeline;
pub mod prove;
pub mod read;
pub mod resolve;
pub mod simulate;
pub mod stats;
pub mod verify;
