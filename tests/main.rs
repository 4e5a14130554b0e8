//! The tests that use only the public interface, in one binary.

mod cli;
mod docs;
mod emit;
mod explain;
mod invalid;
mod layers;
mod layout;
mod licences;
mod mutants;
mod reading;
mod scans;
mod snapshots;
mod stability;
mod support;
mod text;
