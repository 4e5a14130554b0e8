//! What reading one program adds to a project.

use super::Problem;
use super::scope::Scope;
use super::st::{self, Fail, Value};
use super::xml::{self, Family, Node};
use crate::base::{Arena, Diagnostics};
use crate::ir::iec::{Block, BlockId, BlockKind, Kind, Scope as Place, VarId, Variable};

/// The surroundings in which a body is read.
pub struct Context<'c, 'g> {
    /// Whose conventions the file keeps to.
    pub family: Family,
    /// What names mean.
    pub scope: Scope<'g>,
    /// The program's own place, for blocks that no one declares.
    pub place: Place,
    /// All variables of the project.
    pub variables: &'c Arena<Variable>,
    /// All blocks of the project.
    pub blocks: &'c mut Arena<Block>,
    /// What is wrong so far.
    pub problems: &'c mut Diagnostics,
}

impl Context<'_, '_> {
    /// Notes a problem.
    pub fn report(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// The type of a variable.
    pub fn kind(&self, variable: VarId) -> Kind {
        self.variables[variable].kind
    }

    /// A block that stands for an edge contact or edge coil.
    pub fn trigger(&mut self, rising: bool) -> BlockId {
        let kind = if rising { BlockKind::RTrig } else { BlockKind::FTrig };
        self.blocks.push(Block { name: String::new(), scope: self.place, kind })
    }

    /// The value of an expression that stands at `node`.
    pub fn expression(&self, text: &str, node: Node<'_>) -> Result<(Value, st::Binding), Problem> {
        st::expression(text, &self.scope, self.blocks).map_err(|fail| broken(fail, text, node))
    }
}

/// A problem with a text at `node`.
pub fn broken(fail: Fail, text: &str, node: Node<'_>) -> Problem {
    let shown: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let shown = match shown.char_indices().nth(80) {
        Some((end, _)) => format!("{}…", &shown[..end]),
        None => shown,
    };
    let mut problem = xml::problem(fail.code, fail.message, node);
    if let Some(label) = problem.labels.first_mut() {
        label.text = format!("in `{shown}`");
    }
    problem
}
