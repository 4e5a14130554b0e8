//! The written plant to travels with their sensors and to rules, times in scans.

use super::Resolver;
use super::expressions::Context;
use super::names::Symbol;
use crate::base::{Code, Diagnostic, Span};
use crate::ir::ast::{self, Change, Doing, Technology};
use crate::ir::chart::{ActuatorId, Atom, Guard, InputId};
use crate::ir::expr::Expr;
use crate::ir::scenario::{Given, Rule, Sensor, Travel, Valve};

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let by_steps = tree.plants.iter().any(|p| p.by_steps.is_some() || !p.steps.is_empty());
    r.machine.plant.by_steps = by_steps;
    // For each input, the actuator whose sensor it is.
    let mut sensed: Vec<Option<Span>> = vec![None; r.machine.inputs.len()];
    for written in tree.plants.iter().flat_map(|p| &p.travels) {
        let valve = |id: ActuatorId| tree.actuators[id.index()].valve;
        travel(r, written, &valve, &mut sensed);
    }
    tree.plants.iter().flat_map(|p| &p.steps).for_each(|written| r.happening(written));
    for written in tree.plants.iter().flat_map(|p| &p.rules) {
        rule(r, written, &sensed);
    }
    for written in tree.plants.iter().flat_map(|p| &p.initially) {
        match &written.doing {
            Doing::Set(names, value) => {
                for name in names {
                    let Some(given) = r.given(name) else { continue };
                    if let Given::Input(input) = given
                        && let Some(travel) = sensed[input.index()]
                    {
                        given_twice(r, name, travel);
                        continue;
                    }
                    r.machine.plant.initially.push((given, *value));
                }
            }
            Doing::Place(actuator, position) => {
                let place = r.place(actuator, position);
                r.machine.plant.places.extend(place);
            }
            Doing::Any(names) => {
                for name in names {
                    match r.symbol(&name.text) {
                        Some(Symbol::Bit(bit)) => r.machine.plant.unknown.push(bit),
                        other => r.wrong_symbol(name, other, "a hidden bit"),
                    }
                }
            }
            Doing::Press(..)
            | Doing::Force(..)
            | Doing::Release(..)
            | Doing::Happens(..)
            | Doing::Wait(..)
            | Doing::Until(..)
            | Doing::Expect(..)
            | Doing::Watch(..)
            | Doing::Repeat(..) => unreachable!("the grammar takes only `set`, `reset`, `any` and `place` here"),
        }
    }
}

fn travel(
    r: &mut Resolver,
    written: &ast::Travel,
    declared: &impl Fn(ActuatorId) -> Option<(ast::Valve, Span)>,
    sensed: &mut [Option<Span>],
) {
    let (out, power) = (r.scans(&written.out, 1), power(r, written));
    let back = written.back.map_or(out, |t| r.scans(&t, 1));
    let Some(id) = r.actuator(&written.actuator) else { return };
    let span = written.actuator.span;
    if let Some(first) = r.machine.plant.travels.iter().find(|t| t.actuator == id).map(|t| t.span) {
        r.diagnostics.push(
            Diagnostic::new(Code::CannotTravel, format!("`{}` travels twice", written.actuator.text))
                .label(span, "said again")
                .label(first, "first said here"),
        );
        return;
    }
    if let (Some((ast::Valve::Memory, valve)), Some(driven)) = (declared(id), written.driven) {
        r.diagnostics.push(
            Diagnostic::new(Code::BadValve, format!("the valve of `{}` remembers its order", written.actuator.text))
                .label(driven, "it goes on without being driven")
                .label(valve, "declared here"),
        );
    }
    let closed = matches!(declared(id), Some((ast::Valve::ClosedCentre, _)));
    let valve = match (r.machine.actuators[id].technology, written.driven) {
        (Technology::Bistable, None) if closed => Valve::WhileDriven,
        (Technology::Bistable, None) => Valve::Keeps,
        (Technology::Bistable, Some(_)) => Valve::WhileDriven,
        (Technology::Monostable | Technology::OnOff, None) => Valve::Spring,
        (Technology::Monostable | Technology::OnOff, Some(driven)) => {
            let text = format!("`{}` has one output: without it, it goes back", written.actuator.text);
            r.diagnostics.push(
                Diagnostic::new(Code::CannotTravel, text)
                    .label(driven, "only a bistable actuator stands still where it is")
                    .label(span, "this one is not bistable"),
            );
            Valve::Spring
        }
    };
    let Some(sensors) = sensors(r, id, span) else { return };
    for sensor in &sensors {
        sensed[sensor.input.index()] = Some(span);
    }
    r.machine.plant.travels.push(Travel {
        actuator: id,
        valve,
        at_most: written.at_most,
        out,
        back,
        power,
        sensors,
        span,
    });
}

