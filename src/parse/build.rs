//! The parser's pairs to the syntax tree.
//!
//! The grammar guarantees the shape of what arrives here; what it does not guarantee (that a number
//! fits) is turned into a value that a later stage refuses.

use super::scan::on_one_line;
use super::{Rule, derive, functions, numbers, properties, scenarios, ways};
use crate::base::Span;
use crate::ir::ast::*;
use crate::ir::expr::Expr;
use pest::iterators::Pair;

/// What could not be parsed, kept for the second look.
pub type Bad<'i> = Vec<Pair<'i, Rule>>;

/// The tree of a file. What a recovery rule caught goes into `bad` and is missing in the tree.
pub fn machine<'i>(file: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Machine {
    let pair = file.into_inner().next().expect("a file holds a machine");
    let mut tree = Machine {
        name: Name { text: String::new(), span: Span::default() },
        description: None,
        cycles: Vec::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        variables: Vec::new(),
        events: Vec::new(),
        actuators: Vec::new(),
        functions: Vec::new(),
        sequences: Vec::new(),
        observers: Vec::new(),
        charts: Vec::new(),
        safety: Vec::new(),
        properties: Vec::new(),
        accepted: Vec::new(),
        plants: Vec::new(),
        scenarios: Vec::new(),
    };
    for p in pair.into_inner() {
        match p.as_rule() {
            Rule::name => tree.name = name(p),
            Rule::text => tree.description = Some(text(p)),
            Rule::cycle => tree.cycles.push(duration_in(p)),
            Rule::inputs => entries(p, bad, &mut tree.inputs, signal),
            Rule::outputs => entries(p, bad, &mut tree.outputs, signal),
            Rule::variables => entries(p, bad, &mut tree.variables, variable),
            Rule::events => entries(p, bad, &mut tree.events, event),
            Rule::actuator => tree.actuators.push(actuator(p, bad)),
            Rule::function => tree.functions.push(functions::function(p, bad)),
            Rule::sequence => tree.sequences.push(functions::sequence(p, bad)),
            Rule::observer => tree.observers.push(observer(p, bad)),
            Rule::chart => tree.charts.push(chart(p, bad)),
            Rule::safety => tree.safety.push(safety(p, bad)),
            Rule::properties => properties::properties(p, bad, &mut tree),
            Rule::plant => tree.plants.push(scenarios::plant(p, bad)),
            Rule::scenario => tree.scenarios.push(scenarios::scenario(p, bad)),
            Rule::bad_part => bad.push(p),
            _ => {}
        }
    }
    tree
}

pub fn span(p: &Pair<'_, Rule>) -> Span {
    // A pair's span ends where its last token does; white space before its end is not part of it.
    let s = p.as_span();
    Span::new(s.start(), s.start() + s.as_str().trim_end().len())
}

pub fn name(p: Pair<'_, Rule>) -> Name {
    Name { text: p.as_str().to_owned(), span: span(&p) }
}

pub fn text(p: Pair<'_, Rule>) -> Text {
    let span = span(&p);
    let raw = &p.as_str()[1..p.as_str().len() - 1];
    Text { value: raw.replace("\\\"", "\"").replace("\\\\", "\\"), span }
}

pub fn number(p: &Pair<'_, Rule>) -> Option<u32> {
    p.as_str().parse().ok()
}

fn entries<'i, T>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, into: &mut Vec<T>, build: impl Fn(Pair<'i, Rule>) -> T) {
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::signal | Rule::variable | Rule::event => into.push(build(p)),
            Rule::bad_signal | Rule::bad_variable | Rule::bad_event => bad.push(p),
            _ => {}
        }
    }
}

/// The duration that stands in `p`.
pub fn duration_in(p: Pair<'_, Rule>) -> Duration {
    duration(p.into_inner().find(|p| p.as_rule() == Rule::duration).expect("a duration stands here"))
}

