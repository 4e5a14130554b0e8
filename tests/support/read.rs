//! Reads the bodies of PLCopen XML back by following connections: what an IDE would see.

use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// A transition as the XML has it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Transition {
    pub from: String,
    /// Its place among those that leave the step, from left to right.
    pub place: usize,
    pub condition: String,
    pub to: String,
}

/// A body's elements by their number.
pub struct Body<'a, 'input> {
    elements: BTreeMap<u64, Node<'a, 'input>>,
}

/// The bodies of all programs, in order.
pub fn bodies<'a, 'input>(document: &'a Document<'input>) -> Vec<Body<'a, 'input>> {
    // Namespaces differ between dialects, so names are compared without.
    let bodies = document.descendants().filter(|n| matches!(name(*n), "SFC" | "LD"));
    let numbered = |body: Node<'a, 'input>| {
        let elements = body.children().filter(Node::is_element);
        Body { elements: elements.map(|e| (number(e, "localId"), e)).collect() }
    };
    bodies.map(numbered).collect()
}

fn number(node: Node, attribute: &str) -> u64 {
    node.attribute(attribute).expect(attribute).parse().expect("a number")
}

fn name<'a>(node: Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

fn child<'a, 'input>(node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|c| name(*c) == tag)
}

/// The numbers that the connections of each `connectionPointIn` of `node` refer to.
fn inputs(node: Node) -> Vec<Vec<u64>> {
    let points = node.children().filter(|c| name(*c) == "connectionPointIn");
    let references =
        |p: Node| p.children().filter(|c| name(*c) == "connection").map(|c| number(c, "refLocalId")).collect();
    points.map(references).collect()
}

impl<'a, 'input> Body<'a, 'input> {
    /// The elements of one kind, in order of number.
    pub fn all(&self, tag: &str) -> Vec<Node<'a, 'input>> {
        self.elements.values().copied().filter(|e| name(*e) == tag).collect()
    }

    /// Steps and their actions.
    pub fn steps(&self) -> Vec<(String, Vec<String>)> {
        let steps = self.all("step");
        let mut found: BTreeMap<u64, (String, Vec<String>)> = BTreeMap::new();
        for step in steps {
            let name = step.attribute("name").expect("a name").to_owned();
            found.insert(number(step, "localId"), (name, Vec::new()));
        }
        for block in self.all("actionBlock") {
            for action in block.children().filter(|c| name(*c) == "action") {
                let reference = child(action, "reference").expect("a reference");
                let qualifier = action.attribute("qualifier").expect("a qualifier");
                let text = format!("{qualifier} {}", reference.attribute("name").expect("a name"));
                found.get_mut(&inputs(block)[0][0]).expect("its step").1.push(text);
            }
        }
        let mut steps: Vec<_> = found.into_values().collect();
        steps.sort();
        steps
    }

    /// Transitions, but for those that never fire.
    pub fn transitions(&self) -> Vec<Transition> {
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        let mut found = Vec::new();
        for transition in self.all("transition") {
            let above = self.elements[&inputs(transition)[0][0]];
            let step = match name(above) {
                "selectionDivergence" => self.elements[&inputs(above)[0][0]],
                _ => above,
            };
            let condition = child(transition, "condition").expect("a condition");
            let variable = self.elements[&inputs(condition)[0][0]];
            let text = child(variable, "expression").and_then(|e| e.text()).expect("an expression");
            if text == "FALSE" {
                continue;
            }
            let from = step.attribute("name").expect("a step").to_owned();
            let place = places.entry(from.clone()).or_default();
            *place += 1;
            let to = self.target(number(transition, "localId"));
            found.push(Transition { place: *place, from, condition: text.to_owned(), to });
        }
        found.sort();
        found
    }

    /// The step that what `id` leads to is, or names.
    fn target(&self, id: u64) -> String {
        let mut next = self.elements.values().filter(|e| inputs(**e).iter().any(|i| i.contains(&id)));
        let next = next.find(|e| name(**e) != "actionBlock").expect("something follows");
        match name(*next) {
            "step" => next.attribute("name").expect("a name").to_owned(),
            "jumpStep" => next.attribute("targetName").expect("a name").to_owned(),
            "selectionConvergence" => self.target(number(*next, "localId")),
            other => panic!("{other} follows a transition"),
        }
    }

    /// For each coil, from top to bottom: `S`, `R` or nothing, the variable, and the series of
    /// contacts that lead to it from the rail.
    pub fn rungs(&self) -> Vec<(String, String, Vec<Vec<String>>)> {
        let coils = self.all("coil").into_iter();
        coils
            .map(|coil| {
                let storage = match coil.attribute("storage") {
                    Some("set") => "S",
                    Some("reset") => "R",
                    _ => "",
                };
                (storage.to_owned(), variable(coil), self.series(coil))
            })
            .collect()
    }

    fn series(&self, element: Node) -> Vec<Vec<String>> {
        let mut all = Vec::new();
        for id in &inputs(element)[0] {
            let before = self.elements[id];
            if name(before) == "leftPowerRail" {
                all.push(Vec::new());
                continue;
            }
            let sign = if before.attribute("negated") == Some("true") { "/" } else { "" };
            for mut series in self.series(before) {
                series.push(format!("{sign}{}", variable(before)));
                all.push(series);
            }
        }
        all
    }
}

fn variable(node: Node) -> String {
    child(node, "variable").and_then(|v| v.text()).expect("a variable").to_owned()
}
