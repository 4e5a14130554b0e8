//! Elements to what the generator and the compiler behind Beremiz fail at, although it says nothing.
//!
//! A file that cannot be compiled runs nowhere, so nothing is said of it. Each of these is a file that the official
//! schema permits and that the reader would understand.

use super::body::describe;
use super::declarations;
use super::functions;
use super::xml::{self, Node};
use crate::base::{iec, words};

/// What they fail at in this element, apart from those in it.
pub fn objection(node: Node<'_>) -> Option<String> {
    let name = || xml::attribute(node, "name").unwrap_or_default();
    let parent = node.parent().map_or("", |n| n.tag_name().name());
    match node.tag_name().name() {
        // Their names stand in the text that is compiled.
        "configuration" | "resource" if words::clash(name()).is_some() => Some(misnamed(node)),
        "configuration" | "resource" | "task" | "pouInstance" => iec::illegal(name()).map(|_| misnamed(node)),
        "globalVars" if xml::children_named(node, "variable").next().is_none() => {
            Some("a list of global variables without any".to_owned())
        }
        "variable" if parent.ends_with("Vars") && parent != "globalVars" => {
            let empty = node.attribute("address").is_some_and(|a| a.trim().is_empty());
            empty.then(|| format!("the empty address of {}", describe(node)))
        }
        "action" if node.attribute("indicator").is_some() => Some(format!("the indicator of {}", describe(node))),
        "contact" if xml::child(node, "connectionPointIn").is_none() => {
            Some(format!("{}, which has no place for a line,", describe(node)))
        }
        "block" => {
            let kind = xml::attribute(node, "typeName").unwrap_or_default();
            let known = functions::is_known(kind) || declarations::block_named(kind).is_some();
            (!known).then(|| format!("the type of {}", describe(node)))
        }
        _ => None,
    }
}

fn misnamed(node: Node<'_>) -> String {
    format!("the name of {}", describe(node))
}

/// What they fail at in a program organisation unit, whether anything runs it or not.
pub fn unit(pou: Node<'_>) -> Option<String> {
    let interface = xml::child(pou, "interface");
    let what = if xml::child(pou, "body").is_none() {
        "without a body"
    } else if interface.is_none() {
        "without an interface"
    } else if xml::attribute(pou, "pouType") == Some("function")
        && interface.is_none_or(|n| xml::child(n, "returnType").is_none())
    {
        "without a type"
    } else {
        return None;
    };
    Some(format!("{} {what}", describe(pou)))
}