fn duration(p: Pair<'_, Rule>) -> Duration {
    let span = span(&p);
    let mut parts = p.into_inner();
    let value = parts.next().as_ref().and_then(number);
    let seconds = parts.next().is_some_and(|u| u.as_str() == "s");
    let milliseconds = value.and_then(|v| v.checked_mul(if seconds { 1000 } else { 1 }));
    Duration { milliseconds, span }
}

fn signal(p: Pair<'_, Rule>) -> Signal {
    let mut signal = Signal { name: Name { text: String::new(), span: span(&p) }, address: None, description: None };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => signal.name = name(p),
            Rule::address => signal.address = Some(name(p)),
            Rule::text => signal.description = Some(text(p)),
            _ => {}
        }
    }
    signal
}

fn variable(p: Pair<'_, Rule>) -> Variable {
    let mut variable = Variable {
        name: Name { text: String::new(), span: span(&p) },
        kind: VariableKind::Bool(false),
        description: None,
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => variable.name = name(p),
            Rule::constant => variable.kind = VariableKind::Bool(p.as_str() == "true"),
            Rule::range => variable.kind = numbers::range(p),
            Rule::integer => {
                if let VariableKind::Integer { initial, .. } = &mut variable.kind {
                    *initial = Some(numbers::integer(p));
                }
            }
            Rule::text => variable.description = Some(text(p)),
            _ => {}
        }
    }
    variable
}

fn event(p: Pair<'_, Rule>) -> Event {
    let mut event = Event { name: Name { text: String::new(), span: span(&p) }, description: None };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => event.name = name(p),
            Rule::text => event.description = Some(text(p)),
            _ => {}
        }
    }
    event
}

fn actuator<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Actuator {
    let place = span(&p);
    let mut actuator = Actuator {
        name: Name { text: String::new(), span: place },
        technology: Technology::OnOff,
        technology_span: place,
        valve: None,
        by: None,
        description: None,
        positions: Vec::new(),
    };
    let mut named = false;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name if !named => {
                actuator.name = name(p);
                named = true;
            }
            Rule::name => actuator.by = Some(name(p)),
            Rule::technology => {
                actuator.technology_span = span(&p);
                actuator.technology = match p.as_str() {
                    "bistable" => Technology::Bistable,
                    "monostable" => Technology::Monostable,
                    _ => Technology::OnOff,
                };
            }
            Rule::valve => {
                let kind = p.into_inner().find(|p| p.as_rule() == Rule::valve_kind).expect("a valve is of a kind");
                let valve = if kind.as_str() == "memory" { Valve::Memory } else { Valve::ClosedCentre };
                actuator.valve = Some((valve, span(&kind)));
            }
            Rule::text => actuator.description = Some(text(p)),
            Rule::position => actuator.positions.push(position(p)),
            Rule::bad_position => bad.push(p),
            _ => {}
        }
    }
    actuator
}

fn position(p: Pair<'_, Rule>) -> Position {
    let named = Name { text: String::new(), span: span(&p) };
    let mut position = Position { name: named, output: None, sensor: None, limit: None, description: None };
    let mut output = false;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::kw_output => output = true,
            Rule::name if output => position.output = Some(name(p)),
            Rule::name => position.name = name(p),
            Rule::expression => position.sensor = Some(guard(p)),
            Rule::limit => position.limit = Some(limit(p)),
            Rule::text => position.description = Some(text(p)),
            _ => {}
        }
    }
    position
}

fn limit(p: Pair<'_, Rule>) -> Limit {
    let whole = span(&p);
    let (mut time, mut effects) = (None, Vec::new());
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::duration => time = Some(duration(p)),
            Rule::effect => effects.extend(effect(p)),
            _ => {}
        }
    }
    Limit { time: time.expect("a limit has a time"), effects, span: whole }
}

fn chart<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Chart {
    let head = Head::read(p, bad);
    Chart {
        name: head.name,
        controls: head.controls,
        description: head.description,
        body: head.body.expect("a chart has a body"),
    }
}

