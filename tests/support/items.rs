//! The text of a model as a tree of items: what a generator makes and a shrinker takes apart.

use std::fmt::{self, Write};

/// One item of a `.chart` text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// An item without braces, such as a transition.
    Line(String),
    /// What stands before the braces and what stands between them.
    Block(String, Vec<Item>),
}

impl Item {
    /// An item without braces.
    pub fn line(text: impl Into<String>) -> Item {
        Item::Line(text.into())
    }

    /// An item with braces, even if there is nothing between them.
    pub fn block(head: impl Into<String>, items: impl IntoIterator<Item = Item>) -> Item {
        Item::Block(head.into(), items.into_iter().collect())
    }

    /// What stands before the braces, or all of it.
    pub fn head(&self) -> &str {
        match self {
            Item::Line(text) | Item::Block(text, _) => text,
        }
    }

    fn write(&self, out: &mut impl Write, depth: usize) -> fmt::Result {
        let indent = "  ".repeat(depth);
        match self {
            Item::Line(text) => writeln!(out, "{indent}{text}"),
            Item::Block(head, items) => {
                writeln!(out, "{indent}{head} {{")?;
                items.iter().try_for_each(|item| item.write(out, depth + 1))?;
                writeln!(out, "{indent}}}")
            }
        }
    }
}

/// The text of a list of items.
pub fn text(items: &[Item]) -> String {
    let mut out = String::new();
    items.iter().try_for_each(|item| item.write(&mut out, 0)).expect("a string takes everything");
    out
}

/// The names and words in a text, each once, in order of first mention.
pub fn words(text: &str) -> Vec<&str> {
    let mut words: Vec<&str> = Vec::new();
    for word in text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty()) {
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words
}
