//! Ladder bodies to statements.
//!
//! Coils and assigned variables run in document order. In files of the Beremiz family a function
//! block runs before its first user, one with an execution order before everything, and one that
//! nobody uses after everything: so does its code generator. A function is evaluated by its user. In the CODESYS family a block runs
//! where it stands, or before its first user.

use super::Problem;
use super::body::{Body, describe};
use super::flow::{Flow, given, place};
use super::program::{Context, broken};
use super::st::{self, Value};
use super::xml::{self, Family, Node};
use crate::base::Code;
use crate::ir::iec::{Coil, CoilKind, Condition, Kind, Statement};

/// Reads what stands within `LD`.
pub fn read(content: Node<'_>, cx: &mut Context<'_, '_>) -> Vec<Statement> {
    let body = Body::new(content, cx.problems);
    let mut flow = Flow::new(&body);
    let mut statements = Vec::new();
    for element in sequence(&body, cx) {
        let node = body.elements[element];
        let end = match node.tag_name().name() {
            "coil" => coil(node, &mut flow, cx).map(Some),
            "outVariable" => out_variable(node, &body, &mut flow, cx).map(Some),
            _ => flow.call(element, cx).map(|()| None),
        };
        statements.append(&mut flow.calls);
        match end {
            Ok(statement) => statements.extend(statement),
            Err(problem) => cx.report(problem),
        }
    }
    statements
}

/// The elements that do something, in the order in which they do.
fn sequence(body: &Body<'_>, cx: &mut Context<'_, '_>) -> Vec<usize> {
    let (mut first, mut ends, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
    for (index, &node) in body.elements.iter().enumerate() {
        if xml::attribute(node, "executionOrderId").is_some_and(|n| n.parse::<u64>().is_err()) {
            cx.report(xml::not_understood(format!("the execution order of {}", describe(node)), node));
        }
        match (node.tag_name().name(), place(node), cx.family) {
            ("block" | "outVariable", Some(place), Family::Beremiz) => first.push((place, index)),
            ("coil" | "outVariable", _, _) | ("block", _, Family::Codesys) => ends.push(index),
            ("block", None, Family::Beremiz) => blocks.push(index),
            ("leftPowerRail" | "rightPowerRail" | "contact" | "inVariable" | "comment", _, _) => {}
            ("vendorElement", _, _) if is_title(node) => {}
            _ => cx.report(xml::not_understood(describe(node), node)),
        }
    }
    first.sort();
    refuse_other_order(body, &ends, cx);
    first.into_iter().map(|(_, index)| index).chain(ends).chain(blocks).collect()
}

/// Rungs run in document order in a Beremiz of today; older ones sort them by place, in rows of ten units.
fn refuse_other_order(body: &Body<'_>, ends: &[usize], cx: &mut Context<'_, '_>) {
    let place = |index: usize| {
        let position = xml::child(body.elements[index], "position")?;
        let number = |name| xml::attribute(position, name)?.parse::<f64>().ok();
        Some((number("x")?, number("y")?))
    };
    if cx.family == Family::Codesys {
        return;
    }
    for pair in ends.windows(2) {
        let (Some((x, y)), Some((next_x, next_y))) = (place(pair[0]), place(pair[1])) else { continue };
        let follows = if (next_y - y).abs() < 10.0 { next_x >= x } else { next_y > y };
        if !follows {
            let node = body.elements[pair[1]];
            let what = format!("{}, which stands above one that comes before it in the file,", describe(node));
            cx.report(xml::not_understood(what, node));
        }
    }
}

/// Whether a vendor element is the title of a network.
fn is_title(node: Node<'_>) -> bool {
    let mut types = xml::descendants(node, "ElementType");
    types.next().is_some_and(|n| xml::text(n).trim() == "networktitle") && types.next().is_none()
}

fn coil<'a>(node: Node<'a>, flow: &mut Flow<'_, 'a>, cx: &mut Context<'_, '_>) -> Result<Statement, Problem> {
    let name = xml::child(node, "variable").map(xml::text).unwrap_or_default();
    let path: Vec<&str> = name.trim().split('.').collect();
    let (variable, kind) = st::writable(&path, &cx.scope).map_err(|f| broken(f, &name, node))?;
    if kind != Kind::Bool {
        return Err(xml::problem(Code::BrokenText, format!("{} is not of type BOOL", describe(node)), node));
    }
    let kind = match given(node, "storage") {
        None => CoilKind::Plain,
        Some("set") => CoilKind::Set,
        Some("reset") => CoilKind::Reset,
        Some(_) => return Err(xml::not_understood(format!("the storage of {}", describe(node)), node)),
    };
    if kind != CoilKind::Plain && (xml::flag(node, "negated") || given(node, "edge").is_some()) {
        let message = format!("{} with storage and negation or edge", describe(node));
        return Err(xml::not_understood(message, node));
    }
    flow.inputs(node)?;
    let condition = flow.condition(node, cx)?;
    let condition = flow.modify(condition, node, cx)?;
    Ok(Statement::Coil(Coil { condition, variable, kind }))
}

