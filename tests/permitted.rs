//! What the official schema permits in a program file beyond what the compiler writes: each attribute and each
//! element at each kind of place is refused, or means what the simulators show, or is known to mean nothing.
//!
//! Negation, edges, storage and their like are never passed over; what else changes nothing is printed, to be read.
//! `CHARTWRIGHT_PERMITTED=all` tries them in the programs of all models.

use crate::support::models;
use crate::support::proof::{agree_by_chance, build, confirm, read_back};
use crate::support::xml_damage::MEANING;
use crate::support::xml_edit;
use crate::support::xsd::{self, Schema};
use chartwright::pipeline::{Dialect, Output};
use chartwright::prove::{Correspondence, Verdict, equivalence};
use chartwright::read;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

/// Attributes that say where something is drawn, who made it, or what it is called in a place where nobody calls it.
/// Nobody who runs a program looks at them.
const DESCRIBING: &[&str] = &[
    "@WorksheetName",
    "@author",
    "@companyName",
    "@companyURL",
    "@contentDescription",
    "@creationDateTime",
    "@globalId",
    "@height",
    "@hidden",
    "@language",
    "@modificationDateTime",
    "@organization",
    "@productName",
    "@productRelease",
    "@productVersion",
    "@version",
    "@width",
    "@x",
    "@y",
    // Of elements: geometry, words, data of vendors, which are looked at elsewhere, and rails that end where they are drawn.
    "Comment",
    "addData",
    "addDataInfo",
    "comment",
    "documentation",
    "pageSize",
    "position",
    "relPosition",
    "rightPowerRail",
    "leftPowerRail",
    // Ends of lines without lines, and empty lists.
    "connectionPointIn",
    "connectionPointOut",
    "connectionPointOutAction",
    "dataType",
    "actions",
    "transitions",
    "localVars",
    "inputVars",
    "outputVars",
    "externalVars",
    "globalVars",
    "inOutVariables",
    "pou",
    "configuration",
];

/// One change.
struct Edit {
    what: String,
    text: String,
    /// Whether it says no more than what is said without it.
    nothing: bool,
    /// Whether it always says something else: negation, edges, storage and their like.
    means: bool,
}

/// What the schema permits in a file beyond what stands there, at each kind of place that has not been seen.
fn edits(xml: &str, schema: &Schema, seen: &mut BTreeSet<String>) -> Vec<Edit> {
    let document = Document::parse(xml).expect("the compiler writes XML");
    let root = document.root_element();
    let mut open = vec![(root, 0)];
    let mut found = Vec::new();
    while let Some((node, element)) = open.pop() {
        if seen.insert(place(node)) {
            at_place(xml, node, element, schema, &mut found);
        }
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            let vendor = name == "addData" || node.tag_name().name() == "addData";
            let kind = match name {
                // Within vendor data stands what stands elsewhere in other files.
                "data" => Some(element),
                "resource" | "globalVars" | "pou" if node.tag_name().name() == "data" => schema.named(name),
                _ if vendor => Some(element),
                _ => schema.child(element, name),
            };
            open.extend(kind.map(|kind| (child, kind)));
        }
    }
    found
}

/// What kind of place an element stands at.
fn place(node: Node<'_, '_>) -> String {
    let path: Vec<&str> = node.ancestors().take(4).map(|n| n.tag_name().name()).collect();
    let kind = |n: Node<'_, '_>| n.attribute("typeName").or(n.attribute("formalParameter")).unwrap_or("").to_owned();
    let block = node.ancestors().find(|n| n.tag_name().name() == "block").map(kind);
    format!("{path:?} {} {block:?}", kind(node))
}

