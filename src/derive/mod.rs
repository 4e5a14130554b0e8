//! Actuators and forbidden positions to the constraints that follow from them.
//!
//! Gone after it: `forbid` and `derive`. What they stand for are constraints like written ones, with names
//! of their own, so nothing further down knows where a constraint comes from. Of what is forbidden and left to
//! other constraints the words stay.
//!
//! | module | derives |
//! | --- | --- |
//! | [`ends`] | what each actuator's technology demands (the paper on validation filters, its position and output automata) |
//! | [`apart`] | what keeps forbidden positions of two actuators unreachable |

mod apart;
mod ends;

use crate::base::{Code, Diagnostic, Diagnostics, Span, limits};
use crate::ir::ast::{self, Constraint, Derive, Guard, Name, PathRef, Term, Text};
use crate::ir::expr::Expr;
use crate::ir::source;

/// A condition as it is written.
type Condition = Expr<Term>;

/// A constraint, and what it follows from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Derived {
    /// The constraint. Its places are those of the actuator or the `forbid` that it follows from; what holds an order
    /// names all that need it.
    pub constraint: Constraint,
    /// What `derive` without `by edges` leaves out (TRUE) or `by edges` does (FALSE), if one of them does.
    edges: Option<bool>,
}

impl Derived {
    /// What it follows from, by name.
    pub fn sources(&self) -> Vec<String> {
        self.constraint.from.iter().map(|n| n.text.clone()).collect()
    }
}

/// All that can be derived from a tree, by edges or not, and what is wrong with what it is derived from.
pub fn everything(tree: &ast::Machine, edges: bool) -> (Vec<Derived>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut all: Vec<Derived> = tree.actuators.iter().flat_map(ends::of).collect();
    all.extend(apart::of(tree, &mut diagnostics));
    all.retain(|d| d.edges.is_none_or(|e| e == edges));
    (all, diagnostics)
}

/// Puts the constraints that are to be derived among those that are written.
pub fn expand(tree: &mut ast::Machine) -> Diagnostics {
    if tree.safety.iter().all(|s| s.forbids.is_empty() && s.derives.is_empty()) {
        return Diagnostics::new();
    }
    let (_, mut diagnostics) = everything(tree, false);
    let mut added: Vec<(usize, Constraint)> = Vec::new();
    // Where the names of what constraints are derived from stand.
    let mut kept: Vec<Span> = Vec::new();
    for (i, safety) in tree.safety.iter().enumerate() {
        for item in &safety.derives {
            let (all, _) = everything(tree, item.edges.is_some());
            let chosen = choose(item, &all, &mut diagnostics);
            for d in chosen {
                let mut constraint = d.constraint.clone();
                kept.push(constraint.never.span);
                constraint.name.span = item.span;
                // What two items ask for is derived once.
                if added.iter().all(|(_, a)| a.name.text != constraint.name.text) {
                    added.push((i, constraint));
                }
            }
        }
        let all = |item: &Derive| item.names.is_empty();
        for forbid in &safety.forbids {
            let names = |item: &Derive| item.names.iter().chain(&item.except).any(|n| n.text == forbid.name.text);
            if !tree.safety.iter().flat_map(|s| &s.derives).any(|item| all(item) || names(item)) {
                let text = format!("nothing keeps `{}`: no constraint is derived from it", forbid.name.text);
                let d = Diagnostic::new(Code::NotKept, text)
                    .label(forbid.name.span, "forbidden, but not prevented")
                    .help(format!(
                        "write `derive {}`, or `derive all except {0}` if other constraints see to it",
                        forbid.name.text
                    ));
                diagnostics.push(d);
            }
        }
    }
    for (i, constraint) in added {
        tree.safety[i].constraints.push(constraint);
    }
    for safety in &mut tree.safety {
        let forbids = std::mem::take(&mut safety.forbids);
        safety.unkept = forbids.into_iter().filter(|f| !kept.contains(&f.name.span)).collect();
        safety.derives.clear();
    }
    diagnostics
}

fn means(name: &Name, derived: &Derived) -> bool {
    derived.constraint.from.iter().any(|n| n.text == name.text) || derived.constraint.name.text == name.text
}

