//! The parser's error to a diagnostic in the language's own words.

use super::Rule;
use crate::base::{Code, Diagnostic, Span, iec};
use pest::error::{Error, ErrorVariant, InputLocation};

/// Says what stands at the error's place and what could stand there; `base` is where the parsed
/// text begins in `source`.
pub fn describe(source: &str, base: usize, error: Error<Rule>) -> Diagnostic {
    let at = base
        + match error.location {
            InputLocation::Pos(p) => p,
            InputLocation::Span((p, _)) => p,
        };
    let ErrorVariant::ParsingError { positives, .. } = error.variant else {
        unreachable!("the grammar makes no errors of its own");
    };
    if source.trim().is_empty() {
        return Diagnostic::new(Code::Empty, "the file is empty")
            .label(Span::new(0, 0), "")
            .help("begin with `machine NAME`, then say what it consists of");
    }
    let word = word_at(source, at);
    let end = at + word.len().max(source[at..].chars().next().map_or(0, char::len_utf8));
    let mut expected: Vec<String> = positives.iter().filter_map(|r| spelling(*r)).collect();
    expected.sort();
    expected.dedup();
    if positives.contains(&Rule::name) && is_word_of_language(word) {
        return Diagnostic::new(Code::Reserved, format!("`{word}` is a word of the language and cannot be a name"))
            .label(Span::new(at, end), "a name is expected here")
            .help(format!("write it with a capital, such as `{}`, or choose another name", capitalised(word)));
    }
    let what = match source[at..].chars().next() {
        None => "the file ends too early".to_owned(),
        Some(_) if !word.is_empty() => format!("`{word}` cannot stand here"),
        Some(c) => format!("`{}` cannot stand here", c.escape_default()),
    };
    let mut d = Diagnostic::new(Code::Syntax, what).label(Span::new(at, end), expectation(&expected));
    if !word.is_empty() && iec::fold(word) == word && is_word_of_language(&word.to_ascii_lowercase()) {
        d = d.help(format!("words of the language are written small: `{}`", word.to_ascii_lowercase()));
    }
    d
}

fn expectation(expected: &[String]) -> String {
    match expected {
        [] => "unexpected".to_owned(),
        [one] => format!("expected {one}"),
        [most @ .., last] => format!("expected {} or {last}", most.join(", ")),
    }
}

/// The word that begins at `at`, if one does.
fn word_at(source: &str, at: usize) -> &str {
    let rest = &source[at..];
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    &rest[..end]
}

fn is_word_of_language(word: &str) -> bool {
    use pest::Parser;
    super::Grammar::parse(Rule::keyword, word).is_ok_and(|pairs| pairs.as_str() == word)
}

fn capitalised(word: &str) -> String {
    let mut c = word.chars();
    c.next().map(|first| first.to_ascii_uppercase().to_string() + c.as_str()).unwrap_or_default()
}

