//! The text form of the intermediate representations: what snapshots hold and people review.
//!
//! Text is for reading and comparing; nothing reads it back.

use super::expr::IEC;
use super::ladder::{CoilKind, Operand, Rung};
use super::plc::{Body, GlobalId, Project};
use super::sfc::Sfc;
use super::sop::Literal;
use std::fmt::Write;

/// All SFCs of a project: under each step its action, then the transitions that leave it.
///
/// ```text
/// SFC P_Run: moves the cylinder
///
///   S_Idle, initial
///     1: S_Idle -> S_Out when X_Run
///
///   S_Out, N X_Out
///     1: S_Out -> S_Idle when NOT X_Run
/// ```
pub fn sfc(project: &Project) -> String {
    let mut text = String::new();
    for program in &project.programs {
        match &program.body {
            Body::Sfc(sfc) => {
                heading(&mut text, "SFC", &program.name, &program.description);
                steps(&mut text, project, sfc);
            }
            Body::Ladder(_) => {}
        }
    }
    text
}

/// All ladders of a project, drawn with characters.
///
/// ```text
/// LD P_Outputs: what drives the cylinder
///
///   Out: extends
///   |--[ X_Out  ]--[/Stop ]--+--( Out )--|
///   |--[ X_Hold ]------------+
/// ```
pub fn ladder(project: &Project) -> String {
    let mut text = String::new();
    for program in &project.programs {
        match &program.body {
            Body::Sfc(_) => {}
            Body::Ladder(ladder) => {
                heading(&mut text, "LD", &program.name, &program.description);
                for r in &ladder.rungs {
                    rung(&mut text, project, r);
                }
            }
        }
    }
    text
}

fn heading(text: &mut String, language: &str, name: &str, description: &str) {
    if !text.is_empty() {
        text.push('\n');
    }
    text.push_str(language);
    text.push(' ');
    text.push_str(name);
    described(text, description);
}

/// Ends a line with what it means, on that one line.
fn described(text: &mut String, description: &str) {
    for (i, word) in description.split_whitespace().enumerate() {
        text.push_str(if i == 0 { ": " } else { " " });
        text.push_str(word);
    }
    text.push('\n');
}

fn steps(text: &mut String, project: &Project, sfc: &Sfc) {
    let outgoing = sfc.outgoing();
    for (id, step) in sfc.steps.iter() {
        text.push_str("\n  ");
        text.push_str(&step.name);
        if id == sfc.initial() {
            text.push_str(", initial");
        }
        if let Some(flag) = step.flag {
            text.push_str(", N ");
            text.push_str(&project.globals[flag].name);
        }
        described(text, &step.description);
        for &t in &outgoing[id.index()] {
            let t = &sfc.transitions[t];
            let (from, to) = (&step.name, &sfc.steps[t.to].name);
            write!(text, "    {}: {from} -> {to} when ", t.priority).expect(INFALLIBLE);
            let name = &mut |&g: &GlobalId, f: &mut dyn Write| f.write_str(&project.globals[g].name);
            t.condition.write(text, &IEC, name).expect(INFALLIBLE);
            described(text, &t.description);
        }
    }
}

const INFALLIBLE: &str = "a String takes everything";

fn rung(text: &mut String, project: &Project, rung: &Rung) {
    drawn(text, rung, &|g| project.globals[g].name.clone());
}

/// A rung of a project with what each of its variables is: `[ Stop=1 ]`.
pub fn rung_with(project: &Project, rung: &Rung, value: &dyn Fn(GlobalId) -> i64) -> String {
    let mut text = String::new();
    drawn(&mut text, rung, &|g| format!("{}={}", project.globals[g].name, value(g)));
    text
}

fn drawn(text: &mut String, rung: &Rung, name: &dyn Fn(GlobalId) -> String) {
    text.push_str("\n  ");
    text.push_str(&name(rung.coil));
    described(text, &rung.comment);

    // A coil on the rail has one branch, without contacts.
    let one: [&[Literal<GlobalId>]; 1] = [&[]];
    let products: Vec<_> = rung.condition.products().iter().map(|p| p.literals()).collect();
    let branches = if rung.condition.is_one() { one.to_vec() } else { products };
    let mut columns: Vec<usize> = Vec::new();
    for branch in &branches {
        for (i, literal) in branch.iter().enumerate() {
            let width = name(literal.atom).len();
            match columns.get_mut(i) {
                Some(c) => *c = width.max(*c),
                None => columns.push(width),
            }
        }
    }

    for (row, branch) in branches.iter().enumerate() {
        text.push_str("  |--");
        for (i, width) in columns.iter().enumerate() {
            match branch.get(i) {
                Some(l) => {
                    let sign = if l.negated { '/' } else { ' ' };
                    write!(text, "[{sign}{:width$} ]--", name(l.atom)).expect(INFALLIBLE);
                }
                None => text.extend(std::iter::repeat_n('-', width + 6)),
            }
        }
        if branches.len() > 1 {
            text.push('+');
        }
        if row == 0 {
            let (open, close) = match rung.kind {
                CoilKind::Plain => ("( ", " )"),
                CoilKind::Set => ("(S ", " )"),
                CoilKind::Reset => ("(R ", " )"),
            };
            let line = if branches.len() > 1 { "--" } else { "" };
            let timer = rung.timer.as_ref().map(|t| format!("[TON {} {}]--", t.instance, t.literal()));
            let function = rung.function.as_ref().map(|f| {
                let operand = |o: &Operand| match o {
                    Operand::Const(n) => n.to_string(),
                    Operand::Global(g) => name(*g),
                };
                let operands: Vec<String> = f.operands.iter().map(operand).collect();
                format!("[{} {}]--", f.operator.name(), operands.join(", "))
            });
            let middle = timer.or(function);
            write!(text, "{line}{}{open}{}{close}--|", middle.unwrap_or_default(), name(rung.coil)).expect(INFALLIBLE);
        }
        text.push('\n');
    }
}
