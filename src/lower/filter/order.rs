//! Sweeps of `relief in-order` (the paper on ITS PLC): combined products in the order in which they are written, each
//! relieved at once.
//!
//! Every relief gives its output a new selection coil, which all that comes after it reads:
//! `not (Hit and not On) and Sel` for one that goes off, `Hit and not Off or Sel` for one that goes on. So
//! every coil is written by one rung.

use super::Filter;
use crate::ir::chart::Atom;
use crate::ir::expr::Expr;
use crate::ir::plc::{Origin, Role};
use crate::ir::relief::Reliefs;
use crate::lower::context::Context;

impl Filter {
    /// One sweep over all combined products.
    pub fn sweep(&mut self, context: &mut Context<'_>, reliefs: &Reliefs, sweep: usize) {
        let machine = context.machine;
        for (c, path) in reliefs.combined.iter().zip(Self::paths(context, reliefs)) {
            let constraint = &machine.safety.constraints[c.constraint];
            for literal in c.product.literals() {
                if let Atom::Output(o) = literal.atom {
                    self.select(context, o, sweep);
                }
            }
            let violated = self.product(context, &c.product);
            let text = format!("{} is violated in sweep {}", constraint.name, sweep + 1);
            let word = format!("Hit{}", sweep + 1);
            let hit =
                self.coil(context, (&word, &path), Role::Filter, Origin::Constraint(c.constraint), text, &violated);
            self.alarms[c.constraint.index()].push(Expr::Atom(hit));
            for &(output, value) in &c.reliefs {
                let (i, name) = (output.index(), &machine.outputs[output].name);
                let selected = Expr::Atom(self.selected[i].expect("outputs of a product are selected first"));
                let held = if value { self.off[i] } else { self.on[i] };
                let changes = Expr::all([Expr::Atom(hit), held.map_or(Expr::FALSE, Expr::Atom).not()]);
                let condition =
                    if value { Expr::any([selected, changes]) } else { Expr::all([selected, changes.not()]) };
                let text = format!("{name} after {} in sweep {}", constraint.name, sweep + 1);
                let names = (&*format!("Sel{}", sweep + 1), &*format!("{name}_{path}"));
                let coil = self.coil(context, names, Role::Filter, Origin::Constraint(c.constraint), text, &condition);
                self.selected[i] = Some(coil);
            }
        }
    }
}
