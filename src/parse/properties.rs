//! The parser's pairs of properties to their syntax trees.

use super::Rule;
use super::build::{Bad, guard, name, text};
use crate::ir::ast::{Property, PropertyKind};
use pest::iterators::Pair;

/// `properties { … }`.
pub fn properties<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, into: &mut Vec<Property>) {
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::property => into.push(property(p)),
            Rule::bad_property => bad.push(p),
            _ => {}
        }
    }
}

fn property(p: Pair<'_, Rule>) -> Property {
    let (mut named, mut kind, mut condition, mut description) = (None, None, None, None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => named = Some(name(p)),
            Rule::quantifier => {
                let possible = p.clone().into_inner().any(|p| p.as_rule() == Rule::kw_possible);
                kind = Some(match p.as_str() {
                    _ if possible => PropertyKind::AlwaysPossible,
                    word if word.starts_with("never") => PropertyKind::Never,
                    word if word.starts_with("reachable") => PropertyKind::Reachable,
                    _ => PropertyKind::Always,
                });
            }
            Rule::expression => condition = Some(guard(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    Property {
        name: named.expect("a property has a name"),
        kind: kind.expect("a property says how often"),
        condition: condition.expect("a property has a condition"),
        text: description,
    }
}
