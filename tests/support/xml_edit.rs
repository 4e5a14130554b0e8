//! PLCopen XML with one thing changed, as text.

use roxmltree::Node;

/// The end of the name in a start tag.
fn after_name(xml: &str, node: Node<'_, '_>) -> usize {
    let start = node.range().start;
    start + xml[start..].find(|c: char| c.is_whitespace() || c == '>' || c == '/').expect("a tag ends")
}

/// Where the start tag ends, and whether it is the whole element.
fn tag_end(xml: &str, node: Node<'_, '_>) -> (usize, bool) {
    let start = node.range().start;
    let mut quote = None;
    for (at, c) in xml[start..].char_indices() {
        match (c, quote) {
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            ('>', None) => return (start + at + 1, xml[..start + at].ends_with('/')),
            _ => {}
        }
    }
    unreachable!("a tag ends")
}

/// With an attribute of that value, whether there was one or not.
pub fn with_attribute(xml: &str, node: Node<'_, '_>, name: &str, value: &str) -> String {
    let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let text = without_attribute(xml, node, name);
    let at = after_name(&text, node);
    format!("{} {name}=\"{value}\"{}", &text[..at], &text[at..])
}

/// Without the attribute.
pub fn without_attribute(xml: &str, node: Node<'_, '_>, name: &str) -> String {
    let Some(attribute) = node.attributes().find(|a| a.name() == name && a.namespace().is_none()) else {
        return xml.to_owned();
    };
    let range = attribute.range();
    format!("{}{}", xml[..range.start].trim_end(), &xml[range.end..])
}

/// With an element at the beginning or the end of what is in it.
pub fn with_child(xml: &str, node: Node<'_, '_>, child: &str, first: bool) -> String {
    let (end, whole) = tag_end(xml, node);
    if whole {
        let name = &xml[node.range().start + 1..after_name(xml, node)];
        return format!("{}>{child}</{name}>{}", xml[..end - 1].trim_end_matches('/'), &xml[end..]);
    }
    let at = if first { end } else { xml[..node.range().end].rfind("</").expect("an end tag") };
    format!("{}{child}{}", &xml[..at], &xml[at..])
}

/// With something else in the place of the element.
pub fn replaced(xml: &str, node: Node<'_, '_>, by: &str) -> String {
    let range = node.range();
    format!("{}{by}{}", &xml[..range.start], &xml[range.end..])
}

/// With the two elements in each other's place; neither is within the other.
pub fn exchanged(xml: &str, one: Node<'_, '_>, two: Node<'_, '_>) -> String {
    let (a, b) = if one.range().start < two.range().start { (one, two) } else { (two, one) };
    let (a, b) = (a.range(), b.range());
    [&xml[..a.start], &xml[b.clone()], &xml[a.end..b.start], &xml[a.clone()], &xml[b.end..]].concat()
}
