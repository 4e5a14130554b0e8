//! Whether any outputs meet all constraints, asked before anybody asks how a filter would find them.
//!
//! That is a question about all readings and some outputs. It is answered by examples: for readings that
//! the assumptions allow, outputs are looked for that violate nothing; where there are some, other readings
//! are looked for under which just these outputs violate something; and so on.

use super::questions::{Found, Questions, Witness};
use crate::bits::aig::{Lit, lanes};
use crate::bits::sat::Model;
use crate::ir::chart::{Atom, Machine, OutputId, outputs_of};
use crate::ir::sop::Product;

/// Most examples that are tried. Who reaches that is not told that no outputs are safe; the constraints are
/// refused all the same, for what was found before.
const EXAMPLES: usize = 300;

/// Readings under which no outputs meet all constraints, if examples lead there.
pub fn hopeless(machine: &Machine) -> Option<Witness> {
    let mut questions = Questions::new(machine);
    let products = products(&mut questions);
    let mut tried = Vec::new();
    for _ in 0..EXAMPLES {
        let Found::Can(model) = questions.ask(&tried) else { return None };
        let Some(outputs) = outputs(&mut questions, &products, &model) else {
            return Some(reason(&mut questions, &products, &model));
        };
        // Next time, readings for which these outputs will not do.
        let matching = products.iter().filter(|p| p.outputs.iter().all(|&(o, negated)| outputs[o.index()] != negated));
        let conditions: Vec<Lit> = matching.map(|p| p.condition).collect();
        tried.push(questions.aig.any(&conditions));
    }
    None
}

/// Whether no outputs meet all constraints with the readings of that assignment.
pub fn hopeless_in(questions: &mut Questions<'_>, model: &Model) -> bool {
    let products = products(questions);
    outputs(questions, &products, model).is_none()
}

/// A product of a constraint.
struct Part {
    condition: Lit,
    outputs: Vec<(OutputId, bool)>,
}

fn products(questions: &mut Questions<'_>) -> Vec<Part> {
    let constraints = &questions.machine().safety.constraints;
    let products: Vec<&Product<Atom>> = constraints.values().flat_map(|c| &c.products).collect();
    let part = |p: &Product<Atom>| Part {
        condition: questions.condition(&p.retain(|a| !matches!(a, Atom::Output(_)))),
        outputs: outputs_of(p).collect(),
    };
    products.into_iter().map(part).collect()
}

/// For each product, that it is FALSE; what is commanded stands for what is put out.
fn met(questions: &mut Questions<'_>, products: &[Part]) -> Vec<Lit> {
    let one = |p: &Part| {
        let literals: Vec<Lit> = p.outputs.iter().map(|&(o, negated)| questions.command(o).xor(negated)).collect();
        let literals: Vec<Lit> = literals.into_iter().chain([p.condition]).collect();
        !questions.aig.all(&literals)
    };
    products.iter().map(one).collect()
}

/// The conditions of all products, with the values of that assignment.
fn fixed(questions: &Questions<'_>, products: &[Part], model: &Model) -> Vec<Lit> {
    let values = model.evaluate(&questions.aig);
    products.iter().map(|p| p.condition.xor(lanes(&values, p.condition) & 1 == 0)).collect()
}

/// Outputs that violate nothing with the readings of that assignment.
fn outputs(questions: &mut Questions<'_>, products: &[Part], model: &Model) -> Option<Vec<bool>> {
    let met = met(questions, products);
    let goals: Vec<Lit> = met.into_iter().chain(fixed(questions, products, model)).collect();
    match questions.ask(&goals) {
        Found::Can(model) => {
            let outputs: Vec<Lit> = questions.machine().outputs.ids().map(|o| questions.command(o)).collect();
            let values = model.evaluate(&questions.aig);
            Some(outputs.into_iter().map(|o| lanes(&values, o) & 1 == 1).collect())
        }
        Found::Never => None,
        // As good as found: nothing is claimed then.
        Found::Open => Some(vec![false; questions.machine().outputs.len()]),
    }
}

/// What of the readings of that assignment leaves no outputs.
fn reason(questions: &mut Questions<'_>, products: &[Part], model: &Model) -> Witness {
    let met = met(questions, products);
    let mut holding: Vec<Lit> =
        fixed(questions, products, model).into_iter().filter(|l| products.iter().any(|p| p.condition == *l)).collect();
    // Conditions that hold only ever exclude more; those that are not needed are dropped.
    let mut at = 0;
    while at < holding.len() {
        let mut fewer = holding.clone();
        fewer.remove(at);
        let goals: Vec<Lit> = met.iter().copied().chain(fewer.iter().copied()).collect();
        if matches!(questions.ask(&goals), Found::Never) { holding = fewer } else { at += 1 }
    }
    let goal = questions.aig.all(&holding);
    match questions.ask(&[goal]) {
        Found::Can(model) => questions.witness(&model, goal),
        Found::Never | Found::Open => Witness::default(),
    }
}
