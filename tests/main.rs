//! The tests that use only the public interface, in one binary.

mod cli;
mod constraints;
mod docs;
mod emit;
mod explain;
mod filters;
mod indexa_by_chance;
mod invalid;
mod layers;
mod layout;
mod licences;
mod mutants;
mod never_entered;
mod program_mutants;
mod prove;
mod random_models;
mod reading;
mod regressions;
mod scans;
mod scenarios;
mod simulate_chart;
mod snapshots;
mod stability;
mod support;
mod text;