/// How a rule is named in a message; rules that only wrap others are named by what they hold.
fn spelling(rule: Rule) -> Option<String> {
    Some(match rule {
        Rule::name => "a name".into(),
        Rule::path => "a state".into(),
        Rule::text => "a text in quotes".into(),
        Rule::text_chars => "characters".into(),
        Rule::number => "a number".into(),
        Rule::duration => "a time such as `10ms`".into(),
        Rule::unit => "`ms` or `s`".into(),
        Rule::address => "an address such as `%IX0.0`".into(),
        Rule::bool_type => "`BOOL`".into(),
        Rule::constant => "`true` or `false`".into(),
        Rule::mode => "a filter mode such as `supervisor`".into(),
        Rule::technology => "`bistable`, `monostable` or `onoff`".into(),
        Rule::expression | Rule::exclusive | Rule::conjunction | Rule::negation | Rule::primary => "a condition".into(),
        Rule::call | Rule::operator | Rule::elapsed => return None,
        // They can stand behind almost everything, and say little.
        Rule::comparison | Rule::relation | Rule::sign | Rule::minus => return None,
        Rule::sum | Rule::factor => "an integer".into(),
        Rule::range | Rule::integer => "a range such as `0..3`".into(),
        Rule::source => "a state or `any`".into(),
        Rule::target => "a state".into(),
        Rule::several => "`(`".into(),
        Rule::history => "`history of`".into(),
        Rule::choice => "`choice`".into(),
        Rule::branch => "`when` or `else`".into(),
        Rule::effect => "`set`, `reset` or `raise`".into(),
        Rule::outcome => "`set` or `reset`".into(),
        Rule::body | Rule::outer_body | Rule::observer_body => "`{`".into(),
        Rule::close => "`}`".into(),
        Rule::EOI => "the end".into(),
        Rule::machine => "`machine`".into(),
        Rule::cycle => "`cycle`".into(),
        Rule::inputs => "`inputs`".into(),
        Rule::outputs => "`outputs`".into(),
        Rule::variables => "`variables`".into(),
        Rule::events => "`events`".into(),
        Rule::limit => "`within`".into(),
        Rule::actuator => "`actuator`".into(),
        Rule::position => "`position`".into(),
        Rule::observer => "`observer`".into(),
        Rule::after_filter => "`after filter`".into(),
        Rule::chart => "`chart`".into(),
        Rule::safety => "`safety`".into(),
        Rule::state => "`state`".into(),
        Rule::modifier => "`initial`, `final` or `parallel`".into(),
        Rule::region => "`region`".into(),
        Rule::transition => "`from` or `move`".into(),
        Rule::drive => "`drives`".into(),
        Rule::action => "`sets` or `resets`".into(),
        Rule::entry => "`entry`".into(),
        Rule::exit => "`exit`".into(),
        Rule::internal => "`internal`".into(),
        Rule::signal | Rule::variable | Rule::event | Rule::constraint => "a name".into(),
        Rule::assumption => "`assume`".into(),
        Rule::derive => "`derive`".into(),
        Rule::forbid | Rule::place_of | Rule::derived => "a name".into(),
        Rule::valve => "`valve`".into(),
        Rule::valve_kind => "`closed-centre` or `memory`".into(),
        Rule::by_edges => "`by edges`".into(),
        Rule::never => "`never`".into(),
        Rule::function => "`function`".into(),
        Rule::sequence => "`sequence`".into(),
        Rule::clause => "`activate`, `deactivate`, `abort`, `request` or `release`".into(),
        Rule::aborted => "`abort`".into(),
        Rule::run => "`do`".into(),
        Rule::job => "a function".into(),
        Rule::ask => "`activate` or `deactivate`".into(),
        Rule::pause => "`wait`".into(),
        Rule::relief => "`relief`".into(),
        Rule::in_order => "`in-order`".into(),
        Rule::reset_by => "`reset by`".into(),
        Rule::properties => "`properties`".into(),
        Rule::property => "a name".into(),
        Rule::quantifier => "`never`, `always`, `reachable`, `always possible` or `always eventually`".into(),
        Rule::response => "`after`".into(),
        Rule::fairness => "`assume`".into(),
        Rule::acceptance => "`accept`".into(),
        Rule::accepted => {
            "`unreachable`, `silent`, `overlap`, `saturates`, `acts`, `void`, `unused` or `cyclic`".into()
        }
        Rule::leads => "`from` or `internal of`".into(),
        Rule::past => "`prev`, `rise` or `fall`".into(),
        Rule::plant => "`plant`".into(),
        Rule::by_steps => "`by steps`".into(),
        Rule::hidden => "`hidden`".into(),
        Rule::happening => "`step`".into(),
        Rule::unknown => "`any`".into(),
        Rule::initially => "`initially`".into(),
        Rule::travel | Rule::reaction | Rule::forced => "a name".into(),
        Rule::change => "`follows`, `rises when` or `falls when`".into(),
        Rule::driven => "`while driven`".into(),
        Rule::time | Rule::scans => "a time such as `100ms` or `3 scans`".into(),
        Rule::scenario => "`scenario`".into(),
        Rule::preset => "`set` or `reset`".into(),
        Rule::watch => "`always` or `never`".into(),
        Rule::before => "`before writing`".into(),
        Rule::press
        | Rule::force
        | Rule::release
        | Rule::place
        | Rule::happens
        | Rule::wait
        | Rule::expect
        | Rule::repeat => format!("`{rule:?}`"),
        other => {
            let name = format!("{other:?}");
            let word = name.strip_prefix("kw_")?;
            format!("`{word}`")
        }
    })
}
