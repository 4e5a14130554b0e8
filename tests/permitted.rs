//! What the official schema permits in a program file beyond what the compiler writes: each attribute and each
//! element at each kind of place is refused, or means what the simulators show, or is known to mean nothing.
//!
//! Negation, edges, storage and their like are never passed over; what else may change nothing stands in a table, with
//! its reason. `CHARTWRIGHT_PERMITTED=all` tries them in the programs of all models, and `CHARTWRIGHT_PERMITTED_KEPT=DIR`
//! keeps each file that is read, for other tools to be asked.

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
use std::time::Instant;

/// What may change nothing: in which elements (`*` is any), which attributes (`@name`, or `@name=` with that value
/// alone) and elements, and why nobody who runs the program does anything else with or without it.
const MAY: &[(&str, &str, &str)] = &[
    ("*", "@height @width @x @y position relPosition", "where it is drawn"),
    ("contentHeader coordinateInfo fbd ld sfc", "coordinateInfo pageSize fbd ld sfc scaling", "how large it is drawn"),
    (
        "*",
        "@globalId @WorksheetName @hidden documentation addData",
        "words, and vendor data, which are looked at elsewhere",
    ),
    (
        "project fileHeader contentHeader",
        "fileHeader @companyName @companyURL @contentDescription @productName",
        "who made it",
    ),
    ("fileHeader contentHeader", "@productRelease @productVersion @creationDateTime @version", "who made it"),
    ("contentHeader", "@author @language @modificationDateTime @organization Comment addDataInfo", "who made it"),
    ("LD SFC comment", "comment content vendorElement", "words in a drawing"),
    (
        "configuration resource globalVars localVars inputVars outputVars externalVars",
        "@name",
        "nothing calls it by that",
    ),
    ("variable", "@address=", "an empty address is none"),
    ("*", "@executionOrderId=0", "0 is no place in an order"),
    ("action", "@duration= @indicator=", "an empty one is none"),
    ("task", "@priority", "there is one task"),
    ("transition", "@priority", "it is the only one, or has the place that it has anyway"),
    ("*", "@localId", "no line leads from it"),
    (
        "connection",
        "@refLocalId",
        "it comes from another rail, or leads to a right rail, which is an end of lines and no more",
    ),
    ("connectionPointIn", "connection", "it leads to a right rail"),
    (
        "connection connectionPointOut connectionPointOutAction",
        "@formalParameter",
        "there is one output, whatever it is called",
    ),
    ("*", "connectionPointIn connectionPointOut connectionPointOutAction", "an end of lines without lines"),
    ("LD SFC", "contact inVariable leftPowerRail rightPowerRail", "it leads nowhere"),
    ("SFC", "block step selectionDivergence selectionConvergence", "nothing leads to it, so it is never active"),
    ("SFC", "simultaneousDivergence simultaneousConvergence", "nothing leads to it"),
    ("configuration resource", "globalVars", "an empty list"),
    ("interface", "localVars inputVars outputVars externalVars", "an empty list"),
    ("pou", "interface actions transitions", "an empty list"),
    ("configurations", "configuration", "an empty list"),
    ("pous dataTypes", "pou dataType", "nothing runs it, nothing has it"),
    ("block", "inOutVariables", "an empty list"),
    ("project", "instances", "an empty list: the programs run from vendor data"),
];

