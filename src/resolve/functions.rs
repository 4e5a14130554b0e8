//! Functions and sequences to charts, variables and events: the syntax tree as it would be written
//! without them. Everything that follows sees charts only.
//!
//! A function `F` (the paper on validation filters) becomes the chart `F` with the
//! states `F_Off` and `F_Running` (Fi1), the events `F_Activate` (RA), `F_Deactivate` (RD) and
//! `F_Ended`, and the variable `F_Requested` (Fi2). If the learner drives it, the variables `F_ds` and
//! `F_fs` are its alarms.
//!
//! A sequence `S` becomes the chart `S` with a state for each line, `S_1`, `S_2` and so on.

use super::Resolver;
use crate::base::{Code, Diagnostic, Span, iec};
use crate::ir::ast::*;
use crate::ir::expr::Expr;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

/// The tree without functions and sequences.
pub fn expand<'t>(r: &mut Resolver, tree: &'t Machine) -> Cow<'t, Machine> {
    if tree.functions.is_empty() && tree.sequences.is_empty() {
        return Cow::Borrowed(tree);
    }
    let mut plain = Machine { functions: Vec::new(), sequences: Vec::new(), ..tree.clone() };
    let named = named(tree);
    let inputs: HashSet<String> = tree.inputs.iter().map(|i| iec::fold(&i.name.text)).collect();
    let mut charts = Vec::new();
    let mut known = HashMap::new();
    for function in &tree.functions {
        known.insert(iec::fold(&function.name.text), function);
        charts.push(Maker { r, plain: &mut plain, inputs: &inputs, named: &named }.function(function));
    }
    for sequence in &tree.sequences {
        charts.extend(Steps { r, known: &known, sequence }.chart());
    }
    charts.append(&mut plain.charts);
    plain.charts = charts;
    Cow::Owned(plain)
}

/// The signals that the model mentions, and the events that its sequences mean: what a function brings along and
/// nobody names is left out.
fn named(tree: &Machine) -> HashSet<String> {
    let event = |function: &Name, part: &str| iec::fold(&format!("{}_{part}", function.text));
    let meant = tree.sequences.iter().flat_map(|s| &s.steps).flat_map(|step| match &step.doing {
        SequenceDoing::Do(jobs) => jobs
            .iter()
            .flat_map(|job| {
                let end = if job.until.is_some() { "Deactivate" } else { "Ended" };
                [event(&job.function, "Activate"), event(&job.function, end)]
            })
            .collect(),
        SequenceDoing::Activate(names) => names.iter().map(|n| event(n, "Activate")).collect(),
        SequenceDoing::Deactivate(names) => names.iter().map(|n| event(n, "Deactivate")).collect::<Vec<_>>(),
        SequenceDoing::Until(_) | SequenceDoing::Wait(_) => Vec::new(),
    });
    let mut named: HashSet<String> = meant.collect();
    mentions(tree, &mut |word| {
        named.insert(iec::fold(word));
    });
    named
}

struct Maker<'r, 'p> {
    r: &'r mut Resolver,
    plain: &'p mut Machine,
    inputs: &'p HashSet<String>,
    named: &'p HashSet<String>,
}

