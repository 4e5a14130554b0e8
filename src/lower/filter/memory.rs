//! What the filter remembers, and the stop of a blocking filter.
//!
//! `Still := Noted and not (Reset and not prev(Reset))` says that what was noted before this scan has not
//! been reset. Unless it holds, `First_C` takes over which constraints act; and `Noted := Still or` any of
//! them. In a blocking filter `Noted` is called `Blocked`. There constraints are held against the commands
//! themselves, before anything else is decided, and commands count only while `Blocked` is FALSE: so the
//! stop is effective in the scan of the violation.
//!
//! Scans are numbered, and the number of the one in which `Noted` began is kept: `Scan := Scan + 1`, and
//! `First_Scan := if Still then First_Scan else if Noted then Scan else 0`. What a PLC makes of a sum that
//! does not fit is no question, since none is computed: at its end the count goes on from 0.

use super::Filter;
use crate::ir::chart::{Atom, FilterMode, LAST_SCAN};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Operand, Operator};
use crate::ir::number::Relation;
use crate::ir::plc::{Global, GlobalId, Origin, Role, Value};
use crate::lower::context::{Condition, Context};
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
            let text = format!("{} is commanded and the machine is not stopped", signal.name);
            let counts = Expr::all([command, Expr::Atom(blocked).not()]);
            self.taken[output.index()] =
                self.coil(context, ("Let", &signal.name), Role::Filter, Origin::Output(output), text, &counts);
        }
    }

    /// Remembers which constraints acted first, if there is an input that makes the filter forget it; returns
    /// the flag that says that something is noted.
    pub fn remember(&mut self, context: &mut Context<'_>, acted: &[GlobalId]) -> Option<GlobalId> {
        let machine = context.machine;
        let reset = machine.safety.reset?;
        let blocking = machine.safety.mode == Some(FilterMode::Blocking);
        let (name, text) = if blocking {
            ("Blocked", "stopped by a violation, until the reset")
        } else {
            ("Noted", "a constraint has acted since the last reset")
        };
        // Its rung comes last, but the ones before read what it was in the scan before.
        let noted = self.flag(context, name, Role::Noted, Origin::Filter, text);
        let still =
            self.flag(context, &format!("Still{name}"), Role::Filter, Origin::Filter, "and this is not the reset");
        let (now, before) = (context.value(Atom::Input(reset)), context.value(Atom::PrevInput(reset)));
        let rises = Expr::all([now, before.not()]);
        self.write(context, still, &Expr::all([Expr::Atom(noted), rises.not()]));
        for ((id, constraint), &acts) in machine.safety.constraints.iter().zip(acted) {
            let text = if constraint.text.is_empty() {
                format!("{} acted first", constraint.name)
            } else {
                format!("first: {}", constraint.text)
            };
            let first =
                self.flag(context, &format!("First_{}", constraint.name), Role::First, Origin::Constraint(id), &text);
            let stays = Expr::all([Expr::Atom(first), Expr::Atom(still)]);
            let begins = Expr::all([Expr::Atom(acts), Expr::Atom(still).not()]);
            self.write(context, first, &Expr::any([stays, begins]));
        }
        let any = std::iter::once(still).chain(acted.iter().copied()).map(Expr::Atom);
        self.write(context, noted, &Expr::any(any.collect::<Vec<_>>()));
        self.number(context, noted, still);
        Some(noted)
    }

    /// Numbers the scans and keeps the number of the one in which `noted` began.
    fn number(&mut self, context: &mut Context<'_>, noted: GlobalId, still: GlobalId) {
        let (this, first) = ("number of this scan since power-up", "number of the scan of the first violation, or 0");
        let end = "the count of scans is at its end";
        let scan = self.count(context, "Scan", Role::Scan, this);
        let base = self.count(context, "Scan_Before", Role::Interim, "number of the scan before");
        let now = self.count(context, "Scan_Noted", Role::Interim, "number of this scan if something is noted");
        let kept = self.count(context, "First_Scan", Role::FirstScan, first);
        let full = self.flag(context, "Scan_Ends", Role::Filter, Origin::Filter, end);
        let (of, constant) = (Operand::Global, Operand::Const);
        let mut compute = |operator, operands, coil: GlobalId| {
            let text = context.globals[coil].description.clone();
            context.function(&mut self.rungs, operator, operands, coil, text);
        };
        compute(Operator::Compare(Relation::Equal), vec![of(scan), constant(i64::from(LAST_SCAN))], full);
        compute(Operator::Select, vec![of(full), of(scan), constant(0)], base);
        compute(Operator::Add, vec![of(base), constant(1)], scan);
        compute(Operator::Select, vec![of(noted), constant(0), of(scan)], now);
        compute(Operator::Select, vec![of(still), of(now), of(kept)], kept);
    }

    /// A number of a scan.
    fn count(&mut self, context: &mut Context<'_>, name: &str, role: Role, text: &str) -> GlobalId {
        let name = context.names.fixed(name);
        let (origin, description) = (Origin::Filter, text.to_owned());
        context.globals.push(Global { name, address: None, initial: Value::Udint(0), role, description, origin })
    }

    fn flag(&mut self, context: &mut Context<'_>, name: &str, role: Role, origin: Origin, text: &str) -> GlobalId {
        let name = context.names.fixed(name);
        context.global(name, role, text.to_owned(), origin)
    }

    fn write(&mut self, context: &mut Context<'_>, flag: GlobalId, condition: &Condition) {
        let text = context.globals[flag].description.clone();
        rung(context, &mut self.rungs, (flag, CoilKind::Plain), condition, text);
    }
}
