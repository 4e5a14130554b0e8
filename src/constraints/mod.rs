//! Machine to what is to be known about its safety constraints.
//!
//! | module | does |
//! | --- | --- |
//! | [`questions`] | asks a solver what the filter may meet |
//! | [`properties`] | whether it can always meet all constraints |
//! | [`sweeps`] | how many sweeps `relief in-order` takes |
//! | [`safe`] | whether any outputs meet all constraints |
//! | [`redundancy`] | constraints that the others imply |
//! | [`graphs`] | the matrices and graphs of the paper on logical constraints |
//! | [`analysis`] | all of it, in names and texts |
//! | [`show`] | that as text and for Graphviz |
//! | [`words`] | products in the words of the model |

pub mod analysis;
pub mod graphs;
pub mod properties;
pub mod questions;
pub mod redundancy;
pub mod safe;
mod show;
pub mod sweeps;
pub mod words;

pub use analysis::Analysis;
