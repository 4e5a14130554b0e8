//! What constraints are derived from, and which.

use super::{Name, Text};
use crate::base::Span;

/// What a bistable actuator does when neither of its outputs is TRUE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Valve {
    /// `closed-centre`: it stands where it is.
    ClosedCentre,
    /// `memory`: it goes on by its last order.
    Memory,
}

/// `F1: forbid Horizontal between unless Vertical at Up "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Forbid {
    /// Its name.
    pub name: Name,
    /// Where one actuator must not be …
    pub first: Place,
    /// … unless (TRUE) or while (FALSE) …
    pub unless: bool,
    /// … another one is here.
    pub second: Place,
    /// Why.
    pub text: Option<Text>,
}

/// `Vertical at Up`, or `Vertical between`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The actuator.
    pub actuator: Name,
    /// Its position; nothing for `between`.
    pub position: Option<Name>,
}

/// `derive all by edges except End_OHC`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Derive {
    /// What it is derived from, or single constraints; none for `all`.
    pub names: Vec<Name>,
    /// `by edges`, where it stands.
    pub edges: Option<Span>,
    /// What is left out.
    pub except: Vec<Name>,
    /// All of it.
    pub span: Span,
}
