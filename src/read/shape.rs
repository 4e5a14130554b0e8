//! Whether a file has the shape that the schema gives it, as far as reading relies on it.
//!
//! Where one element can be and two stand, one tool takes the first, another one the last. What has
//! another namespace is seen by some. A comment within a text ends it for those who read no further.
//! The attribute `negated="yes"` is no for one and an error for the next. None of that has a definite
//! meaning, so it is refused.

use super::vendor;
use super::xml::{self, Family, Node};
use crate::base::{Code, Diagnostics};
use std::collections::BTreeSet;

/// Attributes that are true or false.
const FLAGS: [&str; 7] = ["constant", "initialStep", "negated", "nonpersistent", "nonretain", "persistent", "retain"];

/// Says what is not as it has to be.
pub fn check(root: Node<'_>, family: Family, problems: &mut Diagnostics) {
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        attributes(node, problems);
        match node.tag_name().name() {
            "addData" => open.extend(vendor::data(node, family, problems)),
            "documentation" | "content" | "alternativeText" | "Comment" | "addDataInfo" => {}
            "expression" => text(node, problems),
            "variable" if node.parent().is_some_and(|p| xml::is(p, "contact") || xml::is(p, "coil")) => {
                text(node, problems);
            }
            "ST" => text(wrapped(node), problems),
            _ => {
                children(node, problems);
                open.extend(xml::children(node));
            }
        }
    }
}

fn attributes(node: Node<'_>, problems: &mut Diagnostics) {
    let wrong = |name: &str, value: &str| {
        let message = format!("`{value}` is no value of the attribute `{name}`");
        xml::problem(Code::NotPlcopen, message, node)
    };
    for name in FLAGS {
        let value = node.attribute(name).unwrap_or("false").trim();
        if !matches!(value, "true" | "false" | "1" | "0") {
            problems.push(wrong(name, value));
        }
    }
    for (name, values) in [("edge", ["none", "rising", "falling"]), ("storage", ["none", "set", "reset"])] {
        let value = node.attribute(name).unwrap_or("none").trim();
        if !values.contains(&value) {
            problems.push(wrong(name, value));
        }
    }
}

fn children(node: Node<'_>, problems: &mut Diagnostics) {
    let namespace = node.tag_name().namespace();
    let parent = node.tag_name().name();
    let mut seen = BTreeSet::new();
    for child in xml::children(node) {
        let name = child.tag_name().name();
        if child.tag_name().namespace() != namespace {
            problems.push(xml::not_understood(format!("`{name}`, of another namespace than `{parent}`,"), child));
        } else if !seen.insert(name) && !may_repeat(parent, name) {
            problems.push(xml::not_understood(format!("a second `{name}` in one `{parent}`"), child));
        }
    }
    if parent == "connectionPointIn" && seen.contains("connection") && seen.contains("expression") {
        problems.push(xml::not_understood("a point with both lines and a text", node));
    }
    if parent == "body" || parent == "inline" {
        let bodies = xml::children(node).filter(|n| !xml::is(*n, "addData") && !xml::is(*n, "documentation"));
        if bodies.count() > 1 {
            problems.push(xml::not_understood("a body in two languages", node));
        }
    }
}

fn may_repeat(parent: &str, child: &str) -> bool {
    match parent {
        "LD" | "SFC" | "FBD" => true,
        "contact" | "coil" => false,
        "connection" => child == "position",
        "selectionConvergence" | "simultaneousConvergence" | "rightPowerRail" => child == "connectionPointIn",
        "selectionDivergence" | "simultaneousDivergence" | "leftPowerRail" => child == "connectionPointOut",
        "interface" => child.ends_with("Vars"),
        _ => matches!(
            child,
            "accessVariable"
                | "action"
                | "configVariable"
                | "configuration"
                | "connection"
                | "data"
                | "dataType"
                | "dimension"
                | "globalVars"
                | "pou"
                | "pouInstance"
                | "resource"
                | "task"
                | "transition"
                | "value"
                | "variable"
        ),
    }
}

/// The innermost of the elements that are wrapped around a text.
fn wrapped(node: Node<'_>) -> Node<'_> {
    let mut node = node;
    loop {
        let mut inner = xml::children(node);
        match (inner.next(), inner.next()) {
            (Some(only), None) if node.children().all(|n| n == only || blank(n)) => node = only,
            _ => return node,
        }
    }
}

fn blank(node: roxmltree::Node<'_, '_>) -> bool {
    node.is_text() && node.text().is_none_or(|t| t.trim().is_empty())
}

/// A text is one piece.
fn text(node: Node<'_>, problems: &mut Diagnostics) {
    if node.children().any(|n| !n.is_text()) {
        let what = format!("a text in pieces, with comments or elements in `{}`,", node.tag_name().name());
        problems.push(xml::not_understood(what, node));
    }
}
