//! Whether the filter can always meet all constraints: properties 1, 3 and 4 of the paper on
//! logical constraints, decided exactly under the declared assumptions, each violation with a case in which it happens.
//!
//! Exactly means: for everything that the filter can come to. Commands are arbitrary, and so is what
//! constraints read as far as the assumptions allow; the outputs are what the rounds of the filter
//! select. An output is relieved both ways if its reliefs of all rounds of a scan contradict each other,
//! and a relief is blocked if its product is violated in some round. Constraints that exclude each other
//! only because no round leads there are no violation: `never A xor B yields B` is one of these.
//!
//! Without violations, and with property 0, the filter ends with all constraints met: while a combined
//! product is violated none of its reliefs is blocked, none is ever taken back, so from the next round
//! on one of its literals is FALSE for good.
//!
//! Most of that is seen by comparing products. Where this leaves a doubt, the rounds are spelled out and a
//! solver decides. They end where nothing new can be violated, at the latest one after as many as the graph GO
//! says: its bound holds up to the round of the first violation.

use super::questions::{Found, Questions, Witness};
use crate::base::limits;
use crate::bits::aig::{Lit, lanes};
use crate::bits::sat::Model;
use crate::ir::chart::{Atom, ConstraintId, Machine, OutputId};
use crate::ir::relief::Reliefs;
use crate::ir::sop::Product;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Simple constraints force the output both ways: property 1.
    Forced,
    /// Combined constraints relieve it both ways: property 1.
    Relieved,
    /// A combined constraint, the first one, wants it to take `value`; a simple one, the second one,
    /// holds it at the opposite: property 3 for FALSE, 4 for TRUE.
    Blocked {
        /// What the relief is.
        value: bool,
    },
}

/// A violated property.
#[derive(Clone, Debug)]
pub struct Violation {
    /// What is wrong.
    pub kind: Kind,
    /// The output concerned.
    pub output: OutputId,
    /// The two constraints: first the one that makes it FALSE where both do the same.
    pub constraints: [ConstraintId; 2],
    /// When it happens.
    pub witness: Witness,
}

/// The contradictions between simple constraints alone, in order of output.
pub fn contradictions(machine: &Machine, reliefs: &Reliefs) -> Vec<Violation> {
    forced_both_ways(&mut Questions::new(machine), reliefs, &Forced::of(machine, reliefs))
}

fn forced_both_ways(questions: &mut Questions<'_>, reliefs: &Reliefs, forced: &Forced) -> Vec<Violation> {
    let mut found = Vec::new();
    for (output, [off, on]) in questions.machine().outputs.ids().zip(&forced.by_output) {
        // One pair per output is enough to start with.
        let pairs = off.iter().flat_map(|&i| on.iter().map(move |&j| (i, j)));
        let hit = pairs.into_iter().find_map(|(i, j)| {
            let (a, b) = (&reliefs.forcings[i], &reliefs.forcings[j]);
            let witness = together(questions, &a.condition.times(&b.condition)?)?;
            Some(Violation { kind: Kind::Forced, output, constraints: [a.constraint, b.constraint], witness })
        });
        found.extend(hit);
    }
    found
}

/// All violations, at most [`limits::REPORTED_ERRORS`] of them, in order of property and output.
pub fn violations(machine: &Machine, reliefs: &Reliefs) -> Vec<Violation> {
    let mut questions = Questions::new(machine);
    let forced = Forced::of(machine, reliefs);
    let mut found = forced_both_ways(&mut questions, reliefs, &forced);
    let suspects = suspects(machine, reliefs, &forced, &mut questions);
    if !suspects.is_empty() {
        let run = Run::of(&mut questions, reliefs, &forced);
        found.extend(suspects.into_iter().filter_map(|s| run.judge(&mut questions, reliefs, &s)));
    }
    found.truncate(limits::REPORTED_ERRORS);
    found
}

/// The simple products that force each output off and on.
struct Forced {
    by_output: Vec<[Vec<usize>; 2]>,
}

impl Forced {
    fn of(machine: &Machine, reliefs: &Reliefs) -> Forced {
        let mut by_output: Vec<[Vec<usize>; 2]> = vec![Default::default(); machine.outputs.len()];
        for (i, f) in reliefs.forcings.iter().enumerate() {
            by_output[f.output.index()][usize::from(f.value)].push(i);
        }
        Forced { by_output }
    }

    fn at(&self, output: OutputId, value: bool) -> &[usize] {
        &self.by_output[output.index()][usize::from(value)]
    }
}

/// When the product is TRUE and no assumption broken, if that can be.
fn together(questions: &mut Questions<'_>, product: &Product<Atom>) -> Option<Witness> {
    let goal = questions.condition(product);
    match if questions.nothing_assumed() { Found::Open } else { questions.ask(&[goal]) } {
        Found::Never => None,
        Found::Can(model) => Some(questions.witness(&model, goal)),
        Found::Open => {
            let readings = product.literals().iter().map(|l| (l.atom, !l.negated)).collect();
            Some(Witness { readings, commands: Vec::new() })
        }
    }
}

/// An output that products alone do not clear, with those concerned: each combined product with what
/// stands against it, a combined or a simple one.
struct Suspect {
    kind: Kind,
    output: OutputId,
    pairs: Vec<(usize, usize)>,
}

