//! The parser's pairs of plants and scenarios to their syntax trees.

use super::Rule;
use super::build::{Bad, effect, guard, name, number, span, text};
use super::numbers;
use crate::base::Span;
use crate::ir::ast::{
    self, Change, Doing, Guard, Happening, Hidden, Name, Plant, Scenario, Step, Text, Time, TimeUnit, Travel,
};
use pest::iterators::Pair;

/// `plant { … }`.
pub fn plant<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Plant {
    let mut plant = Plant::default();
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::by_steps => plant.by_steps = Some(span(&p)),
            Rule::hidden => plant.hidden.push(hidden(p)),
            Rule::happening => plant.steps.push(happening(p)),
            Rule::initially => steps(p, bad, &mut plant.initially),
            Rule::travel => plant.travels.push(travel(p)),
            Rule::reaction => plant.rules.push(rule(p)),
            Rule::bad_plant_item => bad.push(p),
            _ => {}
        }
    }
    plant
}

/// `scenario … { … }`.
pub fn scenario<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Scenario {
    let mut texts = p.clone().into_inner().filter(|p| p.as_rule() == Rule::text).map(text);
    let name = texts.next().expect("a scenario has a name");
    let mut scenario = Scenario { name, after: texts.next(), steps: Vec::new() };
    steps(p, bad, &mut scenario.steps);
    scenario
}

fn steps<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, into: &mut Vec<Step>) {
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::bad_step => bad.push(p),
            Rule::preset
            | Rule::unknown
            | Rule::press
            | Rule::force
            | Rule::release
            | Rule::place
            | Rule::happens
            | Rule::wait
            | Rule::expect
            | Rule::watch
            | Rule::repeat => into.push(step(p, bad)),
            _ => {}
        }
    }
}

fn step<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Step {
    if p.as_rule() == Rule::happens {
        return happens(p);
    }
    let mut place = span(&p);
    let (rule, source) = (p.as_rule(), p.as_str());
    let mut parts = Parts::default();
    let mut inner = Vec::new();
    if rule == Rule::repeat {
        steps(p.clone(), bad, &mut inner);
    }
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => parts.names.push(name(p)),
            Rule::forced => {
                let value = p.clone().into_inner().all(|p| p.as_rule() != Rule::kw_not);
                parts.forced.extend(p.into_inner().filter(|p| p.as_rule() == Rule::name).map(|p| (name(p), value)));
            }
            Rule::expression => parts.condition = Some(guard(p)),
            Rule::time => parts.time = Some(time(p)),
            Rule::number => parts.number = Some((number(&p), span(&p))),
            Rule::text => {
                // What is shown of a line that fails is what it does, not why.
                let end = source[..p.as_span().start() - place.range().start].trim_end().len();
                place = Span::new(place.range().start, place.range().start + end);
                parts.description = Some(text(p));
            }
            _ => {}
        }
    }
    let Parts { names, forced, condition, time, number, description } = parts;
    let doing = match rule {
        Rule::preset => Doing::Set(names, source.starts_with("set")),
        Rule::unknown => Doing::Any(names),
        Rule::press => Doing::Press(names, time),
        Rule::force => Doing::Force(forced),
        Rule::release => Doing::Release(names),
        Rule::place => {
            let mut names = names.into_iter();
            Doing::Place(names.next().expect("an actuator"), names.next().expect("a position"))
        }
        Rule::wait => {
            let time = time.expect("a wait has a time");
            condition.map_or(Doing::Wait(time), |condition| Doing::Until(condition, time))
        }
        Rule::expect => Doing::Expect(condition.expect("an expectation has a condition")),
        Rule::watch => Doing::Watch(condition.expect("a watch has a condition"), source.starts_with("always")),
        Rule::repeat => {
            let (count, span) = number.expect("a repetition has a number");
            Doing::Repeat(count, span, inner)
        }
        other => unreachable!("{other:?} is no line of a scenario"),
    };
    Step { doing, span: place, description }
}

