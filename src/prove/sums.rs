//! Whether the numbers of a program stay within their types, once it is known to be its chart.
//!
//! What becomes of a sum that leaves its type is an error by the standard: one tool cuts it at once, another one when it
//! is assigned. The proof computes it whole, so where that would make a difference to a tool nothing is proved.

use super::induction::{Shown, Sums};
use crate::bits::sat::{Answer, Budget, Sat};

/// Proves it for the first scan and for any later one, or says where it may fail.
pub fn examine(shown: Shown<'_, '_>, sat: &mut Sat) -> Result<(), String> {
    for Sums { aig, given, leave } in shown.sums() {
        for (what, leaves) in leave {
            sat.forget();
            match sat.ask(&aig, &[given, leaves], Budget::PROOF) {
                Answer::Never => {}
                Answer::Sometimes(_) | Answer::GaveUp => {
                    return Err(format!("a sum may leave its type, where tools differ: {what}"));
                }
            }
        }
    }
    sat.forget();
    Ok(())
}
