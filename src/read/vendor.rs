//! What vendors add to a file.
//!
//! It means something to their own tools alone. Those of the Beremiz family look into none of it. CODESYS and
//! its kin repeat there what an element of an SFC says, and say more; which of the two they go by where they
//! differ is not known, so that is refused, and so is all that is not known to change nothing.

use super::body::{Body, describe};
use super::literal;
use super::plain;
use super::program::Context;
use super::xml::{self, Family, Node};
use crate::base::Diagnostics;
use crate::ir::iec::Time;

/// The vendor data of CODESYS that changes nothing, or is looked into: behind its address.
const KNOWN: [&str; 12] = [
    "application",
    "fbdcalltype",
    "fbdelementtype",
    "globalvars",
    "objectid",
    "pou",
    "projectinformation",
    "projectstructure",
    "resource",
    "sfc/element",
    "sfcsettings",
    "tasksettings",
];
/// Where all of it is.
const ADDRESS: &str = "http://www.3s-software.com/plcopenxml/";

/// What an attribute of an element of an SFC says.
enum Attribute {
    /// Nothing that is executed, such as a comment.
    Harmless,
    /// What the element is called, or what a transition waits for.
    Name,
    /// Whether a step is the initial one.
    Initial,
    /// Whether branches are active together.
    Parallel,
    /// The qualifier of an action, and its duration.
    Qualifier,
    /// Whether the element is left out.
    Excluded,
    /// Something that a step does besides.
    More(&'static str),
}

fn attribute(guid: &str) -> Option<Attribute> {
    Some(match guid {
        // A comment, the access to symbols, how a step is copied, and one that is 0 wherever it stands.
        "7d894980-aeea-405c-a0f6-e2b26429c58f"
        | "bc882c11-1e91-4dd8-a6b8-2075724ed18b"
        | "62e1754b-7629-4e63-9cec-10ae0c536f1f"
        | "8294df19-5962-4dee-a874-1051dabb0e3e" => Attribute::Harmless,
        "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8" => Attribute::Name,
        "6844a48e-46c2-4cc8-a185-a478f3b99cc0" => Attribute::Initial,
        "23bdaa98-72ec-41f7-817b-9dede5697086" => Attribute::Parallel,
        "e174fc0d-80b0-4a9e-a530-ca239c249a50" => Attribute::Qualifier,
        "01580b27-6378-448b-8ecb-0e4b795b58d6" => Attribute::Excluded,
        "700a583f-b4d4-43e4-8c14-629c7cd3bec8" => Attribute::More("the main action"),
        "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8" => Attribute::More("the entry action"),
        "a2621e18-7de3-4ea6-ae6d-89e9e0b7befd" => Attribute::More("the exit action"),
        "cacf1a68-236e-47c2-b7b1-1cf9199718cb" => Attribute::More("the minimal time"),
        "b693554c-1b01-4a8d-afde-9e3a46f7465d" => Attribute::More("the maximal time"),
        _ => return None,
    })
}

/// Looks at what a vendor has added in an `addData`; returns what within it is PLCopen again.
pub fn data<'a>(node: Node<'a>, family: Family, problems: &mut Diagnostics) -> Vec<Node<'a>> {
    let mut found = Vec::new();
    if family == Family::Beremiz {
        return found;
    }
    for data in xml::children(node) {
        let name = xml::attribute(data, "name").unwrap_or_default();
        match name.strip_prefix(ADDRESS) {
            Some(known) if KNOWN.contains(&known) => {}
            Some("attributes") if only(data, "Attribute", |n| xml::attribute(n, "Name") == Some("qualified_only")) => {}
            Some("buildproperties") if only(data, "LinkAlways", |_| true) => {}
            Some("interfaceasplaintext") => {
                let owner = node.parent().filter(|n| n.is_element());
                if !owner.is_some_and(|owner| plain::agrees(&xml::text(data), owner)) {
                    let what = "a text of declarations that is not known to say what the lists say";
                    problems.push(xml::not_understood(what, data));
                }
            }
            _ => problems.push(xml::not_understood(format!("the vendor data `{name}`"), data)),
        }
        let namespace = node.tag_name().namespace();
        found.extend(xml::children(data).filter(|n| n.tag_name().namespace() == namespace && holds(data, *n)));
    }
    found
}

/// Whether the element within vendor data holds elements of that name alone, all of which are `harmless`.
fn only(data: Node<'_>, name: &str, harmless: impl Fn(Node<'_>) -> bool) -> bool {
    let inner: Vec<_> = xml::children(data).flat_map(xml::children).collect();
    !inner.is_empty() && inner.into_iter().all(|n| xml::is(n, name) && harmless(n))
}

