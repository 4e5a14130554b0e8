//! The parser's pairs of choices, forks, joins, histories and internal transitions to the syntax tree.

use super::Rule;
use super::build::{Bad, effect, guard, name, path, span, text};
use crate::ir::ast::*;
use pest::iterators::Pair;

pub fn target(p: Pair<'_, Rule>) -> Target {
    let inner = p.into_inner().next().expect("a target is a path, several or a history");
    match inner.as_rule() {
        Rule::several => Target::Fork(paths(inner)),
        Rule::history => {
            let deep = inner.as_str().starts_with("deep");
            let of = inner.into_inner().find(|p| p.as_rule() == Rule::path).map(path).expect("it names a state");
            Target::History { of, deep }
        }
        _ => Target::State(path(inner)),
    }
}

pub fn choice<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Choice {
    let mut choice = Choice {
        name: Name { text: String::new(), span: span(&p) },
        initial: None,
        description: None,
        branches: Vec::new(),
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::kw_initial => choice.initial = Some(span(&p)),
            Rule::name => choice.name = name(p),
            Rule::text => choice.description = Some(text(p)),
            Rule::branch => choice.branches.push(branch(p)),
            Rule::bad_branch => bad.push(p),
            _ => {}
        }
    }
    choice
}

fn branch(p: Pair<'_, Rule>) -> Branch {
    let whole = span(&p);
    let (mut guard_, mut target_, mut effects, mut description) = (None, None, Vec::new(), None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::expression => guard_ = Some(guard(p)),
            Rule::target => target_ = Some(target(p)),
            Rule::effect => effects.extend(effect(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    let target = target_.expect("a branch has a target");
    Branch { guard: guard_, target, effects, description, span: whole }
}

/// The paths between parentheses.
pub fn paths(p: Pair<'_, Rule>) -> Vec<Path> {
    p.into_inner().filter(|p| p.as_rule() == Rule::path).map(path).collect()
}

/// A transition that leaves nothing.
pub fn internal(p: Pair<'_, Rule>) -> Internal {
    let whole = span(&p);
    let (mut condition, mut effects, mut description) = (None, Vec::new(), None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::expression => condition = Some(guard(p)),
            Rule::effect => effects.extend(effect(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    let guard = condition.expect("an internal transition has a condition");
    Internal { guard, effects, description, span: whole }
}