fn out_variable<'a>(
    node: Node<'a>,
    body: &Body<'a>,
    flow: &mut Flow<'_, 'a>,
    cx: &mut Context<'_, '_>,
) -> Result<Statement, Problem> {
    let name = xml::child(node, "expression").map(xml::text).unwrap_or_default();
    let path: Vec<&str> = name.trim().split('.').collect();
    let (variable, kind) = st::writable(&path, &cx.scope).map_err(|f| broken(f, &name, node))?;
    flow.inputs(node)?;
    match kind {
        Kind::Bool => {
            let condition = flow.condition(node, cx)?;
            Ok(Statement::Coil(Coil { condition, variable, kind: CoilKind::Plain }))
        }
        Kind::Int { .. } | Kind::Time => {
            let lines = body.lines(node)?;
            if let [line] = lines.as_slice()
                && let Some(function) = flow.function(line, cx)?
            {
                return function.assign(&name, node, cx);
            }
            let value = flow.number(&lines, node, cx)?;
            st::assignment(&path, value, &cx.scope).map_err(|f| broken(f, &name, node))
        }
    }
}

/// The condition that a transition's own ladder body gives to the transition's name, and the calls
/// that come before it.
pub fn transition(
    content: Node<'_>,
    name: &str,
    cx: &mut Context<'_, '_>,
) -> Result<(Condition, Vec<Statement>), Problem> {
    let body = Body::new(content, cx.problems);
    let mut flow = Flow::new(&body);
    let mut found = None;
    for &node in &body.elements {
        if place(node).is_some() {
            return Err(xml::not_understood(format!("the execution order of {}", describe(node)), node));
        }
        let variable = match node.tag_name().name() {
            "coil" => xml::child(node, "variable"),
            "outVariable" => xml::child(node, "expression"),
            _ => continue,
        };
        let variable = variable.map(xml::text).unwrap_or_default();
        let plain = !xml::flag(node, "negated") && given(node, "edge").is_none() && given(node, "storage").is_none();
        // A generator drops whatever else the body does, and whatever the coil does to its value.
        if !variable.trim().eq_ignore_ascii_case(name) || !plain || found.is_some() {
            return Err(xml::not_understood(format!("{} in the body of transition `{name}`", describe(node)), node));
        }
        flow.inputs(node)?;
        found = Some(flow.condition(node, cx)?);
    }
    match found {
        Some(condition) => Ok((condition, flow.calls)),
        None => {
            let message = format!("the body of transition `{name}` gives it no condition");
            Err(xml::problem(Code::Unconnected, message, content))
        }
    }
}

/// A BOOL value as a condition.
pub fn truth(value: Value, what: &str, node: Node<'_>) -> Result<Condition, Problem> {
    let value =
        value.bool().ok_or_else(|| xml::problem(Code::BrokenText, format!("{what} is not of type BOOL"), node))?;
    Ok(Condition::simple(value))
}
