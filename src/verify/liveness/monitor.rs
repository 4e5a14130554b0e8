//! A system to one that remembers what is open, and how often what makes a run fair has come.
//!
//! What is added stands behind the latches and inputs of the system, so that a run of the one is a run of the other.

use super::super::aig::Lit;
use super::super::system::{Giver, System};

/// A system that never is `bad` if something comes sooner or later.
pub struct Monitor {
    /// The system, without its claims.
    pub system: System,
    /// What must never be.
    pub bad: Lit,
}

/// A system whose states tell what is open and what makes a run fair.
pub struct States {
    /// The system, without its claims.
    pub system: System,
    /// The latch that says that something is open.
    pub open: Lit,
    /// For each fairness, the latch that says that it came in the scan before.
    pub came: Vec<Lit>,
}

/// A latch that remembers whether the answer is open, and whether it is at the end of the scan.
fn open(system: &mut System, after: Lit, then: Lit) -> (Lit, Lit) {
    let latch = system.latches.len();
    let before = system.latch("the answer is open", Some(false));
    let asked = system.aig.or(before, after);
    let now = system.aig.and(asked, !then);
    system.latches[latch].next = now;
    (before, now)
}

fn bare(system: &System) -> System {
    System { claims: Vec::new(), ..system.clone() }
}

/// Makes states tell all that a loop has to show.
pub fn states(system: &System, after: Lit, then: Lit) -> States {
    let mut system = bare(system);
    let (open, _) = open(&mut system, after, then);
    let mut came = Vec::new();
    for i in 0..system.fair.len() {
        let holds = system.fair[i].holds;
        if holds == Lit::TRUE {
            continue;
        }
        let latch = system.latches.len();
        came.push(system.latch(format!("{} came", system.fair[i].name), Some(false)));
        system.latches[latch].next = holds;
    }
    States { system, open, came }
}

/// A system that keeps one of its states and is bad when it comes back, if the answer was open and all that makes
/// a run fair came in between.
pub fn lasso(system: &System, after: Lit, then: Lit) -> Monitor {
    let (latches, _) = system.cone(&system.roots_of(after, then));
    let mut system = bare(system);
    let (_, now) = open(&mut system, after, then);
    let waits = system.latches.len() - 1;
    let keep = system.input("this state comes back", Giver::Operator);
    let latch = system.latches.len();
    let kept = system.latch("a state is kept", Some(false));
    let within = system.aig.or(kept, keep);
    system.latches[latch].next = within;
    let keeps = system.aig.and(keep, !kept);
    let mut bad = vec![kept];
    for l in latches.into_iter().chain([waits]) {
        let now = system.latches[l].leaf;
        let latch = system.latches.len();
        let name = format!("kept: {}", system.name(now));
        let copy = system.latch(name, Some(false));
        system.latches[latch].next = system.aig.select(keeps, now, copy);
        bad.push(!system.aig.xor(now, copy));
    }
    // Open in all scans of the loop.
    let latch = system.latches.len();
    let always = system.latch("open since then", Some(true));
    let still = system.aig.and(always, now);
    system.latches[latch].next = system.aig.select(within, still, Lit::TRUE);
    bad.push(always);
    for i in 0..system.fair.len() {
        let latch = system.latches.len();
        let came = system.latch(format!("{} since then", system.fair[i].name), Some(false));
        let some = system.aig.or(came, system.fair[i].holds);
        system.latches[latch].next = system.aig.and(within, some);
        bad.push(came);
    }
    let bad = system.aig.all(&bad);
    Monitor { system, bad }
}

/// A system that is bad when all that makes a run fair has come `rounds` times over while the answer was open. If
/// that never is, no fair run leaves it open for ever.
pub fn rounds(system: &System, after: Lit, then: Lit, rounds: usize) -> Monitor {
    let mut system = bare(system);
    let (_, now) = open(&mut system, after, then);
    let first = system.latches.len();
    let mut came = Vec::new();
    for i in 0..system.fair.len() {
        let before = system.latch(format!("{} in this round", system.fair[i].name), Some(false));
        came.push(system.aig.or(before, system.fair[i].holds));
    }
    let all = system.aig.all(&came);
    let ends = system.aig.and(now, all);
    let goes_on = system.aig.and(now, !all);
    for (i, came) in came.into_iter().enumerate() {
        system.latches[first + i].next = system.aig.and(goes_on, came);
    }
    // A number in unary: one more latch is TRUE after each round.
    let mut bad = ends;
    let mut before = Lit::TRUE;
    for round in 1..rounds {
        let latch = system.latches.len();
        let passed = system.latch(format!("round {round} has passed"), Some(false));
        let more = system.aig.and(ends, before);
        let either = system.aig.or(passed, more);
        system.latches[latch].next = system.aig.and(now, either);
        bad = system.aig.and(ends, passed);
        before = passed;
    }
    Monitor { system, bad }
}

/// Lets a run say that from some scan on the answer will never come: an input for that, and memory of whether it was
/// said and whether it was wrong. What is returned comes again and again if and only if it was said and is right.
pub fn doom(system: &mut System, name: &str, after: Lit, then: Lit) -> Lit {
    let (_, now) = open(system, after, then);
    let says = system.input(format!("{name}: from here on no answer"), Giver::Operator);
    let latch = system.latches.len();
    let said = system.latch(format!("{name}: no answer is to come"), Some(false));
    let wrong = system.latch(format!("{name}: an answer came"), Some(false));
    let says = system.aig.and(says, now);
    let since = system.aig.or(said, says);
    system.latches[latch].next = since;
    let comes = system.aig.and(since, !now);
    system.latches[latch + 1].next = system.aig.or(wrong, comes);
    system.aig.and(said, !wrong)
}
