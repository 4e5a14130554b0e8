//! Declared actuators to those of the machine: positions, outputs and sensors by technology.

use super::Resolver;
use super::expressions::Context;
use super::names::describe;
use crate::base::{Code, Diagnostic, Span};
use crate::ir::{ast, chart};

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    // For each output, the actuator that has it.
    let mut owner: Vec<Option<(String, Span)>> = vec![None; r.machine.outputs.len()];
    for actuator in &tree.actuators {
        let positions = positions(r, actuator);
        for (i, position) in positions.iter().enumerate() {
            let Some(output) = position.output else { continue };
            let span = match (&actuator.by, actuator.positions.get(i).and_then(|p| p.output.as_ref())) {
                (_, Some(name)) | (Some(name), None) => name.span,
                (None, None) => actuator.name.span,
            };
            match &owner[output.index()] {
                None => owner[output.index()] = Some((actuator.name.text.clone(), span)),
                Some((other, first)) => {
                    let name = &r.machine.outputs[output].name;
                    let d = Diagnostic::new(
                        Code::SharedOutput,
                        format!("`{name}` belongs to `{other}` and to `{}`", actuator.name.text),
                    )
                    .label(span, "used again")
                    .label(*first, "first used here")
                    .help("one output belongs to one actuator, at one of its positions");
                    r.diagnostics.push(d);
                }
            }
        }
        if let Some((_, span)) = actuator.valve.filter(|_| actuator.technology != ast::Technology::Bistable) {
            r.diagnostics.push(
                Diagnostic::new(Code::BadValve, format!("`{}` has no choice of valve", actuator.name.text))
                    .label(span, "only a bistable actuator can be without an order")
                    .label(actuator.technology_span, "here a spring leads back"),
            );
        }
        let id = r.machine.actuators.push(chart::Actuator {
            name: actuator.name.text.clone(),
            technology: actuator.technology,
            description: describe(&actuator.description),
            positions,
            span: actuator.name.span,
        });
        r.declare_actuator(&actuator.name, id);
    }
    for (id, output) in r.machine.outputs.iter() {
        if owner[id.index()].is_none() {
            r.diagnostics.push(
                Diagnostic::new(Code::NoTechnology, format!("`{}` has no technology", output.name))
                    .label(output.span, "no actuator has this output")
                    .help(format!("for a motor or a lamp: `actuator {}Drive onoff by {}`", output.name, output.name))
                    .help("for a cylinder: an `actuator` that is `bistable` or `monostable`, with its positions"),
            );
        }
    }
}

fn positions(r: &mut Resolver, actuator: &ast::Actuator) -> Vec<chart::Position> {
    if let Some(by) = &actuator.by {
        let output = r.output(by);
        if actuator.technology != ast::Technology::OnOff || !actuator.positions.is_empty() {
            shape(r, actuator, "`by` is the short form of an on/off actuator without sensors");
        }
        let position = |name: &str, output| chart::Position {
            name: name.into(),
            output,
            sensor: None,
            limit: None,
            description: String::new(),
            span: by.span,
        };
        return vec![position("Off", None), position("On", output)];
    }
    let mut positions: Vec<chart::Position> = Vec::new();
    for p in &actuator.positions {
        r.legal(&p.name);
        if let Some(first) = positions.iter().find(|q| q.name.eq_ignore_ascii_case(&p.name.text)).map(|q| q.span) {
            r.duplicate(&p.name, first);
        }
        let output = p.output.as_ref().and_then(|o| r.output(o));
        let sensor = p.sensor.as_ref().map(|g| r.guard(g, &Context::Sensor));
        let limit = p.limit.as_ref().and_then(|l| {
            let (time, deeds) = (r.time(&l.time), r.deeds(&l.effects, "this limit"));
            Some(chart::Limit { time: time?, deeds, span: l.span })
        });
        let (name, description) = (p.name.text.clone(), describe(&p.description));
        positions.push(chart::Position { name, output, sensor, limit, description, span: p.name.span });
    }
    let driven: Vec<bool> = actuator.positions.iter().map(|p| p.output.is_some()).collect();
    match (actuator.technology, driven.as_slice()) {
        (ast::Technology::Bistable, [true, true]) => {}
        (ast::Technology::Bistable, _) => {
            shape(r, actuator, "a bistable actuator has two positions, each with its output")
        }
        (ast::Technology::Monostable | ast::Technology::OnOff, [false, true]) => {}
        (ast::Technology::Monostable, _) => shape(
            r,
            actuator,
            "a monostable actuator has two positions: first the one of rest, then the one to which its output leads",
        ),
        (ast::Technology::OnOff, _) => {
            shape(r, actuator, "an on/off actuator has two positions: first off, then the one with its output");
        }
    }
    positions
}

fn shape(r: &mut Resolver, actuator: &ast::Actuator, rule: &str) {
    r.diagnostics.push(
        Diagnostic::new(Code::ActuatorShape, rule)
            .label(actuator.name.span.to(actuator.technology_span), "this one has not")
            .help("write `position NAME output OUTPUT sensor INPUT` for each position"),
    );
}
