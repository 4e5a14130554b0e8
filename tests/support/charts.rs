//! SFCs and ladders by chance, for properties that hold of all.

use super::plc;
use chartwright::ir::expr::Expr;
use chartwright::ir::ladder::{CoilKind, Ladder};
use chartwright::ir::plc::{Body, GlobalId, Project, Role};
use chartwright::ir::sfc::{Sfc, StepId};
use proptest::prelude::*;

/// How many globals the projects have.
const GLOBALS: usize = 6;

/// A project with one SFC, every step of which is reachable. Steps without a way out occur.
pub fn sfc() -> impl Strategy<Value = Project> {
    let steps = (1usize..14).prop_flat_map(|n| {
        let parents = (1..n).map(|i| 0..i).collect::<Vec<_>>();
        let others = prop::collection::vec((0..n, 0..n), 0..2 * n);
        let flags = prop::collection::vec(prop::option::of(0..GLOBALS), n);
        (flags, parents, others, any::<u64>())
    });
    steps.prop_map(|(flags, parents, others, seed)| {
        let mut project = globals();
        let mut sfc = Sfc::default();
        for (i, flag) in flags.iter().enumerate() {
            plc::step(&mut sfc, &"x".repeat(1 + i * i % 17), flag.map(GlobalId::from_index));
            let name = format!("S{i}_{}", "n".repeat(1 + i * i % 17));
            sfc.steps[StepId::from_index(i)].name = name;
        }
        let tree = parents.into_iter().enumerate().map(|(i, parent)| (parent, i + 1));
        let mut ways: Vec<(usize, usize)> = tree.chain(others).collect();
        shuffle(&mut ways, seed);
        for (i, (from, to)) in ways.into_iter().enumerate() {
            let condition = (0..1 + i % 4).map(|k| plc::on(GlobalId::from_index((i + k) % GLOBALS)));
            plc::transition(&mut sfc, StepId::from_index(from), StepId::from_index(to), Expr::all(condition));
        }
        plc::program(&mut project, "Sfc", Body::Sfc(sfc));
        project
    })
}

/// A project with one ladder.
pub fn ladder() -> impl Strategy<Value = Project> {
    let literal = (0..GLOBALS, any::<bool>());
    let product = prop::collection::vec(literal, 0..4);
    let rung = (prop::collection::vec(product, 1..5), 0..GLOBALS, 0..3usize);
    prop::collection::vec(rung, 0..6).prop_map(|rungs| {
        let mut project = globals();
        let mut ladder = Ladder::default();
        for (products, coil, kind) in rungs {
            let literal = |(g, negated): (usize, bool)| {
                let atom = plc::on(GlobalId::from_index(g));
                if negated { atom.not() } else { atom }
            };
            let products: Vec<_> = products.into_iter().map(|p| Expr::all(p.into_iter().map(literal))).collect();
            let kind = [CoilKind::Plain, CoilKind::Set, CoilKind::Reset][kind];
            plc::rung(&mut ladder, &Expr::any(products), GlobalId::from_index(coil), kind);
        }
        // A coil that nothing feeds has no rung.
        ladder.rungs.retain(|r| !r.condition.is_zero());
        plc::program(&mut project, "Ladder", Body::Ladder(ladder));
        project
    })
}

fn globals() -> Project {
    let mut project = plc::project("Chance");
    for i in 0..GLOBALS {
        let name = format!("V{i}_{}", "v".repeat(1 + i * 5 % 13));
        plc::global(&mut project, &name, Role::Variable, None);
    }
    project
}

/// Swaps neighbours by the bits of `seed`: each order of ways out of a step comes up.
fn shuffle<T>(items: &mut [T], seed: u64) {
    let mut state = seed | 1;
    for i in (1..items.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        items.swap(i, (state >> 33) as usize % (i + 1));
    }
}
