//! Functions and sequences: the parser's pairs to the syntax tree.

use super::Rule;
use super::build::{Bad, duration, guard, name, named_condition, span, text};
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
        drives: Vec::new(),
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => function.name = name(p),
            Rule::kw_automatic => function.automatic = Some(span(&p)),
            Rule::text => function.description = Some(text(p)),
            Rule::clause => clause(p, &mut function),
            Rule::drive => {
                let (output, condition) = named_condition(p);
                function.drives.push(Drive { output, condition });
            }
            Rule::bad_function_item => bad.push(p),
            _ => {}
        }
    }
    function
}

fn clause(p: Pair<'_, Rule>, function: &mut Function) {
    let into = match p.as_str() {
        word if word.starts_with("activate") => &mut function.activate,
        word if word.starts_with("deactivate") => &mut function.deactivate,
        _ => &mut function.abort,
    };
    into.extend(p.into_inner().filter(|p| p.as_rule() == Rule::expression).map(guard));
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
        _ if timed => SequenceDoing::Wait(duration(p)),
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