fn power(r: &mut Resolver, written: &ast::Travel) -> crate::ir::scenario::Condition {
    let Some(guard) = &written.power else { return Expr::TRUE };
    let power = r.condition(guard, &Context::Plant);
    if r.machine.plant.by_steps {
        r.timeless(&power, guard.span);
    }
    power
}

/// The sensors of an actuator's positions; reports those that say more than where it is.
fn sensors(r: &mut Resolver, id: ActuatorId, span: Span) -> Option<Vec<Sensor>> {
    let actuator = &r.machine.actuators[id];
    let name = actuator.name.clone();
    let mut sensors: Vec<Sensor> = Vec::new();
    for (position, p) in actuator.positions.iter().enumerate() {
        let Some(sensor) = &p.sensor else { continue };
        match literal(sensor) {
            // One input for both ends: the second position decides.
            Some((input, _)) => {
                sensors.retain(|s| s.input != input);
                let there = matches!(sensor, Expr::Atom(_));
                sensors.push(Sensor { input, position, there });
            }
            None => {
                let d = Diagnostic::new(
                    Code::CannotTravel,
                    format!("the plant cannot tell the sensors of `{name}` from where it is"),
                )
                .label(span, "travels")
                .label(p.span, "the sensor of this position is no single input")
                .help("give each position one input, or write rules for these inputs: `INPUT rises when …`");
                r.diagnostics.push(d);
                return None;
            }
        }
    }
    if sensors.is_empty() {
        r.diagnostics.push(
            Diagnostic::new(Code::CannotTravel, format!("`{name}` has no sensor"))
                .label(span, "nobody would see it travel")
                .help("an actuator without sensors needs no place in the plant; what it brings about is a rule"),
        );
        return None;
    }
    for sensor in &sensors {
        let other = r.machine.plant.travels.iter().find(|t| t.sensors.iter().any(|s| s.input == sensor.input));
        if let Some(other) = other {
            let text = format!("`{}` is a sensor of two actuators that travel", r.machine.inputs[sensor.input].name);
            let d = Diagnostic::new(Code::CannotTravel, text)
                .label(span, "and of this one")
                .label(other.span, "of this one");
            r.diagnostics.push(d);
            return None;
        }
    }
    Some(sensors)
}

/// The input of `x` or `not x`, and whether it stands plain.
fn literal(guard: &Guard) -> Option<(InputId, bool)> {
    match guard {
        Expr::Atom(Atom::Input(i)) => Some((*i, true)),
        Expr::Not(inner) => literal(inner).map(|(i, plain)| (i, !plain)),
        Expr::Atom(_) | Expr::Const(_) | Expr::And(_) | Expr::Or(_) | Expr::Xor(..) => None,
    }
}

fn rule(r: &mut Resolver, written: &ast::Rule, sensed: &[Option<Span>]) {
    let condition = r.condition(&written.condition, &Context::Plant);
    let delay = written.delay.map_or(0, |t| r.scans(&t, 0));
    let Some(target) = r.given(&written.target) else { return };
    if let Given::Input(input) = target
        && let Some(travel) = sensed[input.index()]
    {
        given_twice(r, &written.target, travel);
        return;
    }
    let span = written.target.span;
    let mut push = |value, condition| r.machine.plant.rules.push(Rule { target, value, condition, delay, span });
    match written.change {
        Change::Follows => {
            push(true, condition.clone());
            push(false, condition.not());
        }
        Change::Rises => push(true, condition),
        Change::Falls => push(false, condition),
    }
}

fn given_twice(r: &mut Resolver, name: &ast::Name, travel: Span) {
    r.diagnostics.push(
        Diagnostic::new(Code::GivenTwice, format!("`{}` is a sensor of an actuator that travels", name.text))
            .label(name.span, "given again")
            .label(travel, "given by this actuator")
            .help("where the actuator is decides; `place ACTUATOR at POSITION` says where it begins"),
    );
}
