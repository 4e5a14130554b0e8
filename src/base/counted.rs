//! Numbers with what they count, as a sentence says them.

use std::fmt::Display;

/// `n` of what `noun` names one of: `no errors`, `1 scan`, `2 properties`.
pub fn count(n: impl Display, noun: &str) -> String {
    let n = n.to_string();
    match n.as_str() {
        "0" => format!("no {}", plural(noun)),
        "1" => format!("1 {noun}"),
        _ => format!("{n} {}", plural(noun)),
    }
}

/// The same with a figure for none: `0 scans`.
pub fn figure(n: impl Display, noun: &str) -> String {
    let n = n.to_string();
    if n == "1" { format!("1 {noun}") } else { format!("{n} {}", plural(noun)) }
}

/// Several of what `noun` names one of, as far as its ending decides it.
fn plural(noun: &str) -> String {
    match noun.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'i', 'o', 'u']) => format!("{stem}ies"),
        _ => format!("{noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::{count, figure};

    #[test]
    fn one_is_one() {
        assert_eq!([0, 1, 2].map(|n| count(n, "error")), ["no errors", "1 error", "2 errors"]);
        assert_eq!([0, 1, 21].map(|n| figure(n, "scan")), ["0 scans", "1 scan", "21 scans"]);
        assert_eq!(figure("18446744073709551616", "delay"), "18446744073709551616 delays");
        assert_eq!(count(3, "property"), "3 properties");
    }
}
