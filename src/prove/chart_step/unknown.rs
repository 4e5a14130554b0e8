//! A program of which nothing is known, in place of the control charts.

use super::Now;
use crate::bits::aig::Lit;
use crate::bits::vector::Vector;

/// What such a program does in a scan: literals that nothing else decides. Observers run in front of it and
/// behind it as ever, for it cannot write what they do.
#[derive(Clone, Debug)]
pub struct Unknown {
    /// For each output, its command.
    pub commands: Vec<Lit>,
    /// For each variable, what the program makes of it; nothing where an observer writes it.
    pub variables: Vec<Option<Lit>>,
    /// For each event, whether the program raises it.
    pub raised: Vec<Lit>,
    /// For each integer, what the program makes of it, as wide as an INT and within the range; nothing where
    /// an observer counts it.
    pub integers: Vec<Option<Vector>>,
}

impl Unknown {
    pub(super) fn act(&self, now: &mut Now) {
        for (value, &written) in now.variables.iter_mut().zip(&self.variables) {
            *value = written.unwrap_or(*value);
        }
        now.raised.clone_from(&self.raised);
        for (value, counted) in now.integers.iter_mut().zip(&self.integers) {
            if let Some(counted) = counted {
                value.clone_from(counted);
            }
        }
    }
}
