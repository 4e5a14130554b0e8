//! Written transitions to those of the machine; a movement becomes the two around its state.

use super::expressions::Context;
use super::names::describe;
use super::targets::{self, Choice};
use super::{ResolvedBody, Resolver};
use crate::base::{Code, Diagnostic, Span};
use crate::ir::chart::{self, Atom, Guard, Inside, StateKind, Technology};
use crate::ir::{ast, expr::Expr};

pub fn resolve<'a>(r: &mut Resolver, bodies: &[ResolvedBody<'a>], choices: &mut [Choice<'a>]) {
    let mut found = Vec::new();
    for body in bodies {
        if let Some(state) = body.state {
            found.extend(body.body.internals.iter().map(|written| internal(r, body, written, state)));
        }
        // The braces of a plain composite state are its region's, which has its own entry.
        let composite = |s: chart::StateId| !r.machine.states[s].regions.is_empty();
        if body.state.is_some_and(composite) && body.body.regions.is_empty() {
            continue;
        }
        for (i, written) in body.body.transitions.iter().enumerate() {
            match body.movements.iter().find(|(at, _)| *at == i) {
                Some(&(_, state)) => movement(r, body, written, state, &mut found),
                None if written.movement.is_some() => no_movement(r, written),
                None => plain(r, choices, body, written, &mut found),
            }
        }
    }
    // Braces are visited from the outside in; what counts is the order of the text.
    found.sort_by_key(|t| t.span.start);
    for t in found {
        r.machine.transitions.push(t);
    }
    limits(r);
}

/// Time limits of positions to internal transitions of the movements there. They come after all others.
fn limits(r: &mut Resolver) {
    let mut found = Vec::new();
    let mut used = std::collections::BTreeSet::new();
    for (id, state) in r.machine.states.iter() {
        let StateKind::Movement { to } = state.kind else { continue };
        let Some(actuator) = r.machine.regions[state.region].actuator else { continue };
        let Some(limit) = r.machine.actuators[actuator].positions.get(to).and_then(|p| p.limit.as_ref()) else {
            continue;
        };
        used.insert((actuator, to));
        found.push(chart::Transition {
            source: id,
            target: id,
            inside: Inside::Default,
            internal: true,
            scope: state.region,
            phase: chart::Phase::Start,
            guard: Expr::Atom(Atom::After(id, limit.time)),
            deeds: limit.deeds.clone(),
            priority: None,
            description: String::new(),
            span: limit.span,
        });
    }
    for t in found {
        r.machine.transitions.push(t);
    }
    for (id, actuator) in r.machine.actuators.iter() {
        for (i, position) in actuator.positions.iter().enumerate() {
            if let (Some(limit), false) = (&position.limit, used.contains(&(id, i))) {
                r.diagnostics.push(
                    Diagnostic::new(
                        Code::LimitWithoutMovement,
                        format!("no movement of `{}` leads to `{}`", actuator.name, position.name),
                    )
                    .label(limit.span, "a time limit of no movement")
                    .help("write `move from … to …` where it moves, or leave the limit out"),
                );
            }
        }
    }
}

fn plain<'a>(
    r: &mut Resolver,
    choices: &mut [Choice<'a>],
    body: &ResolvedBody<'a>,
    written: &'a ast::Transition,
    into: &mut Vec<chart::Transition>,
) {
    let (sources, joined) = sources(r, body, &written.source);
    let before_all = into.len();
    for (i, &source) in sources.iter().enumerate() {
        let before = r.diagnostics.clone();
        let guard = guard(r, body, written, source, &joined);
        let ways = targets::ways(r, choices, &written.target, body.braces(), Some((source, body.phase)));
        for way in ways.iter().flatten() {
            let Some(elsewhere) = elsewhere(&r.machine, &written.source, source, way) else { continue };
            let deeds = r.deeds(written.effects.iter().chain(way.effects.iter().copied()), "this transition");
            let Some(scope) = r.machine.scope(source, way.target) else {
                r.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, "no region holds both states")
                        .label(written.span, "from one chart or one of its regions into another")
                        .help("let a guard of the other one read `in(STATE)`"),
                );
                return;
            };
            jump(r, written.span, source, way.target);
            let own = written.description.iter().map(|t| t.value.as_str());
            let description = own.chain(way.descriptions.iter().copied()).collect::<Vec<_>>().join(", ");
            into.push(chart::Transition {
                source,
                target: way.target,
                inside: way.inside.clone(),
                internal: false,
                phase: body.phase,
                scope,
                guard: Expr::all([guard.clone(), way.exact.clone(), elsewhere]),
                deeds,
                priority: written.priority.map(|(n, _)| n),
                description,
                span: written.span,
            });
        }
        if ways.is_none() {
            // The rest may hold errors of its own.
            r.deeds(&written.effects, "this transition");
            return;
        }
        if i > 0 {
            // What is wrong with the text has been said for the first source.
            r.diagnostics = before;
        }
    }
    if let (ast::Source::Any { span, .. }, false) = (&written.source, r.diagnostics.has_errors())
        && into.len() == before_all
    {
        r.diagnostics.push(
            Diagnostic::new(Code::WrongKind, "`any` leads nowhere from here")
                .label(*span, "in each state that this stands for, the machine is there already")
                .help("name the state from which it leads: from the target itself it is a restart"),
        );
    }
    if sources.is_empty() {
        targets::ways(r, choices, &written.target, body.braces(), None);
    }
}