/// What an item asks for; reports names that mean nothing here.
fn choose<'a>(item: &Derive, all: &'a [Derived], diagnostics: &mut Diagnostics) -> Vec<&'a Derived> {
    let mut known = |name: &Name| {
        if !all.iter().any(|d| means(name, d)) {
            let d = Diagnostic::new(Code::NothingDerived, format!("nothing is derived from or as `{}`", name.text))
                .label(name.span, "no such actuator, forbidden position or derived constraint")
                .help("`chartwright constraints FILE --derive` lists what can be derived");
            diagnostics.push(d);
        }
    };
    item.names.iter().chain(&item.except).for_each(&mut known);
    if all.is_empty() && item.names.is_empty() {
        diagnostics.push(
            Diagnostic::new(Code::NothingDerived, "there is nothing to derive")
                .label(item.span, "no actuator has two outputs, and nothing is forbidden"),
        );
    }
    let wanted = |d: &&Derived| item.names.is_empty() || item.names.iter().any(|n| means(n, d));
    all.iter().filter(wanted).filter(|d| !item.except.iter().any(|n| means(n, d))).collect()
}

/// A constraint that follows from something; `parts` are what must not be TRUE together.
fn derived(source: &Name, name: String, parts: Vec<Condition>, yields: Option<&Name>, text: String) -> Derived {
    let (span, expr) = (source.span, Expr::all(parts));
    let written = source::expression(&expr);
    Derived {
        constraint: Constraint {
            name: Name { text: shortened(name), span },
            never: Guard { expr, written, span },
            yields: yields.map(|n| Name { text: n.text.clone(), span }).into_iter().collect(),
            text: Some(Text { value: text, span }),
            from: vec![source.clone()],
        },
        edges: None,
    }
}

/// A name that is not too long: one that would be ends in a number that depends on all of it.
fn shortened(name: String) -> String {
    if name.chars().count() <= limits::NAME_LENGTH {
        return name;
    }
    let hash = name.bytes().fold(0x811c_9dc5_u32, |h, b| (h ^ u32::from(b)).wrapping_mul(0x0100_0193));
    let kept: String = name.chars().take(limits::NAME_LENGTH - 9).collect();
    format!("{}_{hash:08x}", kept.trim_end_matches('_'))
}

fn reference(name: &Name, span: Span) -> PathRef {
    PathRef { parts: vec![(name.text.clone(), span)] }
}

fn value(output: &Name, span: Span) -> Condition {
    Expr::Atom(Term::Value(reference(output, span)))
}

fn before(output: &Name, span: Span) -> Condition {
    Expr::Atom(Term::Prev(reference(output, span)))
}

fn rise(output: &Name, span: Span) -> Condition {
    Expr::Atom(Term::Rise(reference(output, span)))
}

fn fall(output: &Name, span: Span) -> Condition {
    Expr::Atom(Term::Fall(reference(output, span)))
}

/// A sensor, at the place of what is derived from it.
fn sensor(guard: &Guard, span: Span) -> Condition {
    guard.expr.map(&mut |term| match term {
        Term::Value(path) => {
            Expr::Atom(Term::Value(PathRef { parts: path.parts.iter().map(|(n, _)| (n.clone(), span)).collect() }))
        }
        // Resolving refuses it in the sensor.
        other => Expr::Atom(other.clone()),
    })
}

/// The rising edge of a sensor.
fn reached(guard: &Guard, span: Span) -> Condition {
    let now = sensor(guard, span);
    if let Expr::Atom(Term::Value(path)) = now {
        return Expr::Atom(Term::Rise(path));
    }
    let past = now.map(&mut |term| match term {
        Term::Value(path) => Expr::Atom(Term::Prev(path.clone())),
        other => Expr::Atom(other.clone()),
    });
    Expr::all([now, past.not()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_stay_distinct_and_legal() {
        let long = |end: &str| shortened(format!("{}{end}", "Both_".repeat(12)));
        assert!(long("a").chars().count() <= limits::NAME_LENGTH && long("a") != long("b"));
        assert!(!long("a").contains("__"));
        assert_eq!(shortened("Both_A_B".into()), "Both_A_B");
    }
}
