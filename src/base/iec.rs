//! Names as IEC 61131-3 has them.
//!
//! A legal name is `[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*`, is none of the [words](super::words) that PLCs keep to
//! themselves, and two names that differ only by case are the same name (IEC 61131-3, 2.1.2).

/// The form in which names are compared: IEC names have no case.
pub fn fold(name: &str) -> String {
    name.to_ascii_uppercase()
}

/// Why a name is no legal IEC identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illegal {
    /// It is empty or begins with something other than a letter.
    FirstCharacter,
    /// It holds a character other than letters, digits and `_` of ASCII.
    Character(char),
    /// It holds `__`.
    DoubleUnderscore,
    /// It ends in `_`.
    TrailingUnderscore,
}

/// Says what keeps `name` from having the form of an identifier, if anything does.
pub fn illegal(name: &str) -> Option<Illegal> {
    if let Some(c) = name.chars().find(|c| !c.is_ascii_alphanumeric() && *c != '_') {
        return Some(Illegal::Character(c));
    }
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Some(Illegal::FirstCharacter);
    }
    if name.contains("__") {
        return Some(Illegal::DoubleUnderscore);
    }
    if name.ends_with('_') {
        return Some(Illegal::TrailingUnderscore);
    }
    None
}

/// The numbers in the address of a bit, in upper or lower case: one to four, each below 65,536. `area` is `I` or
/// `Q`.
pub fn bit_numbers(address: &str, area: char) -> Option<Vec<u16>> {
    let upper = address.to_ascii_uppercase();
    let numbers = upper.strip_prefix(&format!("%{area}X"))?;
    let parts: Vec<u16> = numbers
        .split('.')
        .map(|n| {
            let digits = !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
            digits.then(|| n.parse::<u16>().ok()).flatten()
        })
        .collect::<Option<_>>()?;
    (parts.len() <= 4).then_some(parts)
}

/// The address of a bit in its one spelling: upper case, without leading zeros. `area` is `I` or `Q`.
pub fn bit_address(address: &str, area: char) -> Option<String> {
    let numbers: Vec<String> = bit_numbers(address, area)?.iter().map(u16::to_string).collect();
    Some(format!("%{area}X{}", numbers.join(".")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_judged_by_the_standard() {
        assert_eq!(illegal("Go_out2"), None);
        assert_eq!(illegal("a__b"), Some(Illegal::DoubleUnderscore));
        assert_eq!(illegal("a_"), Some(Illegal::TrailingUnderscore));
        assert_eq!(illegal("2a"), Some(Illegal::FirstCharacter));
        assert_eq!(illegal("_a"), Some(Illegal::FirstCharacter));
        assert_eq!(illegal("é"), Some(Illegal::Character('é')));
    }
}
