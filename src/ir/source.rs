//! The text form of a syntax tree: the model as it would be written without comments.
//!
//! Reading it back gives the same tree, places apart.

use super::ast::*;
use super::expr::{CHART, Expr};
use super::number::Number;
use crate::base::figure;
use std::fmt::{self, Write};

/// Writes the tree as source text.
pub fn source(machine: &Machine) -> String {
    let mut w = Writer { out: String::new(), depth: 0 };
    w.machine(machine).expect("writing to a string succeeds");
    w.out
}

struct Writer {
    out: String,
    depth: usize,
}

impl Writer {
    fn line(&mut self, text: fmt::Arguments<'_>) -> fmt::Result {
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
        self.out.write_fmt(text)?;
        self.out.push('\n');
        Ok(())
    }

    fn block(&mut self, head: fmt::Arguments<'_>, inside: impl FnOnce(&mut Self) -> fmt::Result) -> fmt::Result {
        self.line(format_args!("{head} {{"))?;
        self.depth += 1;
        inside(self)?;
        self.depth -= 1;
        self.line(format_args!("}}"))
    }

    fn machine(&mut self, m: &Machine) -> fmt::Result {
        self.line(format_args!("machine {}{}", m.name.text, text(&m.description)))?;
        for cycle in &m.cycles {
            self.line(format_args!("cycle {}ms", cycle.milliseconds.unwrap_or(0)))?;
        }
        for (word, signals) in [("inputs", &m.inputs), ("outputs", &m.outputs)] {
            if signals.is_empty() {
                continue;
            }
            self.block(format_args!("{word}"), |w| {
                signals.iter().try_for_each(|s| {
                    let address = clause("at", s.address.as_ref());
                    w.line(format_args!("{}{address}{}", s.name.text, text(&s.description)))
                })
            })?;
        }
        if !m.variables.is_empty() {
            self.block(format_args!("variables"), |w| {
                m.variables.iter().try_for_each(|v| {
                    w.line(format_args!("{} : {}{}", v.name.text, kind(&v.kind), text(&v.description)))
                })
            })?;
        }
        if !m.events.is_empty() {
            self.block(format_args!("events"), |w| {
                m.events.iter().try_for_each(|e| w.line(format_args!("{}{}", e.name.text, text(&e.description))))
            })?;
        }
        m.actuators.iter().try_for_each(|a| self.actuator(a))?;
        m.functions.iter().try_for_each(|f| self.function(f))?;
        m.sequences.iter().try_for_each(|s| self.sequence(s))?;
        for observer in &m.observers {
            let head = format!("observer {}{}", observer.name.text, text(&observer.description));
            self.block(format_args!("{head}"), |w| {
                w.body(&observer.body)?;
                observer.after_filter.iter().try_for_each(|b| w.block(format_args!("after filter"), |w| w.body(b)))
            })?;
        }
        for chart in &m.charts {
            let head = format!(
                "chart {}{}{}",
                chart.name.text,
                clause("controls", chart.controls.as_ref()),
                text(&chart.description)
            );
            self.block(format_args!("{head}"), |w| w.body(&chart.body))?;
        }
        m.safety.iter().try_for_each(|s| self.safety(s))?;
        if !m.properties.is_empty() || !m.accepted.is_empty() {
            self.block(format_args!("properties"), |w| {
                m.properties.iter().try_for_each(|p| {
                    let assumed = if p.kind == PropertyKind::Fair { "assume " } else { "" };
                    let (name, text, holds) = (&p.name.text, text(&p.text), condition(&p.condition));
                    match &p.after {
                        Some(after) => {
                            w.line(format_args!("{name}: after {} eventually {holds}{text}", condition(after)))
                        }
                        None => w.line(format_args!("{assumed}{name}: {} {holds}{text}", p.kind.words())),
                    }
                })?;
                m.accepted.iter().try_for_each(|a| w.line(format_args!("{}{}", a.written, quoted(&a.reason))))
            })?;
        }
        m.plants.iter().try_for_each(|p| self.plant(p))?;
        m.scenarios.iter().try_for_each(|s| {
            let after = s.after.as_ref().map(|t| format!(" after{}", quoted(t))).unwrap_or_default();
            self.block(format_args!("scenario{}{after}", quoted(&s.name)), |w| w.steps(&s.steps))
        })
    }

