//! What names mean in a program: its steps, its own variables, the global ones.

use crate::base::iec::fold;
use crate::ir::iec::{BlockId, Kind, StepId, VarId};
use std::collections::{BTreeMap, BTreeSet};

/// What a name means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A variable of a type that is understood.
    Variable(VarId, Kind),
    /// An instance of a function block that is understood.
    Block(BlockId),
    /// Something of another type, which does no harm as long as nothing uses it.
    Other(String),
}

/// Names of one place, folded.
pub type Names = BTreeMap<String, Symbol>;

/// The global variables.
#[derive(Clone, Debug, Default)]
pub struct Globals {
    /// What they are called.
    pub names: Names,
    /// The names of the lists in which they are declared, folded; CODESYS takes `List.Variable`.
    pub lists: BTreeSet<String>,
}

/// What is seen within one program.
#[derive(Clone, Debug)]
pub struct Scope<'g> {
    /// Its own variables, and the external ones that it declares.
    pub locals: Names,
    /// The global variables, seen without being declared; `None` where they have to be.
    pub globals: Option<&'g Globals>,
    /// Its steps, folded.
    pub steps: BTreeMap<String, StepId>,
}

/// What a path of names means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// A variable of a type that is understood.
    Variable(VarId, Kind),
    /// X of a step.
    StepFlag(StepId),
    /// T of a step.
    StepTime(StepId),
    /// A function block itself.
    Block(BlockId),
    /// An output or input of a function block, folded.
    Pin(BlockId, String),
    /// Something of a type that is not understood.
    Other(String),
}

impl Scope<'_> {
    /// What `path` means, if it is declared.
    pub fn find(&self, path: &[&str]) -> Option<Meaning> {
        match path {
            [name] => Some(match self.symbol(&fold(name))? {
                Symbol::Variable(id, kind) => Meaning::Variable(*id, *kind),
                Symbol::Block(id) => Meaning::Block(*id),
                Symbol::Other(what) => Meaning::Other(what.clone()),
            }),
            [owner, member] => {
                let (owner, member) = (fold(owner), fold(member));
                if let Some(&step) = self.steps.get(&owner) {
                    match member.as_str() {
                        "X" => return Some(Meaning::StepFlag(step)),
                        "T" => return Some(Meaning::StepTime(step)),
                        _ => {}
                    }
                }
                match self.symbol(&owner) {
                    Some(Symbol::Block(id)) => Some(Meaning::Pin(*id, member)),
                    Some(Symbol::Other(what)) => Some(Meaning::Other(what.clone())),
                    Some(Symbol::Variable(..)) => None,
                    None => {
                        let globals = self.globals.filter(|g| g.lists.contains(&owner))?;
                        match globals.names.get(&member)? {
                            Symbol::Variable(id, kind) => Some(Meaning::Variable(*id, *kind)),
                            Symbol::Block(id) => Some(Meaning::Block(*id)),
                            Symbol::Other(what) => Some(Meaning::Other(what.clone())),
                        }
                    }
                }
            }
            _ => None,
        }
    }

    fn symbol(&self, name: &str) -> Option<&Symbol> {
        self.locals.get(name).or_else(|| self.globals?.names.get(name))
    }
}
