//! Boolean functions as graphs and questions about them: the one bit-level form of machines and
//! programs, which proof, verification and analysis of constraints share.

pub mod aig;
pub mod random;
pub mod sat;
pub mod vector;
