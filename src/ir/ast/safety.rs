//! What must never be, and what that is derived from.

use super::{Guard, Name, Text};
use crate::base::Span;

/// What a bistable actuator does when neither of its outputs is TRUE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Valve {
    /// `closed-centre`: it stands where it is.
    ClosedCentre,
    /// `memory`: it goes on by its last order.
    Memory,
}

/// `safety supervisor relief in-order reset by Ack { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Safety {
    /// `supervisor`, where it stands.
    pub mode: Name,
    /// `relief in-order`, where it stands.
    pub in_order: Option<Span>,
    /// `reset by …`.
    pub reset: Option<Name>,
    /// The constraints in order.
    pub constraints: Vec<Constraint>,
    /// The assumptions in order.
    pub assumptions: Vec<Constraint>,
    /// What is forbidden, in order.
    pub forbids: Vec<Forbid>,
    /// What is to be derived, in order.
    pub derives: Vec<Derive>,
    /// What was forbidden and has left no constraint, once constraints have been derived; none before.
    pub unkept: Vec<Forbid>,
}

/// `S1: never OHC and not V0 yields … "…"`, or `assume never …`, which nobody yields to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constraint {
    /// Its name.
    pub name: Name,
    /// What must never be TRUE.
    pub never: Guard,
    /// Who gives way.
    pub yields: Vec<Name>,
    /// Why, in words for the operator.
    pub text: Option<Text>,
    /// The actuators and forbidden positions that it is derived from; none if it is written.
    pub from: Vec<Name>,
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
