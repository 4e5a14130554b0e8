//! Whether something stays possible, by plans: inputs that lead to it, whatever the state.
//!
//! A plan covers the states from which its inputs keep the constraints and show the goal. If some plans together cover all that is
//! reachable, which is a question of the kind that [`pdr`] answers, the goal is always possible. A reachable state that none
//! covers yet asks for one more plan (counterexample-guided, Clarke et al., 2003, on plans instead of abstractions). What this
//! does not find out may be so or not.

use super::aig::{Lit, lanes};
use super::bounded::Bounded;
use super::certificate;
use super::limits::{Limit, Limits, Stop};
use super::pdr::{self, Cube, Proof};
use super::system::{System, Trace};

/// Scans of plans that are found soon.
pub const SHORT: usize = 12;

/// Scans of the longest plan.
pub const LONG: usize = 60;

/// Plans after which it gives up.
const PLANS: usize = 40;

/// Conflicts for one more scan of a plan.
const QUESTION: u64 = 5_000;

/// The inputs of each scan.
type Plan = Vec<Vec<bool>>;

/// Says so if every run can be continued to a scan in which `goal` is TRUE. `states` are some that are reachable, `known` cubes in
/// which no reachable state is. No plan is longer than the scans that `limits` allows.
pub fn prove(
    system: &System,
    goal: Lit,
    states: &[Vec<bool>],
    known: &[Cube],
    limits: &Limits,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(usize),
) -> Result<(), Limit> {
    // What is known of reachable states holds while the constraints are kept.
    let kept = (system.latches.len(), true);
    let known: Vec<Cube> = known.iter().map(|cube| cube.iter().copied().chain([kept]).collect()).collect();
    let mut plans: Vec<Plan> = Vec::new();
    let mut states = states.to_vec();
    loop {
        while let Some(state) = uncovered(system, goal, &plans, &states) {
            if plans.len() == PLANS {
                return Err(Limit::Plans);
            }
            plans.push(plan(system, goal, limits.scans, state, stop)?);
        }
        let (covered, bad) = cover(system, goal, &plans);
        match pdr::prove(&covered, bad, &known, limits, stop, progress)? {
            Proof::Never(cubes) if certificate::holds(&covered, bad, &known, &cubes) => return Ok(()),
            Proof::Never(_) => return Err(Limit::Certificate),
            Proof::Run(run) => {
                let before = &run.inputs[..run.inputs.len() - 1];
                let replay = Trace { inputs: before.to_vec(), ..run.clone() };
                let mut state = covered.replay(&replay, &mut |_| {}).map_err(|_| Limit::Replay)?;
                state.truncate(system.latches.len());
                states = vec![state];
            }
        }
    }
}

/// A state that no plan covers.
fn uncovered<'s>(system: &System, goal: Lit, plans: &[Plan], states: &'s [Vec<bool>]) -> Option<&'s Vec<bool>> {
    for states in states.chunks(64) {
        let mut left = if states.len() == 64 { u64::MAX } else { (1 << states.len()) - 1 };
        for plan in plans {
            left &= !reaches(system, goal, plan, states);
        }
        if left != 0 {
            return Some(&states[left.trailing_zeros() as usize]);
        }
    }
    None
}

/// The states, up to 64 of them, that a plan covers.
fn reaches(system: &System, goal: Lit, plan: &Plan, states: &[Vec<bool>]) -> u64 {
    let mut now: Vec<u64> = (0..system.latches.len())
        .map(|l| states.iter().enumerate().fold(0, |word, (lane, state)| word | u64::from(state[l]) << lane))
        .collect();
    let (mut valid, mut reached) = (u64::MAX, 0);
    for inputs in plan {
        let inputs: Vec<u64> = inputs.iter().map(|&value| if value { u64::MAX } else { 0 }).collect();
        let values = system.lanes(&now, &inputs);
        valid = system.constraints.iter().fold(valid, |all, &c| all & lanes(&values, c));
        reached |= valid & lanes(&values, goal);
        now = system.latches.iter().map(|l| lanes(&values, l.next)).collect();
    }
    reached
}

/// Inputs that lead from a state to the goal, as few as there are.
fn plan(system: &System, goal: Lit, longest: usize, state: &[bool], stop: Stop<'_>) -> Result<Plan, Limit> {
    let mut from = system.clone();
    from.latches.iter_mut().zip(state).for_each(|(l, &value)| l.initial = Some(value));
    let mut bounded = Bounded::new(&from, &[goal], stop);
    for _ in 0..longest {
        bounded.scan();
        if let Some(run) = bounded.find(0, &mut { QUESTION })? {
            return Ok(run.inputs);
        }
    }
    Err(Limit::Plans)
}

/// The system without constraints, which remembers whether they have been kept, and that they have while no plan covers the state.
fn cover(system: &System, goal: Lit, plans: &[Plan]) -> (System, Lit) {
    let mut covered = System { claims: Vec::new(), fair: Vec::new(), alternatives: Vec::new(), ..system.clone() };
    let kept = covered.latch("constraints were kept", Some(true));
    let keeps = covered.aig.all(&system.constraints);
    let next = covered.aig.and(kept, keeps);
    covered.latches.last_mut().expect("it has just been added").next = next;
    covered.constraints.clear();
    let roots: Vec<Lit> = system.constraints.iter().copied().chain([goal]).collect();
    let (latches, _) = system.cone(&roots);
    let roots: Vec<Lit> = roots.into_iter().chain(latches.iter().map(|&l| system.latches[l].next)).collect();
    let mut bad = kept;
    for plan in plans {
        let mut now: Vec<Lit> = system.latches.iter().map(|l| l.leaf).collect();
        let (mut valid, mut reached) = (Lit::TRUE, Lit::FALSE);
        for inputs in plan {
            let mut value = vec![Lit::FALSE; system.aig.leaves().len()];
            system.latches.iter().zip(&now).for_each(|(l, &lit)| value[system.aig.number(l.leaf)] = lit);
            system.inputs.iter().zip(inputs).for_each(|(i, &v)| value[system.aig.number(i.leaf)] = Lit::of(v));
            let image = covered.aig.import(&system.aig, &roots, &mut |_, leaf| value[leaf as usize]);
            let (constraints, rest) = image.split_at(system.constraints.len());
            let kept = covered.aig.all(constraints);
            valid = covered.aig.and(valid, kept);
            let shows = covered.aig.and(valid, rest[0]);
            reached = covered.aig.or(reached, shows);
            latches.iter().zip(&rest[1..]).for_each(|(&l, &next)| now[l] = next);
        }
        bad = covered.aig.and(bad, !reached);
    }
    (covered, bad)
}
