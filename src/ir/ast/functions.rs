//! Functions and sequences of them, as they are written.

use super::{Body, Duration, Guard, Name, Text};
use crate::base::Span;

/// `function F23 automatic "go up" { activate when … deactivate when … drives … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name.
    pub name: Name,
    /// `automatic`, where it stands.
    pub automatic: Option<Span>,
    /// What it does.
    pub description: Option<Text>,
    /// `activate when …`, every one that was written.
    pub activate: Vec<Guard>,
    /// `deactivate when …`, likewise.
    pub deactivate: Vec<Guard>,
    /// `abort when …`, likewise.
    pub abort: Vec<Guard>,
    /// `request when …`, likewise.
    pub request: Vec<Guard>,
    /// `release when …`, likewise.
    pub release: Vec<Guard>,
    /// What else stands between its braces: what happens while it runs.
    pub body: Body,
}

/// `sequence Bottling "…" { abort when … do F23 … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    /// Its name.
    pub name: Name,
    /// What it is for.
    pub description: Option<Text>,
    /// `abort when …`, every one that was written.
    pub abort: Vec<Guard>,
    /// What is done, in order.
    pub steps: Vec<SequenceStep>,
}

/// One line of a sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SequenceStep {
    /// What is done.
    pub doing: SequenceDoing,
    /// All of it.
    pub span: Span,
    /// Why.
    pub description: Option<Text>,
}

/// What a line of a sequence does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SequenceDoing {
    /// `do F23, F11`: runs functions side by side until all have ended.
    Do(Vec<Job>),
    /// `activate F251`.
    Activate(Vec<Name>),
    /// `deactivate F251`.
    Deactivate(Vec<Name>),
    /// `wait until …`.
    Until(Guard),
    /// `wait 500ms`.
    Wait(Duration),
}

/// `F21 until Out2`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// The function.
    pub function: Name,
    /// When it is to be deactivated.
    pub until: Option<Guard>,
}
