//! States, one after the other, to a run: the inputs that lead from each to the next.

use super::aig::Lit;
use super::limits::{Limit, Stop};
use super::solver::{Outcome, SatLit, Solver};
use super::system::{System, Trace};

/// The run through these states of those latches; the others begin as they may. With `bad` it has one scan more, which shows that.
/// Each scan is a small question to one solver, which is told the system once.
pub fn run(
    system: &System,
    latches: &[usize],
    path: &[Vec<bool>],
    bad: Option<Lit>,
    stop: Stop<'_>,
) -> Result<Trace, Limit> {
    let mut solver = Solver::new(stop);
    system.constraints.iter().for_each(|&c| solver.demand(&system.aig, c));
    let mut literals = |of: &dyn Fn(usize) -> Lit| -> Vec<SatLit> {
        latches.iter().map(|&l| solver.literal(&system.aig, of(l))).collect()
    };
    let now = literals(&|l| system.latches[l].leaf);
    let then = literals(&|l| system.latches[l].next);
    let bad = bad.map(|bad| solver.literal(&system.aig, bad));
    let is = |literals: &[SatLit], state: &[bool]| -> Vec<SatLit> {
        literals.iter().zip(state).map(|(&l, &value)| if value { l } else { !l }).collect()
    };
    let mut initial: Vec<bool> = system.latches.iter().map(|l| l.initial.unwrap_or(false)).collect();
    latches.iter().zip(&path[0]).for_each(|(&l, &value)| initial[l] = value);
    let mut trace = Trace { initial, inputs: Vec::new(), shortest: false };
    for (i, state) in path.iter().enumerate() {
        let mut assumed = is(&now, state);
        match (path.get(i + 1), bad) {
            (Some(after), _) => assumed.extend(is(&then, after)),
            (None, Some(bad)) => assumed.push(bad),
            (None, None) => break,
        }
        match solver.solve(&assumed, &mut { u64::MAX }) {
            Outcome::Sometimes => {}
            Outcome::Never => unreachable!("one scan leads from each state to the next"),
            Outcome::GaveUp => return Err(Limit::Stopped),
        }
        trace.inputs.push(system.inputs.iter().map(|i| solver.value(i.leaf)).collect());
    }
    Ok(trace)
}
