//! A code to its page.

use super::args::Explain;
use super::{Outcome, say, tell};
use crate::base::Code;

/// Runs `chartwright explain`.
pub fn run(args: &Explain) -> Outcome {
    let Some(number) = &args.code else {
        return tell(&list(Code::ALL));
    };
    if let Some(code) = Code::find(number.trim()) {
        return tell(code.page());
    }
    let shown = annotate_snippets::normalize_untrusted_str(number);
    let near = near(number);
    if near.is_empty() {
        say(&format!("error: there is no code `{shown}`\n\n`chartwright explain` lists all codes\n"));
    } else {
        say(&format!("error: there is no code `{shown}`; near it are\n\n{}", list(&near)));
    }
    Outcome::Usage
}

fn list(codes: &[Code]) -> String {
    codes.iter().map(|c| format!("{c}  {}\n", c.title())).collect()
}

/// The codes that differ from `number` in one letter or digit, or, for digits alone, in the letter.
fn near(number: &str) -> Vec<Code> {
    let number = number.trim().to_ascii_uppercase();
    let one_apart = |code: &str| {
        code.len() == number.len() && code.bytes().zip(number.bytes()).filter(|(a, b)| a != b).count() == 1
    };
    Code::ALL.iter().copied().filter(|c| one_apart(c.number()) || c.number()[1..] == number).collect()
}