    fn function(&mut self, f: &Function) -> fmt::Result {
        let automatic = if f.automatic.is_some() { " automatic" } else { "" };
        self.block(format_args!("function {}{automatic}{}", f.name.text, text(&f.description)), |w| {
            for (word, guards) in [
                ("request", &f.request),
                ("release", &f.release),
                ("activate", &f.activate),
                ("deactivate", &f.deactivate),
                ("abort", &f.abort),
            ] {
                guards.iter().try_for_each(|g| w.line(format_args!("{word} when {}", condition(g))))?;
            }
            w.body(&f.body)
        })
    }

    fn sequence(&mut self, s: &Sequence) -> fmt::Result {
        self.block(format_args!("sequence {}{}", s.name.text, text(&s.description)), |w| {
            s.abort.iter().try_for_each(|g| w.line(format_args!("abort when {}", condition(g))))?;
            s.steps.iter().try_for_each(|step| {
                let doing = match &step.doing {
                    SequenceDoing::Do(jobs) => {
                        let job = |j: &Job| {
                            let until = j.until.as_ref().map(|g| format!(" until {}", condition(g)));
                            format!("{}{}", j.function.text, until.unwrap_or_default())
                        };
                        format!("do {}", jobs.iter().map(job).collect::<Vec<_>>().join(", "))
                    }
                    SequenceDoing::Activate(names) => format!("activate {}", list(names)),
                    SequenceDoing::Deactivate(names) => format!("deactivate {}", list(names)),
                    SequenceDoing::Until(g) => format!("wait until {}", condition(g)),
                    SequenceDoing::Wait(d) => format!("wait {}ms", d.milliseconds.unwrap_or(0)),
                };
                w.line(format_args!("{doing}{}", text(&step.description)))
            })
        })
    }

    fn plant(&mut self, p: &Plant) -> fmt::Result {
        let head = if p.by_steps.is_some() { "plant by steps" } else { "plant" };
        self.block(format_args!("{head}"), |w| {
            for h in &p.hidden {
                let kind = h.integer.as_ref().map(|k| format!(" : {}", kind(k))).unwrap_or_default();
                w.line(format_args!("hidden {}{kind}{}", h.name.text, text(&h.description)))?;
            }
            for s in &p.steps {
                let one = |(e, w): &(Effect, Option<Guard>)| format!("{}{}", effects(std::slice::from_ref(e)), when(w));
                let outcomes = s.outcomes.iter().map(one).collect::<Vec<_>>().join(", ");
                let head = text(&Some(s.text.clone()));
                w.line(format_args!("step{head} when {} then {outcomes}", condition(&s.condition)))?;
            }
            if !p.initially.is_empty() {
                w.block(format_args!("initially"), |w| w.steps(&p.initially))?;
            }
            for t in &p.travels {
                let back = t.back.map(|b| format!(" back {}", time(&b))).unwrap_or_default();
                let driven = if t.driven.is_some() { " while driven" } else { "" };
                let most = if t.at_most { "at most " } else { "" };
                let (name, out) = (&t.actuator.text, time(&t.out));
                w.line(format_args!(
                    "{name} travels {most}{out}{back}{driven}{}{}",
                    when(&t.power),
                    text(&t.description)
                ))?;
            }
            p.rules.iter().try_for_each(|r| {
                let verb = match r.change {
                    Change::Follows => "follows",
                    Change::Rises => "rises when",
                    Change::Falls => "falls when",
                };
                let delay = r.delay.map(|d| format!(" after {}", time(&d))).unwrap_or_default();
                let (name, condition) = (&r.target.text, condition(&r.condition));
                w.line(format_args!("{name} {verb} {condition}{delay}{}", text(&r.description)))
            })
        })
    }

