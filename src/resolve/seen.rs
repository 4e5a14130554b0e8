//! Conditions, names and times of plants and scenarios to what they mean.

use super::Resolver;
use super::expressions::Context;
use super::names::Symbol;
use crate::base::{Code, Diagnostic, Span, iec, limits};
use crate::ir::ast::{self, PathRef, Term, TimeUnit};
use crate::ir::chart::{ActuatorId, Atom, ConstraintId, FilterMode, Mark};
use crate::ir::expr::Expr;
use crate::ir::scenario::{BitId, Condition, Given, Seen};

impl Resolver {
    /// Resolves a condition; what cannot be resolved is reported and reads FALSE.
    pub fn condition(&mut self, guard: &ast::Guard, context: &Context) -> Condition {
        guard.expr.map(&mut |term| self.seen(term, context))
    }

    fn seen(&mut self, term: &Term, context: &Context) -> Condition {
        let now = |b| Expr::Atom(Seen::Bit(b));
        let before = |b| Expr::Atom(Seen::PrevBit(b));
        match term {
            Term::Value(path) if self.bit(path).is_some() => self.bit(path).map_or(Expr::FALSE, now),
            Term::Prev(path) if self.bit(path).is_some() => self.bit(path).map_or(Expr::FALSE, before),
            Term::Rise(path) if self.bit(path).is_some() => {
                self.bit(path).map_or(Expr::FALSE, |b| Expr::all([before(b).not(), now(b)]))
            }
            Term::Fall(path) if self.bit(path).is_some() => {
                self.bit(path).map_or(Expr::FALSE, |b| Expr::all([before(b), now(b).not()]))
            }
            Term::PrevIn(path) | Term::RiseIn(path) | Term::FallIn(path) if matches!(context, Context::Expectation) => {
                self.past_of_state(term, path, context)
            }
            Term::Alarm(path) if matches!(context, Context::Expectation) => self.alarm(path),
            Term::Acts(path) if matches!(context, Context::Expectation) => self.acts(path),
            Term::First(path) if matches!(context, Context::Expectation) => self.first(path),
            Term::Blocked(span) if matches!(context, Context::Expectation) => self.blocked(*span),
            Term::Compare(comparison, span)
                if matches!(context, Context::Plant | Context::Expectation) && self.compares_hidden(comparison) =>
            {
                self.compare_hidden(comparison, *span, context)
            }
            Term::Value(_)
            | Term::Compare(..)
            | Term::Prev(_)
            | Term::Rise(_)
            | Term::Fall(_)
            | Term::In(_)
            | Term::PrevIn(_)
            | Term::RiseIn(_)
            | Term::FallIn(_)
            | Term::DoneOf(_)
            | Term::Done(_)
            | Term::Alarm(_)
            | Term::Acts(_)
            | Term::First(_)
            | Term::Blocked(_)
            | Term::After(_) => self.term(term, context).map(&mut |atom| Expr::Atom(Seen::Machine(*atom))),
        }
    }

    /// What a state was in the scan before, or its edge.
    fn past_of_state(&mut self, term: &Term, path: &PathRef, context: &Context) -> Condition {
        let state = self.about_state(path, context, Atom::In);
        let now = state.map(&mut |atom| Expr::Atom(Seen::Machine(*atom)));
        let before = state.map(&mut |atom| match *atom {
            Atom::In(s) => Expr::Atom(Seen::PrevIn(s)),
            other => Expr::Atom(Seen::Machine(other)),
        });
        match term {
            Term::RiseIn(_) => Expr::all([before.not(), now]),
            Term::FallIn(_) => Expr::all([before, now.not()]),
            _ => before,
        }
    }

    /// The hidden bit that a path means, if it means one.
    fn bit(&self, path: &PathRef) -> Option<BitId> {
        match (path.parts.as_slice(), self.symbol(&path.parts[0].0)) {
            ([_], Some(Symbol::Bit(id))) => Some(id),
            _ => None,
        }
    }

    fn alarm(&mut self, path: &PathRef) -> Condition {
        let name = dotted(path);
        let folded = iec::fold(&name);
        let safety = &self.machine.safety;
        if let Some(i) = safety.assumptions.iter().position(|a| iec::fold(&a.name) == folded) {
            return Expr::Atom(Seen::Broken(i));
        }
        match self.constraint(path, "`alarm` asks for a constraint or an assumption of the safety part") {
            Some(_) if !self.machine.safety.alarms() => {
                self.misplaced(
                    &format!("`{name}` raises no alarm"),
                    path.span(),
                    "to a controller a correction is normal",
                    &format!("to ask whether it corrects, write `acts({name})`"),
                );
                Expr::FALSE
            }
            Some(id) => Expr::Atom(Seen::Acted(id)),
            None => Expr::FALSE,
        }
    }

