//! The tests that use only the public interface, in one binary.

mod cli;
mod emit;
mod explain;
mod invalid;
mod layout;
mod mutants;
mod support;
mod text;
