//! How many sweeps `relief in-order` takes: found exactly, for all commands and for all readings that the
//! assumptions allow, with a case that shows it where no number suffices.
//!
//! A sweep is a function from outputs to outputs. A solver looks for a case in which so many sweeps leave a
//! constraint violated. That case is swept on, value by value: either it comes to rest, and then so many
//! sweeps are needed at least, or it comes back to outputs that it has been at, and then it never will.

use super::questions::{Found, Questions, Witness};
use super::safe;
use crate::base::limits;
use crate::bits::aig::{Lit, lanes};
use crate::bits::sat::Model;
use crate::ir::chart::{ConstraintId, Machine, OutputId, outputs_of};
use crate::ir::relief::{Combined, Reliefs};
use std::collections::BTreeSet;

/// Why sweeps do not meet all constraints.
#[derive(Clone, Debug)]
pub struct Restless {
    /// What is wrong.
    pub kind: Kind,
    /// The constraints that are violated time and again, in order.
    pub constraints: Vec<ConstraintId>,
    /// When that happens.
    pub witness: Witness,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// No assignment of outputs meets all constraints.
    Unsafe,
    /// One does, but the sweeps come back to where they have been.
    Endless,
    /// They come to rest only after more than [`limits::SWEEPS`], or the solver gave up.
    TooMany,
}

/// The number of sweeps after which no constraint is violated, the least there is.
pub fn sweeps(machine: &Machine, reliefs: &Reliefs) -> Result<usize, Restless> {
    let mut questions = Questions::new(machine);
    let forced = forced(&mut questions, reliefs);
    let select = |questions: &mut Questions<'_>, o: OutputId| {
        let [off, on] = forced[o.index()];
        let command = questions.command(o);
        let allowed = questions.aig.and(command, !off);
        questions.aig.or(allowed, on)
    };
    let mut selected: Vec<Lit> = machine.outputs.ids().map(|o| select(&mut questions, o)).collect();
    let mut needed = 0;
    let mut made = 0;
    loop {
        while made < needed {
            for c in &reliefs.combined {
                let now = questions.product(&c.product, &mut |_, o| selected[o.index()]);
                for &(output, value) in &c.reliefs {
                    let k = output.index();
                    let changes = questions.aig.and(now, !forced[k][usize::from(!value)]);
                    selected[k] = questions.aig.select(changes, Lit::of(value), selected[k]);
                }
            }
            made += 1;
        }
        let violated: Vec<Lit> =
            reliefs.combined.iter().map(|c| questions.product(&c.product, &mut |_, o| selected[o.index()])).collect();
        let goal = questions.aig.any(&violated);
        let model = match questions.ask(&[goal]) {
            Found::Never => return Ok(needed),
            Found::Open => {
                return Err(Restless { kind: Kind::TooMany, constraints: Vec::new(), witness: Witness::default() });
            }
            Found::Can(model) => model,
        };
        let course = Course::of(&mut questions, reliefs, &model, &forced);
        match course.rest {
            Some(rest) if rest <= limits::SWEEPS => needed = rest,
            rest => {
                let kind = match rest {
                    Some(_) => Kind::TooMany,
                    None if safe::hopeless_in(&mut questions, &model) => Kind::Unsafe,
                    None => Kind::Endless,
                };
                let mut constraints: Vec<ConstraintId> =
                    course.violated.into_iter().map(|j| reliefs.combined[j].constraint).collect();
                constraints.dedup();
                return Err(Restless { kind, constraints, witness: questions.witness(&model, goal) });
            }
        }
    }
}

/// For each output, whether simple products force it off and on.
fn forced(questions: &mut Questions<'_>, reliefs: &Reliefs) -> Vec<[Lit; 2]> {
    let mut forced = vec![[Lit::FALSE; 2]; questions.machine().outputs.len()];
    for f in &reliefs.forcings {
        let condition = questions.condition(&f.condition);
        let so_far = &mut forced[f.output.index()][usize::from(f.value)];
        *so_far = questions.aig.or(*so_far, condition);
    }
    forced
}

/// The sweeps in one case.
struct Course {
    /// After how many of them nothing is violated; nothing if they never end.
    rest: Option<usize>,
    /// The combined products that are violated at the last, in order.
    violated: BTreeSet<usize>,
}

impl Course {
    fn of(questions: &mut Questions<'_>, reliefs: &Reliefs, model: &Model, forced: &[[Lit; 2]]) -> Course {
        let machine = questions.machine();
        let readings: Vec<Lit> = reliefs.combined.iter().map(|c| questions.condition(&c.readings())).collect();
        let commands: Vec<Lit> = machine.outputs.ids().map(|o| questions.command(o)).collect();
        let values = model.evaluate(&questions.aig);
        let value = |l: Lit| lanes(&values, l) & 1 == 1;
        let held: Vec<[bool; 2]> = forced.iter().map(|f| f.map(value)).collect();
        let mut outputs: Vec<bool> =
            commands.iter().zip(&held).map(|(&c, &[off, on])| value(c) && !off || on).collect();
        let holds = |j: usize, c: &Combined, outputs: &[bool]| {
            value(readings[j]) && outputs_of(&c.product).all(|(o, negated)| outputs[o.index()] != negated)
        };
        let mut seen = BTreeSet::new();
        // A case that does not repeat itself may go on for as long as there are assignments.
        for sweep in 0..=limits::SWEEPS {
            if reliefs.combined.iter().enumerate().all(|(j, c)| !holds(j, c, &outputs)) {
                return Course { rest: Some(sweep), violated: BTreeSet::new() };
            }
            let again = !seen.insert(outputs.clone());
            let mut violated = BTreeSet::new();
            for (j, c) in reliefs.combined.iter().enumerate() {
                if holds(j, c, &outputs) {
                    violated.insert(j);
                    for &(o, value) in &c.reliefs {
                        let [off, on] = held[o.index()];
                        outputs[o.index()] = value && !off || on;
                    }
                }
            }
            if again {
                return Course { rest: None, violated };
            }
        }
        Course { rest: Some(limits::SWEEPS + 1), violated: BTreeSet::new() }
    }
}
