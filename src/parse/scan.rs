//! Text to the certainty that its brackets match and nest no deeper than the limit.

use crate::base::{Code, Diagnostic, Span, limits};

/// Looks at brackets, texts and comments alone. Nothing else of the grammar matters here.
pub fn scan(source: &str) -> Result<(), Vec<Diagnostic>> {
    let bytes = source.as_bytes();
    let mut open: Vec<(u8, usize)> = Vec::new();
    let mut found = Vec::new();
    let mut i = 0;
    while i < bytes.len() {
        match bytes[i] {
            b'/' if bytes.get(i + 1) == Some(&b'/') => {
                i += memchr(bytes, i, b'\n');
                continue;
            }
            b'"' => match text_end(bytes, i) {
                Some(end) => i = end,
                None => {
                    let end = i + memchr(bytes, i, b'\n');
                    found.push(
                        Diagnostic::new(Code::Unbalanced, "a text is not closed on its line")
                            .label(Span::new(i, end), "begins here")
                            .help("end it with `\"`; inside, write `\\\"` for a quote and `\\\\` for a backslash"),
                    );
                    i = end;
                    continue;
                }
            },
            b @ (b'{' | b'(') => {
                open.push((b, i));
                if open.len() > limits::NESTING {
                    found.push(
                        Diagnostic::new(Code::TooDeep, format!("brackets nest more than {} deep", limits::NESTING))
                            .label(Span::new(i, i + 1), "one too many")
                            .help("give a part of the hierarchy or of the expression a name of its own"),
                    );
                    return Err(found);
                }
            }
            b @ (b'}' | b')') => match open.pop() {
                Some((o, _)) if (o == b'{') == (b == b'}') => {}
                Some((o, at)) => {
                    found.push(
                        Diagnostic::new(Code::Unbalanced, format!("`{}` is closed by `{}`", o as char, b as char))
                            .label(Span::new(at, at + 1), "opened here")
                            .label(Span::new(i, i + 1), "closed here"),
                    );
                    return Err(found);
                }
                None => {
                    found.push(
                        Diagnostic::new(Code::Unbalanced, format!("`{}` closes nothing", b as char))
                            .label(Span::new(i, i + 1), "nothing is open here"),
                    );
                    return Err(found);
                }
            },
            _ => {}
        }
        i += 1;
    }
    for (b, at) in open.into_iter().rev().take(3) {
        found.push(
            Diagnostic::new(Code::Unbalanced, format!("`{}` is never closed", b as char))
                .label(Span::new(at, at + 1), "opened here"),
        );
    }
    if found.is_empty() { Ok(()) } else { Err(found) }
}

/// Distance from `from` to the next `byte`, or to the end.
fn memchr(bytes: &[u8], from: usize, byte: u8) -> usize {
    bytes[from..].iter().position(|&b| b == byte).unwrap_or(bytes.len() - from)
}

/// Index of the quote that closes the text opened at `from`.
fn text_end(bytes: &[u8], from: usize) -> Option<usize> {
    let mut i = from + 1;
    while i < bytes.len() {
        match bytes[i] {
            b'"' => return Some(i),
            b'\n' => return None,
            b'\\' => i += 2,
            _ => i += 1,
        }
    }
    None
}

/// Something as it is written, without comments and with one space where there is white space. Texts stay as they are.
pub fn on_one_line(written: &str) -> String {
    let mut line = String::with_capacity(written.len());
    let (mut rest, mut space) = (written, false);
    while let Some(c) = rest.chars().next() {
        let length = match c {
            // A text ends where a quote stands that nothing escapes, and a comment with its line.
            '"' => text_length(rest),
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ => c.len_utf8(),
        };
        let (piece, after) = rest.split_at(length);
        rest = after;
        if piece.starts_with("//") || c.is_whitespace() {
            space = true;
            continue;
        }
        if space && !line.is_empty() {
            line.push(' ');
        }
        space = false;
        line.push_str(piece);
    }
    line
}

/// How many bytes the text takes with which this begins, quotes included.
fn text_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::on_one_line;

    #[test]
    fn comments_and_lines_go_and_texts_stay() {
        for (written, line) in [
            ("A\n  and\tB", "A and B"),
            ("A // not\n and B // nor this", "A and B"),
            ("happens \"a  // b \\\" c\"  before writing", "happens \"a  // b \\\" c\" before writing"),
            ("// nothing", ""),
            ("A/B", "A/B"),
            ("\"open // ended", "\"open // ended"),
        ] {
            assert_eq!(on_one_line(written), line);
        }
    }
}
