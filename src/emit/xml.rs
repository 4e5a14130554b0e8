//! Elements, attributes and texts to well-formed XML 1.0.
//!
//! Descriptions come from users and hold anything that Unicode has, and an XML writer passes most of
//! it on as it stands. So all text goes through [`clean`], elements close themselves, and nothing is
//! written as an XML comment.

use quick_xml::Writer;
use quick_xml::escape::escape;
use quick_xml::events::{BytesCData, BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::borrow::Cow;

/// An XML text that grows.
pub struct Xml {
    writer: Writer<Vec<u8>>,
    /// Name and attributes of the element under way, kept to save allocations.
    tag: String,
}

/// An element whose attributes are being written.
#[must_use = "an element is written by `empty`, `text`, `cdata` or `with`"]
pub struct Tag<'x> {
    xml: &'x mut Xml,
    name: &'static str,
}

/// What an attribute may hold.
pub trait Value {
    /// Appends the value, escaped.
    fn append(&self, to: &mut String);
}

impl Value for i32 {
    fn append(&self, to: &mut String) {
        if *self < 0 {
            to.push('-');
        }
        self.unsigned_abs().append(to);
    }
}

impl Value for u32 {
    fn append(&self, to: &mut String) {
        // Most of a drawing is numbers, and the formatting machinery is slow.
        let (mut rest, mut digits, mut first) = (*self, [0; 10], 10);
        loop {
            first -= 1;
            digits[first] = b'0' + (rest % 10) as u8;
            rest /= 10;
            if rest == 0 {
                break;
            }
        }
        to.push_str(std::str::from_utf8(&digits[first..]).expect("digits are ASCII"));
    }
}

impl Value for str {
    fn append(&self, to: &mut String) {
        // Readers turn line breaks in attributes into blanks, so blanks are written at once.
        let text = clean(self);
        let text = if text.contains(['\n', '\t']) { text.replace(['\n', '\t'], " ").into() } else { text };
        to.push_str(&escape(text));
    }
}

impl Value for String {
    fn append(&self, to: &mut String) {
        self.as_str().append(to);
    }
}

impl<V: Value + ?Sized> Value for &V {
    fn append(&self, to: &mut String) {
        (**self).append(to);
    }
}

impl Xml {
    /// Begins a text with the XML declaration.
    pub fn new() -> Self {
        // With a wider indentation almost half of the text would be blanks.
        let writer = Writer::new_with_indent(Vec::with_capacity(1 << 16), b' ', 1);
        let mut xml = Xml { writer, tag: String::new() };
        xml.write(Event::Decl(BytesDecl::new("1.0", Some("utf-8"), None)));
        xml
    }

    /// The text.
    pub fn finish(self) -> String {
        let mut text = String::from_utf8(self.writer.into_inner()).expect("only str went in");
        text.push('\n');
        text
    }

    /// Begins an element.
    pub fn tag(&mut self, name: &'static str) -> Tag<'_> {
        self.tag.clear();
        self.tag.push_str(name);
        Tag { xml: self, name }
    }

    /// Writes an element without attributes around what `inner` writes.
    pub fn element(&mut self, name: &'static str, inner: impl FnOnce(&mut Xml)) {
        self.tag(name).with(inner);
    }

    fn write(&mut self, event: Event<'_>) {
        self.writer.write_event(event).expect("a Vec takes everything");
    }

    fn start(&mut self, name: &'static str, empty: bool) {
        let start = BytesStart::from_content(self.tag.as_str(), name.len());
        let event = if empty { Event::Empty(start) } else { Event::Start(start) };
        self.writer.write_event(event).expect("a Vec takes everything");
    }

    fn end(&mut self, name: &'static str) {
        self.write(Event::End(BytesEnd::new(name)));
    }
}

impl Tag<'_> {
    /// Adds an attribute.
    pub fn attr(self, name: &str, value: impl Value) -> Self {
        self.xml.tag.push(' ');
        self.xml.tag.push_str(name);
        self.xml.tag.push_str("=\"");
        value.append(&mut self.xml.tag);
        self.xml.tag.push('"');
        self
    }

