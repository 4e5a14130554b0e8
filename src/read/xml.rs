//! XML text to a tree, and what is asked of its nodes.
//!
//! Vendor data resets namespaces at will, so elements are told by their local names alone; only the
//! root element's namespace counts.

use super::Problem;
use crate::base::{Code, Diagnostic, Span};
use roxmltree::{Document, ParsingOptions};

/// An element.
pub type Node<'a> = roxmltree::Node<'a, 'a>;

/// Which IDEs wrote the file, and so by which conventions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// TC6 v2.01: Beremiz, OpenPLC Editor and their kin.
    Beremiz,
    /// TC6 v2.0: CODESYS, TwinCAT and their kin.
    Codesys,
}

/// Most elements, attributes and texts of a file.
const NODES: u32 = 20_000_000;

/// Most attributes of one element. No tool writes more than a dozen; comparing each with each other one takes time.
const ATTRIBUTES: usize = 256;

/// Parses the text.
pub fn parse(text: &str) -> Result<Document<'_>, Problem> {
    if let Some(at) = crowded(text) {
        let message = format!("an element has more than {ATTRIBUTES} attributes");
        return Err(Diagnostic::new(Code::NotPlcopen, message).label(Span::new(at, at + 1), ""));
    }
    let options = ParsingOptions { nodes_limit: NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        let line_start: usize =
            text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize).map(str::len).sum();
        let column: usize =
            text[line_start..].chars().take(place.col.saturating_sub(1) as usize).map(char::len_utf8).sum();
        let at = (line_start + column).min(text.len());
        Diagnostic::new(Code::NotPlcopen, format!("the XML is broken: {error}")).label(Span::new(at, at), "")
    })
}

/// Where an element with too many attributes begins, if there is one. Of a broken text it may say anything.
fn crowded(text: &str) -> Option<usize> {
    let mut next = 0;
    while let Some(found) = text[next..].find('<') {
        let start = next + found;
        let rest = &text[start..];
        let after = |opening: &str, closing: &str| {
            let rest = rest.strip_prefix(opening)?;
            Some(start + opening.len() + rest.find(closing).map_or(rest.len(), |end| end + closing.len()))
        };
        let skipped = after("<!--", "-->")
            .or_else(|| after("<![CDATA[", "]]>"))
            .or_else(|| after("<?", "?>"))
            .or_else(|| after("</", ">"));
        next = match skipped {
            Some(end) => end,
            None => {
                let (mut quote, mut attributes) = (None, 0);
                let end = rest.char_indices().skip(1).find(|&(_, c)| {
                    match (c, quote) {
                        ('"' | '\'', None) => (quote, attributes) = (Some(c), attributes + 1),
                        (c, Some(open)) if c == open => quote = None,
                        _ => {}
                    }
                    attributes > ATTRIBUTES || (quote.is_none() && matches!(c, '>' | '<'))
                });
                if attributes > ATTRIBUTES {
                    return Some(start);
                }
                start + end.map_or(rest.len(), |(at, c)| at + usize::from(c == '>'))
            }
        };
    }
    None
}

/// The root element and who wrote it.
pub fn root<'a>(document: &'a Document<'_>) -> Result<(Node<'a>, Family), Problem> {
    let root = document.root_element();
    let family = match root.tag_name().namespace() {
        Some("http://www.plcopen.org/xml/tc6_0201") => Some(Family::Beremiz),
        Some("http://www.plcopen.org/xml/tc6_0200") => Some(Family::Codesys),
        _ => None,
    };
    match family {
        Some(family) if is(root, "project") => Ok((root, family)),
        _ => {
            let name = root.tag_name();
            let found = format!("this is `{}` of namespace `{}`", name.name(), name.namespace().unwrap_or(""));
            let problem = Diagnostic::new(Code::NotPlcopen, "the root element is not a PLCopen project");
            let help = "export the project as PLCopen XML, of namespace tc6_0200 or tc6_0201";
            Err(problem.label(place(root), found).help(help))
        }
    }
}

/// The start tag's name, for a label.
pub fn place(node: Node<'_>) -> Span {
    let start = node.range().start;
    Span::new(start, (start + 1 + node.tag_name().name().len()).min(node.range().end))
}

/// A problem with an element.
pub fn problem(code: Code, message: impl Into<String>, node: Node<'_>) -> Problem {
    Diagnostic::new(code, message).label(place(node), String::new())
}

/// Something that this reader does not take.
pub fn not_understood(what: impl std::fmt::Display, node: Node<'_>) -> Problem {
    problem(Code::NotUnderstood, format!("{what} is not understood"), node)
}

/// Whether an element has that name.
pub fn is(node: Node<'_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// The elements directly within one.
pub fn children<'a>(node: Node<'a>) -> impl Iterator<Item = Node<'a>> {
    node.children().filter(Node::is_element)
}

/// The first element of that name directly within one.
pub fn child<'a>(node: Node<'a>, name: &str) -> Option<Node<'a>> {
    children(node).find(|&n| is(n, name))
}

/// The elements of that name directly within one.
pub fn children_named<'a>(node: Node<'a>, name: &'static str) -> impl Iterator<Item = Node<'a>> {
    children(node).filter(move |&n| is(n, name))
}

/// All elements of that name below one.
pub fn descendants<'a>(node: Node<'a>, name: &'static str) -> impl Iterator<Item = Node<'a>> {
    node.descendants().filter(move |&n| is(n, name))
}

/// An attribute without surrounding white space; an empty one counts as missing.
pub fn attribute<'a>(node: Node<'a>, name: &str) -> Option<&'a str> {
    node.attribute(name).map(str::trim).filter(|v| !v.is_empty())
}

/// An attribute that must be there.
pub fn required<'a>(node: Node<'a>, name: &str) -> Result<&'a str, Problem> {
    attribute(node, name).ok_or_else(|| {
        let message = format!("`{}` has no attribute `{name}`", node.tag_name().name());
        problem(Code::NotPlcopen, message, node)
    })
}

/// A Boolean attribute; missing is false.
pub fn flag(node: Node<'_>, name: &str) -> bool {
    matches!(attribute(node, name), Some("true" | "TRUE" | "True" | "1"))
}

/// All text below an element, whatever elements are around it.
pub fn text(node: Node<'_>) -> String {
    node.descendants().filter(|n| n.is_text()).filter_map(|n| n.text()).collect()
}
