//! Scenarios as they are written.

use super::{Guard, Name, Text, Time};
use crate::base::Span;

/// `scenario "name" after "other" { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenario {
    /// Its name.
    pub name: Text,
    /// The scenario that is played before.
    pub after: Option<Text>,
    /// What is done, in order.
    pub steps: Vec<Step>,
}

/// One line of a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// What is done.
    pub doing: Doing,
    /// All of it, the text behind it left out.
    pub span: Span,
    /// The text behind it.
    pub description: Option<Text>,
}

/// What a line of a scenario does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doing {
    /// `set A, B` or `reset A, B`.
    Set(Vec<Name>, bool),
    /// `any A, B`, only where a plant begins.
    Any(Vec<Name>),
    /// `press A, B for 300ms`.
    Press(Vec<Name>, Option<Time>),
    /// `force A, not B`: each name with its value.
    Force(Vec<(Name, bool)>),
    /// `release A, B`.
    Release(Vec<Name>),
    /// `place Vertical at Down`.
    Place(Name, Name),
    /// `happens "…"`, with whether `before writing`; nothing for `happens nothing`.
    Happens(Option<Text>, bool),
    /// `wait 100ms`.
    Wait(Time),
    /// `wait until … within 2s`.
    Until(Guard, Time),
    /// `expect …`.
    Expect(Guard),
    /// `always …` (TRUE) or `never …` (FALSE).
    Watch(Guard, bool),
    /// `repeat 3 { … }`; nothing when the number does not fit.
    Repeat(Option<u32>, Span, Vec<Step>),
}