    fn steps(&mut self, steps: &[Step]) -> fmt::Result {
        steps.iter().try_for_each(|s| {
            let line = match &s.doing {
                Doing::Set(names, value) => format!("{} {}", if *value { "set" } else { "reset" }, list(names)),
                Doing::Any(names) => format!("any {}", list(names)),
                Doing::Press(names, None) => format!("press {}", list(names)),
                Doing::Press(names, Some(t)) => format!("press {} for {}", list(names), time(t)),
                Doing::Force(forced) => {
                    let one = |(n, v): &(Name, bool)| format!("{}{}", if *v { "" } else { "not " }, n.text);
                    format!("force {}", forced.iter().map(one).collect::<Vec<_>>().join(", "))
                }
                Doing::Release(names) => format!("release {}", list(names)),
                Doing::Place(actuator, position) => format!("place {} at {}", actuator.text, position.text),
                Doing::Happens(None, _) => "happens nothing".to_owned(),
                Doing::Happens(Some(what), before) => {
                    format!("happens{}{}", quoted(what), if *before { " before writing" } else { "" })
                }
                Doing::Wait(t) => format!("wait {}", time(t)),
                Doing::Until(g, t) => format!("wait until {} within {}", condition(g), time(t)),
                Doing::Expect(g) => format!("expect {}", condition(g)),
                Doing::Watch(g, value) => format!("{} {}", if *value { "always" } else { "never" }, condition(g)),
                Doing::Repeat(count, _, inner) => {
                    let head = format!("repeat {}", count.unwrap_or(0));
                    return self.block(format_args!("{head}"), |w| w.steps(inner));
                }
            };
            self.line(format_args!("{line}{}", text(&s.description)))
        })
    }

    fn actuator(&mut self, a: &Actuator) -> fmt::Result {
        let technology = match a.technology {
            Technology::Bistable => "bistable",
            Technology::Monostable => "monostable",
            Technology::OnOff => "onoff",
        };
        let valve = match a.valve {
            None => "",
            Some((Valve::ClosedCentre, _)) => " valve closed-centre",
            Some((Valve::Memory, _)) => " valve memory",
        };
        let (by, about) = (clause("by", a.by.as_ref()), text(&a.description));
        let head = format!("actuator {} {technology}{valve}{by}{about}", a.name.text);
        if a.positions.is_empty() {
            return self.line(format_args!("{head}"));
        }
        self.block(format_args!("{head}"), |w| {
            a.positions.iter().try_for_each(|p| {
                let sensor = p.sensor.as_ref().map(|g| format!(" sensor {}", condition(g))).unwrap_or_default();
                let output = clause("output", p.output.as_ref());
                let limit = p.limit.as_ref().map(limit).unwrap_or_default();
                w.line(format_args!("position {}{output}{sensor}{limit}{}", p.name.text, text(&p.description)))
            })
        })
    }

    fn body(&mut self, body: &Body) -> fmt::Result {
        for drive in &body.drives {
            self.line(format_args!("drives {}{}", drive.output.text, when(&drive.condition)))?;
        }
        for action in &body.actions {
            let verb = if action.value { "sets" } else { "resets" };
            self.line(format_args!("{verb} {}{}", action.variable.text, when(&action.condition)))?;
        }
        for (word, list) in [("entry", &body.entry), ("exit", &body.exit)] {
            if !list.is_empty() {
                self.line(format_args!("{word} {}", effects(list)))?;
            }
        }
        for t in &body.internals {
            let (when, then) = (condition(&t.guard), then(&t.effects));
            self.line(format_args!("internal when {when}{then}{}", text(&t.description)))?;
        }
        for region in &body.regions {
            let head = format!(
                "region {}{}{}",
                region.name.text,
                clause("controls", region.controls.as_ref()),
                text(&region.description)
            );
            self.block(format_args!("{head}"), |w| w.body(&region.body))?;
        }
        body.states.iter().try_for_each(|s| self.state(s))?;
        body.choices.iter().try_for_each(|c| self.choice(c))?;
        body.transitions.iter().try_for_each(|t| self.transition(t))
    }

