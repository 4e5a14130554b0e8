//! Scans to times: for how long states have been active.
//!
//! A state's time counts from the first scan that begins in it, so entering it, also from itself, only
//! marks it; the next scan starts the count. Scans are one cycle apart.

use super::code::{Layout, times_of};
use crate::ir::chart::{Machine, StateId};

/// The times that guards wait for.
#[derive(Clone, Debug)]
pub struct Times {
    /// Milliseconds from scan to scan.
    cycle: u64,
    /// Sorted by state.
    list: Vec<Time>,
}

/// One state and time.
#[derive(Clone, Debug)]
struct Time {
    state: StateId,
    milliseconds: u64,
    /// Word and bit of the state.
    active: (usize, u64),
    /// Word and bit that guards read.
    passed: (usize, u64),
    /// The scan that began in the state first, since it was entered last.
    since: Option<u64>,
}

impl Times {
    /// The times of `machine`, none of them running.
    pub fn of(machine: &Machine, layout: Layout) -> Times {
        let list = times_of(machine).into_iter().enumerate().map(|(i, (state, ms))| Time {
            state,
            milliseconds: u64::from(ms),
            active: layout.state(state),
            passed: layout.time(i),
            since: None,
        });
        Times { cycle: u64::from(machine.cycle), list: list.collect() }
    }

    /// Whether no guard waits for a time.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// At the start of the scan of that number: which times have passed.
    pub fn count(&mut self, scan: u64, words: &mut [u64]) {
        for time in &mut self.list {
            let (word, bit) = time.active;
            time.since = (words[word] & bit != 0).then(|| time.since.unwrap_or(scan));
            let passed = time.since.is_some_and(|since| (scan - since) * self.cycle >= time.milliseconds);
            let (word, bit) = time.passed;
            words[word] = if passed { words[word] | bit } else { words[word] & !bit };
        }
    }

    /// The state has been entered: its times start with the next scan.
    pub fn start(&mut self, state: StateId) {
        let from = self.list.partition_point(|t| t.state < state);
        self.list[from..].iter_mut().take_while(|t| t.state == state).for_each(|t| t.since = None);
    }
}
