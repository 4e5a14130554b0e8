//! Where transitions start and where they lead, as it is written.

use super::{Effect, Guard, Name, Path, Text};
use crate::base::Span;

/// Where a transition starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// One state.
    State(Path),
    /// `any except A, B`: each other state of the region in which it is written.
    Any {
        /// The states that are left out.
        except: Vec<Path>,
        /// The word `any`.
        span: Span,
    },
    /// Join: all of these states together.
    Join(Vec<Path>),
}

/// Where a transition or a branch leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A state or a choice.
    State(Path),
    /// `history of S` or `deep history of S`.
    History {
        /// The state.
        of: Path,
        /// Whether `deep` stands before it.
        deep: bool,
    },
    /// Fork: all of these states together.
    Fork(Vec<Path>),
}

impl Target {
    /// From the first word of its paths to the last.
    pub fn span(&self) -> Span {
        match self {
            Target::State(path) | Target::History { of: path, .. } => path.span(),
            Target::Fork(paths) => paths[0].span().to(paths[paths.len() - 1].span()),
        }
    }
}

/// `initial choice NAME "…" { when G to A  else to B }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The choice's name.
    pub name: Name,
    /// `initial`, where it stands.
    pub initial: Option<Span>,
    /// What it decides.
    pub description: Option<Text>,
    /// Its branches in order.
    pub branches: Vec<Branch>,
}

/// `when G to A then set V "…"` or `else to A …`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Branch {
    /// Its condition; nothing for `else`.
    pub guard: Option<Guard>,
    /// Where it leads.
    pub target: Target,
    /// `then …`.
    pub effects: Vec<Effect>,
    /// Why it is there.
    pub description: Option<Text>,
    /// All of it.
    pub span: Span,
}