fn suspects(machine: &Machine, reliefs: &Reliefs, forced: &Forced, questions: &mut Questions<'_>) -> Vec<Suspect> {
    let mut relieved: Vec<[Vec<usize>; 2]> = vec![Default::default(); machine.outputs.len()];
    for (j, c) in reliefs.combined.iter().enumerate() {
        for &(output, value) in &c.reliefs {
            relieved[output.index()][usize::from(value)].push(j);
        }
    }
    let mut possible = |product: Option<Product<Atom>>| {
        let Some(product) = product else { return false };
        let goal = questions.condition(&product.retain(|a| !matches!(a, Atom::Output(_))));
        questions.nothing_assumed() || !matches!(questions.ask(&[goal]), Found::Never)
    };
    let mut suspects = Vec::new();
    for (output, [off, on]) in machine.outputs.ids().zip(&relieved) {
        let pairs = off.iter().flat_map(|&i| on.iter().map(move |&j| (i, j)));
        let readings = |j: usize| reliefs.combined[j].readings();
        let pairs: Vec<_> = pairs.filter(|&(i, j)| possible(readings(i).times(&readings(j)))).collect();
        if !pairs.is_empty() {
            suspects.push(Suspect { kind: Kind::Relieved, output, pairs });
        }
    }
    for value in [false, true] {
        for (output, relieved) in machine.outputs.ids().zip(&relieved) {
            let against = forced.at(output, !value);
            let pairs = relieved[usize::from(value)].iter().flat_map(|&j| against.iter().map(move |&i| (j, i)));
            let whole = |j: usize, i: usize| reliefs.combined[j].product.times(&reliefs.forcings[i].condition);
            let pairs: Vec<_> = pairs.filter(|&(j, i)| possible(whole(j, i))).collect();
            if !pairs.is_empty() {
                suspects.push(Suspect { kind: Kind::Blocked { value }, output, pairs });
            }
        }
    }
    suspects
}

/// The rounds of the filter, for all commands and readings at once.
struct Run {
    /// For each simple product, whether its condition holds.
    conditions: Vec<Lit>,
    /// For each combined product, whether it is violated in some round.
    ever: Vec<Lit>,
}

impl Run {
    fn of(questions: &mut Questions<'_>, reliefs: &Reliefs, forced: &Forced) -> Run {
        let machine = questions.machine();
        let conditions: Vec<Lit> = reliefs.forcings.iter().map(|f| questions.condition(&f.condition)).collect();
        let any = |questions: &mut Questions<'_>, output, value| {
            let lits: Vec<Lit> = forced.at(output, value).iter().map(|&i| conditions[i]).collect();
            questions.aig.any(&lits)
        };
        // What simple products, and reliefs so far, force off and on.
        let simple: Vec<[Lit; 2]> =
            machine.outputs.ids().map(|o| [any(questions, o, false), any(questions, o, true)]).collect();
        let mut relieved = vec![[Lit::FALSE; 2]; machine.outputs.len()];
        let mut ever = vec![Lit::FALSE; reliefs.combined.len()];
        for round in 0..=reliefs.depth() {
            let select = &mut |questions: &mut Questions<'_>, output: OutputId| {
                let ([fs0, fs1], [fc0, fc1]) = (simple[output.index()], relieved[output.index()]);
                let command = questions.command(output);
                let aig = &mut questions.aig;
                let wanted = aig.and(!fc0, command);
                let wanted = aig.or(wanted, fc1);
                let wanted = aig.and(!fs0, wanted);
                aig.or(wanted, fs1)
            };
            let violated: Vec<Lit> = reliefs.combined.iter().map(|c| questions.product(&c.product, select)).collect();
            let news: Vec<Lit> = violated.iter().zip(&ever).map(|(&v, &e)| questions.aig.and(v, !e)).collect();
            let news = questions.aig.any(&news);
            if round > 0 && matches!(questions.ask(&[news]), Found::Never) {
                break;
            }
            for ((c, now), ever) in reliefs.combined.iter().zip(violated).zip(&mut ever) {
                *ever = questions.aig.or(*ever, now);
                for &(output, value) in &c.reliefs {
                    let so_far = &mut relieved[output.index()][usize::from(value)];
                    *so_far = questions.aig.or(*so_far, now);
                }
            }
        }
        Run { conditions, ever }
    }

    fn judge(&self, questions: &mut Questions<'_>, reliefs: &Reliefs, suspect: &Suspect) -> Option<Violation> {
        let second = |j: usize| match suspect.kind {
            Kind::Relieved => self.ever[j],
            _ => self.conditions[j],
        };
        let both: Vec<Lit> = suspect.pairs.iter().map(|&(i, j)| questions.aig.and(self.ever[i], second(j))).collect();
        let goal = questions.aig.any(&both);
        let model = match questions.ask(&[goal]) {
            Found::Never => return None,
            Found::Can(model) => Some(model),
            Found::Open => None,
        };
        let at = model.as_ref().map_or(0, |model| first(questions, model, &both));
        let (i, j) = suspect.pairs[at];
        let witness = model.map(|model| questions.witness(&model, both[at])).unwrap_or_default();
        let other = match suspect.kind {
            Kind::Relieved => reliefs.combined[j].constraint,
            _ => reliefs.forcings[j].constraint,
        };
        let constraints = [reliefs.combined[i].constraint, other];
        Some(Violation { kind: suspect.kind, output: suspect.output, constraints, witness })
    }
}

/// The first of `lits` that the model makes TRUE.
fn first(questions: &Questions<'_>, model: &Model, lits: &[Lit]) -> usize {
    let values = model.evaluate(&questions.aig);
    lits.iter().position(|&l| lanes(&values, l) & 1 == 1).expect("one of them is TRUE")
}