/// Whether vendor data holds that element as a part of the project, not as something of the vendor's own.
pub fn holds(data: Node<'_>, element: Node<'_>) -> bool {
    let name = xml::attribute(data, "name").and_then(|n| n.strip_prefix(ADDRESS));
    matches!(
        (name, element.tag_name().name()),
        (Some("application" | "resource"), "resource") | (Some("globalvars"), "globalVars") | (Some("pou"), "pou")
    )
}

/// How often a task runs by its settings: nothing if it has none, an error if they say no definite time.
pub fn interval(task: Node<'_>) -> Result<Option<Time>, ()> {
    let mut found = None;
    for settings in xml::children_named(task, "addData").flat_map(|n| xml::descendants(n, "TaskSettings")) {
        let text = xml::attribute(settings, "Interval").ok_or(())?;
        // A literal with its unit, or a number of which another attribute says the unit.
        let time = match xml::attribute(settings, "IntervalUnit") {
            Some(unit) if !text.contains('#') => literal::counted(text, unit),
            _ => literal::interval(text),
        };
        let time = time.filter(|_| xml::attribute(settings, "KindOfTask") == Some("Cyclic")).ok_or(())?;
        if found.replace(time).is_some_and(|first| first != time) {
            return Err(());
        }
    }
    Ok(found)
}

/// Refuses attributes of an element of an SFC that change what it does, or contradict it.
pub fn refuse_attributes(node: Node<'_>, body: &Body<'_>, cx: &mut Context<'_, '_>) {
    if cx.family == Family::Beremiz {
        return;
    }
    let Some(data) = xml::child(node, "addData") else { return };
    for attribute_node in xml::descendants(data, "attribute") {
        let value = xml::text(attribute_node);
        let value = value.trim();
        let guid = xml::attribute(attribute_node, "guid").unwrap_or_default().to_ascii_lowercase();
        let truth = value.eq_ignore_ascii_case("TRUE");
        let agrees = match attribute(&guid) {
            None => {
                let message = format!("the vendor attribute `{guid}` of {}", describe(node));
                cx.report(xml::not_understood(message, node));
                continue;
            }
            Some(_) if value.is_empty() => true,
            Some(Attribute::Harmless) => true,
            Some(Attribute::Excluded) if truth => {
                cx.report(xml::not_understood(format!("{}, excluded from execution,", describe(node)), node));
                continue;
            }
            Some(Attribute::Excluded) => value.eq_ignore_ascii_case("FALSE"),
            Some(Attribute::More(what)) => {
                cx.report(xml::not_understood(format!("{what} of {}", describe(node)), node));
                continue;
            }
            Some(Attribute::Initial) => truth == xml::flag(node, "initialStep"),
            Some(Attribute::Parallel) => truth == xml::is(node, "simultaneousDivergence"),
            Some(Attribute::Qualifier) => {
                let said =
                    [xml::attribute(node, "qualifier").unwrap_or("N"), xml::attribute(node, "duration").unwrap_or("")];
                same(value, &said.join(" "))
            }
            Some(Attribute::Name) => name(node, body).is_none_or(|name| same(value, &name)),
        };
        if !agrees {
            let message = format!("the vendor attribute `{value}`, which contradicts {},", describe(node));
            cx.report(xml::not_understood(message, node));
        }
    }
}

/// What the element says that the vendor's name repeats; branches say nothing.
fn name(node: Node<'_>, body: &Body<'_>) -> Option<String> {
    match node.tag_name().name() {
        "step" => Some(xml::attribute(node, "name").unwrap_or_default().to_owned()),
        "jumpStep" => Some(xml::attribute(node, "targetName").unwrap_or_default().to_owned()),
        "action" => {
            let reference = xml::child(node, "reference").and_then(|n| xml::attribute(n, "name"));
            Some(reference.unwrap_or_default().to_owned())
        }
        "transition" => Some(condition(node, body)),
        _ => None,
    }
}

/// The text of what a transition waits for, if one text says it.
fn condition(transition: Node<'_>, body: &Body<'_>) -> String {
    let Some(condition) = xml::child(transition, "condition") else { return String::new() };
    let named = xml::child(condition, "reference").and_then(|n| xml::attribute(n, "name"));
    let inline = xml::child(condition, "inline").map(xml::text);
    let drawn = || match body.lines(condition).as_deref() {
        Ok([line]) => xml::child(body.elements[line.from], "expression").map(xml::text),
        _ => None,
    };
    named.map(str::to_owned).or(inline).or_else(drawn).unwrap_or_default()
}

fn same(left: &str, right: &str) -> bool {
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
    words(left) == words(right)
}