/// One change.
struct Edit {
    what: String,
    text: String,
    /// Whether it says no more than what is said without it.
    same: bool,
    /// In which element which attribute or element is touched.
    touched: Vec<(String, String)>,
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
                same: before.is_some_and(same),
                touched: vec![(name.to_owned(), format!("@{}={value}", attribute.name))],
                means,
            });
        }
        if !attribute.required && node.has_attribute(attribute.name.as_str()) {
            found.push(Edit {
                what: format!("{}: no @{}", place(node), attribute.name),
                text: xml_edit::without_attribute(xml, node, &attribute.name),
                same: before == attribute.default.as_deref(),
                touched: vec![(name.to_owned(), format!("@{}=", attribute.name))],
                means,
            });
        }
    }
    for child in &schema.elements[element].children {
        let (parent, name) = (name, schema.elements[child.element].name.as_str());
        let touched = |names: &[&str]| names.iter().map(|n| (parent.to_owned(), (*n).to_owned())).collect::<Vec<_>>();
        let smallest = schema.smallest(child.element).replace("localId=\"1\"", "localId=\"99991\"");
        for first in [true, false] {
            let text = xml_edit::with_child(xml, node, &smallest, first);
            let what = format!("{}: {smallest} {}", place(node), if first { "first" } else { "last" });
            found.push(Edit { what, text, same: false, touched: touched(&[name]), means: false });
        }
        // In the place of another one, where one of several may stand.
        for other in node.children().filter(|n| n.is_element() && n.tag_name().name() != name) {
            let gone = other.tag_name().name();
            let what = format!("{}: {smallest} for {gone}", place(node));
            let text = xml_edit::replaced(xml, other, &smallest);
            found.push(Edit { what, text, same: false, touched: touched(&[name, gone]), means: false });
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
    /// What was needed of the table, by line and word.
    needed: BTreeSet<(usize, usize)>,
    kept: usize,
}

/// The places in the table that allow the change of one attribute or element to change nothing.
fn allowed((element, change): &(String, String)) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for (line, (elements, words, _)) in MAY.iter().enumerate() {
        if !elements.split(' ').any(|e| e == "*" || e == element) {
            continue;
        }
        let fits = |word: &str| word == change || (!word.contains('=') && change.split('=').next() == Some(word));
        found.extend(words.split(' ').enumerate().filter(|(_, word)| fits(word)).map(|(place, _)| (line, place)));
    }
    found
}

/// `same` is what is read of the file as it was written.
fn judge(output: &Output, same: &str, edit: &Edit, counts: &mut Counts, wrong: &mut Vec<String>) {
    let (project, diagnostics) = read::read(&edit.text);
    let Some(project) = project else {
        assert!(diagnostics.iter().any(|d| d.code.number().starts_with("E6")), "{}", edit.what);
        counts.refused += 1;
        return;
    };
    let unchanged = format!("{project:?}") == same;
    keep(edit, unchanged, counts);
    if unchanged {
        counts.nothing += 1;
        if edit.same {
            return;
        }
        let reasons: Vec<_> = edit.touched.iter().map(allowed).collect();
        if edit.means || reasons.iter().any(Vec::is_empty) {
            wrong.push(format!("{} is passed over", edit.what));
        }
        counts.needed.extend(reasons.into_iter().flatten());
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

fn keep(edit: &Edit, unchanged: bool, counts: &mut Counts) {
    let Some(folder) = std::env::var_os("CHARTWRIGHT_PERMITTED_KEPT") else { return };
    let kind = if unchanged { "same" } else { "other" };
    let family = if edit.text.contains("tc6_0201") { "beremiz" } else { "codesys" };
    let file = std::path::Path::new(&folder).join(format!("{family}-{kind}-{}.xml", counts.kept));
    std::fs::write(file, format!("{}\n<!-- {} -->\n", edit.text, edit.what.replace("--", "- -")))
        .expect("the folder takes files");
    counts.kept += 1;
}

#[test]
fn what_the_schema_permits_is_interpreted_or_refused() {
    let Some(text) = xsd::text() else { return };
    let schema = Schema::parse(&text);
    let all = std::env::var("CHARTWRIGHT_PERMITTED").is_ok_and(|value| value == "all");
    let mut wrong = Vec::new();
    let mut needed = BTreeSet::new();
    for dialect in [Dialect::Beremiz, Dialect::Codesys] {
        let (mut seen, mut counts, mut tried) = (BTreeSet::new(), Counts::default(), 0);
        for model in models::all() {
            if !all && !["timer"].contains(&model.name.as_str()) {
                continue;
            }
            let output = build(&model.source, dialect).expect("the models are right");
            let same = format!("{:?}", read_back(&output));
            let (start, before) = (Instant::now(), seen.len());
            for edit in edits(&output.xml, &schema, &mut seen) {
                tried += 1;
                judge(&output, &same, &edit, &mut counts, &mut wrong);
            }
            println!("{dialect:?} {}: {} more places, {:?}", model.name, seen.len() - before, start.elapsed());
        }
        needed.append(&mut counts.needed);
        println!("{dialect:?}: {tried} tried at {} kinds of places: {counts:?}", seen.len());
        assert!(counts.refused > 100 && counts.nothing > 100, "{dialect:?}: {counts:?}");
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    let words = MAY.iter().enumerate().flat_map(|(line, (elements, words, _))| {
        words.split(' ').enumerate().map(move |(place, word)| (line, place, format!("{word} in {elements}")))
    });
    let idle: Vec<String> =
        words.filter(|(line, place, _)| !needed.contains(&(*line, *place))).map(|(.., word)| word).collect();
    assert!(idle.is_empty(), "these never change nothing: {idle:#?}");
}
