//! Written transitions to those of the machine; a movement becomes the two around its state.

use super::expressions::Context;
use super::names::describe;
use super::{ResolvedBody, Resolver};
use crate::base::{Code, Diagnostic, Span};
use crate::ir::chart::{self, Atom, Guard, StateKind, Technology};
use crate::ir::{ast, expr::Expr};

pub fn resolve(r: &mut Resolver, bodies: &[ResolvedBody<'_>]) {
    let mut found = Vec::new();
    for body in bodies {
        if let Some(state) = body.state {
            found.extend(body.body.internals.iter().map(|written| internal(r, body, written, state)));
        }
        // The braces of a plain composite state are its region's, which has its own entry.
        if body.state.is_some() && body.body.regions.is_empty() {
            continue;
        }
        for (i, written) in body.body.transitions.iter().enumerate() {
            match body.movements.iter().find(|(at, _)| *at == i) {
                Some(&(_, state)) => movement(r, body, written, state, &mut found),
                None => plain(r, body, written, &mut found),
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

/// Time limits of positions to internal transitions of the movements there. They come after all others,
/// so that they are tried last.
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

fn plain(r: &mut Resolver, body: &ResolvedBody<'_>, written: &ast::Transition, into: &mut Vec<chart::Transition>) {
    let target = find(r, body, &written.target);
    let sources = match &written.source {
        ast::Source::State(path) => find(r, body, path).into_iter().collect(),
        ast::Source::Any(_) if body.owns_region => r.machine.regions[body.region].states.clone(),
        ast::Source::Any(span) => {
            r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, "`any` means each state of a region, and this is not in one")
                    .label(*span, "beside the regions of a parallel state")
                    .help("name the parallel state itself"),
            );
            Vec::new()
        }
    };
    let Some(target) = target else {
        // The rest may hold errors of its own.
        if let Some(&source) = sources.first() {
            details(r, body, written, source);
        }
        return;
    };
    for (i, &source) in sources.iter().enumerate() {
        let before = r.diagnostics.clone();
        let (guard, deeds) = details(r, body, written, source);
        if i > 0 {
            // What is wrong with the text has been said for the first source.
            r.diagnostics = before;
        }
        let Some(scope) = r.machine.scope(source, target) else {
            r.diagnostics.push(
                Diagnostic::new(Code::WrongKind, "no region holds both states")
                    .label(written.span, "from one chart or one of its regions into another")
                    .help("let a guard of the other one read `in(STATE)`"),
            );
            return;
        };
        jump(r, written.span, source, target);
        into.push(transition(written, source, target, (scope, body.phase), guard, deeds));
    }
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

fn movement(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Transition,
    state: chart::StateId,
    into: &mut Vec<chart::Transition>,
) {
    let ast::Source::State(path) = &written.source else { unreachable!("a movement starts in one state") };
    let (source, target) = (find(r, body, path), find(r, body, &written.target));
    if let Some(source) = source {
        let (guard, deeds) = details(r, body, written, source);
        if let Some(sensor) = target.and_then(|target| sensor(r, body, written, state, source, target)) {
            let target = target.expect("a sensor belongs to a target");
            into.push(transition(written, source, state, (body.region, body.phase), guard, deeds));
            into.push(chart::Transition {
                source: state,
                target,
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

fn find(r: &mut Resolver, body: &ResolvedBody<'_>, path: &ast::Path) -> Option<chart::StateId> {
    let parts: Vec<(&str, Span)> = path.parts.iter().map(|n| (n.text.as_str(), n.span)).collect();
    r.state(&parts, Some(body.region))
}

/// Guard and effects; without `when`, a composite source waits for `done`.
fn details(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Transition,
    source: chart::StateId,
) -> (Guard, chart::Deeds) {
    let guard = match &written.guard {
        Some(guard) => r.guard(guard, &Context::Guard { region: body.region, source, phase: body.phase }),
        None if r.machine.states[source].kind == StateKind::Composite => Expr::Atom(Atom::Done(source)),
        None => Expr::TRUE,
    };
    (guard, r.deeds(&written.effects, "this transition"))
}

/// A transition that leaves nothing, out of the state between whose braces it is written.
fn internal(
    r: &mut Resolver,
    body: &ResolvedBody<'_>,
    written: &ast::Internal,
    state: chart::StateId,
) -> chart::Transition {
    let guard = r.guard(&written.guard, &Context::Guard { region: body.region, source: state, phase: body.phase });
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
        phase: body.phase,
        internal: true,
        scope: r.machine.states[state].region,
        guard,
        deeds,
        priority: written.priority.map(|(n, _)| n),
        description: describe(&written.description),
        span: written.span,
    }
}

fn transition(
    written: &ast::Transition,
    source: chart::StateId,
    target: chart::StateId,
    (scope, phase): (chart::RegionId, chart::Phase),
    guard: Guard,
    deeds: chart::Deeds,
) -> chart::Transition {
    chart::Transition {
        source,
        target,
        internal: false,
        scope,
        phase,
        guard,
        deeds,
        priority: written.priority.map(|(n, _)| n),
        description: describe(&written.description),
        span: written.span,
    }
}
