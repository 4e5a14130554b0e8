//! The tests that use only the public interface, in one binary.

mod emit;
mod layout;
mod random_models;
mod support;
mod text;