    /// Adds an attribute if there is a value.
    pub fn attr_opt(self, name: &str, value: Option<impl Value>) -> Self {
        match value {
            Some(v) => self.attr(name, v),
            None => self,
        }
    }

    /// Ends the element: it holds nothing.
    pub fn empty(self) {
        self.xml.start(self.name, true);
    }

    /// Ends the element: it holds `text`.
    pub fn text(self, text: &str) {
        self.xml.start(self.name, false);
        self.xml.write(Event::Text(BytesText::new(&clean(text))));
        self.xml.end(self.name);
    }

    /// Ends the element: it holds `text` as one CDATA section without white space around it, or
    /// escaped where the text has the marks of such a section in it: there are readers that look for
    /// these marks before they parse.
    pub fn cdata(self, text: &str) {
        if text.contains("]]>") || text.contains("<![CDATA[") {
            return self.text(text);
        }
        self.xml.start(self.name, false);
        self.xml.write(Event::CData(BytesCData::new(clean(text))));
        self.xml.end(self.name);
    }

    /// Ends the element: it holds what `inner` writes.
    pub fn with(self, inner: impl FnOnce(&mut Xml)) {
        self.xml.start(self.name, false);
        inner(self.xml);
        self.xml.end(self.name);
    }
}

/// `text` without characters that XML 1.0 forbids (2.2, Char), with line breaks as XML readers
/// report them.
fn clean(text: &str) -> Cow<'_, str> {
    // Almost all text is plain, and this loop has no exit, so that it handles many bytes at once.
    if text.bytes().fold(true, |plain, b| plain & (b' '..0x7f).contains(&b)) {
        return Cow::Borrowed(text);
    }
    let legal = |c: char| matches!(c, '\t' | '\n' | ' '..='\u{fffd}' | '\u{10000}'..);
    if text.chars().all(legal) {
        return Cow::Borrowed(text);
    }
    let text = text.replace("\r\n", "\n");
    Cow::Owned(
        text.chars()
            .map(|c| {
                if c == '\r' {
                    '\n'
                } else if legal(c) {
                    c
                } else {
                    '\u{fffd}'
                }
            })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_forbids_is_replaced() {
        assert_eq!(clean("a\0b\u{b}c\u{ffff}d"), "a\u{fffd}b\u{fffd}c\u{fffd}d");
        assert_eq!(clean("a\r\nb\rc\td"), "a\nb\nc\td");
        assert_eq!(clean("déjà vu 🙂"), "déjà vu 🙂");
    }

    #[test]
    fn numbers_are_decimal() {
        let mut text = String::new();
        for n in [0, 7, 10, -305, i32::MAX, i32::MIN] {
            n.append(&mut text);
            text.push(' ');
        }
        u32::MAX.append(&mut text);
        assert_eq!(text, "0 7 10 -305 2147483647 -2147483648 4294967295");
    }

    #[test]
    fn any_text_survives_a_reader() {
        for text in ["", "]]>", "a]]>]]>b", "<![CDATA[", "-->", "<&>\"'", "]]", "🙂\n\ttab", "&amp;"] {
            let mut xml = Xml::new();
            xml.tag("a").attr("b", text).with(|xml| {
                xml.tag("c").text(text);
                xml.tag("d").cdata(text);
            });
            let written = xml.finish();
            let read = roxmltree::Document::parse(&written).unwrap();
            let child = |name| read.descendants().find(|n| n.has_tag_name(name)).unwrap();
            assert_eq!(child("c").text().unwrap_or(""), text);
            let cdata: String = child("d").children().filter_map(|n| n.text()).collect();
            assert_eq!(cdata, text);
            assert_eq!(child("a").attribute("b").unwrap(), text.replace(['\n', '\t'], " "));
        }
    }
}
