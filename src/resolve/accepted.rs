//! Accepted findings and warnings to the states, transitions and others of which they speak.

use super::Resolver;
use super::names::Symbol;
use crate::base::{Code, Diagnostic, Span, iec};
use crate::ir::ast::{self, Leads, Path, Target};
use crate::ir::chart::{self, ConstraintId, Inside, StateId, TransitionId};
use crate::ir::scenario::{Acceptance, Accepted, Declared, Excuse, Excused, PropertyKind};

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    for written in &tree.accepted {
        let finding = match warning(r, &written.finding) {
            Some(Ok(warning)) => {
                excuse(r, written, warning);
                continue;
            }
            Some(Err(Unknown)) => continue,
            None => finding(r, &written.finding),
        };
        let Some(finding) = finding else { continue };
        if let Some(first) = r.machine.accepted.iter().find(|a| a.finding == finding) {
            let first = first.span;
            repeated(r, "a finding is accepted more than once", written.span, first);
            continue;
        }
        let (reason, span) = (written.reason.value.clone(), written.span);
        r.machine.accepted.push(Acceptance { finding, written: written.written.clone(), reason, span });
    }
}

fn repeated(r: &mut Resolver, message: &str, again: Span, first: Span) {
    let d = Diagnostic::new(Code::Repeated, message).label(again, "accepted again").label(first, "first accepted here");
    r.diagnostics.push(d);
}

fn excuse(r: &mut Resolver, written: &ast::Acceptance, warning: Excused) {
    if let Some(first) = r.machine.excused.iter().find(|e| e.warning == warning).map(|e| e.span) {
        repeated(r, "a warning is accepted more than once", written.span, first);
        return;
    }
    let (reason, span) = (written.reason.value.clone(), written.span);
    r.machine.excused.push(Excuse { warning, written: written.written.clone(), reason, span });
}

/// A name that means nothing has been reported.
struct Unknown;

/// The warning that is meant, if it is one.
fn warning(r: &mut Resolver, written: &ast::Accepted) -> Option<Result<Excused, Unknown>> {
    let declared = match written {
        ast::Accepted::Unused(name) => match r.symbol(&name.text) {
            Some(Symbol::Input(id)) => Some(Declared::Input(id)),
            Some(Symbol::Output(id)) => Some(Declared::Output(id)),
            Some(Symbol::Variable(id)) => Some(Declared::Variable(id)),
            Some(Symbol::Event(id)) => Some(Declared::Event(id)),
            Some(Symbol::Integer(id)) => Some(Declared::Integer(id)),
            other @ (None | Some(Symbol::Bit(_) | Symbol::Count(_))) => {
                r.wrong_symbol(name, other, "something that the program declares");
                None
            }
        },
        ast::Accepted::Cyclic(names) => {
            let found: Option<Vec<ConstraintId>> = names.iter().map(|name| constraint(r, name)).collect();
            return Some(match found {
                Some(mut constraints) => {
                    constraints.sort_unstable();
                    constraints.dedup();
                    Ok(Excused::Cyclic(constraints))
                }
                None => Err(Unknown),
            });
        }
        ast::Accepted::Unreachable(_)
        | ast::Accepted::Silent(_)
        | ast::Accepted::Overlap(..)
        | ast::Accepted::Saturates(_)
        | ast::Accepted::Acts(_)
        | ast::Accepted::Void(_) => return None,
    };
    Some(declared.map(Excused::Unused).ok_or(Unknown))
}

/// The constraint of that name, or an error.
fn constraint(r: &mut Resolver, name: &ast::Name) -> Option<ConstraintId> {
    let folded = iec::fold(&name.text);
    let found = r.machine.safety.constraints.iter().find(|(_, c)| iec::fold(&c.name) == folded).map(|(id, _)| id);
    if found.is_none() {
        missing(r, &format!("there is no constraint `{}`", name.text), name.span);
    }
    found
}

fn finding(r: &mut Resolver, written: &ast::Accepted) -> Option<Accepted> {
    Some(match written {
        ast::Accepted::Unreachable(path) => Accepted::Unreachable(state(r, path)?),
        ast::Accepted::Silent(leads) => Accepted::Silent(transition(r, leads)?),
        ast::Accepted::Overlap(a, b) => overlap(r, a, b)?,
        ast::Accepted::Saturates(name) => match r.symbol(&name.text) {
            Some(Symbol::Integer(id)) => Accepted::Saturates(id),
            other => {
                r.wrong_symbol(name, other, "an integer");
                return None;
            }
        },
        ast::Accepted::Acts(name) => Accepted::Acts(constraint(r, name)?),
        // These are warnings.
        ast::Accepted::Unused(_) | ast::Accepted::Cyclic(_) => return None,
        ast::Accepted::Void(name) => {
            let folded = iec::fold(&name.text);
            let found = r.machine.properties.iter().position(|p| iec::fold(&p.name) == folded);
            match found {
                Some(i) if r.machine.properties[i].kind == PropertyKind::Eventually => Accepted::Void(i),
                Some(_) => {
                    r.misplaced(
                        &format!("`{}` waits for nothing to come", name.text),
                        name.span,
                        "only a property that something comes `eventually` can say nothing",
                        "leave this out",
                    );
                    return None;
                }
                None => return missing(r, &format!("there is no property `{}`", name.text), name.span),
            }
        }
    })
}

