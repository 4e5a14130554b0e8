//! A transition system over bits to verdicts about all its runs.
//!
//! | module | does |
//! | --- | --- |
//! | [`system`] | latches, inputs, constraints, claims, and runs |
//! | [`replay`] | what a run does |
//! | [`engine`] | which engine answers what |
//! | [`symbolic`] | all reachable states, with [`bdd`], [`order`] and [`relation`] |
//! | [`parts`] | the states of a small part, one by one |
//! | [`bounded`] | shortest runs, by a [`solver`] |
//! | [`path`] | runs through known states |
//! | [`wander`] | runs by chance |
//! | [`pdr`], [`certificate`] | proofs by an invariant, which is checked again |
//! | [`possible`] | proofs that something stays possible, by plans |
//! | [`follow`] | runs of a system along those of one that does more |
//! | [`export`] | for other tools, and their runs back |
//! | [`liveness`] | what comes sooner or later in fair runs |
//! | [`machine`] | a machine in its plant as such a system, and what to ask of it |
//! | [`limits`] | how much they may spend, and why they gave up |
//!
//! Only [`machine`] knows of charts.

pub mod bdd;
pub mod bounded;
pub mod certificate;
pub mod count;
pub mod engine;
pub mod export;
pub mod follow;
pub mod limits;
pub mod liveness;
pub mod machine;
pub mod order;
pub mod parts;
pub mod path;
pub mod pdr;
pub mod possible;
pub mod relation;
pub mod replay;
pub mod solver;
pub mod symbolic;
pub mod system;
pub mod wander;

pub use crate::bits::{aig, sat};
pub use engine::{Choice, Coarser, Engine, Finding, Known, Progress, Report, Verdict, check};
pub use limits::{Limit, Limits};
pub use system::{Claim, Fairness, Giver, Input, Latch, Property, System, Trace};