fn observer<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Observer {
    let inside = p.clone().into_inner().find(|p| p.as_rule() == Rule::observer_body).expect("an observer has a body");
    let after_filter = inside.into_inner().filter(|p| p.as_rule() == Rule::after_filter);
    let after_filter = after_filter.map(|p| body(p, bad)).collect();
    let head = Head::read(p, bad);
    Observer {
        name: head.name,
        description: head.description,
        body: head.body.expect("an observer has a body"),
        after_filter,
    }
}

/// What charts, states and regions have in common.
struct Head {
    name: Name,
    modifiers: Vec<(Span, &'static str)>,
    position: Option<Name>,
    controls: Option<Name>,
    description: Option<Text>,
    body: Option<Body>,
}

impl Head {
    fn read<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Head {
        let mut head = Head {
            name: Name { text: String::new(), span: span(&p) },
            modifiers: Vec::new(),
            position: None,
            controls: None,
            description: None,
            body: None,
        };
        let mut before = None;
        for p in p.into_inner() {
            let rule = p.as_rule();
            match rule {
                Rule::modifier => {
                    let word = match p.as_str().trim_end() {
                        "initial" => "initial",
                        "final" => "final",
                        _ => "parallel",
                    };
                    head.modifiers.push((span(&p), word));
                }
                Rule::name => match before {
                    Some(Rule::kw_at) => head.position = Some(name(p)),
                    Some(Rule::kw_controls) => head.controls = Some(name(p)),
                    _ => head.name = name(p),
                },
                Rule::text => head.description = Some(text(p)),
                Rule::body | Rule::outer_body | Rule::observer_body => head.body = Some(body(p, bad)),
                _ => {}
            }
            before = Some(rule);
        }
        head
    }

    fn modifier(&self, word: &str) -> Option<Span> {
        self.modifiers.iter().find(|(_, w)| *w == word).map(|(s, _)| *s)
    }
}

fn body<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Body {
    let mut body = Body { span: span(&p), ..Body::default() };
    p.into_inner().for_each(|p| item(p, bad, &mut body));
    body
}

/// Puts one item to the others between its braces.
pub fn item<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>, body: &mut Body) {
    match p.as_rule() {
        Rule::state => {
            let head = Head::read(p, bad);
            body.states.push(State {
                initial: head.modifier("initial"),
                is_final: head.modifier("final"),
                parallel: head.modifier("parallel"),
                name: head.name,
                position: head.position,
                controls: head.controls,
                description: head.description,
                body: head.body,
            });
        }
        Rule::region => {
            let head = Head::read(p, bad);
            body.regions.push(Region {
                name: head.name,
                controls: head.controls,
                description: head.description,
                body: head.body.expect("a region has a body"),
            });
        }
        Rule::choice => body.choices.push(ways::choice(p, bad)),
        Rule::transition => body.transitions.push(transition(p)),
        Rule::drive => {
            let (output, condition) = named_condition(p);
            body.drives.push(Drive { output, condition });
        }
        Rule::action => {
            let value = p.as_str().starts_with("sets");
            let (variable, condition) = named_condition(p);
            body.actions.push(Action { variable, value, condition });
        }
        Rule::entry => body.entry.extend(p.into_inner().filter_map(effect)),
        Rule::exit => body.exit.extend(p.into_inner().filter_map(effect)),
        Rule::internal => body.internals.push(ways::internal(p)),
        Rule::bad_item | Rule::bad_outer_item => bad.push(p),
        _ => {}
    }
}

/// The effect that the pair is, if it is one.
pub fn effect(p: Pair<'_, Rule>) -> Option<Effect> {
    if p.as_rule() != Rule::effect {
        return None;
    }
    let mut value = match p.as_str() {
        text if text.starts_with("raise") => EffectValue::Raised,
        text => EffectValue::Bool(text.starts_with("set")),
    };
    let mut variable = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => variable = Some(name(p)),
            Rule::sum => {
                let span = span(&p);
                value = EffectValue::Integer(numbers::sum(p), span);
            }
            _ => {}
        }
    }
    Some(Effect { variable: variable.expect("an effect has a name"), value })
}