fn missing(r: &mut Resolver, message: &str, span: Span) -> Option<Accepted> {
    r.diagnostics.push(Diagnostic::new(Code::UnknownName, message).label(span, "not declared"));
    None
}

/// Two transitions of one source, in the order of the text.
fn overlap(r: &mut Resolver, a: &Leads, b: &Leads) -> Option<Accepted> {
    let (first, second) = (transition(r, a)?, transition(r, b)?);
    let source = |t: TransitionId| r.machine.transitions[t].source;
    if first == second || source(first) != source(second) {
        r.misplaced(
            "only two transitions of one source can overlap",
            b.span,
            if first == second { "the same transition again" } else { "another source" },
            "name both as `verify` shows them",
        );
        return None;
    }
    Some(Accepted::Overlap(first.min(second), first.max(second)))
}

/// The state that a path means, from outside of all charts.
fn state(r: &mut Resolver, path: &Path) -> Option<StateId> {
    let parts: Vec<(&str, Span)> = path.parts.iter().map(|n| (n.text.as_str(), n.span)).collect();
    match (r.chart(parts[0].0), &parts[1..]) {
        // The name of a chart may stand before the path.
        (Some(first), rest @ [_, ..]) => r.state_of_chart(&parts[0], rest, first),
        _ => {
            let braces = r.outermost(parts[0].0);
            r.state(&parts, braces)
        }
    }
}

/// The transition with these ends, or an error if there is none, or several and it is not said which.
fn transition(r: &mut Resolver, leads: &Leads) -> Option<TransitionId> {
    let source = state(r, &leads.source)?;
    let goal = match &leads.target {
        None => None,
        Some(Target::State(path)) => Some((vec![state(r, path)?], Inside::Default)),
        Some(Target::History { of, deep }) => {
            Some((vec![state(r, of)?], if *deep { Inside::DeepHistory } else { Inside::History }))
        }
        Some(Target::Fork(paths)) => {
            let states: Option<Vec<StateId>> = paths.iter().map(|p| state(r, p)).collect();
            Some((states?, Inside::Fork(Vec::new())))
        }
    };
    let fits = |t: &chart::Transition| match &goal {
        None => t.internal,
        Some((states, inside)) => !t.internal && same_goal(t, states, inside),
    };
    let all = r.machine.transitions.iter().filter(|(_, t)| t.source == source && fits(t));
    let all: Vec<TransitionId> = all.map(|(id, _)| id).collect();
    match (all.as_slice(), leads.number) {
        ([], _) => {
            let d = Diagnostic::new(Code::UnknownName, "there is no transition with these ends")
                .label(leads.span, "no transition")
                .help("write it as `verify` shows it: `from A to B`, `internal of A`");
            r.diagnostics.push(d);
            None
        }
        ([one], None) => Some(*one),
        (several, Some((Some(number @ 1..), _))) if number as usize <= several.len() => {
            Some(several[number as usize - 1])
        }
        (several, _) => {
            let span = leads.number.map_or(leads.span, |(_, span)| span);
            let (said, help) = match several.len() {
                1 => ("one transition has these ends".to_owned(), "leave `number` out, or write `number 1`".to_owned()),
                n => {
                    let help = format!("write `number 1` to `number {n}` behind it, in the order of the text");
                    (format!("{n} transitions have these ends"), help)
                }
            };
            let label = if leads.number.is_some() { "there is none of this number" } else { "say which one" };
            let mut d = Diagnostic::new(Code::AmbiguousName, said).label(span, label).help(help);
            for &t in several.iter().take(3) {
                d = d.label(r.machine.transitions[t].span, "one of them");
            }
            r.diagnostics.push(d);
            None
        }
    }
}

/// Whether a transition leads there in that way.
fn same_goal(t: &chart::Transition, states: &[StateId], inside: &Inside) -> bool {
    match (&t.inside, inside) {
        (Inside::Fork(goals), Inside::Fork(_)) => {
            goals.len() == states.len() && states.iter().all(|s| goals.contains(s))
        }
        (a, b) => a == b && t.target == states[0],
    }
}
