//! What charts count.

use super::{ChartStep, Moves, numbers};
use crate::bits::aig::{Aig, Lit};
use crate::bits::vector::{self, Vector};
use crate::ir::number::Range;

impl ChartStep<'_> {
    /// What becomes of integers in a step: each value is that of the integers from before the step, kept within the
    /// range. Second, for each of them, whether a value beyond the range is assigned to it.
    pub(super) fn count(
        &self,
        aig: &mut Aig,
        before: &[Vector],
        fires: &[Lit],
        moves: &Moves,
    ) -> (Vec<Vector>, Vec<Lit>) {
        let mut after = before.to_vec();
        let mut beyond = vec![Lit::FALSE; before.len()];
        if before.is_empty() {
            return (after, beyond);
        }
        for (happens, deeds) in self.deeds(fires, moves).into_values().flatten() {
            for assignment in &deeds.assignments {
                let Range { lowest, highest } = self.machine.integers[assignment.integer].range;
                let (lowest, highest) = (vector::constant(lowest), vector::constant(highest));
                let value = numbers::number(aig, &assignment.value, before);
                let (low, high) = (vector::less(aig, &value, &lowest), vector::less(aig, &highest, &value));
                let kept = vector::select(aig, low, &lowest, &value);
                let kept = vector::select(aig, high, &highest, &kept);
                let i = assignment.integer.index();
                let kept = vector::fit(&kept, after[i].len());
                after[i] = vector::select(aig, happens, &kept, &after[i]);
                let out = aig.or(low, high);
                let out = aig.and(happens, out);
                beyond[i] = aig.or(beyond[i], out);
            }
        }
        (after, beyond)
    }
}