fn named_condition(p: Pair<'_, Rule>) -> (Name, Option<Guard>) {
    let mut named = Name { text: String::new(), span: span(&p) };
    let mut condition = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => named = name(p),
            Rule::expression => condition = Some(guard(p)),
            _ => {}
        }
    }
    (named, condition)
}

fn transition(p: Pair<'_, Rule>) -> Transition {
    let whole = span(&p);
    let mut source = None;
    let mut target = None;
    let mut movement = None;
    let mut priority = None;
    let mut guard_ = None;
    let mut effects = Vec::new();
    let mut description = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::kw_move => movement = Some(Movement { span: span(&p), name: None }),
            Rule::source => {
                let place = span(&p);
                let inner = p.into_inner().next().expect("a source is others, a path or several");
                source = Some(match inner.as_rule() {
                    Rule::path => Source::State(path(inner)),
                    Rule::several => Source::Join(ways::paths(inner)),
                    _ => {
                        let except = inner.into_inner().filter(|p| p.as_rule() == Rule::path).map(path).collect();
                        Source::Any { except, span: place }
                    }
                });
            }
            Rule::path if source.is_none() => source = Some(Source::State(path(p))),
            Rule::path => target = Some(Target::State(path(p))),
            Rule::target => target = Some(ways::target(p)),
            Rule::name => {
                // Only a movement has a name of its own.
                if let Some(movement) = &mut movement {
                    movement.name = Some(name(p));
                }
            }
            Rule::number => priority = Some((number(&p).unwrap_or(u32::MAX), span(&p))),
            Rule::expression => guard_ = Some(guard(p)),
            Rule::effect => effects.extend(effect(p)),
            Rule::text => description = Some(text(p)),
            _ => {}
        }
    }
    let source = source.expect("a transition has a source");
    let target = target.expect("a transition has a target");
    Transition { source, target, movement, priority, guard: guard_, effects, description, span: whole }
}

fn safety<'i>(p: Pair<'i, Rule>, bad: &mut Bad<'i>) -> Safety {
    let mut safety = Safety {
        mode: Name { text: String::new(), span: span(&p) },
        in_order: None,
        reset: None,
        constraints: Vec::new(),
        assumptions: Vec::new(),
        forbids: Vec::new(),
        unkept: Vec::new(),
        derives: Vec::new(),
    };
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::mode => safety.mode = name(p),
            Rule::relief => safety.in_order = Some(span(&p)),
            Rule::reset_by => safety.reset = p.into_inner().find(|p| p.as_rule() == Rule::name).map(name),
            Rule::constraint => safety.constraints.push(constraint(p)),
            Rule::assumption => safety.assumptions.push(constraint(p)),
            Rule::forbid => safety.forbids.push(derive::forbid(p)),
            Rule::derive => safety.derives.push(derive::derive(p)),
            Rule::bad_constraint => bad.push(p),
            _ => {}
        }
    }
    safety
}

