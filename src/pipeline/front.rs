//! Text to a machine: the stages in front of every program, in their order.

use crate::base::Diagnostics;
use crate::ir::ast;
use crate::ir::chart::Machine;
use crate::{check, derive, parse, resolve};

/// What a text has come to.
pub struct Front {
    /// The machine as its names resolve, whether or not it keeps the rules; nothing if the text cannot be parsed.
    pub machine: Option<Machine>,
    /// What there was to say up to there.
    pub resolving: Diagnostics,
    /// What there is to say about the rules; they are asked for only where nothing is wrong before.
    pub checking: Diagnostics,
}

/// Text to what becomes of it; `change` may take something out of the tree once all is derived, or say why it cannot.
pub fn front(source: &str, change: impl FnOnce(&mut ast::Machine) -> Diagnostics) -> Front {
    let (tree, mut resolving) = parse::parse(source);
    let mut checking = Diagnostics::new();
    let machine = tree.map(|mut tree| {
        resolving.append(derive::expand(&mut tree));
        resolving.append(change(&mut tree));
        let (mut machine, found) = resolve::resolve(&tree);
        resolving.append(found);
        if !resolving.has_errors() {
            checking = check::check(&mut machine);
        }
        machine
    });
    Front { machine, resolving, checking }
}

impl Front {
    /// The machine, if it keeps every rule, and all there is to say.
    pub fn whole(self) -> (Option<Machine>, Diagnostics) {
        let (machine, diagnostics) = (self.machine, all(self.resolving, self.checking));
        (machine.filter(|_| !diagnostics.has_errors()), diagnostics)
    }
}

/// What two parts of the stages have to say, in the order of the text.
pub fn all(mut first: Diagnostics, second: Diagnostics) -> Diagnostics {
    first.append(second);
    first.sort();
    first
}
