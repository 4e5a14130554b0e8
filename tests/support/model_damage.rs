//! Models with one thing wrong in what engineers write: constraints, observers and guards.

/// A model with one thing wrong.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// Its source.
    pub source: String,
    /// What is wrong.
    pub kind: Kind,
    /// What it is, in words.
    pub what: String,
}

/// What is wrong with a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A constraint is gone.
    Dropped,
    /// A literal of a constraint is negated.
    Negated,
    /// A literal in a guard of an observer is negated.
    Misled,
    /// An observer sees something a scan late.
    Late,
    /// A literal in a guard of a chart, or in a condition of a function, is negated.
    Misguided,
}

/// The words of conditions that are no atoms.
const WORDS: &[&str] = &["and", "or", "not", "xor", "true", "false", "done", "after"];

/// Where a line stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Safety,
    Observer,
    Chart,
    Other,
}

/// All models with one thing wrong that can be made of a model, in the order of its lines.
pub fn mutants(source: &str) -> Vec<Mutant> {
    let lines: Vec<&str> = source.lines().collect();
    let mut all = Vec::new();
    let (mut section, mut part) = (Section::Other, String::new());
    for (i, line) in lines.iter().enumerate() {
        if line.starts_with(|c: char| c.is_ascii_lowercase()) {
            let words: Vec<&str> = line.split_whitespace().collect();
            section = match words[0] {
                "safety" => Section::Safety,
                "observer" => Section::Observer,
                "chart" | "function" | "sequence" => Section::Chart,
                _ => Section::Other,
            };
            part = words.get(1).map_or_else(String::new, |w| (*w).to_owned());
        }
        let code = line.split("//").next().expect("a line has a beginning");
        let code = code.split('"').next().expect("a line has a beginning");
        let mut put = |kind, with: Option<String>, what: String| {
            let changed = lines.iter().enumerate().filter_map(|(j, l)| match (i == j, &with) {
                (false, _) => Some((*l).to_owned()),
                (true, with) => with.clone(),
            });
            let source = changed.collect::<Vec<_>>().join("\n") + "\n";
            all.push(Mutant { source, kind, what });
        };
        match section {
            Section::Safety => {
                let (Some(colon), Some(never)) = (code.find(':'), code.find(": never ")) else { continue };
                if colon != never {
                    continue;
                }
                let name = code[..colon].trim();
                if name.starts_with("assume") {
                    continue;
                }
                put(Kind::Dropped, None, format!("{name} is left out"));
                for (at, atom) in atoms(code, never + ": never ".len()) {
                    let with = negated(line, at);
                    put(Kind::Negated, Some(with), format!("{atom} is negated in {name}"));
                }
            }
            Section::Observer => {
                let Some(when) = code.find(" when ") else { continue };
                for (at, atom) in atoms(code, when + " when ".len()) {
                    let place = format!("{part}: {}", code.trim());
                    put(Kind::Misled, Some(negated(line, at)), format!("{atom} is negated in {place}"));
                    // What it sees of the last scan already cannot be seen any later like this.
                    if !atom.contains('(') && !code.contains("after filter") {
                        let late = format!("{}prev({atom}){}", &line[..at], &line[at + atom.len()..]);
                        put(Kind::Late, Some(late), format!("{atom} is seen late in {place}"));
                    }
                }
                if let Some(late) = before_the_filter(line) {
                    put(Kind::Late, Some(late), format!("the filter is seen late in {part}: {}", code.trim()));
                }
            }
            Section::Chart => {
                let Some(when) = code.find(" when ") else { continue };
                for (at, atom) in atoms(code, when + " when ".len()) {
                    let what = format!("{atom} is negated in {part}: {}", code.trim());
                    put(Kind::Misguided, Some(negated(line, at)), what);
                }
            }
            Section::Other => {}
        }
    }
    all
}

/// The atoms of the condition that begins there, each with its place; comparisons are left out.
fn atoms(code: &str, from: usize) -> Vec<(usize, String)> {
    let end = |word: &str| code[from..].find(word).map(|at| from + at);
    let ends = [" yields ", " then ", "{", "}", " priority ", " drives "];
    let end = ends.iter().filter_map(|word| end(word)).min().unwrap_or(code.len());
    let mut found = Vec::new();
    let bytes = code.as_bytes();
    let is_word = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'.';
    let mut at = from;
    while at < end {
        if !is_word(bytes[at]) {
            at += 1;
            continue;
        }
        let begin = at;
        while at < end && is_word(bytes[at]) {
            at += 1;
        }
        let word = &code[begin..at];
        if code[at..end].starts_with('(')
            && !WORDS.contains(&word)
            && let Some(close) = code[at..end].find(')')
        {
            at += close + 1;
        }
        let compared = |text: &str, last: bool| {
            let text = text.trim();
            let c = if last { text.chars().next_back() } else { text.chars().next() };
            c.is_some_and(|c| "<>=+-".contains(c))
        };
        let number = word.starts_with(|c: char| c.is_ascii_digit());
        if !WORDS.contains(&word) && !number && !compared(&code[..begin], true) && !compared(&code[at..end], false) {
            found.push((begin, code[begin..at].to_owned()));
        }
    }
    found
}

/// The line with the atom at that place negated.
fn negated(line: &str, at: usize) -> String {
    match line[..at].strip_suffix("not ") {
        Some(before) => format!("{before}{}", &line[at..]),
        None => format!("{}not {}", &line[..at], &line[at..]),
    }
}

/// A transition that is taken after the filter, taken in front of it in the next scan.
fn before_the_filter(line: &str) -> Option<String> {
    let begin = line.find("after filter {")?;
    let end = line.rfind('}')?;
    let inner = line[begin + "after filter {".len()..end].trim();
    let mut late = format!("{}{inner}", &line[..begin]);
    // The output rose in the last scan; which it was before that is not to be seen any more.
    while let Some(rise) = late.find("rise(O") {
        late.replace_range(rise..rise + "rise".len(), "prev");
    }
    Some(late)
}