    fn state(&mut self, s: &State) -> fmt::Result {
        let word = |present: bool, word: &str| if present { format!("{word} ") } else { String::new() };
        let head = format!(
            "{}{}{}state {}{}{}{}",
            word(s.initial.is_some(), "initial"),
            word(s.is_final.is_some(), "final"),
            word(s.parallel.is_some(), "parallel"),
            s.name.text,
            clause("at", s.position.as_ref()),
            clause("controls", s.controls.as_ref()),
            text(&s.description)
        );
        match &s.body {
            None => self.line(format_args!("{head}")),
            Some(body) => self.block(format_args!("{head}"), |w| w.body(body)),
        }
    }

    fn transition(&mut self, t: &Transition) -> fmt::Result {
        let source = match &t.source {
            Source::State(path) => words(path),
            Source::Any { except, .. } if except.is_empty() => "any".to_owned(),
            Source::Any { except, .. } => {
                format!("any except {}", except.iter().map(words).collect::<Vec<_>>().join(", "))
            }
            Source::Join(paths) => several(paths),
        };
        let (verb, name) = match &t.movement {
            Some(m) => ("move from", clause("as", m.name.as_ref())),
            None => ("from", String::new()),
        };
        self.line(format_args!(
            "{verb} {source} to {}{name}{}{}{}{}",
            target(&t.target),
            priority(t.priority),
            when(&t.guard),
            then(&t.effects),
            text(&t.description)
        ))
    }

    fn choice(&mut self, c: &Choice) -> fmt::Result {
        let initial = if c.initial.is_some() { "initial " } else { "" };
        self.block(format_args!("{initial}choice {}{}", c.name.text, text(&c.description)), |w| {
            c.branches.iter().try_for_each(|b| {
                let head = b.guard.as_ref().map_or_else(|| "else".to_owned(), |g| format!("when {}", condition(g)));
                w.line(format_args!("{head} to {}{}{}", target(&b.target), then(&b.effects), text(&b.description)))
            })
        })
    }

    fn safety(&mut self, s: &Safety) -> fmt::Result {
        let relief = if s.in_order.is_some() { " relief in-order" } else { "" };
        self.block(format_args!("safety {}{relief}{}", s.mode.text, clause("reset by", s.reset.as_ref())), |w| {
            for a in &s.assumptions {
                w.line(format_args!("assume {}: never {}{}", a.name.text, condition(&a.never), text(&a.text)))?;
            }
            for f in &s.forbids {
                let (first, word, second) =
                    (place(&f.first), if f.unless { "unless" } else { "and" }, place(&f.second));
                w.line(format_args!("{}: forbid {first} {word} {second}{}", f.name.text, text(&f.text)))?;
            }
            for d in &s.derives {
                let names = if d.names.is_empty() { "all".to_owned() } else { list(&d.names) };
                let edges = if d.edges.is_some() { " by edges" } else { "" };
                let except = if d.except.is_empty() { String::new() } else { format!(" except {}", list(&d.except)) };
                w.line(format_args!("derive {names}{edges}{except}"))?;
            }
            s.constraints.iter().try_for_each(|c| w.line(format_args!("{}", constraint(c))))
        })
    }
}

/// A constraint as a model writes it.
pub fn constraint(c: &Constraint) -> String {
    let yields = if c.yields.is_empty() { String::new() } else { format!(" yields {}", list(&c.yields)) };
    format!("{}: never {}{yields}{}", c.name.text, condition(&c.never), text(&c.text))
}

fn place(place: &Place) -> String {
    match &place.position {
        Some(position) => format!("{} at {}", place.actuator.text, position.text),
        None => format!("{} between", place.actuator.text),
    }
}

fn priority(priority: Option<(u32, crate::base::Span)>) -> String {
    priority.map(|(n, _)| format!(" priority {n}")).unwrap_or_default()
}

/// What a variable can hold.
fn kind(kind: &VariableKind) -> String {
    match kind {
        VariableKind::Bool(initial) => format!("BOOL := {initial}"),
        VariableKind::Integer { lowest, highest, initial, .. } => {
            let initial = initial.map(|(n, _)| format!(" := {n}")).unwrap_or_default();
            format!("{lowest}..{highest}{initial}")
        }
    }
}

