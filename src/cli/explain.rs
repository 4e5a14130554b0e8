//! A code to its page.

use super::args::Explain;
use super::{Outcome, files, say};
use crate::base::Code;

/// Runs `chartwright explain`.
pub fn run(args: &Explain) -> Outcome {
    let Some(number) = &args.code else {
        // Where it cannot be printed, nobody reads.
        let _ = files::print(&list(Code::ALL));
        return Outcome::Fine;
    };
    if let Some(code) = Code::find(number.trim()) {
        let _ = files::print(code.page());
        return Outcome::Fine;
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