impl Maker<'_, '_> {
    fn function(&mut self, f: &Function) -> Chart {
        let name = |part: &str| Name { text: format!("{}_{part}", f.name.text), span: f.name.span };
        let what = f.description.as_ref().map_or(f.name.text.as_str(), |t| t.value.as_str());
        let about = |text: String| Some(Text { value: text, span: f.name.span });
        let activate = self.event(name("Activate"), about(format!("{what}: asked for")));
        let deactivate = self.event(name("Deactivate"), about(format!("{what}: asked to end")));
        let ended: Vec<Effect> =
            self.event(name("Ended"), about(format!("{what}: has ended"))).into_iter().map(raised).collect();
        self.variable(name("Requested"), about(format!("{what}: asked for and not yet asked to end")));

        let request = self.only(f, "request", &f.request).map(|g| self.over_inputs(g));
        let release = self.only(f, "release", &f.release).map(|g| self.over_inputs(g));
        let abort = self.only(f, "abort", &f.abort);
        let may = self.only(f, "activate", &f.activate);
        let must = self.only(f, "deactivate", &f.deactivate);

        let asked = any([activate.map(value), request]);
        let unasked = any([deactivate.map(value), release]);
        let (may, must) = (may.unwrap_or(Expr::TRUE), must.unwrap_or(Expr::TRUE));
        let off = name("Off");
        let running = name("Running");
        let mut transitions = Vec::new();
        let mut go = |from: &Name, to: &Name, guard: Expr<Term>, effects: Vec<Effect>| {
            transitions.push(transition(from, to, Some(guard), effects, f.name.span));
        };
        // What a mistake sets, where there can be one: without a condition it always may begin, or end.
        let (mut too_soon, mut too_early) = (Vec::new(), Vec::new());
        if let Some(abort) = &abort {
            go(&running, &off, abort.clone(), Vec::new());
        }
        let calm = |guard: Expr<Term>| match &abort {
            Some(abort) => Expr::And(vec![guard, negated(abort.clone())]),
            None => guard,
        };
        if f.automatic.is_some() {
            let wanted = any([Some(asked.clone()), Some(value(name("Requested")))]);
            go(&off, &running, calm(Expr::And(vec![wanted, may])), Vec::new());
            go(&running, &off, must, [vec![reset(name("Requested"))], ended].concat());
        } else {
            self.variable(name("ds"), about(format!("{what}: asked for while it may not begin")));
            self.variable(name("fs"), about(format!("{what}: asked to end while it must go on")));
            let alarms = vec![reset(name("ds")), reset(name("fs"))];
            // Of two requests in one scan the one to activate counts.
            let only_unasked = Expr::And(vec![unasked.clone(), negated(asked.clone())]);
            go(&off, &running, calm(Expr::And(vec![asked.clone(), may.clone()])), alarms);
            go(&running, &off, Expr::And(vec![only_unasked.clone(), must.clone()]), ended);
            let watch = |wrong: Expr<Term>, alarm: &str| {
                let never = wrong.map(&mut |term| Expr::Atom(term.clone())) == Expr::FALSE;
                (!never).then(|| internal(wrong, vec![set(name(alarm))], f.name.span))
            };
            too_soon.extend(watch(calm(Expr::And(vec![asked.clone(), negated(may)])), "ds"));
            too_early.extend(watch(Expr::And(vec![only_unasked, negated(must)]), "fs"));
        }
        let actions = || {
            let action = |value, condition: Expr<Term>| Action {
                variable: name("Requested"),
                value,
                condition: Some(Guard { expr: condition, written: String::new(), span: f.name.span }),
            };
            let mut actions = vec![action(true, asked.clone()), action(false, unasked.clone())];
            actions.extend(abort.clone().map(|abort| action(false, abort)));
            actions
        };
        let rest = Body { actions: actions(), internals: too_soon.clone(), span: f.name.span, ..Body::default() };
        let mut inside = f.body.clone();
        inside.actions.splice(0..0, actions());
        inside.internals.splice(0..0, too_soon.into_iter().chain(too_early));
        let parallel = (!inside.regions.is_empty()).then_some(f.name.span);
        let states = vec![
            State { initial: Some(f.name.span), ..state(off, about(format!("{what}: does not run")), Some(rest)) },
            State { parallel, ..state(running, f.description.clone(), Some(inside)) },
        ];
        Chart {
            name: f.name.clone(),
            controls: None,
            description: f.description.clone(),
            body: Body { states, transitions, span: f.body.span, ..Body::default() },
        }
    }
}

impl Maker<'_, '_> {
    /// The event, if somebody names it.
    fn event(&mut self, name: Name, description: Option<Text>) -> Option<Name> {
        let named = self.named.contains(&iec::fold(&name.text));
        named.then(|| self.plain.events.push(Event { name: name.clone(), description }))?;
        Some(name)
    }

    fn variable(&mut self, name: Name, description: Option<Text>) {
        self.plain.variables.push(Variable { name, kind: VariableKind::Bool(false), description });
    }

    /// The one clause of a kind; more are an error.
    fn only(&mut self, f: &Function, word: &str, clauses: &[Guard]) -> Option<Expr<Term>> {
        if let [first, again, ..] = clauses {
            self.r.diagnostics.push(
                Diagnostic::new(Code::Repeated, format!("`{}` has `{word} when` more than once", f.name.text))
                    .label(again.span, "given again")
                    .label(first.span, "first given here")
                    .help("join the conditions with `and` or `or`"),
            );
        }
        clauses.first().map(|g| g.expr.clone())
    }

