//! A run that shows a difference to a shorter and quieter one that still does.

use super::joint::{Joint, Stimulus};

/// Scans that may be spent on it: long runs of large machines should not cost minutes.
const WORK: usize = 60_000;

/// Leaves out scans and quietens inputs as long as a difference remains.
pub fn shorten(joint: &Joint, stimuli: Vec<Stimulus>) -> Vec<Stimulus> {
    let mut best = Best { joint, work: WORK, stimuli };
    best.attempt(best.stimuli.clone());
    let mut block = best.stimuli.len() / 2;
    while block > 0 {
        let mut at = 0;
        while at + block < best.stimuli.len() {
            let mut candidate = best.stimuli.clone();
            candidate.drain(at..at + block);
            if !best.attempt(candidate) {
                at += block;
            }
        }
        block /= 2;
    }
    for input in 0..joint.inputs {
        best.quieten(input);
    }
    for scan in 0..best.stimuli.len() {
        if best.stimuli.get(scan).is_some_and(|s| s.pause != joint.cycle) {
            let mut candidate = best.stimuli.clone();
            candidate[scan].pause = joint.cycle;
            best.attempt(candidate);
        }
    }
    best.stimuli
}

struct Best<'j> {
    joint: &'j Joint,
    work: usize,
    stimuli: Vec<Stimulus>,
}

impl Best<'_> {
    /// Takes the candidate if it shows a difference, up to that.
    fn attempt(&mut self, candidate: Vec<Stimulus>) -> bool {
        if self.work < candidate.len() {
            return false;
        }
        self.work -= candidate.len();
        let Some(scan) = self.joint.first_difference(&candidate) else { return false };
        self.stimuli = candidate;
        self.stimuli.truncate(scan + 1);
        true
    }

    /// An input that keeps the value of the scan before is one thing less to read.
    fn quieten(&mut self, input: usize) {
        for value in [false, true] {
            let mut candidate = self.stimuli.clone();
            candidate.iter_mut().for_each(|s| s.inputs[input] = value);
            if candidate == self.stimuli || self.attempt(candidate) {
                return;
            }
        }
        let mut scan = 0;
        while scan < self.stimuli.len() {
            let before = scan > 0 && self.stimuli[scan - 1].inputs[input];
            if self.stimuli[scan].inputs[input] != before {
                let mut candidate = self.stimuli.clone();
                candidate[scan].inputs[input] = before;
                self.attempt(candidate);
            }
            scan += 1;
        }
    }
}
