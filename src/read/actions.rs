//! Action blocks to associations, and bodies of actions to statements.

use super::Problem;
use super::ladder;
use super::program::{Context, broken};
use super::scope::Meaning;
use super::st::{self, Value};
use super::xml::{self, Family, Node};
use crate::base::iec::fold;
use crate::base::{Arena, Code, Id};
use crate::ir::iec::{Action, ActionId, Association, Kind, Number, Qualifier, Sfc, Statement, Target, Time};
use std::collections::BTreeMap;

/// Actions that have been read, by folded name; `None` where that failed.
pub type Known = BTreeMap<String, Option<ActionId>>;

/// Reads one action of an action block of `step`.
pub fn association(
    pou: Node<'_>,
    action: Node<'_>,
    step: &str,
    sfc: &mut Sfc,
    known: &mut Known,
    cx: &mut Context<'_, '_>,
) -> Result<Association, Problem> {
    let qualifier = qualifier(action)?;
    let duration = duration(action, qualifier, cx)?;
    let target = match (xml::child(action, "reference"), xml::child(action, "inline")) {
        (Some(reference), None) => reference_target(pou, reference, sfc, known, cx)?,
        (None, Some(inline)) => {
            let statements = statements(inline, cx)?;
            Target::Action(push(sfc, &format!("{step}_INLINE{}", sfc.actions.len()), statements))
        }
        _ => return Err(xml::not_understood("an action that is neither named nor inline", action)),
    };
    // There a body runs once more when its step has been left, and a pulse lasts for two scans.
    let simple = matches!(qualifier, Qualifier::NonStored | Qualifier::Set | Qualifier::Reset);
    if cx.family == Family::Codesys && !(simple && matches!(target, Target::Variable(_))) {
        let what = "an action other than a variable with the qualifier N, S or R, which CODESYS runs otherwise,";
        return Err(xml::not_understood(what, action));
    }
    Ok(Association { target, qualifier, duration })
}

/// Adds an action.
pub fn push(sfc: &mut Sfc, name: &str, body: Vec<Statement>) -> ActionId {
    sfc.actions.push(Action { name: name.to_owned(), body })
}

/// Brings actions into the order of their first associations.
pub fn sort(sfc: &mut Sfc) {
    let mut places: Vec<Option<usize>> = vec![None; sfc.actions.len()];
    let mut count = 0;
    for id in sfc.steps.ids() {
        for association in &mut sfc.steps[id].associations {
            if let Target::Action(action) = &mut association.target {
                let place = places[action.index()].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                });
                *action = Id::from_index(*place);
            }
        }
    }
    let mut sorted: Vec<(usize, Action)> = Vec::new();
    for (place, action) in places.into_iter().zip(std::mem::take(&mut sfc.actions).values()) {
        sorted.extend(place.map(|p| (p, action.clone())));
    }
    sorted.sort_by_key(|(place, _)| *place);
    let mut actions = Arena::new();
    for (_, action) in sorted {
        actions.push(action);
    }
    sfc.actions = actions;
}

