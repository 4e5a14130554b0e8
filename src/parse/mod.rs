//! Text to syntax tree.
//!
//! Gone after it: comments, white space, escapes in texts, parentheses.
//!
//! The text is scanned for unclosed braces and for nesting before the parser sees it, because the
//! parser descends recursively. What the grammar's `bad_…` rules catch is parsed once more, alone and
//! strictly, which yields a place and what was expected there; so one run reports several errors.

mod build;
mod derive;
mod functions;
mod numbers;
mod properties;
mod scan;
mod scenarios;
mod syntax_error;
mod ways;

use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::ast;
use pest::Parser;
use pest::iterators::Pair;

use grammar::{Grammar, Rule};
pub use scan::on_one_line;

#[allow(missing_docs)] // The grammar file documents its rules.
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "../grammar/chart.pest"]
    pub struct Grammar;
}

/// Turns the bytes of a file into text: UTF-8 (a byte order mark is dropped), at most `limit` bytes.
pub fn decode(bytes: Vec<u8>, limit: usize) -> Result<String, Diagnostic> {
    if bytes.len() > limit {
        return Err(Diagnostic::new(Code::TooLarge, format!("the file has more than {limit} bytes"))
            .help("describe one machine per file"));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text)),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let line = 1 + error.as_bytes()[..at].iter().filter(|&&b| b == b'\n').count();
            let byte = error.as_bytes()[at];
            Err(Diagnostic::new(Code::NotUtf8, format!("byte {at} (0x{byte:02X}, line {line}) is not UTF-8"))
                .help("save the file as UTF-8; a file with a zero byte in every other place is UTF-16"))
        }
    }
}

/// Reads one machine. Without errors among the diagnostics there is a tree.
pub fn parse(source: &str) -> (Option<ast::Machine>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    if let Err(found) = scan::scan(source) {
        found.into_iter().for_each(|d| diagnostics.push(d));
        return (None, diagnostics);
    }
    let file = match Grammar::parse(Rule::file, source) {
        Ok(mut pairs) => pairs.next().expect("a file is one pair"),
        Err(error) => {
            diagnostics.push(syntax_error::describe(source, 0, error));
            return (None, diagnostics);
        }
    };
    let mut bad = Vec::new();
    let machine = build::machine(file, &mut bad);
    for slice in &bad {
        if let Some(d) = second_look(source, slice) {
            diagnostics.push(d);
        }
    }
    if let (Some(slice), true) = (bad.first(), diagnostics.is_empty()) {
        // Each caught slice is well-formed alone: what follows the first one does not fit.
        let end = slice.as_span().end();
        let rest = source[end..].len() - source[end..].trim_start().len();
        let first = source[end + rest..].chars().next().map_or(0, char::len_utf8);
        diagnostics.push(
            Diagnostic::new(Code::Syntax, "this cannot follow what stands before it")
                .label(Span::new(end + rest, end + rest + first), "unexpected"),
        );
    }
    diagnostics.sort();
    if diagnostics.has_errors() { (None, diagnostics) } else { (Some(machine), diagnostics) }
}

/// Reads a text that is one condition, and nothing besides. Its places are those in this text.
pub fn condition(text: &str) -> Result<ast::Guard, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    match scan::scan(text) {
        Err(found) => found.into_iter().for_each(|d| diagnostics.push(d)),
        Ok(()) => match Grammar::parse(Rule::lone_condition, text) {
            Ok(pairs) => {
                let mut inside = pairs.flat_map(Pair::into_inner);
                let expression = inside.find(|p| p.as_rule() == Rule::expression);
                return Ok(build::guard(expression.expect("a condition is an expression")));
            }
            Err(error) => diagnostics.push(syntax_error::describe(text, 0, error)),
        },
    }
    Err(diagnostics)
}

/// Parses what a `bad_…` rule caught with the strict rule, for a good message.
fn second_look(source: &str, slice: &Pair<'_, Rule>) -> Option<Diagnostic> {
    let strict = match slice.as_rule() {
        Rule::bad_part => Rule::lone_part,
        Rule::bad_signal => Rule::lone_signal,
        Rule::bad_variable => Rule::lone_variable,
        Rule::bad_event => Rule::lone_event,
        Rule::bad_position => Rule::lone_position,
        Rule::bad_item => Rule::lone_item,
        Rule::bad_outer_item => Rule::lone_outer_item,
        Rule::bad_branch => Rule::lone_branch,
        Rule::bad_constraint => Rule::lone_constraint,
        Rule::bad_function_item => Rule::lone_function_item,
        Rule::bad_sequence_item => Rule::lone_sequence_item,
        Rule::bad_property => Rule::lone_property,
        Rule::bad_plant_item => Rule::lone_plant_item,
        Rule::bad_step => Rule::lone_step,
        other => unreachable!("{other:?} is no recovery rule"),
    };
    let error = Grammar::parse(strict, slice.as_str()).err()?;
    Some(syntax_error::describe(source, slice.as_span().start(), error))
}
