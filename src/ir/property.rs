//! What a model says of all runs of its machine, as it is written.

use super::ast::{Guard, Name, Path, Target, Text};
use crate::base::Span;

/// `P1: always possible E "…"`, `P2: after E eventually E "…"`, `assume F1: always eventually E "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    /// Its name.
    pub name: Name,
    /// In which runs and how often.
    pub kind: PropertyKind,
    /// After what, if it says so.
    pub after: Option<Guard>,
    /// What, at the end of a scan.
    pub condition: Guard,
    /// Why, in words.
    pub text: Option<Text>,
}

/// In which runs, and how often, a property's condition holds at the end of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PropertyKind {
    /// In no scan of any run.
    Never,
    /// In all scans of all runs.
    Always,
    /// In a scan of a run.
    Reachable,
    /// Every run can go on to a scan in which it does.
    AlwaysPossible,
    /// In every fair run that goes on for ever: in infinitely many scans, or, if it says after what, in that scan
    /// or a later one.
    Eventually,
    /// In infinitely many scans of every fair run: that is what makes it fair.
    Fair,
}

impl PropertyKind {
    /// The words of the language.
    pub fn words(self) -> &'static str {
        match self {
            PropertyKind::Never => "never",
            PropertyKind::Always => "always",
            PropertyKind::Reachable => "reachable",
            PropertyKind::AlwaysPossible => "always possible",
            PropertyKind::Eventually | PropertyKind::Fair => "always eventually",
        }
    }
}

/// `accept silent from Off to On "…"`: a finding of verification, or a warning, that is meant so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Acceptance {
    /// What is accepted.
    pub finding: Accepted,
    /// All of it but the reason, as it is written.
    pub written: String,
    /// Why.
    pub reason: Text,
    /// From `accept` to the end of the reason.
    pub span: Span,
}

/// A finding or a warning by what it speaks of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Accepted {
    /// `unreachable S`.
    Unreachable(Path),
    /// `silent from A to B`.
    Silent(Leads),
    /// `overlap from A to B and from A to C`.
    Overlap(Leads, Leads),
    /// `saturates N`.
    Saturates(Name),
    /// `acts C`.
    Acts(Name),
    /// `void P`.
    Void(Name),
    /// `unused X`.
    Unused(Name),
    /// `cyclic C, D`.
    Cyclic(Vec<Name>),
}

/// `from A to B number 2`, `internal of A`: a transition by its ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leads {
    /// The state that it leaves.
    pub source: Path,
    /// Where it leads; nothing for an internal one.
    pub target: Option<Target>,
    /// Which of those with these ends, counted from 1; nothing if it is not said, or no number that there can be.
    pub number: Option<(Option<u32>, Span)>,
    /// Where.
    pub span: Span,
}
