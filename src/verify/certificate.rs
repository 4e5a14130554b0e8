//! Whether an invariant is one: looked at by a solver that knows nothing of how it was found.

use super::aig::{Aig, Lit};
use super::pdr::Cube;
use super::sat::{Answer, Budget, Sat};
use super::system::System;

/// Whether the cubes exclude `bad`, no initial state is in one of them, and no scan leads from outside
/// all of them into one; all that where no state is in one of the `known` ones, of which that has been shown before.
pub fn holds(system: &System, bad: Lit, known: &[Cube], cubes: &[Cube]) -> bool {
    let mut aig = system.aig.clone();
    let outside: Vec<Lit> = known.iter().chain(cubes).map(|cube| !inside(&mut aig, system, cube, |l| l.leaf)).collect();
    let given: Vec<Lit> = outside.iter().chain(&system.constraints).copied().collect();
    let never = |aig: &Aig, goals: &[Lit]| {
        let mut sat = Sat::new();
        matches!(sat.ask(aig, goals, Budget::PROOF), Answer::Never)
    };
    let mut goals = given.clone();
    goals.push(bad);
    if !never(&aig, &goals) {
        return false;
    }
    cubes.iter().all(|cube| {
        let starts = cube.iter().all(|&(l, value)| system.latches[l].initial.is_none_or(|i| i == value));
        let mut goals = given.clone();
        goals.push(inside(&mut aig, system, cube, |l| l.next));
        !starts && never(&aig, &goals)
    })
}

fn inside(aig: &mut Aig, system: &System, cube: &Cube, of: impl Fn(&super::system::Latch) -> Lit) -> Lit {
    let values: Vec<Lit> = cube.iter().map(|&(l, value)| of(&system.latches[l]).xor(!value)).collect();
    aig.all(&values)
}
