//! Combined products to the matrices and graphs of the paper on logical constraints (equations 14 to 16).
//!
//! MX0 and MX1 say which outputs a product names complemented and plain, MC0 and MC1 which it forces off
//! and on when it is relieved. MX = MX1ᵀ·MX0 + MX0ᵀ·MX1 joins products that name an output with both
//! polarities: the undirected graph G. MC = MC0ᵀ·MX0 + MC1ᵀ·MX1 leads from a product to those that its
//! relief may make TRUE: the directed graph GO.

use crate::ir::chart::outputs_of;
use crate::ir::relief::Combined;
use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A Boolean matrix: where it is 1, by row and column.
pub type Matrix = BTreeSet<(usize, usize)>;

/// All matrices. Outputs and combined products are counted in the order of the machine, from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub struct Matrices {
    /// Output by product: the output occurs complemented.
    pub mx0: Matrix,
    /// Output by product: the output occurs plain.
    pub mx1: Matrix,
    /// Output by product: the relief forces the output off.
    pub mc0: Matrix,
    /// Output by product: the relief forces the output on.
    pub mc1: Matrix,
    /// Product by product, symmetric: some output occurs with both polarities. The edges of G.
    pub mx: Matrix,
    /// Product by product: the relief of the first may make the second TRUE. The arcs of GO.
    pub mc: Matrix,
}

impl Matrices {
    /// The matrices of these products.
    pub fn of(combined: &[Combined]) -> Matrices {
        let mut m = Matrices::default();
        for (j, c) in combined.iter().enumerate() {
            for (output, negated) in outputs_of(&c.product) {
                if negated { &mut m.mx0 } else { &mut m.mx1 }.insert((output.index(), j));
            }
            for &(output, value) in &c.reliefs {
                if value { &mut m.mc1 } else { &mut m.mc0 }.insert((output.index(), j));
            }
        }
        m.mx = product(&m.mx1, &m.mx0);
        m.mx.extend(product(&m.mx0, &m.mx1));
        m.mc = product(&m.mc0, &m.mx0);
        m.mc.extend(product(&m.mc1, &m.mx1));
        m
    }
}

/// The product of the transpose of `a` with `b`.
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut rows: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    b.iter().for_each(|&(row, column)| rows.entry(row).or_default().push(column));
    let pairs = a.iter().flat_map(|&(row, i)| rows.get(&row).into_iter().flatten().map(move |&j| (i, j)));
    pairs.collect()
}

/// The groups of products that lead to each other in a cycle, each in order; they are what property 2
/// forbids. `arcs` lead between `count` products.
pub fn cycles(count: usize, arcs: &Matrix) -> Vec<Vec<usize>> {
    let mut graph = DiGraph::<(), ()>::new();
    let nodes: Vec<_> = (0..count).map(|_| graph.add_node(())).collect();
    arcs.iter().for_each(|&(i, j)| {
        graph.update_edge(nodes[i], nodes[j], ());
    });
    let mut cycles: Vec<Vec<usize>> = tarjan_scc(&graph)
        .into_iter()
        .filter(|component| component.len() > 1)
        .map(|component| component.iter().map(|n| n.index()).collect())
        .collect();
    cycles.iter_mut().for_each(|c: &mut Vec<usize>| c.sort_unstable());
    cycles.sort();
    cycles
}