    /// Requests are read in two places of a scan, so they may not depend on what a scan changes.
    fn over_inputs(&mut self, condition: Expr<Term>) -> Expr<Term> {
        condition.for_each_atom(&mut |term| {
            let input = match term {
                Term::Value(p) | Term::Prev(p) | Term::Rise(p) | Term::Fall(p) => {
                    matches!(p.parts.as_slice(), [(word, _)] if self.inputs.contains(&iec::fold(word)))
                }
                _ => false,
            };
            if !input {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, "a request comes from inputs only")
                        .label(place(term), "not an input")
                        .help("let a chart raise the function's event instead"),
                );
            }
        });
        condition
    }
}

/// Makes the chart of a sequence.
struct Steps<'r, 's> {
    r: &'r mut Resolver,
    known: &'s HashMap<String, &'s Function>,
    sequence: &'s Sequence,
}

impl Steps<'_, '_> {
    fn chart(mut self) -> Option<Chart> {
        let s = self.sequence;
        if let [first, again, ..] = s.abort.as_slice() {
            self.r.diagnostics.push(
                Diagnostic::new(Code::Repeated, format!("`{}` has `abort when` more than once", s.name.text))
                    .label(again.span, "given again")
                    .label(first.span, "first given here"),
            );
        }
        let Some(first) = s.steps.first() else {
            self.r.diagnostics.push(
                Diagnostic::new(Code::EmptyState, format!("`{}` does nothing", s.name.text))
                    .label(s.name.span, "holds no step")
                    .help("write `do FUNCTION`, `activate FUNCTION`, `deactivate FUNCTION` or `wait …`"),
            );
            return None;
        };
        let waits = matches!(first.doing, SequenceDoing::Until(_) | SequenceDoing::Wait(_));
        if let (false, Some(abort)) = (waits, s.abort.first()) {
            self.r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, format!("`{}` would begin anew at once", s.name.text))
                    .label(abort.span, "leads back to the first step")
                    .label(first.span, "which asks for a function")
                    .help("begin with `wait until …`"),
            );
        }
        let mut body = Body { span: s.name.span, ..Body::default() };
        let name =
            |i: usize| Name { text: format!("{}_{}", s.name.text, i % s.steps.len() + 1), span: s.steps[i].span };
        if let Some(abort) = s.abort.first() {
            let begin = transition(&name(0), &name(0), Some(abort.expr.clone()), Vec::new(), abort.span);
            let others = Source::Any { except: Vec::new(), span: abort.span };
            body.transitions.push(begin.clone());
            body.transitions.push(Transition { source: others, ..begin });
        }
        for (i, step) in s.steps.iter().enumerate() {
            let here = name(i);
            let next = Name { text: format!("{}_{}", s.name.text, (i + 1) % s.steps.len() + 1), span: step.span };
            let mut inside = Body { span: step.span, ..Body::default() };
            let mut leave = (None, Vec::new());
            match &step.doing {
                SequenceDoing::Do(jobs) => match jobs.as_slice() {
                    [job] => leave = self.job(job, &mut inside),
                    jobs => {
                        for job in jobs {
                            let region = self.region(&here, job);
                            inside.regions.push(region);
                        }
                    }
                },
                SequenceDoing::Activate(names) => self.raise(names, "Activate", &mut inside),
                SequenceDoing::Deactivate(names) => self.raise(names, "Deactivate", &mut inside),
                SequenceDoing::Until(guard) => leave.0 = Some(guard.expr.clone()),
                SequenceDoing::Wait(time) => leave.0 = Some(Expr::Atom(Term::After(time.clone()))),
            }
            let parallel = (!inside.regions.is_empty()).then_some(step.span);
            body.transitions.push(transition(&here, &next, leave.0, leave.1, step.span));
            let initial = (i == 0).then_some(step.span);
            let inside = (!inside.entry.is_empty() || !inside.regions.is_empty()).then_some(inside);
            body.states.push(State { initial, parallel, ..state(here, step.description.clone(), inside) });
        }
        let (name, description) = (s.name.clone(), s.description.clone());
        Some(Chart { name, controls: None, description, body })
    }

    /// Asks for the function when the state is entered; returns when the state can be left, and what is
    /// done then.
    fn job(&mut self, job: &Job, inside: &mut Body) -> (Option<Expr<Term>>, Vec<Effect>) {
        self.raise(std::slice::from_ref(&job.function), "Activate", inside);
        let part = |part: &str| Name { text: format!("{}_{part}", job.function.text), span: job.function.span };
        let automatic = self.known.get(&iec::fold(&job.function.text)).map(|f| f.automatic.is_some());
        match (&job.until, automatic) {
            (Some(until), Some(true)) => {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, format!("`{}` ends by itself", job.function.text))
                        .label(until.span, "it is automatic")
                        .help("leave `until …` out"),
                );
            }
            (None, Some(false)) => {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, format!("`{}` does not end by itself", job.function.text))
                        .label(job.function.span, "nothing asks it to end")
                        .help(format!("write `do {} until …`, or make the function `automatic`", job.function.text)),
                );
            }
            _ => {}
        }
        match &job.until {
            Some(until) => (Some(until.expr.clone()), vec![raised(part("Deactivate"))]),
            None => (Some(value(part("Ended"))), Vec::new()),
        }
    }

    /// A function among several that run side by side.
    fn region(&mut self, step: &Name, job: &Job) -> Region {
        let span = job.function.span;
        let part = |part: &str| Name { text: format!("{}_{}_{part}", step.text, job.function.text), span };
        let (runs, ended) = (part("Runs"), part("Ended"));
        let mut inside = Body { span, ..Body::default() };
        let (guard, effects) = self.job(job, &mut inside);
        let states = vec![
            State { initial: Some(span), ..state(runs.clone(), None, Some(inside)) },
            State { is_final: Some(span), ..state(ended.clone(), None, None) },
        ];
        let transitions = vec![transition(&runs, &ended, guard, effects, span)];
        let body = Body { states, transitions, span, ..Body::default() };
        Region { name: job.function.clone(), controls: None, description: None, body }
    }

    fn raise(&mut self, functions: &[Name], part: &str, inside: &mut Body) {
        for function in functions {
            if !self.known.contains_key(&iec::fold(&function.text)) {
                self.r.diagnostics.push(
                    Diagnostic::new(Code::UnknownName, format!("there is no function `{}`", function.text))
                        .label(function.span, "not declared"),
                );
                continue;
            }
            let name = Name { text: format!("{}_{part}", function.text), span: function.span };
            inside.entry.push(raised(name));
        }
    }
}