    fn acts(&mut self, path: &PathRef) -> Condition {
        let id = self.constraint(path, "`acts` asks for a constraint of the safety part");
        id.map_or(Expr::FALSE, |id| Expr::Atom(Seen::Acted(id)))
    }

    fn first(&mut self, path: &PathRef) -> Condition {
        let id = self.constraint(path, "`first` asks for a constraint of the safety part");
        if id.is_some() && self.machine.safety.reset.is_none() {
            self.misplaced(
                "which constraint acted first is not remembered",
                path.span(),
                "nothing would make the filter forget it",
                "name an input that does: `safety supervisor reset by Acknowledge { … }`",
            );
            return Expr::FALSE;
        }
        id.map_or(Expr::FALSE, |id| Expr::Atom(Seen::Mark(Mark::First(id))))
    }

    fn blocked(&mut self, span: Span) -> Condition {
        if self.machine.safety.mode == Some(FilterMode::Blocking) {
            return Expr::Atom(Seen::Mark(Mark::Noted));
        }
        self.misplaced(
            "this machine is never blocked",
            span,
            "only a blocking filter stops it",
            "write `safety blocking reset by INPUT { … }`",
        );
        Expr::FALSE
    }

    /// The constraint that a path means; reports one that means none.
    fn constraint(&mut self, path: &PathRef, help: &str) -> Option<ConstraintId> {
        let name = dotted(path);
        let folded = iec::fold(&name);
        let found = self.machine.safety.constraints.iter().find(|(_, c)| iec::fold(&c.name) == folded);
        let found = found.map(|(id, _)| id);
        if found.is_none() {
            self.diagnostics.push(
                Diagnostic::new(Code::UnknownName, format!("there is no constraint `{name}`"))
                    .label(path.span(), "not declared")
                    .help(help),
            );
        }
        found
    }

    /// The input or hidden bit of that name, or an error.
    pub fn given(&mut self, name: &ast::Name) -> Option<Given> {
        match self.symbol(&name.text) {
            Some(Symbol::Input(id)) => Some(Given::Input(id)),
            Some(Symbol::Bit(id)) => Some(Given::Bit(id)),
            other => {
                self.wrong_symbol(name, other, "an input or hidden bit");
                None
            }
        }
    }

    /// The actuator and the index of its position, or an error.
    pub fn place(&mut self, actuator: &ast::Name, position: &ast::Name) -> Option<(ActuatorId, usize)> {
        let id = self.actuator(actuator)?;
        let folded = iec::fold(&position.text);
        let positions = &self.machine.actuators[id].positions;
        let found = positions.iter().position(|p| iec::fold(&p.name) == folded);
        if found.is_none() {
            let names: Vec<String> = positions.iter().map(|p| format!("`{}`", p.name)).collect();
            self.diagnostics.push(
                Diagnostic::new(Code::UnknownName, format!("`{}` has no position `{}`", actuator.text, position.text))
                    .label(position.span, "not declared there")
                    .help(format!("it has {}", names.join(" and "))),
            );
        } else if self.machine.plant.travels.iter().all(|t| t.actuator != id) {
            self.diagnostics.push(
                Diagnostic::new(Code::CannotTravel, format!("`{}` does not travel in the plant", actuator.text))
                    .label(actuator.span, "it is nowhere")
                    .help(format!("say in the plant how long it takes: `{} travels 300ms`", actuator.text)),
            );
            return None;
        }
        Some((id, found?))
    }

    /// A time in scans, rounded up; what is out of range is reported and reads as the least.
    pub fn scans(&mut self, time: &ast::Time, least: u32) -> u32 {
        let scans = time.value.map(|value| match time.unit {
            TimeUnit::Milliseconds => value.div_ceil(self.machine.cycle.max(1)),
            TimeUnit::Scans => value,
        });
        match scans {
            Some(n) if (least..=limits::SCENARIO_SCANS).contains(&n) => n,
            Some(n) => {
                let what = if n < least {
                    "this takes at least a scan".to_owned()
                } else {
                    format!("a time is at most {} scans", limits::SCENARIO_SCANS)
                };
                self.bad_time(&what, time.span);
                least
            }
            None => {
                self.bad_time("this is more than any time can be", time.span);
                least
            }
        }
    }

    /// Reports a time or a number of repetitions.
    pub fn bad_time(&mut self, what: &str, span: crate::base::Span) {
        self.diagnostics.push(Diagnostic::new(Code::BadScans, what).label(span, "out of range"));
    }
}

fn dotted(path: &PathRef) -> String {
    path.parts.iter().map(|p| p.0.as_str()).collect::<Vec<_>>().join(".")
}
