//! The tests that use only the public interface, in one binary.

mod emit;
mod layers;
mod layout;
mod snapshots;
mod stability;
mod support;
mod text;