fn state(name: Name, description: Option<Text>, body: Option<Body>) -> State {
    State { name, initial: None, is_final: None, parallel: None, position: None, controls: None, description, body }
}

fn value(name: Name) -> Expr<Term> {
    Expr::Atom(Term::Value(PathRef { parts: vec![(name.text, name.span)] }))
}

fn negated(e: Expr<Term>) -> Expr<Term> {
    Expr::Not(Box::new(e))
}

/// At least one of those that there are.
fn any(parts: [Option<Expr<Term>>; 2]) -> Expr<Term> {
    match parts {
        [Some(a), Some(b)] => Expr::Or(vec![a, b]),
        [Some(e), None] | [None, Some(e)] => e,
        [None, None] => Expr::FALSE,
    }
}

fn transition(from: &Name, to: &Name, guard: Option<Expr<Term>>, effects: Vec<Effect>, span: Span) -> Transition {
    let path = |name: &Name| Path { parts: vec![name.clone()] };
    Transition {
        source: Source::State(path(from)),
        target: Target::State(path(to)),
        movement: None,
        priority: None,
        guard: guard.map(|expr| Guard { expr, written: String::new(), span }),
        effects,
        description: None,
        span,
    }
}

fn internal(guard: Expr<Term>, effects: Vec<Effect>, span: Span) -> Internal {
    Internal { guard: Guard { expr: guard, written: String::new(), span }, effects, description: None, span }
}

fn set(variable: Name) -> Effect {
    Effect { variable, value: EffectValue::Bool(true) }
}

fn reset(variable: Name) -> Effect {
    Effect { variable, value: EffectValue::Bool(false) }
}

fn raised(variable: Name) -> Effect {
    Effect { variable, value: EffectValue::Raised }
}

fn place(term: &Term) -> Span {
    match term {
        Term::Done(span) | Term::Blocked(span) | Term::Compare(_, span) => *span,
        Term::After(time) => time.span,
        Term::Value(p)
        | Term::Prev(p)
        | Term::Rise(p)
        | Term::Fall(p)
        | Term::In(p)
        | Term::PrevIn(p)
        | Term::RiseIn(p)
        | Term::FallIn(p)
        | Term::DoneOf(p)
        | Term::Acts(p)
        | Term::First(p)
        | Term::Alarm(p) => p.span(),
    }
}
