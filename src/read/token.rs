//! Structured text to tokens.

use super::literal;
use crate::ir::iec::Time;

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    /// A name or keyword, as written.
    Word(String),
    /// TRUE or FALSE, with or without `BOOL#`.
    Bool(bool),
    /// An integer without sign.
    Int(i64),
    /// A duration.
    Time(Time),
    /// An operator or delimiter.
    Sign(&'static str),
}

/// Longer ones first.
const SIGNS: [&str; 18] =
    [":=", "=>", "<>", "<=", ">=", "**", "<", ">", "=", "+", "-", "*", "/", "&", "(", ")", ",", ";"];

const INT_TYPES: [&str; 8] = ["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"];

/// Cuts a text into tokens; comments are left out. An error says what cannot be read.
pub fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut list = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if let Some(after) = rest.strip_prefix("(*") {
            let end = after.find("*)").ok_or("a comment is not closed")?;
            if after[..end].contains("(*") {
                return Err("a comment stands within a comment, where tools disagree".to_owned());
            }
            4 + end
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if first.is_ascii_alphabetic() || first == '_' {
            let (token, length) = word(rest)?;
            list.push(token);
            length
        } else if first.is_ascii_digit() {
            let (token, length) = number(rest)?;
            list.push(token);
            length
        } else if first == '.' {
            list.push(Token::Sign("."));
            1
        } else if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
            list.push(Token::Sign(sign));
            sign.len()
        } else if first == '%' {
            return Err("an address stands where a name is expected".to_owned());
        } else {
            return Err(format!("`{first}` stands where it means nothing"));
        };
        rest = rest[length..].trim_start();
    }
    Ok(list)
}

fn word(text: &str) -> Result<(Token, usize), String> {
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(text.len());
    let name = &text[..end];
    let Some(literal) = text[end..].strip_prefix('#') else {
        let token = if name.eq_ignore_ascii_case("TRUE") {
            Token::Bool(true)
        } else if name.eq_ignore_ascii_case("FALSE") {
            Token::Bool(false)
        } else {
            Token::Word(name.to_owned())
        };
        return Ok((token, end));
    };
    let signed = literal.starts_with(['+', '-']);
    let length = literal[usize::from(signed)..]
        .find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '#')))
        .map_or(literal.len(), |n| n + usize::from(signed));
    let value = &literal[..length];
    let broken = || format!("`{name}#{value}` is no literal that is understood");
    let token = if literal::is_time_prefix(name) {
        Token::Time(literal::duration(value).ok_or_else(broken)?)
    } else if name.eq_ignore_ascii_case("BOOL") {
        match value.to_ascii_uppercase().as_str() {
            "TRUE" | "1" => Token::Bool(true),
            "FALSE" | "0" => Token::Bool(false),
            _ => return Err(broken()),
        }
    } else if INT_TYPES.iter().any(|t| name.eq_ignore_ascii_case(t)) {
        let negative = value.starts_with('-');
        let number = literal::unsigned(value.trim_start_matches(['+', '-'])).ok_or_else(broken)?;
        Token::Int(if negative { -number } else { number })
    } else {
        return Err(broken());
    };
    Ok((token, end + 1 + length))
}

fn number(text: &str) -> Result<(Token, usize), String> {
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '#'))).unwrap_or(text.len());
    let value = literal::unsigned(&text[..end]).ok_or_else(|| format!("`{}` is no integer", &text[..end]))?;
    Ok((Token::Int(value), end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_cut_at_the_right_places() {
        use Token::{Bool, Int, Sign, Time, Word};
        let w = |s: &str| Word(s.to_owned());
        assert_eq!(
            tokens("a.X (* b *) AND t#1s<=INT#-5 // c\n&true:=16#1F").unwrap(),
            [
                w("a"),
                Sign("."),
                w("X"),
                w("AND"),
                Time(1_000_000),
                Sign("<="),
                Int(-5),
                Sign("&"),
                Bool(true),
                Sign(":="),
                Int(31)
            ]
        );
        assert_eq!(tokens("x>=T#-1s").unwrap(), [w("x"), Sign(">="), Time(-1_000_000)]);
        for bad in ["(* a", "(* (* a *) b *)", "%IX0.0", "'a'", "T#", "T#x", "REAL#1", "1.5", "a$", "é", "BOOL#2"] {
            assert!(tokens(bad).is_err(), "{bad}");
        }
    }
}
