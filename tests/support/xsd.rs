//! The official schema of PLCopen TC6, where it is at hand: what may stand at each place of a file.

use roxmltree::{Document, Node, NodeId};
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

/// What the schema says of one kind of element.
#[derive(Debug, Default)]
pub struct Element {
    pub name: String,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Child>,
    /// Whether it is a text of some kind.
    pub text: bool,
}

/// An attribute and values that it may have.
#[derive(Clone, Debug)]
pub struct Attribute {
    pub name: String,
    pub values: Vec<String>,
    /// The value that says what is said without it.
    pub default: Option<String>,
    pub required: bool,
}

/// An element within another one.
#[derive(Debug)]
pub struct Child {
    pub element: usize,
    pub required: bool,
}

/// The schema; the element `project` is the first.
pub struct Schema {
    pub elements: Vec<Element>,
}

/// The text of the schema, or a word about its absence.
pub fn text() -> Option<String> {
    let shared = std::env::var_os("CHARTWRIGHT_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = shared.join("schema/tc6_xml_v201.xsd");
    let text = std::fs::read_to_string(&path);
    if text.is_err() {
        eprintln!("SKIPPED: there is no {}, so its attributes are not tried", path.display());
    }
    text.ok()
}

impl Schema {
    pub fn parse(text: &str) -> Schema {
        let document = Document::parse(text).expect("the schema is XML");
        let root = document.root_element();
        let mut builder = Builder { types: BTreeMap::new(), known: HashMap::new(), elements: Vec::new() };
        for node in root.children().filter(Node::is_element) {
            if let (Some(name), false) = (node.attribute("name"), is(node, "element")) {
                builder.types.insert(name.to_owned(), node);
            }
        }
        let project = root.children().find(|n| is(*n, "element")).expect("there is a root");
        builder.element(project);
        Schema { elements: builder.elements }
    }

    /// The first element of that name within `element`.
    pub fn child(&self, element: usize, name: &str) -> Option<usize> {
        self.elements[element].children.iter().map(|c| c.element).find(|&c| self.elements[c].name == name)
    }

    /// The first element of that name anywhere.
    pub fn named(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|e| e.name == name)
    }

    /// As little as an element of that kind can be.
    pub fn smallest(&self, element: usize) -> String {
        let Element { name, attributes, children, text } = &self.elements[element];
        let mut found = format!("<{name}");
        for attribute in attributes.iter().filter(|a| a.required) {
            found += &format!(" {}=\"{}\"", attribute.name, attribute.values[0]);
        }
        let inner: String = children.iter().filter(|c| c.required).map(|c| self.smallest(c.element)).collect();
        if *text {
            found + ">TRUE</" + name + ">"
        } else if inner.is_empty() {
            found + "/>"
        } else {
            found + ">" + &inner + "</" + name + ">"
        }
    }
}

struct Builder<'a, 'i> {
    types: BTreeMap<String, Node<'a, 'i>>,
    known: HashMap<NodeId, usize>,
    elements: Vec<Element>,
}

impl<'a, 'i> Builder<'a, 'i> {
    fn element(&mut self, node: Node<'a, 'i>) -> usize {
        if let Some(&known) = self.known.get(&node.id()) {
            return known;
        }
        let number = self.elements.len();
        self.known.insert(node.id(), number);
        let name = node.attribute("name").expect("elements have names").to_owned();
        self.elements.push(Element { name, ..Element::default() });
        let mut found = Element::default();
        match node.attribute("type") {
            Some(kind) if kind.starts_with("xsd:") => found.text = true,
            Some(kind) => self.content(self.types[plain(kind)], &mut found, true),
            None => node.children().filter(Node::is_element).for_each(|n| self.content(n, &mut found, true)),
        }
        found.name = std::mem::take(&mut self.elements[number].name);
        self.elements[number] = found;
        number
    }

    fn content(&mut self, node: Node<'a, 'i>, found: &mut Element, required: bool) {
        let needed = required && node.attribute("minOccurs") != Some("0");
        let inner = || node.children().filter(Node::is_element);
        match node.tag_name().name() {
            "complexType" | "complexContent" => inner().for_each(|n| self.content(n, found, required)),
            "sequence" => inner().for_each(|n| self.content(n, found, needed)),
            "choice" => inner().enumerate().for_each(|(i, n)| self.content(n, found, needed && i == 0)),
            "group" => match node.attribute("ref") {
                Some(group) => self.content(self.types[plain(group)], found, needed),
                None => inner().for_each(|n| self.content(n, found, needed)),
            },
            "extension" => {
                self.content(self.types[plain(node.attribute("base").expect("a base"))], found, required);
                inner().for_each(|n| self.content(n, found, required));
            }
            "any" => found.text = true,
            "attribute" => {
                let attribute = self.attribute(node);
                found.attributes.retain(|a| a.name != attribute.name);
                found.attributes.push(attribute);
            }
            "element" => {
                let element = self.element(node);
                found.children.push(Child { element, required: needed });
            }
            _ => {}
        }
    }

    fn attribute(&self, node: Node<'a, 'i>) -> Attribute {
        let kind = node.attribute("type");
        let listed = match kind {
            Some(kind) if !kind.starts_with("xsd:") => Some(self.types[plain(kind)]),
            _ => Some(node),
        };
        let mut values: Vec<String> = listed
            .into_iter()
            .flat_map(|n| n.descendants())
            .filter(|n| is(*n, "enumeration"))
            .filter_map(|n| n.attribute("value").map(str::to_owned))
            .collect();
        if values.is_empty() {
            let some: &[&str] = match kind {
                Some("xsd:boolean") => &["true", "1", "false", "0"],
                Some("xsd:decimal" | "xsd:unsignedLong") | None => &["1", "0", "77"],
                Some("xsd:ID") => &["id77"],
                _ => &["x", "TRUE", "T#1s", ""],
            };
            values = some.iter().map(|v| (*v).to_owned()).collect();
        }
        Attribute {
            name: node.attribute("name").expect("attributes have names").to_owned(),
            values,
            default: node.attribute("default").map(str::to_owned),
            required: node.attribute("use") == Some("required"),
        }
    }
}

fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.tag_name().name() == name
}

fn plain(name: &str) -> &str {
    name.split_once(':').map_or(name, |(_, name)| name)
}
