//! What a model says of all runs of its machine, as it is written.

use super::ast::{Guard, Name, Text};

/// `P1: always possible E "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    /// Its name.
    pub name: Name,
    /// In which runs and how often.
    pub kind: PropertyKind,
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
}

impl PropertyKind {
    /// The words of the language.
    pub fn words(self) -> &'static str {
        match self {
            PropertyKind::Never => "never",
            PropertyKind::Always => "always",
            PropertyKind::Reachable => "reachable",
            PropertyKind::AlwaysPossible => "always possible",
        }
    }
}