fn effects(effects: &[Effect]) -> String {
    let one = |e: &Effect| match &e.value {
        EffectValue::Bool(value) => format!("{} {}", if *value { "set" } else { "reset" }, e.variable.text),
        EffectValue::Raised => format!("raise {}", e.variable.text),
        EffectValue::Integer(value, _) => format!("set {} := {}", e.variable.text, number(value)),
    };
    effects.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn limit(limit: &Limit) -> String {
    format!(" within {}ms else {}", limit.time.milliseconds.unwrap_or(0), effects(&limit.effects))
}

fn then(list: &[Effect]) -> String {
    if list.is_empty() { String::new() } else { format!(" then {}", effects(list)) }
}

fn clause(word: &str, name: Option<&Name>) -> String {
    name.map(|n| format!(" {word} {}", n.text)).unwrap_or_default()
}

fn text(text: &Option<Text>) -> String {
    text.as_ref().map(quoted).unwrap_or_default()
}

fn quoted(t: &Text) -> String {
    format!(" \"{}\"", t.value.replace('\\', "\\\\").replace('"', "\\\""))
}

fn time(t: &Time) -> String {
    let value = t.value.unwrap_or(0);
    match (t.unit, value) {
        (TimeUnit::Milliseconds, _) => format!("{value}ms"),
        (TimeUnit::Scans, _) => figure(value, "scan"),
    }
}

fn list(names: &[Name]) -> String {
    names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(", ")
}

fn when(guard: &Option<Guard>) -> String {
    guard.as_ref().map(|g| format!(" when {}", condition(g))).unwrap_or_default()
}

fn target(target: &Target) -> String {
    match target {
        Target::State(path) => words(path),
        Target::History { of, deep } => format!("{}history of {}", if *deep { "deep " } else { "" }, words(of)),
        Target::Fork(paths) => several(paths),
    }
}

fn several(paths: &[Path]) -> String {
    format!("({})", paths.iter().map(words).collect::<Vec<_>>().join(", "))
}

fn words(path: &Path) -> String {
    path.parts.iter().map(|p| p.text.as_str()).collect::<Vec<_>>().join(".")
}

fn number(number: &Number<Name>) -> String {
    let mut out = String::new();
    let written = number.write(&mut out, &mut |n, f| f.write_str(&n.text));
    written.expect("writing to a string succeeds");
    out
}

fn condition(guard: &Guard) -> String {
    expression(&guard.expr)
}

/// A condition as the language writes it.
pub fn expression(expr: &Expr<Term>) -> String {
    let mut out = String::new();
    let path = |p: &PathRef| p.parts.iter().map(|(t, _)| t.as_str()).collect::<Vec<_>>().join(".");
    let written = expr.write(&mut out, &CHART, &mut |term, f| match term {
        Term::Value(p) => f.write_str(&path(p)),
        Term::Compare(c, _) => c.write(f, &mut |n, f| f.write_str(&n.text)),
        Term::Prev(p) => write!(f, "prev({})", path(p)),
        Term::Rise(p) => write!(f, "rise({})", path(p)),
        Term::Fall(p) => write!(f, "fall({})", path(p)),
        Term::In(p) => write!(f, "in({})", path(p)),
        Term::PrevIn(p) => write!(f, "prev(in({}))", path(p)),
        Term::RiseIn(p) => write!(f, "rise(in({}))", path(p)),
        Term::FallIn(p) => write!(f, "fall(in({}))", path(p)),
        Term::DoneOf(p) => write!(f, "done({})", path(p)),
        Term::Alarm(p) => write!(f, "alarm({})", path(p)),
        Term::Acts(p) => write!(f, "acts({})", path(p)),
        Term::First(p) => write!(f, "first({})", path(p)),
        Term::Done(_) => f.write_str("done"),
        Term::Blocked(_) => f.write_str("blocked"),
        Term::After(time) => write!(f, "after {}ms", time.milliseconds.unwrap_or(0)),
    });
    written.expect("writing to a string succeeds");
    out
}