fn reference_target(
    pou: Node<'_>,
    reference: Node<'_>,
    sfc: &mut Sfc,
    known: &mut Known,
    cx: &mut Context<'_, '_>,
) -> Result<Target, Problem> {
    let name = xml::required(reference, "name")?;
    let list = xml::child(pou, "actions").into_iter().flat_map(|n| xml::children_named(n, "action"));
    let mut list = list.filter(|n| xml::attribute(*n, "name").is_some_and(|n| n.eq_ignore_ascii_case(name)));
    let body = list.next();
    if let Some(second) = list.next() {
        return Err(xml::problem(Code::Clash, format!("two actions have the name `{name}`"), second));
    }
    let variable = cx.scope.find(&name.split('.').collect::<Vec<_>>());
    match (body, variable) {
        (Some(_), Some(_)) => {
            let message = format!("both an action and a variable have the name `{name}`");
            Err(xml::problem(Code::Clash, message, reference))
        }
        (Some(body), None) => {
            let read = match known.get(&fold(name)) {
                Some(&read) => read,
                None => {
                    let result = statements_of(body, cx);
                    let read = match result {
                        Ok(statements) => Some(push(sfc, name, statements)),
                        Err(problem) => {
                            cx.report(problem);
                            None
                        }
                    };
                    known.insert(fold(name), read);
                    read
                }
            };
            read.map(Target::Action)
                .ok_or_else(|| xml::not_understood(format!("the body of action `{name}`"), reference))
        }
        (None, Some(Meaning::Variable(id, Kind::Bool))) => Ok(Target::Variable(id)),
        (None, Some(_)) => {
            Err(xml::problem(Code::BrokenText, format!("action `{name}` is no BOOL variable"), reference))
        }
        (None, None) => {
            let message = format!("`{name}` is neither an action nor a variable");
            Err(xml::problem(Code::Undeclared, message, reference))
        }
    }
}

fn statements_of(action: Node<'_>, cx: &mut Context<'_, '_>) -> Result<Vec<Statement>, Problem> {
    let body =
        xml::child(action, "body").ok_or_else(|| xml::problem(Code::Unconnected, "an action has no body", action))?;
    statements(body, cx)
}

/// What stands within `body` or `inline`, in LD or simple ST.
pub fn statements(body: Node<'_>, cx: &mut Context<'_, '_>) -> Result<Vec<Statement>, Problem> {
    let Some(content) = xml::children(body).find(|n| !xml::is(*n, "addData")) else { return Ok(Vec::new()) };
    match content.tag_name().name() {
        "LD" => Ok(ladder::read(content, cx)),
        "ST" => {
            let text = xml::text(content);
            st::statements(&text, &cx.scope, cx.blocks).map_err(|f| broken(f, &text, content))
        }
        language => Err(xml::not_understood(format!("a body in {language}"), content)),
    }
}

fn qualifier(action: Node<'_>) -> Result<Qualifier, Problem> {
    Ok(match xml::attribute(action, "qualifier") {
        None | Some("N") => Qualifier::NonStored,
        Some("S") => Qualifier::Set,
        Some("R") => Qualifier::Reset,
        Some("P") => Qualifier::Pulse,
        Some("P1") => Qualifier::PulseRising,
        Some("P0") => Qualifier::PulseFalling,
        Some("L") => Qualifier::Limited,
        Some("D") => Qualifier::Delayed,
        Some("SL") => Qualifier::StoredLimited,
        Some("SD") => Qualifier::StoredDelayed,
        Some("DS") => Qualifier::DelayedStored,
        Some(other) => return Err(xml::not_understood(format!("the qualifier `{other}`"), action)),
    })
}

fn duration(action: Node<'_>, qualifier: Qualifier, cx: &Context<'_, '_>) -> Result<Time, Problem> {
    let text = xml::attribute(action, "duration");
    let timed = match qualifier {
        Qualifier::NonStored
        | Qualifier::Set
        | Qualifier::Reset
        | Qualifier::Pulse
        | Qualifier::PulseRising
        | Qualifier::PulseFalling => false,
        Qualifier::Limited
        | Qualifier::Delayed
        | Qualifier::StoredLimited
        | Qualifier::StoredDelayed
        | Qualifier::DelayedStored => true,
    };
    let text = match (timed, text) {
        (false, None) => return Ok(0),
        (false, Some(text)) => {
            return Err(xml::not_understood(format!("the duration `{text}` of an action without time"), action));
        }
        (true, Some(text)) => text,
        (true, None) => return Err(xml::problem(Code::BrokenText, "a timed action has no duration", action)),
    };
    match cx.expression(text, action)?.0 {
        Value::Time(Number::Const(time)) => Ok(time),
        _ => Err(xml::not_understood(format!("the duration `{text}`"), action)),
    }
}
