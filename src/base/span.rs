//! Spans: places in a source text.

use serde::Serialize;

/// A stretch of source text, in bytes, `start` inclusive and `end` exclusive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The bytes from `start` up to `end`.
    pub fn new(start: usize, end: usize) -> Self {
        Span { start: start as u32, end: end as u32 }
    }

    /// The smallest span that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// The span as a range of byte offsets.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Finds line and column of byte offsets in one text.
#[derive(Clone, Debug)]
pub struct LineIndex {
    starts: Vec<u32>,
}

impl LineIndex {
    /// Reads `text` once and remembers where its lines begin.
    pub fn new(text: &str) -> Self {
        let mut starts = vec![0];
        starts.extend(text.bytes().enumerate().filter(|&(_, b)| b == b'\n').map(|(i, _)| i as u32 + 1));
        LineIndex { starts }
    }

    /// Line and column of a byte offset, both counted from 1, the column in bytes.
    pub fn position(&self, offset: u32) -> (usize, usize) {
        let line = self.starts.partition_point(|&s| s <= offset);
        (line, (offset - self.starts[line - 1]) as usize + 1)
    }

    /// The same with the column in characters, for an offset that begins one of `text`.
    pub fn character(&self, text: &str, offset: usize) -> (usize, usize) {
        let (line, column) = self.position(offset as u32);
        (line, text[offset + 1 - column..offset].chars().count() + 1)
    }
}
