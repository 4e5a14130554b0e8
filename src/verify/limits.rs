//! How much an engine may spend.

use std::fmt;

/// Asked now and then whether to stop. The engines know no clock: who has one looks at it here.
pub type Stop<'a> = &'a dyn Fn() -> bool;

/// What the engines may spend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Nodes of decision diagrams that there may be at once; some 25 bytes each.
    pub nodes: usize,
    /// Operations on decision diagrams, where others may still find an answer; millions a second.
    pub steps: u64,
    /// Scans that a bounded search looks ahead.
    pub scans: usize,
    /// Conflicts of the SAT solver for one claim and engine.
    pub conflicts: u64,
    /// Conflicts for a proof of all claims together, before anything else is tried; without any there is none. Where little is
    /// remembered and much comes in, it is soon found.
    pub at_first: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { nodes: 4_000_000, steps: 8_000_000, scans: 100, conflicts: 200_000, at_first: 0 }
    }
}

/// Why an engine gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The diagrams would need more nodes than there may be.
    Nodes,
    /// The diagrams took as many operations as they may.
    Steps,
    /// The search looked as far ahead as it may.
    Scans,
    /// The solver met as many conflicts as it may.
    Conflicts,
    /// No plans were found that lead from every state to what should stay possible.
    Plans,
    /// It was told to stop.
    Stopped,
    /// It was told to stop by a person, before the time was up.
    Interrupted,
    /// It was told to stop when it knew that there is a run, and had not found it again.
    Unshown,
    /// No engine that was left answers such a question.
    Kind,
    /// A run was found that the system does not do: a fault of the engine.
    Replay,
    /// A proof was found that is none: a fault of the engine.
    Certificate,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Limit::Nodes => "the set of reachable states needs more memory than is allowed",
            Limit::Steps => "the set of reachable states takes too long",
            Limit::Scans => "nothing was found within the scans that are looked ahead",
            Limit::Conflicts => "the solver gave up",
            Limit::Plans => "no few ways were found that always lead there",
            Limit::Stopped => "the time was up",
            Limit::Interrupted => "interrupted",
            Limit::Unshown => "there is a run, but the search ended before it could be shown",
            Limit::Kind => "only the exact set of reachable states would tell",
            Limit::Replay => "a run was found that cannot be replayed; please report this",
            Limit::Certificate => "a proof was found that cannot be checked; please report this",
        })
    }
}
