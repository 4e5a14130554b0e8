//! Models with random damage: whatever stands in a file, the compiler answers and does not panic.

use crate::support::models::{listing, repository};
use chartwright::base::limits;
use chartwright::pipeline::{Dialect, Options};
use chartwright::{parse, pipeline};
use std::fs;

/// Mutants of each model.
const MUTANTS: u64 = 500;

/// What damage is made of, beside bytes of the model itself.
const PIECES: &[&str] = &[
    "{",
    "}",
    "(",
    ")",
    "\"",
    "//",
    "\n",
    "\0",
    "é",
    "\u{feff}",
    "\u{2028}",
    "%IX",
    "%",
    ".",
    ",",
    ":",
    ":=",
    "0",
    "4294967296",
    "any",
    "state",
    "initial state",
    "final",
    "parallel",
    "region",
    "move from",
    "from",
    "to",
    "when",
    "then set",
    "priority 1",
    "drives",
    "sets",
    "never",
    "yields",
    "assume",
    "not",
    "and",
    "or",
    "xor",
    "prev(",
    "rise(",
    "in(",
    "done",
    "true",
    "false",
    "controls",
    "at",
    "safety supervisor {",
    "chart",
    "actuator",
    "bistable",
    "monostable",
    "onoff",
    "position",
    "by",
    "machine",
    "cycle 0s",
    "ms",
];

/// SplitMix64 (Steele, Lea, Flood 2014): small, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Less than `bound`, or 0.
    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }
}

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    let length = random.below(40).min(bytes.len() - at);
    match random.below(8) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..at + length)),
        2 => {
            let again = bytes[at..at + length].to_vec();
            let to = random.below(bytes.len() + 1);
            bytes.splice(to..to, again);
        }
        3 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        4 if at < bytes.len() => bytes[at] = random.next() as u8,
        5 => exchange_words(bytes, random),
        6 => {
            let (from, to) = word(bytes, at);
            bytes.drain(from..to);
        }
        _ => {
            let piece = format!(" {} ", PIECES[random.below(PIECES.len())]);
            bytes.splice(at..at, piece.bytes());
        }
    }
}

/// Puts one word of the text in the place of another: keeps the form, changes the meaning.
fn exchange_words(bytes: &mut Vec<u8>, random: &mut Random) {
    let (from, to) = word(bytes, random.below(bytes.len() + 1));
    let other = bytes[from..to].to_vec();
    let (from, to) = word(bytes, random.below(bytes.len() + 1));
    bytes.splice(from..to, other);
}

/// The word around or behind `at`.
fn word(bytes: &[u8], at: usize) -> (usize, usize) {
    let letter = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
    let start = at + bytes[at..].iter().position(letter).unwrap_or(0);
    let from = bytes[..start].iter().rposition(|b| !letter(b)).map_or(0, |i| i + 1);
    let to = start + bytes[start..].iter().position(|b| !letter(b)).unwrap_or(bytes.len() - start);
    (from, to)
}

/// Builds the mutant, and looks at what is said of it.
fn judge(bytes: Vec<u8>, dialect: Dialect) {
    let Ok(source) = parse::decode(bytes, limits::SOURCE_BYTES) else { return };
    let options = Options { dialect, created: "1970-01-01T00:00:00".to_owned(), prove: false };
    let (output, diagnostics) = pipeline::build(&source, &options);
    for d in &diagnostics {
        assert!(!d.labels.is_empty(), "{}: no place in\n{source}", d.code);
        for label in &d.labels {
            let range = label.span.range();
            assert!(source.get(range.clone()).is_some(), "{}: {range:?} is no place in\n{source}", d.code);
        }
    }
    assert_eq!(output.is_none(), diagnostics.has_errors());
    if let Some(output) = output {
        assert!(output.xml.starts_with("<?xml") && !output.names.is_empty());
    }
}

#[test]
fn no_damage_makes_the_compiler_panic() {
    for directory in ["models", "models/invalid"] {
        for (i, file) in listing(directory).iter().filter(|f| f.ends_with(".chart")).enumerate() {
            let path = repository(directory).join(file);
            let Ok(original) = fs::read(&path) else { continue };
            for seed in 0..MUTANTS {
                let mut random = Random(seed + MUTANTS * i as u64);
                let mut bytes = original.clone();
                for _ in 0..=random.below(4) {
                    damage(&mut bytes, &mut random);
                }
                let dialect = [Dialect::Beremiz, Dialect::Codesys][seed as usize % 2];
                let judged = std::panic::catch_unwind(|| judge(bytes.clone(), dialect));
                assert!(judged.is_ok(), "{file}, seed {seed}: panic on\n{}", String::from_utf8_lossy(&bytes));
            }
        }
    }
}
