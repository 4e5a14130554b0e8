//! What the filter remembers, and the stop of a blocking filter.
//!
//! `Still := Noted and not (Reset and not prev(Reset))` says that what was noted before this scan has not
//! been reset. Unless it holds, `First_C` takes over which constraints act; and `Noted := Still or` any of
//! them. In a blocking filter `Noted` is called `Blocked`. There constraints are held against the commands
//! themselves, before anything else is decided, and commands count only while `Blocked` is FALSE: so the
//! stop is effective in the scan of the violation.

use super::Filter;
use crate::base::Span;
use crate::ir::chart::{Atom, FilterMode};
use crate::ir::expr::Expr;
use crate::ir::ladder::CoilKind;
use crate::ir::plc::{GlobalId, Role};
use crate::lower::context::{Condition, Context, origin};
use crate::lower::rungs::rung;

impl Filter {
    /// Holds the constraints against the commands and lets none of these count while the machine is
    /// stopped.
    pub fn stop(&mut self, context: &mut Context<'_>) {
        let machine = context.machine;
        self.selected = context.commands.iter().copied().map(Some).collect();
        for (id, constraint) in machine.safety.constraints.iter() {
            for product in &constraint.products {
                let violated = self.product(context, product);
                self.alarms[id.index()].push(violated);
            }
        }
        self.selected = vec![None; machine.outputs.len()];
        let acted = self.alarms(context);
        let Some(blocked) = self.remember(context, &acted) else { return };
        for (output, signal) in machine.outputs.iter() {
            let command = Expr::Atom(context.commands[output.index()]);
            let about = (format!("output {}", signal.name), signal.span);
            let text = format!("{} is commanded and the machine is not stopped", signal.name);
            let counts = Expr::all([command, Expr::Atom(blocked).not()]);
            self.taken[output.index()] = self.coil(context, ("Let", &signal.name), Role::Filter, about, text, &counts);
        }
    }

    /// Remembers which constraints acted first, if there is an input that makes the filter forget it; returns
    /// the flag that says that something is noted.
    pub fn remember(&mut self, context: &mut Context<'_>, acted: &[GlobalId]) -> Option<GlobalId> {
        let machine = context.machine;
        let reset = machine.safety.reset?;
        let about = || ("safety filter".to_owned(), machine.safety.span);
        let blocking = machine.safety.mode == Some(FilterMode::Blocking);
        let (name, text) = if blocking {
            ("Blocked", "stopped by a violation, until the reset")
        } else {
            ("Noted", "a constraint has acted since the last reset")
        };
        // Its rung comes last, but the ones before read what it was in the scan before.
        let noted = self.flag(context, name, Role::Noted, about(), text);
        let still = self.flag(context, &format!("Still{name}"), Role::Filter, about(), "and this is not the reset");
        let (now, before) = (context.value(Atom::Input(reset)), context.value(Atom::PrevInput(reset)));
        let rises = Expr::all([now, before.not()]);
        self.write(context, still, &Expr::all([Expr::Atom(noted), rises.not()]));
        for (constraint, &acts) in machine.safety.constraints.values().zip(acted) {
            let about = (format!("constraint {}", constraint.name), constraint.span);
            let text = if constraint.text.is_empty() {
                format!("{} acted first", constraint.name)
            } else {
                format!("first: {}", constraint.text)
            };
            let first = self.flag(context, &format!("First_{}", constraint.name), Role::First, about, &text);
            let stays = Expr::all([Expr::Atom(first), Expr::Atom(still)]);
            let begins = Expr::all([Expr::Atom(acts), Expr::Atom(still).not()]);
            self.write(context, first, &Expr::any([stays, begins]));
        }
        let any = std::iter::once(still).chain(acted.iter().copied()).map(Expr::Atom);
        self.write(context, noted, &Expr::any(any.collect::<Vec<_>>()));
        Some(noted)
    }

    fn flag(
        &mut self,
        context: &mut Context<'_>,
        name: &str,
        role: Role,
        (what, span): (String, Span),
        text: &str,
    ) -> GlobalId {
        let name = context.names.fixed(name);
        context.global(name, role, text.to_owned(), origin(what, span))
    }

    fn write(&mut self, context: &mut Context<'_>, flag: GlobalId, condition: &Condition) {
        let text = context.globals[flag].description.clone();
        rung(context, &mut self.rungs, (flag, CoilKind::Plain), condition, text);
    }
}