/// The states from which it leads, and what a join asks for besides.
fn sources(r: &mut Resolver, body: &ResolvedBody<'_>, written: &ast::Source) -> (Vec<chart::StateId>, Vec<Guard>) {
    match written {
        ast::Source::State(path) => (r.path(path, body.braces()).into_iter().collect(), Vec::new()),
        ast::Source::Join(paths) => match r.side_by_side(paths, body.braces()) {
            Some((parallel, states)) => (vec![parallel], states.into_iter().map(|s| Expr::Atom(Atom::In(s))).collect()),
            None => (Vec::new(), Vec::new()),
        },
        ast::Source::Any { except, .. } if body.owns_region => {
            let mut states = r.machine.regions[body.region].states.clone();
            for path in except {
                let Some(state) = r.path(path, body.braces()) else { continue };
                if r.machine.states[state].region != body.region {
                    r.diagnostics.push(
                        Diagnostic::new(Code::WrongKind, "this state is not one of those that `any` stands for")
                            .label(path.span(), "is not a state of the region in which this is written")
                            .help("except states of this region only"),
                    );
                }
                states.retain(|&s| s != state);
            }
            (states, Vec::new())
        }
        ast::Source::Any { span, .. } => {
            r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, "`any` means each other state of a region, and this is not in one")
                    .label(*span, "not between the braces of a region")
                    .help("name the state from which it leads"),
            );
            (Vec::new(), Vec::new())
        }
    }
}

/// The condition under which a transition `from any` leads on from `source`: where it leads is not active yet. Nothing
/// if it always is when `source` is.
fn elsewhere(
    machine: &chart::Machine,
    written: &ast::Source,
    source: chart::StateId,
    way: &targets::Way<'_>,
) -> Option<Guard> {
    if !matches!(written, ast::Source::Any { .. }) {
        return Some(Expr::TRUE);
    }
    let goals = match &way.inside {
        Inside::Fork(states) => states.as_slice(),
        Inside::Default | Inside::History | Inside::DeepHistory => std::slice::from_ref(&way.target),
    };
    let there = goals.iter().map(|&goal| {
        if machine.contains(goal, source) {
            return Expr::TRUE;
        }
        let exclusive =
            machine.scope(source, goal).is_none_or(|r| machine.child_in(r, source) != machine.child_in(r, goal));
        if exclusive { Expr::FALSE } else { Expr::Atom(Atom::In(goal)) }
    });
    let elsewhere = Expr::all(there.collect::<Vec<_>>()).not();
    (elsewhere != Expr::FALSE).then_some(elsewhere)
}

/// Reports a transition of a bistable actuator that would change the position without driving.
fn jump(r: &mut Resolver, span: Span, source: chart::StateId, target: chart::StateId) {
    let (from, to) = (&r.machine.states[source], &r.machine.states[target]);
    let Some(actuator) = r.machine.regions[from.region].actuator.map(|a| &r.machine.actuators[a]) else { return };
    let differ = matches!((from.position, to.position), (Some(a), Some(b)) if a != b);
    if from.region == to.region && differ && actuator.technology == Technology::Bistable {
        let d = Diagnostic::new(
            Code::JumpBetweenPositions,
            format!("`{}` does not get from `{}` to `{}` without a movement", actuator.name, from.name, to.name),
        )
        .label(span, "neither output is driven on the way")
        .help(format!("write `move from {} to {} when …`", from.name, to.name));
        r.diagnostics.push(d);
    }
}

/// Reports a movement that is written where no region holds it: beside the regions of a parallel state, or after
/// the filter.
fn no_movement(r: &mut Resolver, written: &ast::Transition) {
    let span = written.movement.as_ref().map_or(written.span, |m| m.span);
    r.diagnostics.push(
        Diagnostic::new(Code::MoveWithoutActuator, "nothing moves here")
            .label(span, "not between the braces of a region that controls an actuator")
            .help("write it between the braces of the region that holds both states"),
    );
}

