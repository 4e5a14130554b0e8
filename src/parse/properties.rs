//! The parser's pairs of properties to their syntax trees.

use super::Rule;
use super::build::{Bad, guard, name, path, span, text};
use super::scan::on_one_line;
use super::ways::target;
use crate::ir::ast::{Acceptance, Accepted, Leads, Machine, Property, PropertyKind};
use pest::iterators::Pair;

/// `properties { … }`.
pub fn properties<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, into: &mut Machine) {
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::property | Rule::fairness => into.properties.push(property(p)),
            Rule::acceptance => into.accepted.push(acceptance(p)),
            Rule::bad_property => bad.push(p),
            _ => {}
        }
    }
}

fn property(p: Pair<'_, Rule>) -> Property {
    let (mut named, mut condition, mut description) = (None, None, None);
    let mut kind = (p.as_rule() == Rule::fairness).then_some(PropertyKind::Fair);
    let mut after = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => named = Some(name(p)),
            Rule::quantifier => {
                let says = |rule: Rule| p.clone().into_inner().any(|p| p.as_rule() == rule);
                kind = Some(match p.as_str() {
                    _ if says(Rule::kw_possible) => PropertyKind::AlwaysPossible,
                    _ if says(Rule::kw_eventually) => PropertyKind::Eventually,
                    word if word.starts_with("never") => PropertyKind::Never,
                    word if word.starts_with("reachable") => PropertyKind::Reachable,
                    _ => PropertyKind::Always,
                });
            }
            Rule::response => {
                kind = Some(PropertyKind::Eventually);
                let mut conditions = p.into_inner().filter(|p| p.as_rule() == Rule::expression).map(guard);
                after = conditions.next();
                condition = conditions.next();
            }
            Rule::expression => condition = Some(guard(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    Property {
        name: named.expect("a property has a name"),
        kind: kind.expect("a property says how often"),
        after,
        condition: condition.expect("a property has a condition"),
        text: description,
    }
}

fn acceptance(p: Pair<'_, Rule>) -> Acceptance {
    let whole = span(&p);
    let (mut finding, mut written, mut reason) = (None, String::new(), None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::accepted => {
                written = format!("accept {}", on_one_line(p.as_str()));
                finding = Some(accepted(p));
            }
            Rule::text => reason = Some(text(p)),
            _ => {}
        }
    }
    let finding = finding.expect("something is accepted");
    Acceptance { finding, written, reason: reason.expect("it has a reason"), span: whole }
}

fn accepted(p: Pair<'_, Rule>) -> Accepted {
    let mut parts = p.into_inner();
    let kind = parts.next().expect("it begins with its kind").as_rule();
    let mut leading = parts.clone().filter(|p| p.as_rule() == Rule::leads).map(leads);
    let mut next = || leading.next().expect("it names a transition");
    let named = |mut parts: pest::iterators::Pairs<'_, Rule>| name(parts.next().expect("it names something"));
    match kind {
        Rule::kw_unreachable => Accepted::Unreachable(path(parts.next().expect("it names a state"))),
        Rule::kw_silent => Accepted::Silent(next()),
        Rule::kw_overlap => {
            let first = next();
            Accepted::Overlap(first, next())
        }
        Rule::kw_saturates => Accepted::Saturates(named(parts)),
        Rule::kw_acts => Accepted::Acts(named(parts)),
        Rule::kw_unused => Accepted::Unused(named(parts)),
        Rule::kw_cyclic => Accepted::Cyclic(parts.filter(|p| p.as_rule() == Rule::name).map(name).collect()),
        _ => Accepted::Void(named(parts)),
    }
}

fn leads(p: Pair<'_, Rule>) -> Leads {
    let whole = span(&p);
    let (mut source, mut to, mut number) = (None, None, None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::path => source = Some(path(p)),
            Rule::target => to = Some(target(p)),
            Rule::number => number = Some((p.as_str().parse().ok(), span(&p))),
            _ => {}
        }
    }
    Leads { source: source.expect("it names a state"), target: to, number, span: whole }
}
