//! The parser's pairs of properties to their syntax trees.

use super::Rule;
use super::build::{Bad, guard, name, text};
use crate::ir::ast::{Property, PropertyKind};
use pest::iterators::Pair;

/// `properties { … }`.
pub fn properties<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, into: &mut Vec<Property>) {
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::property | Rule::fairness => into.push(property(p)),
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