fn at_place(xml: &str, node: Node<'_, '_>, element: usize, schema: &Schema, found: &mut Vec<Edit>) {
    let name = node.tag_name().name();
    if matches!(name, "addData" | "data") || schema.elements[element].name != name {
        return;
    }
    for attribute in &schema.elements[element].attributes {
        let means = MEANING.contains(&attribute.name.as_str());
        let before = node.attribute(attribute.name.as_str()).or(attribute.default.as_deref());
        for value in &attribute.values {
            let same =
                |given: &str| given == value || [("true", "1"), ("false", "0")].contains(&(given, value.as_str()));
            found.push(Edit {
                what: format!("{}: @{} = {value}", place(node), attribute.name),
                text: xml_edit::with_attribute(xml, node, &attribute.name, value),
                nothing: before.is_some_and(same) || DESCRIBING.contains(&format!("@{}", attribute.name).as_str()),
                means,
            });
        }
        if !attribute.required && node.has_attribute(attribute.name.as_str()) {
            found.push(Edit {
                what: format!("{}: no @{}", place(node), attribute.name),
                text: xml_edit::without_attribute(xml, node, &attribute.name),
                nothing: before == attribute.default.as_deref()
                    || DESCRIBING.contains(&format!("@{}", attribute.name).as_str()),
                means,
            });
        }
    }
    for child in &schema.elements[element].children {
        let name = schema.elements[child.element].name.as_str();
        let smallest = schema.smallest(child.element).replace("localId=\"1\"", "localId=\"99991\"");
        for first in [true, false] {
            let text = xml_edit::with_child(xml, node, &smallest, first);
            let what = format!("{}: {smallest} {}", place(node), if first { "first" } else { "last" });
            found.push(Edit { what, text, nothing: DESCRIBING.contains(&name), means: false });
        }
        // In the place of another one, where one of several may stand.
        for other in node.children().filter(|n| n.is_element() && n.tag_name().name() != name) {
            let what = format!("{}: {smallest} for {}", place(node), other.tag_name().name());
            found.push(Edit { what, text: xml_edit::replaced(xml, other, &smallest), nothing: false, means: false });
        }
    }
}

/// What came of all edits.
#[derive(Debug, Default)]
struct Counts {
    refused: usize,
    nothing: usize,
    proved: usize,
    refuted: usize,
    open: usize,
}

/// `same` is what is read of the file as it was written.
fn judge(output: &Output, same: &str, edit: &Edit, counts: &mut Counts, wrong: &mut Vec<String>) {
    let (project, diagnostics) = read::read(&edit.text);
    let Some(project) = project else {
        assert!(diagnostics.iter().any(|d| d.code.number().starts_with("E6")), "{}", edit.what);
        counts.refused += 1;
        return;
    };
    if format!("{project:?}") == same {
        counts.nothing += 1;
        if edit.means && !edit.nothing {
            wrong.push(format!("{} is passed over", edit.what));
        } else if !edit.nothing {
            println!("changes nothing: {}", edit.what);
        }
        return;
    }
    let names = Correspondence::of(&output.machine, &output.project);
    match equivalence(&output.machine, &names, &project) {
        Verdict::Proved(_) => {
            counts.proved += 1;
            agree_by_chance(&output.machine, &names, &project, &edit.what, 1);
        }
        Verdict::Refuted(trace) => {
            counts.refuted += 1;
            confirm(&output.machine, &names, &project, &trace, &edit.what);
        }
        Verdict::Unknown(_) => counts.open += 1,
    }
}

#[test]
fn what_the_schema_permits_is_interpreted_or_refused() {
    let Some(text) = xsd::text() else { return };
    let schema = Schema::parse(&text);
    let all = std::env::var("CHARTWRIGHT_PERMITTED").is_ok_and(|value| value == "all");
    let mut wrong = Vec::new();
    for dialect in [Dialect::Beremiz, Dialect::Codesys] {
        let (mut seen, mut counts, mut tried) = (BTreeSet::new(), Counts::default(), 0);
        for model in models::all() {
            if !all && !["timer"].contains(&model.name.as_str()) {
                continue;
            }
            let output = build(&model.source, dialect).expect("the models are right");
            let same = format!("{:?}", read_back(&output));
            for edit in edits(&output.xml, &schema, &mut seen) {
                tried += 1;
                judge(&output, &same, &edit, &mut counts, &mut wrong);
            }
        }
        println!("{dialect:?}: {tried} tried at {} kinds of places: {counts:?}", seen.len());
        assert!(counts.refused > 100 && counts.nothing > 100, "{dialect:?}: {counts:?}");
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
}
