//! The nouns: every form that a machine takes on its way from text to PLC project.
//!
//! | module | form | what is gone |
//! | --- | --- | --- |
//! | [`ast`] | the text as a tree | comments, white space |
//! | [`chart`] | the machine, resolved | names as references, sugar, actuators' technology laws |
//! | [`scenario`] | its plant and its scenarios, resolved | names as references, durations |
//! | [`plc`], [`sfc`], [`ladder`] | the PLC project | hierarchy, guards over states, constraints |
//! | [`iec`] | a PLC project of any origin, as it is executed | how it was drawn |
//! | [`drawing`] | where everything stands on a page | nothing: it points into the project |
//!
//! No passes live here, only types, their invariants and their text form.

pub mod ast;
pub mod chart;
pub mod drawing;
pub mod expr;
pub mod iec;
pub mod integer;
pub mod ladder;
pub mod number;
pub mod origin;
pub mod outline;
pub mod plc;
pub mod property;
pub mod relief;
pub mod scenario;
pub mod sfc;
pub mod sop;
pub mod source;
pub mod text;
