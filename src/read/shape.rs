//! Whether a file says only what is interpreted: one pass over its tree against the table ([`schema`](super::schema)).
//!
//! What the table does not name at a place is refused, whoever would understand it. Where one element can be and
//! two stand, one tool takes the first, another one the last. What has another namespace is seen by some. A
//! comment within a text ends it for those who read no further. The attribute `negated="yes"` is no for one and
//! an error for the next. None of that has a definite meaning, so it is refused as well.
//!
//! A program is looked into when something runs it ([`program`]), and not before.

use super::body::describe;
use super::compiled;
use super::schema::{Content, Row, Table, Use};
use super::vendor;
use super::xml::{self, Family, Node};
use crate::base::{Code, Diagnostics};
use std::collections::{BTreeMap, BTreeSet};

/// The types of attributes that the reader interprets.
const FLAGS: [&str; 7] = ["constant", "initialStep", "negated", "nonpersistent", "nonretain", "persistent", "retain"];

/// The attributes by which any element may name its schema.
const INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// One pass over a part of a file.
struct Pass<'t, 'd> {
    table: &'t Table,
    family: Family,
    problems: &'d mut Diagnostics,
}

/// Examines a file but for its programs.
pub fn file(root: Node<'_>, table: &Table, family: Family, problems: &mut Diagnostics) {
    Pass { table, family, problems }.walk(root, "-");
}

/// Examines one program.
pub fn program(pou: Node<'_>, table: &Table, family: Family, problems: &mut Diagnostics) {
    Pass { table, family, problems }.walk(pou, "pous");
}

impl Pass<'_, '_> {
    fn walk(&mut self, root: Node<'_>, parent: &str) {
        let Some(row) = self.table.row(parent, root.tag_name().name()) else { return };
        let mut open = vec![(root, row)];
        while let Some((node, row)) = open.pop() {
            self.attributes(node, row);
            if self.family == Family::Beremiz
                && let Some(what) = compiled::objection(node)
            {
                self.problems.push(xml::not_understood(what, node));
            }
            match row.content {
                Content::Text => text(node, self.problems),
                Content::Markup => text(wrapped(node), self.problems),
                Content::Elements => {
                    self.no_text(node);
                    for child in self.children(node, row) {
                        let parent = child.parent().map_or("-", |n| n.tag_name().name());
                        let inner = self.table.row(parent, child.tag_name().name());
                        open.extend(inner.filter(|_| !xml::is(child, "pou")).map(|row| (child, row)));
                    }
                }
            }
        }
    }

    fn attributes(&mut self, node: Node<'_>, row: &Row) {
        for attribute in node.attributes() {
            let (name, value) = (attribute.name(), attribute.value().trim());
            if attribute.namespace().is_some_and(|n| n == INSTANCE) && name.ends_with("chemaLocation") {
                continue;
            }
            let good_for = row.attributes.get(name).filter(|_| attribute.namespace().is_none());
            let is_value = match name {
                _ if good_for.is_none() => true,
                "edge" => ["none", "rising", "falling"].contains(&value),
                "storage" => ["none", "set", "reset"].contains(&value),
                flag if FLAGS.contains(&flag) => ["true", "false", "1", "0"].contains(&value),
                _ => true,
            };
            if !is_value {
                let message = format!("`{value}` is no value of the attribute `{name}`");
                self.problems.push(xml::problem(Code::NotPlcopen, message, node));
                continue;
            }
            let fits = match good_for {
                None => false,
                Some(Use::Interpreted | Use::Describes) => true,
                Some(Use::Only(values)) => {
                    values.contains(&if value == "0" && values == &["false"] { "false" } else { value })
                }
            };
            if !fits {
                let what = format!("`{name}` = `{value}` of {}", describe(node));
                self.problems.push(xml::not_understood(what, node));
            }
        }
    }

    /// Elements do not stand within text.
    fn no_text(&mut self, node: Node<'_>) {
        if node.children().any(|n| n.is_text() && !blank(n)) {
            self.problems.push(xml::not_understood(format!("a text in {}", describe(node)), node));
        }
    }

    /// The elements that are to be looked into.
    fn children<'a>(&mut self, node: Node<'a>, row: &Row) -> Vec<Node<'a>> {
        let namespace = node.tag_name().namespace();
        let parent = node.tag_name().name();
        let mut seen = BTreeSet::new();
        let mut chosen: BTreeMap<usize, &str> = BTreeMap::new();
        let mut inner = Vec::new();
        for child in xml::children(node) {
            let name = child.tag_name().name();
            if child.tag_name().namespace() != namespace {
                let what = format!("`{name}`, of another namespace than `{parent}`,");
                self.problems.push(xml::not_understood(what, child));
                continue;
            }
            let Some(entry) = row.elements.get(name) else {
                self.problems.push(xml::not_understood(format!("{} in `{parent}`", describe(child)), child));
                continue;
            };
            if !seen.insert(name) && !entry.repeats {
                self.problems.push(xml::not_understood(format!("a second `{name}` in one `{parent}`"), child));
            }
            if let Some(first) = entry.choice.and_then(|choice| chosen.insert(choice, name))
                && first != name
            {
                let what = format!("both `{first}` and `{name}` in one `{parent}`");
                self.problems.push(xml::not_understood(what, child));
            }
            match (&entry.good_for, name) {
                (Use::Describes, _) => {}
                (_, "addData") => inner.extend(vendor::data(child, self.family, self.problems)),
                _ => inner.push(child),
            }
        }
        inner
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