fn constraint(p: Pair<'_, Rule>) -> Constraint {
    let mut named = None;
    let mut yields = Vec::new();
    let mut condition = None;
    let mut reason = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => named = Some(name(p)),
            Rule::never => {
                for p in p.into_inner() {
                    match p.as_rule() {
                        Rule::expression => condition = Some(guard(p)),
                        Rule::name => yields.push(name(p)),
                        Rule::text => reason = Some(text(p)),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    Constraint {
        name: named.expect("a constraint has a name"),
        never: condition.expect("a constraint has a condition"),
        yields,
        text: reason,
        from: Vec::new(),
    }
}

pub fn path(p: Pair<'_, Rule>) -> Path {
    Path { parts: p.into_inner().filter(|p| p.as_rule() == Rule::name).map(name).collect() }
}

fn path_ref(p: Pair<'_, Rule>) -> PathRef {
    PathRef { parts: path(p).parts.into_iter().map(|n| (n.text, n.span)).collect() }
}

pub fn guard(p: Pair<'_, Rule>) -> Guard {
    let span = span(&p);
    let written = on_one_line(p.as_str());
    Guard { expr: expression(p), written, span }
}

/// An expression; recursion is bounded by the nesting limit of parentheses.
fn expression(p: Pair<'_, Rule>) -> Expr<Term> {
    let mut operands = p.into_inner().filter(|p| p.as_rule() == Rule::exclusive).map(exclusive);
    let first = operands.next().expect("an expression has an operand");
    match operands.next() {
        None => first,
        Some(second) => Expr::Or([first, second].into_iter().chain(operands).collect()),
    }
}

fn exclusive(p: Pair<'_, Rule>) -> Expr<Term> {
    let mut operands: Vec<_> = p.into_inner().filter(|p| p.as_rule() == Rule::conjunction).map(conjunction).collect();
    // Pairwise, so that a long chain becomes a shallow tree: xor is associative.
    while operands.len() > 1 {
        let mut halves = Vec::with_capacity(operands.len().div_ceil(2));
        let mut rest = operands.into_iter();
        while let Some(left) = rest.next() {
            halves.push(match rest.next() {
                Some(right) => Expr::Xor(Box::new(left), Box::new(right)),
                None => left,
            });
        }
        operands = halves;
    }
    operands.pop().expect("an expression has an operand")
}

fn conjunction(p: Pair<'_, Rule>) -> Expr<Term> {
    let mut operands = p.into_inner().filter(|p| p.as_rule() == Rule::negation).map(negation);
    let first = operands.next().expect("an expression has an operand");
    match operands.next() {
        None => first,
        Some(second) => Expr::And([first, second].into_iter().chain(operands).collect()),
    }
}

fn negation(p: Pair<'_, Rule>) -> Expr<Term> {
    let mut negated = false;
    let mut value = None;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::kw_not => negated = !negated,
            Rule::primary => value = Some(primary(p)),
            _ => {}
        }
    }
    let value = value.expect("a negation has an operand");
    if negated { Expr::Not(Box::new(value)) } else { value }
}

fn primary(p: Pair<'_, Rule>) -> Expr<Term> {
    let place = span(&p);
    let inner = p.into_inner().next().expect("a primary holds something");
    match inner.as_rule() {
        Rule::comparison => Expr::Atom(Term::Compare(numbers::comparison(inner), place)),
        Rule::expression => expression(inner),
        Rule::constant => Expr::Const(inner.as_str() == "true"),
        Rule::kw_done => Expr::Atom(Term::Done(place)),
        Rule::kw_blocked => Expr::Atom(Term::Blocked(place)),
        Rule::elapsed => Expr::Atom(Term::After(duration_in(inner))),
        Rule::path => Expr::Atom(Term::Value(path_ref(inner))),
        Rule::call => {
            let mut parts = inner.into_inner();
            let function = parts.next().expect("a call has a function");
            let of_state = function.as_rule() == Rule::past;
            let function = function.as_str().to_owned();
            let argument = path_ref(parts.find(|p| p.as_rule() == Rule::path).expect("a call has an argument"));
            Expr::Atom(match function.as_str() {
                "prev" if of_state => Term::PrevIn(argument),
                "rise" if of_state => Term::RiseIn(argument),
                "fall" if of_state => Term::FallIn(argument),
                "prev" => Term::Prev(argument),
                "rise" => Term::Rise(argument),
                "fall" => Term::Fall(argument),
                "in" => Term::In(argument),
                "alarm" => Term::Alarm(argument),
                "acts" => Term::Acts(argument),
                "first" => Term::First(argument),
                _ => Term::DoneOf(argument),
            })
        }
        other => unreachable!("{other:?} is no primary"),
    }
}