/// A line whose text says what is done, and not why.
fn happens(p: Pair<'_, Rule>) -> Step {
    let place = span(&p);
    let (mut what, mut before) = (None, false);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::text => what = Some(text(p)),
            Rule::before => before = true,
            _ => {}
        }
    }
    Step { doing: Doing::Happens(what, before), span: place, description: None }
}

/// What lines of scenarios consist of.
#[derive(Default)]
struct Parts {
    names: Vec<Name>,
    forced: Vec<(Name, bool)>,
    condition: Option<Guard>,
    time: Option<Time>,
    number: Option<(Option<u32>, Span)>,
    description: Option<Text>,
}

fn hidden(p: Pair<'_, Rule>) -> Hidden {
    let mut hidden = Hidden { name: Name { text: String::new(), span: span(&p) }, integer: None, description: None };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => hidden.name = name(p),
            Rule::range => hidden.integer = Some(numbers::range(p)),
            Rule::integer => {
                if let Some(ast::VariableKind::Integer { initial, .. }) = &mut hidden.integer {
                    *initial = Some(numbers::integer(p));
                }
            }
            Rule::text => hidden.description = Some(text(p)),
            _ => {}
        }
    }
    hidden
}

fn happening(p: Pair<'_, Rule>) -> Happening {
    let (mut words, mut condition, mut outcomes) = (None, None, Vec::new());
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::text => words = Some(text(p)),
            Rule::expression => condition = Some(guard(p)),
            Rule::outcome => {
                let (mut effects, mut when) = (Vec::new(), None);
                for p in p.into_inner() {
                    match p.as_rule() {
                        Rule::effect => effects.extend(effect(p)),
                        Rule::expression => when = Some(guard(p)),
                        _ => {}
                    }
                }
                outcomes.push((effects.pop().expect("an outcome has an effect"), when));
            }
            _ => {}
        }
    }
    Happening {
        text: words.expect("a step has a text"),
        condition: condition.expect("a step has a condition"),
        outcomes,
    }
}

fn travel(p: Pair<'_, Rule>) -> Travel {
    let (mut actuator, mut times, mut driven, mut power, mut description) = (None, Vec::new(), None, None, None);
    let mut at_most = false;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => actuator = Some(name(p)),
            Rule::at_most => at_most = true,
            Rule::time => times.push(time(p)),
            Rule::driven => driven = Some(span(&p)),
            Rule::expression => power = Some(guard(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    let actuator = actuator.expect("what travels has a name");
    Travel { actuator, at_most, out: times[0], back: times.get(1).copied(), driven, power, description }
}

fn rule(p: Pair<'_, Rule>) -> ast::Rule {
    let (mut target, mut change, mut condition, mut delay, mut description) = (None, None, None, None, None);
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => target = Some(name(p)),
            Rule::change => {
                change = Some(match p.as_str() {
                    c if c.starts_with("rises") => Change::Rises,
                    c if c.starts_with("falls") => Change::Falls,
                    _ => Change::Follows,
                });
            }
            Rule::expression => condition = Some(guard(p)),
            Rule::time => delay = Some(time(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    ast::Rule {
        target: target.expect("a rule has a target"),
        change: change.expect("a rule has a verb"),
        condition: condition.expect("a rule has a condition"),
        delay,
        description,
    }
}

/// A duration or a number of scans.
fn time(p: Pair<'_, Rule>) -> Time {
    let place = span(&p);
    let inner = p.into_inner().next().expect("a time is a duration or scans");
    let unit = if inner.as_rule() == Rule::scans { TimeUnit::Scans } else { TimeUnit::Milliseconds };
    let mut parts = inner.into_inner();
    let value = parts.next().as_ref().and_then(number);
    let factor = if parts.next().is_some_and(|u| u.as_str() == "s") { 1000 } else { 1 };
    Time { value: value.and_then(|v| v.checked_mul(factor)), unit, span: place }
}