fn movement(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Transition,
    state: chart::StateId,
    into: &mut Vec<chart::Transition>,
) {
    let (ast::Source::State(from), ast::Target::State(to)) = (&written.source, &written.target) else {
        unreachable!("a movement leads from one state to one state")
    };
    let (source, target) = (r.path(from, body.braces()), r.path(to, body.braces()));
    if let Some(source) = source {
        let guard = guard(r, body, written, source, &[]);
        let deeds = r.deeds(&written.effects, "this transition");
        if let Some(sensor) = target.and_then(|target| sensor(r, body, written, state, source, target)) {
            let target = target.expect("a sensor belongs to a target");
            into.push(chart::Transition {
                source,
                target: state,
                inside: Inside::Default,
                internal: false,
                phase: body.phase,
                scope: body.region,
                guard,
                deeds,
                priority: written.priority.map(|(n, _)| n),
                description: describe(&written.description),
                span: written.span,
            });
            into.push(chart::Transition {
                source: state,
                target,
                inside: Inside::Default,
                scope: body.region,
                phase: body.phase,
                guard: sensor,
                internal: false,
                deeds: chart::Deeds::default(),
                priority: None,
                description: String::new(),
                span: written.span,
            });
        }
    }
}

/// What ends the movement; enters where it leads into its state.
fn sensor(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Transition,
    state: chart::StateId,
    source: chart::StateId,
    target: chart::StateId,
) -> Option<Guard> {
    let move_span = written.movement.as_ref().map_or(written.span, |m| m.span);
    let region = &r.machine.regions[body.region];
    let refuse = |message: String, label: &str, help: &str| {
        Diagnostic::new(Code::MoveWithoutActuator, message).label(move_span, label).help(help)
    };
    let Some(actuator) = region.actuator.map(|a| &r.machine.actuators[a]) else {
        let d = refuse(
            "nothing moves here".into(),
            "this region controls no actuator",
            "write `controls ACTUATOR` behind the name of the region, or `from` instead of `move from`",
        );
        r.diagnostics.push(d);
        return None;
    };
    if actuator.technology == Technology::OnOff {
        let d = refuse(
            format!("`{}` is on or off, it does not move", actuator.name),
            "an on/off actuator has no movements",
            "write `from` instead of `move from`",
        );
        r.diagnostics.push(d);
        return None;
    }
    let (from, to) = (&r.machine.states[source], &r.machine.states[target]);
    let ends = from.region == body.region && to.region == body.region;
    let lost = |s: &chart::State| s.position.is_none() && !matches!(s.kind, StateKind::Movement { .. });
    if ends && (lost(from) || lost(to)) {
        return None; // A state without a position has been reported.
    }
    let (Some(a), Some(b), true) = (from.position, to.position, ends) else {
        let d = refuse(
            format!("`{}` and `{}` are not both at positions of this region's actuator", from.name, to.name),
            "a movement leads from position to position",
            "write it between the braces of the region that holds both states",
        );
        r.diagnostics.push(d);
        return None;
    };
    if a == b {
        let d = refuse(
            format!("`{}` and `{}` are at the same position", from.name, to.name),
            "nothing moves between them",
            "write `from` instead of `move from`",
        );
        r.diagnostics.push(d);
        return None;
    }
    let position = &actuator.positions[b];
    let Some(sensor) = position.sensor.clone() else {
        let d = Diagnostic::new(
            Code::MoveWithoutSensor,
            format!("nothing confirms that `{}` has reached `{}`", actuator.name, position.name),
        )
        .label(move_span, "this movement would never end")
        .label(position.span, "this position has no sensor")
        .help("add `sensor INPUT` to the position");
        r.diagnostics.push(d);
        return None;
    };
    r.machine.states[state].kind = StateKind::Movement { to: b };
    Some(sensor)
}

/// The guard; without `when`, a composite source waits for `done`, and a join for its states.
fn guard(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Transition,
    source: chart::StateId,
    joined: &[Guard],
) -> Guard {
    let guard = match &written.guard {
        Some(guard) => r.guard(guard, &Context::Guard { braces: body.braces(), source, phase: body.phase }),
        None if !joined.is_empty() => Expr::TRUE,
        None if r.machine.states[source].kind == StateKind::Composite => Expr::Atom(Atom::Done(source)),
        None => Expr::TRUE,
    };
    Expr::all(joined.iter().cloned().chain([guard]))
}

/// A transition that leaves nothing, out of the state between whose braces it is written.
fn internal(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Internal,
    state: chart::StateId,
) -> chart::Transition {
    let guard = r.guard(&written.guard, &Context::Guard { braces: body.braces(), source: state, phase: body.phase });
    let deeds = r.deeds(&written.effects, "this transition");
    if written.effects.is_empty() {
        r.diagnostics.push(
            Diagnostic::new(Code::IdleInternal, "this internal transition does nothing")
                .label(written.span, "it leaves nothing and has no effect")
                .help("write what happens: `internal when … then set VARIABLE`"),
        );
    }
    chart::Transition {
        source: state,
        target: state,
        inside: Inside::Default,
        phase: body.phase,
        internal: true,
        scope: r.machine.states[state].region,
        guard,
        deeds,
        priority: None,
        description: describe(&written.description),
        span: written.span,
    }
}
