//! Functions and sequences: the parser's pairs to the syntax tree.

use super::Rule;
use super::build::{Bad, duration_in, guard, item, name, span, text};
use crate::ir::ast::*;
use pest::iterators::Pair;

pub fn function<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Function {
    let mut function = Function {
        name: Name { text: String::new(), span: span(&p) },
        automatic: None,
        description: None,
        activate: Vec::new(),
        deactivate: Vec::new(),
        abort: Vec::new(),
        request: Vec::new(),
        release: Vec::new(),
        body: Body { span: span(&p), ..Body::default() },
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => function.name = name(p),
            Rule::kw_automatic => function.automatic = Some(span(&p)),
            Rule::text => function.description = Some(text(p)),
            Rule::clause => clause(p, &mut function),
            Rule::bad_function_item => bad.push(p),
            _ => item(p, bad, &mut function.body),
        }
    }
    function
}

fn clause(p: Pair<'_, Rule>, function: &mut Function) {
    let mut parts = p.into_inner();
    let into = match parts.next().map(|p| p.as_rule()) {
        Some(Rule::kw_activate) => &mut function.activate,
        Some(Rule::kw_deactivate) => &mut function.deactivate,
        Some(Rule::kw_abort) => &mut function.abort,
        Some(Rule::kw_request) => &mut function.request,
        _ => &mut function.release,
    };
    into.extend(parts.filter(|p| p.as_rule() == Rule::expression).map(guard));
}

pub fn sequence<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Sequence {
    let mut sequence = Sequence {
        name: Name { text: String::new(), span: span(&p) },
        description: None,
        abort: Vec::new(),
        steps: Vec::new(),
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => sequence.name = name(p),
            Rule::text => sequence.description = Some(text(p)),
            Rule::aborted => {
                sequence.abort.extend(p.into_inner().filter(|p| p.as_rule() == Rule::expression).map(guard));
            }
            Rule::run | Rule::ask | Rule::pause => sequence.steps.push(step(p)),
            Rule::bad_sequence_item => bad.push(p),
            _ => {}
        }
    }
    sequence
}

fn step(p: Pair<'_, Rule>) -> SequenceStep {
    let place = span(&p);
    let asks = p.as_str().starts_with("activate");
    let timed = p.clone().into_inner().any(|p| p.as_rule() == Rule::duration);
    let description = p.clone().into_inner().find(|p| p.as_rule() == Rule::text).map(text);
    let doing = match p.as_rule() {
        Rule::run => SequenceDoing::Do(p.into_inner().filter(|p| p.as_rule() == Rule::job).map(job).collect()),
        Rule::ask => {
            let names = p.into_inner().filter(|p| p.as_rule() == Rule::name).map(name).collect();
            if asks { SequenceDoing::Activate(names) } else { SequenceDoing::Deactivate(names) }
        }
        _ if timed => SequenceDoing::Wait(duration_in(p)),
        _ => {
            let until = p.into_inner().find(|p| p.as_rule() == Rule::expression).map(guard);
            SequenceDoing::Until(until.expect("a pause has a time or a condition"))
        }
    };
    SequenceStep { doing, span: place, description }
}

fn job(p: Pair<'_, Rule>) -> Job {
    let mut job = Job { function: Name { text: String::new(), span: span(&p) }, until: None };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => job.function = name(p),
            Rule::expression => job.until = Some(guard(p)),
            _ => {}
        }
    }
    job
}
