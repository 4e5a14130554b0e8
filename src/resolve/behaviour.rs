//! Written drives and actions to those of states, after the drives that technology demands; what happens
//! when something is entered, left or fires.

use super::expressions::Context;
use super::{ResolvedBody, Resolver};
use crate::base::{Code, Diagnostic};
use crate::ir::chart::{self, StateKind, Technology};
use crate::ir::{ast, expr::Expr};

pub fn resolve(r: &mut Resolver, bodies: &[ResolvedBody<'_>]) {
    technology(r);
    for body in bodies {
        let Some(state) = body.state else { continue };
        let context = Context::Active { braces: body.braces() };
        if r.machine.observes(state) {
            let drives = body.body.drives.first().map(|d| (d.output.span, "this state drives an output"));
            let acts = body.body.actions.first();
            let acts = acts.map(|a| (a.variable.span, "this state acts in each scan in which it is active"));
            for (span, what) in drives.into_iter().chain(acts) {
                r.observes_only(span, what);
            }
        }
        for written in &body.body.drives {
            let condition = condition(r, &written.condition, &context);
            if let Some(output) = r.output(&written.output) {
                let drive = chart::Drive { output, condition, technology: false, span: written.output.span };
                r.machine.states[state].drives.push(drive);
            }
        }
        for written in &body.body.actions {
            let condition = condition(r, &written.condition, &context);
            if r.wants_number(&written.variable) {
                continue;
            }
            if let Some(variable) = r.variable(&written.variable) {
                let action = chart::Action { variable, value: written.value, condition, span: written.variable.span };
                r.machine.states[state].actions.push(action);
            }
        }
        let (entry, exit) = (r.deeds(&body.body.entry, "this entry"), r.deeds(&body.body.exit, "this exit"));
        r.machine.states[state].entry = entry;
        r.machine.states[state].exit = exit;
    }
}

impl Resolver {
    /// What happens once; `what` says in a message what it belongs to.
    pub fn deeds<'e>(&mut self, written: impl IntoIterator<Item = &'e ast::Effect>, what: &str) -> chart::Deeds {
        let mut deeds = chart::Deeds::default();
        for effect in written {
            match &effect.value {
                ast::EffectValue::Bool(value) => self.set(&effect.variable, *value, what, &mut deeds.effects),
                ast::EffectValue::Raised => {
                    let event = self.event(&effect.variable).filter(|e| !deeds.raises.contains(e));
                    deeds.raises.extend(event);
                }
                ast::EffectValue::Integer(value, span) => {
                    let Some(assignment) = self.assignment(&effect.variable, value, *span) else { continue };
                    match deeds.assignments.iter().find(|a| a.integer == assignment.integer) {
                        None => deeds.assignments.push(assignment),
                        Some(first) => self.diagnostics.push(
                            Diagnostic::new(
                                Code::SetAndReset,
                                format!("{what} assigns to `{}` twice", effect.variable.text),
                            )
                            .label(assignment.span, "and here the other value")
                            .label(first.span, "here the one"),
                        ),
                    }
                }
            }
        }
        deeds
    }

    /// `set V` or `reset V`.
    fn set(&mut self, name: &ast::Name, value: bool, what: &str, effects: &mut Vec<chart::Effect>) {
        if self.wants_number(name) {
            return;
        }
        let Some(variable) = self.variable(name) else { return };
        match effects.iter().find(|e| e.variable == variable) {
            None => effects.push(chart::Effect { variable, value, span: name.span }),
            Some(first) if first.value == value => {}
            Some(first) => self.diagnostics.push(
                Diagnostic::new(Code::SetAndReset, format!("{what} sets and resets `{}`", name.text))
                    .label(name.span, "and here the other")
                    .label(first.span, "here the one"),
            ),
        }
    }
}

fn condition(r: &mut Resolver, written: &Option<ast::Guard>, context: &Context) -> chart::Guard {
    written.as_ref().map_or(Expr::TRUE, |g| r.guard(g, context))
}

/// The output law (the paper on statecharts, section 3): bistable between the positions, monostable between and in
/// the position of its output, on/off in the position only.
fn technology(r: &mut Resolver) {
    let machine = &mut r.machine;
    for state in machine.states.ids() {
        let Some(actuator) = machine.regions[machine.states[state].region].actuator else { continue };
        let actuator = &machine.actuators[actuator];
        let at = machine.states[state].position;
        let driven = match (machine.states[state].kind, actuator.technology) {
            (StateKind::Movement { to }, Technology::Bistable | Technology::Monostable) => Some(to),
            (StateKind::Movement { .. }, Technology::OnOff) => None,
            (_, Technology::Bistable) => None,
            (_, Technology::Monostable | Technology::OnOff) => at,
        };
        let output = driven.and_then(|p| actuator.positions.get(p)).and_then(|p| p.output);
        if let Some(output) = output {
            let span = machine.states[state].span;
            let drive = chart::Drive { output, condition: Expr::TRUE, technology: true, span };
            machine.states[state].drives.push(drive);
        }
    }
}
