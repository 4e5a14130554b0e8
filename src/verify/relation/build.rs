//! Gates of a system to decision diagrams.

use super::super::aig::{Aig, Lit, Node};
use super::super::bdd::{Bdd, Edge, Var};
use super::super::limits::{Limit, Limits, Stop};
use super::super::order;
use super::super::system::System;
use std::collections::HashMap;

/// A gate that has more nodes than this and is read more than once becomes a variable.
const CUT: usize = 400;

/// Gates to diagrams.
pub struct Build<'a> {
    /// The diagrams.
    pub bdd: Bdd<'a>,
    /// Indices of the latches that matter.
    pub latches: Vec<usize>,
    /// For each of these, its variable before the scan.
    pub now: Vec<Var>,
    /// For each of these, its variable after the scan.
    pub then: Vec<Var>,
    /// Inputs, and gates that became variables.
    pub given: Vec<Var>,
    /// The gates that became variables, each with that it is what the gate says.
    pub cuts: Vec<(Var, Edge)>,
    /// For each leaf, its variable.
    variable: Vec<Option<Var>>,
    /// Ranks of nodes that are variables, each with the variable, in order.
    ranked: Vec<(u32, Var)>,
}

/// A graph over the leaves of a system, with the rank of each gate that matters.
pub struct Graph {
    /// The graph.
    pub aig: Aig,
    rank: Vec<Option<u32>>,
}

impl Graph {
    /// The same leaves with those functions that are left when some gates are known; and what stands for each node that
    /// `roots` depend on.
    pub fn restrict(&self, roots: &[Lit], known: &[(Lit, bool)]) -> (Graph, Vec<Lit>) {
        let (aig, image) = self.aig.restrict(roots, known);
        let mut rank = vec![None; aig.len()];
        for (n, l) in image.iter().enumerate() {
            if let Some(r) = self.rank[n] {
                rank[l.node()].get_or_insert(r);
            }
        }
        (Graph { aig, rank }, image)
    }
}

impl<'a> Build<'a> {
    /// Variables for all that matters to constraints and to what is `asked`, in a good order.
    pub fn new(system: &System, asked: &[Lit], limits: &Limits, stop: Stop<'a>) -> (Self, Graph) {
        // Which kind of scan it is matters, even if nothing asks for it.
        let kinds = system.alternatives.iter().flat_map(|a| [a.is, a.when]);
        let roots: Vec<Lit> = system.constraints.iter().chain(asked).copied().chain(kinds).collect();
        let (latches, inputs) = system.cone(&roots);
        let nexts = latches.iter().map(|&l| system.latches[l].next);
        let leaves = latches.iter().map(|&l| system.latches[l].leaf);
        let roots: Vec<Lit> = roots.iter().copied().chain(nexts).chain(leaves).collect();
        let rank = order::force(system, &latches, &system.aig.cone(&roots));
        let of_latches = latches.iter().map(|&l| (system.latches[l].leaf, true));
        let of_inputs = inputs.iter().map(|&i| (system.inputs[i].leaf, false));
        let ranked = |(leaf, latch): (Lit, bool)| (rank[leaf.node()].expect("it is in the cone"), leaf, latch);
        let mut leaves: Vec<(u32, Lit, bool)> = of_latches.chain(of_inputs).map(ranked).collect();
        leaves.sort_unstable();
        let mut build = Build {
            bdd: Bdd::new(limits.nodes, limits.steps, stop),
            latches,
            now: Vec::new(),
            then: Vec::new(),
            given: Vec::new(),
            cuts: Vec::new(),
            variable: vec![None; system.aig.leaves().len()],
            ranked: Vec::new(),
        };
        let graph = Graph { aig: system.aig.clone(), rank };
        let mut then = vec![0; system.aig.len()];
        for (rank, leaf, latch) in leaves {
            let var = build.bdd.insert(build.bdd.variables());
            build.variable[graph.aig.number(leaf)] = Some(var);
            build.ranked.push((rank, var));
            if latch {
                // A latch's two values stand side by side.
                then[leaf.node()] = build.bdd.insert(build.bdd.variables());
            } else {
                build.given.push(var);
            }
        }
        for &l in &build.latches {
            let leaf = system.latches[l].leaf;
            build.now.push(build.variable[graph.aig.number(leaf)].expect("a latch has a variable"));
            build.then.push(then[leaf.node()]);
        }
        (build, graph)
    }

    /// The diagrams of `roots`, in which what is `known` need not be worked out.
    pub fn functions(&mut self, graph: &Graph, roots: &[Lit], known: &[(Lit, Edge)]) -> Result<Vec<Edge>, Limit> {
        let aig = &graph.aig;
        let cone = aig.cone(roots);
        let mut readers = vec![0u32; aig.len()];
        for &n in &cone {
            if let Node::And(a, b) = aig.node(n) {
                readers[a.node()] += 1;
                readers[b.node()] += 1;
            }
        }
        roots.iter().for_each(|l| readers[l.node()] += 1);
        let mut image = vec![Edge::FALSE; aig.len()];
        let known: HashMap<usize, Edge> = known.iter().map(|&(l, e)| (l.node(), e.xor(l.is_negated()))).collect();
        for n in cone {
            if let (Some(&edge), Node::And(..)) = (known.get(&n), aig.node(n)) {
                image[n] = edge;
                continue;
            }
            image[n] = match aig.node(n) {
                Node::False => Edge::FALSE,
                Node::Leaf(number) => {
                    let var = self.variable[number as usize].expect("leaves are latches and inputs");
                    self.bdd.var(var)?
                }
                Node::And(a, b) => {
                    let (a, b) = (image[a.node()].xor(a.is_negated()), image[b.node()].xor(b.is_negated()));
                    self.bdd.and(a, b)?
                }
            };
            if readers[n] > 1 && self.bdd.size(image[n], CUT) >= CUT {
                image[n] = self.cut(graph.rank[n], image[n])?;
            }
        }
        Ok(roots.iter().map(|l| image[l.node()].xor(l.is_negated())).collect())
    }

    /// Makes a variable of a gate, placed where the gate stands in the order.
    fn cut(&mut self, rank: Option<u32>, function: Edge) -> Result<Edge, Limit> {
        let rank = rank.unwrap_or(u32::MAX);
        let at = self.ranked.partition_point(|&(r, _)| r < rank);
        let level = self.ranked.get(at).map_or(self.bdd.variables(), |&(_, var)| self.bdd.level(var));
        let var = self.bdd.insert(level);
        self.ranked.insert(at, (rank, var));
        self.given.push(var);
        let edge = self.bdd.var(var)?;
        let definition = self.bdd.equal(edge, function)?;
        self.cuts.push((var, definition));
        Ok(edge)
    }
}
