//! Bodies of programs to drawings: an SFC or a ladder to places on an integer grid.
//!
//! All exporters share these drawings, so that what one IDE shows is what every other form shows.
//! Integers make them the same on every machine.

pub mod ladder;
pub mod sfc;

use crate::ir::drawing::CHAR;

/// How an SFC is taken apart into a tree; PLC IDEs differ in what they read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// A branch that does not continue ends in a jump. Each step has at most one divergence; there
    /// are no convergences.
    Jumps,
    /// Strictly nested blocks: each divergence has its convergence, and one jump ends the body. A
    /// branch that jumps away is an input of the convergence nevertheless.
    Balanced,
}

/// How the parallel branches of a rung are drawn; PLC IDEs differ in what they read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branches {
    /// As they are.
    AsWritten,
    /// All single contacts or all series: a single contact beside a series is drawn twice.
    EqualShape,
}

/// Distance from the edge of the page.
const MARGIN: i32 = 40;

/// The width of a name or an expression: text of ASCII only.
fn text_width(text: &str) -> i32 {
    debug_assert!(text.is_ascii());
    i32::try_from(text.len()).expect("names and expressions are shorter than a source file") * CHAR
}
