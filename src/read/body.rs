//! The elements of a drawn body and the lines between them.

use super::Problem;
use super::xml::{self, Node};
use crate::base::{Code, Diagnostics};
use std::collections::BTreeMap;

/// All elements of one body, in document order.
pub struct Body<'a> {
    /// The elements.
    pub elements: Vec<Node<'a>>,
    by_number: BTreeMap<u64, usize>,
}

/// A line into an element.
#[derive(Clone, Copy)]
pub struct Line<'a> {
    /// Where it comes from: an index into [`Body::elements`].
    pub from: usize,
    /// Which output there, if the file says so.
    pub parameter: Option<&'a str>,
    /// The element `connection`.
    pub node: Node<'a>,
}

impl<'a> Body<'a> {
    /// The elements within `SFC` or `LD`.
    pub fn new(content: Node<'a>, problems: &mut Diagnostics) -> Self {
        let elements: Vec<_> = xml::children(content).filter(|n| !xml::is(*n, "addData")).collect();
        let mut by_number = BTreeMap::new();
        for (index, element) in elements.iter().enumerate() {
            let Some(number) = xml::attribute(*element, "localId") else { continue };
            let Ok(value) = number.parse() else {
                problems.push(xml::problem(Code::NotPlcopen, format!("`{number}` is no number"), *element));
                continue;
            };
            if by_number.insert(value, index).is_some() {
                let message = format!("two elements of one body have the number {number}");
                problems.push(xml::problem(Code::Clash, message, *element));
            }
        }
        Body { elements, by_number }
    }

    /// Whether some line comes from that output of an element; one that says no output may come from any.
    pub fn is_left(&self, node: Node<'a>, output: Option<&str>) -> bool {
        let number = xml::attribute(node, "localId").and_then(|n| n.parse::<u64>().ok());
        let lines = self.elements.iter().flat_map(|n| xml::descendants(*n, "connection"));
        lines.into_iter().any(|line| {
            let from = xml::attribute(line, "refLocalId").and_then(|n| n.parse().ok());
            let named = xml::attribute(line, "formalParameter");
            from == number && (named.is_none() || named == output)
        })
    }

    /// The lines into all `connectionPointIn` directly within `node`.
    pub fn lines(&self, node: Node<'a>) -> Result<Vec<Line<'a>>, Problem> {
        let mut lines = Vec::new();
        for point in xml::children_named(node, "connectionPointIn") {
            for connection in xml::children_named(point, "connection") {
                let number = xml::required(connection, "refLocalId")?;
                let Some(&from) = number.parse().ok().and_then(|n: u64| self.by_number.get(&n)) else {
                    let message = format!("a line comes from element {number}, which the body does not have");
                    return Err(xml::problem(Code::Unconnected, message, connection));
                };
                let parameter = xml::attribute(connection, "formalParameter");
                if let Some(output) = parameter.filter(|_| !xml::is(node, "actionBlock"))
                    && is_other_output(self.elements[from], output)
                {
                    let what = format!("a line from output `{output}` of {}", describe(self.elements[from]));
                    return Err(xml::not_understood(what, connection));
                }
                lines.push(Line { from, parameter, node: connection });
            }
        }
        Ok(lines)
    }
}

/// Whether that is no output of a step which leads to transitions, but that of its actions, say.
fn is_other_output(step: Node<'_>, output: &str) -> bool {
    let named = |name| xml::child(step, name).and_then(|n| xml::attribute(n, "formalParameter"));
    let is_main = named("connectionPointOut").map(|main| main.eq_ignore_ascii_case(output));
    xml::is(step, "step") && !is_main.unwrap_or(named("connectionPointOutAction") != Some(output))
}

/// What an element is called in messages: its kind, and its name or variable if it has one.
pub fn describe(node: Node<'_>) -> String {
    let name = ["name", "targetName", "instanceName", "typeName"]
        .iter()
        .find_map(|a| xml::attribute(node, a).map(str::to_owned))
        .or_else(|| xml::child(node, "variable").or_else(|| xml::child(node, "expression")).map(|n| xml::text(n)));
    let number = xml::attribute(node, "localId").map(|n| format!(" (number {n})")).unwrap_or_default();
    match name {
        Some(name) => format!("{} `{}`{number}", node.tag_name().name(), name.trim()),
        None => format!("{}{number}", node.tag_name().name()),
    }
}
