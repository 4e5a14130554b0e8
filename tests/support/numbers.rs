//! PLC programs with one thing wrong in what they count: all of them, one by one.

use super::damage::Mutant;
use chartwright::ir::expr::Expr;
use chartwright::ir::iec::{Atom, Body, Bool, Number, Project, Relation, Statement};

/// Every program that differs from `project` in one constant by 1, one relation, one operator or one
/// assignment that is left out.
pub fn mutants(project: &Project) -> Vec<Mutant> {
    let mut all = Vec::new();
    for p in 0..project.programs.len() {
        let Body::Code(statements) = &project.programs[p].body else { continue };
        for (i, statement) in statements.iter().enumerate() {
            let mut put = |damaged: Option<Statement>, what: String| {
                let mut project = project.clone();
                let Body::Code(statements) = &mut project.programs[p].body else { unreachable!("it was code") };
                match damaged {
                    Some(damaged) => statements[i] = damaged,
                    None => drop(statements.remove(i)),
                }
                all.push(Mutant { project, what });
            };
            match statement {
                Statement::Move { to, value } => {
                    let name = &project.variables[*to].name;
                    put(None, format!("{name} is not assigned"));
                    for (damaged, what) in numbers(value) {
                        put(Some(Statement::Move { to: *to, value: damaged }), format!("{name}: {what}"));
                    }
                }
                Statement::Coil(coil) => {
                    let Expr::Atom(Atom::Compare(relation, left, right)) = &coil.condition.value else { continue };
                    let name = &project.variables[coil.variable].name;
                    let mut put = |value: Bool, what: String| {
                        let mut coil = coil.clone();
                        coil.condition.value = value;
                        put(Some(Statement::Coil(coil)), format!("{name}: {what}"));
                    };
                    for other in Relation::ALL.into_iter().filter(|other| other != relation) {
                        let value = Expr::Atom(Atom::Compare(other, left.clone(), right.clone()));
                        put(value, format!("{relation:?} becomes {other:?}"));
                    }
                    for (damaged, what) in numbers(left) {
                        put(Expr::Atom(Atom::Compare(*relation, damaged, right.clone())), what);
                    }
                    for (damaged, what) in numbers(right) {
                        put(Expr::Atom(Atom::Compare(*relation, left.clone(), damaged)), what);
                    }
                }
                Statement::Call(_) => {}
            }
        }
    }
    all
}

fn numbers(number: &Number) -> Vec<(Number, String)> {
    let near = |n: i64| [n - 1, n + 1].map(|m| (m, format!("{n} becomes {m}")));
    match number {
        Number::Const(n) => near(*n).map(|(m, what)| (Number::Const(m), what)).into(),
        Number::Sum(left, right) => {
            let mut all = vec![(Number::Difference(left.clone(), right.clone()), "ADD becomes SUB".to_owned())];
            all.extend(numbers(right).into_iter().map(|(r, what)| (Number::Sum(left.clone(), Box::new(r)), what)));
            all
        }
        Number::Difference(left, right) => {
            let mut all = vec![(Number::Sum(left.clone(), right.clone()), "SUB becomes ADD".to_owned())];
            all.extend(
                numbers(right).into_iter().map(|(r, what)| (Number::Difference(left.clone(), Box::new(r)), what)),
            );
            all
        }
        Number::Limit { lowest, value, highest } => {
            let low = near(*lowest)
                .map(|(m, what)| (Number::Limit { lowest: m, value: value.clone(), highest: *highest }, what));
            let high = near(*highest)
                .map(|(m, what)| (Number::Limit { lowest: *lowest, value: value.clone(), highest: m }, what));
            low.into_iter().chain(high).collect()
        }
        Number::Select { by, no, yes } => {
            let swapped = Number::Select { by: *by, no: yes.clone(), yes: no.clone() };
            let mut all = vec![(swapped, "the choice is the other way round".to_owned())];
            let choice = |yes| Number::Select { by: *by, no: no.clone(), yes: Box::new(yes) };
            all.extend(numbers(yes).into_iter().map(|(y, what)| (choice(y), what)));
            all
        }
        Number::Variable(_) | Number::StepTime(_) | Number::Elapsed(_) | Number::Negative(_) => Vec::new(),
    }
}
