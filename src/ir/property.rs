//! What a model says of all runs of its machine, as it is written.

use super::ast::{Guard, Name, Text};

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
