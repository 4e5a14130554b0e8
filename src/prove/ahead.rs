//! Scans ahead of a memory that has been reached, as a question to a solver.

use super::joint::{Joint, Memory, Stimulus};
use crate::bits::aig::{Aig, Lit};
use crate::bits::sat::{Answer, Budget, Sat};
use crate::ir::iec::Time;

/// Stimuli for as many scans as there are pauses, such that `goal`, a literal of a later scan, is TRUE in one of them.
///
/// When a timer has started on the way is followed exactly: pauses are given, so it is known how long ago each
/// scan was.
pub fn ahead(joint: &Joint, memory: &Memory, pauses: &[Time], goal: Lit, sat: &mut Sat) -> Option<Vec<Stimulus>> {
    let half = joint.half(false);
    let roots: Vec<Lit> = [goal].iter().chain(&half.begins).chain(&half.next).copied().collect();
    let mut aig = Aig::new();
    let mut bits: Vec<Lit> = memory.bits.iter().map(|&b| Lit::of(b)).collect();
    // For each timer, since when it may have run, and whether it did not start again later.
    let mut starts: Vec<Vec<(Time, Lit)>> = memory.started.iter().map(|&t| vec![(t, Lit::TRUE)]).collect();
    let mut now = memory.now;
    let mut reached = Vec::new();
    for (scan, pause) in pauses.iter().enumerate() {
        now += pause;
        let inputs: Vec<Lit> = (0..joint.inputs).map(|i| aig.leaf(format!("{scan}.{i}"))).collect();
        let passed: Vec<Lit> = starts
            .iter()
            .zip(&joint.times)
            .map(|(starts, time)| {
                let over: Vec<Lit> =
                    starts.iter().filter(|(at, _)| now >= at + time).map(|(_, since)| *since).collect();
                aig.any(&over)
            })
            .collect();
        let last = scan + 1 == pauses.len();
        let wanted = if last { &roots[..1] } else { &roots[..] };
        let found = joint.copy(&mut aig, &bits, &inputs, &passed, wanted);
        reached.push(found[0]);
        if last {
            break;
        }
        let (begins, next) = found[1..].split_at(starts.len());
        for (starts, &begins) in starts.iter_mut().zip(begins) {
            for (_, since) in starts.iter_mut() {
                *since = aig.and(*since, !begins);
            }
            starts.push((now, begins));
            starts.retain(|(_, since)| *since != Lit::FALSE);
        }
        bits = next.to_vec();
    }
    let reached = aig.any(&reached);
    sat.forget();
    let Answer::Sometimes(model) = sat.ask(&aig, &[reached], Budget::ATTEMPT) else { return None };
    let inputs = |scan: usize| (0..joint.inputs).map(|i| model.leaf((scan * joint.inputs + i) as u32)).collect();
    Some(pauses.iter().enumerate().map(|(scan, &pause)| Stimulus { pause, inputs: inputs(scan) }).collect())
}
