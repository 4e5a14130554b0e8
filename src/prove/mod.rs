//! Proofs.
pub mod aig;
mod chart_filter;
pub mod chart_step;
pub mod program_step;
pub mod sat;
