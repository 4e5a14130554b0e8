//! Literals of IEC 61131-3 and durations of XML Schema to numbers.

use crate::ir::iec::Time;

const MILLISECOND: i128 = 1_000;
const SECOND: i128 = 1_000 * MILLISECOND;
const MINUTE: i128 = 60 * SECOND;
const HOUR: i128 = 60 * MINUTE;
const DAY: i128 = 24 * HOUR;

/// What stands behind `T#`, such as `1m30s` or `-1.5s`: parts with units of which only the last may
/// have a fraction, perhaps with `_` between them (IEC 61131-3, table 7).
pub fn duration(text: &str) -> Option<Time> {
    let (negative, mut rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let mut total = 0;
    let mut smallest = i128::MAX;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '_'))?;
        let (number, tail) = rest.split_at(digits);
        let letters = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(letters);
        let unit = match unit.to_ascii_lowercase().as_str() {
            "d" => DAY,
            "h" => HOUR,
            "m" => MINUTE,
            "s" => SECOND,
            "ms" => MILLISECOND,
            "us" => 1,
            _ => return None,
        };
        rest = tail.strip_prefix('_').unwrap_or(tail);
        let fraction = number.contains('.');
        if unit >= smallest || (fraction && !rest.is_empty()) {
            return None;
        }
        smallest = unit;
        total += scaled(number, unit)?;
    }
    if smallest == i128::MAX {
        return None;
    }
    Time::try_from(if negative { -total } else { total }).ok()
}

/// A duration of XML Schema: `PT0.01S`.
pub fn schema_duration(text: &str) -> Option<Time> {
    let rest = text.strip_prefix('P')?;
    let (days, times) = rest.split_once('T').unwrap_or((rest, ""));
    let mut total = 0;
    let mut any = false;
    for (mut rest, units) in [(days, &[('D', DAY)][..]), (times, &[('H', HOUR), ('M', MINUTE), ('S', SECOND)][..])] {
        for &(letter, unit) in units {
            let Some((number, tail)) = rest.split_once(letter) else { continue };
            total += scaled(number, unit)?;
            rest = tail;
            any = true;
        }
        if !rest.is_empty() {
            return None;
        }
    }
    if any { Time::try_from(total).ok() } else { None }
}

/// The interval of a task: `T#10ms`, `10ms` or `PT0.01S`.
pub fn interval(text: &str) -> Option<Time> {
    if text.starts_with('P') {
        return schema_duration(text);
    }
    let rest = match text.split_once('#') {
        Some((prefix, rest)) if is_time_prefix(prefix) => rest,
        Some(_) => return None,
        None => text,
    };
    duration(rest)
}

/// A number without a fraction, and the unit it counts.
pub fn counted(number: &str, unit: &str) -> Option<Time> {
    let unit = match unit.to_ascii_lowercase().as_str() {
        "us" | "µs" => 1,
        "ms" => MILLISECOND,
        "s" => SECOND,
        _ => return None,
    };
    Time::try_from(i128::from(integer(number)?) * unit).ok()
}

/// Whether `T` in `T#1s` marks a duration.
pub fn is_time_prefix(prefix: &str) -> bool {
    prefix.eq_ignore_ascii_case("T") || prefix.eq_ignore_ascii_case("TIME")
}

/// Decimal digits, perhaps with a fraction, times a unit; `None` where that is no whole number of
/// microseconds or far too large.
fn scaled(number: &str, unit: i128) -> Option<i128> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let mut value = i128::from(integer(whole)?) * unit;
    let mut place = unit;
    for c in fraction.chars().filter(|&c| c != '_') {
        let digit = i128::from(c.to_digit(10)?);
        if digit != 0 && (place == 0 || place % 10 != 0) {
            return None;
        }
        place /= 10;
        value += digit * place;
    }
    (!number.contains('.') || fraction.starts_with(|c: char| c.is_ascii_digit())).then_some(value)
}

/// Decimal digits, perhaps with `_` between them.
fn integer(text: &str) -> Option<i64> {
    based(text, 10)
}

fn based(text: &str, base: u32) -> Option<i64> {
    if !text.starts_with(|c: char| c.is_digit(base)) {
        return None;
    }
    let mut value: i64 = 0;
    for c in text.chars().filter(|&c| c != '_') {
        value = value.checked_mul(i64::from(base))?.checked_add(i64::from(c.to_digit(base)?))?;
    }
    Some(value)
}

/// An integer without sign, in base 2, 8, 10 or 16: `10`, `1_000`, `16#FF`.
pub fn unsigned(text: &str) -> Option<i64> {
    match text.split_once('#') {
        None => integer(text),
        Some(("2", digits)) => based(digits, 2),
        Some(("8", digits)) => based(digits, 8),
        Some(("10", digits)) => based(digits, 10),
        Some(("16", digits)) => based(digits, 16),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read_in_all_spellings() {
        for (text, value) in [
            ("10ms", Some(10_000)),
            ("1.5s", Some(1_500_000)),
            ("1m_30s", Some(90_000_000)),
            ("360m0s0ms", Some(21_600_000_000)),
            ("2S", Some(2_000_000)),
            ("-1.25ms", Some(-1_250)),
            ("1d2h", Some(93_600_000_000)),
            ("1s1m", None),
            ("1.5m10s", None),
            ("1.0000001s", None),
            ("1.00000000001s", None),
            (".5s", None),
            ("10", None),
            ("", None),
            ("99999999999999999999d", None),
            ("9999999999999999d", None),
        ] {
            assert_eq!(duration(text), value, "{text}");
        }
        for (text, value) in [
            ("PT0.01S", Some(10_000)),
            ("PT1M30S", Some(90_000_000)),
            ("P1DT1S", Some(86_401_000_000)),
            ("PT0S", Some(0)),
            ("PT", None),
            ("PT1X", None),
        ] {
            assert_eq!(schema_duration(text), value, "{text}");
        }
        assert_eq!(interval("TIME#20ms"), Some(20_000));
        assert_eq!(interval("t#20ms"), Some(20_000));
        assert_eq!(interval("D#20ms"), None);
        let counted = ["us", "µs", "ms", "S", "min"].map(|unit| counted("20", unit));
        assert_eq!(counted, [Some(20), Some(20), Some(20_000), Some(20_000_000), None]);
    }

    #[test]
    fn integers_are_read_in_all_bases() {
        assert_eq!(unsigned("16#Ff"), Some(255));
        assert_eq!(unsigned("2#1010_0001"), Some(161));
        assert_eq!(unsigned("1_000"), Some(1000));
        assert_eq!(unsigned("_1"), None);
        assert_eq!(unsigned("16#G"), None);
        assert_eq!(unsigned("99999999999999999999"), None);
    }
}
