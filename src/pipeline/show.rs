//! Text to any stage on its way to a program, as text for people.

use super::front::front;
use crate::base::{Diagnostics, LineIndex};
use crate::emit::names;
use crate::ir::{outline, source, text};
use crate::{lower, parse};

/// A stage that can be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The text as it was understood, with the compiler's own spacing.
    Tree,
    /// The machine once all names are resolved, constraints derived and actuators' laws worked out.
    Chart,
    /// The SFC programs.
    Sfc,
    /// The ladder programs.
    Ladder,
    /// The table of what each name in the PLC project stands for.
    Names,
}

impl Stage {
    /// All of them, in the order in which a model passes through them.
    pub const ALL: [Stage; 5] = [Stage::Tree, Stage::Chart, Stage::Sfc, Stage::Ladder, Stage::Names];
}

/// Text to a stage of it. Nothing if the model has errors that keep it from getting there: a tree needs a text that
/// can be parsed, a chart names that can be resolved, all others a model that keeps every rule.
pub fn show(text: &str, stage: Stage) -> (Option<String>, Diagnostics) {
    match stage {
        Stage::Tree => {
            let (tree, diagnostics) = parse::parse(text);
            let tree = tree.filter(|_| !diagnostics.has_errors());
            (tree.map(|tree| source::source(&tree)), diagnostics)
        }
        Stage::Chart => {
            let reached = front(text, |_| Diagnostics::new());
            let machine = reached.machine.filter(|_| !reached.resolving.has_errors());
            (machine.map(|machine| outline::outline(&machine)), super::front::all(reached.resolving, reached.checking))
        }
        Stage::Sfc | Stage::Ladder | Stage::Names => {
            let (machine, diagnostics) = front(text, |_| Diagnostics::new()).whole();
            let shown = machine.map(|machine| {
                let project = lower::lower(&machine);
                match stage {
                    Stage::Sfc => text::sfc(&project),
                    Stage::Ladder => text::ladder(&project),
                    _ => names::table(&project, &machine, &LineIndex::new(text)),
                }
            });
            (shown, diagnostics)
        }
    }
}
