//! Safety constraints as the filter sees them: forcings by simple products, reliefs by combined
//! ones, and the graph that says how reliefs set each other off (the paper on logical
//! constraints, from which the names of properties and of the graph GO come).

use super::chart::{Atom, ConstraintId, OutputId, Safety, outputs_of};
use super::sop::Product;
use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;

/// A product with exactly one output of this scan: while its condition holds, the output is forced.
#[derive(Clone, Debug)]
pub struct Forcing {
    /// The constraint that it is part of.
    pub constraint: ConstraintId,
    /// The output.
    pub output: OutputId,
    /// What the output is forced to: the opposite of what the product names.
    pub value: bool,
    /// The product without the output, over read-only values.
    pub condition: Product<Atom>,
}

/// A product with several outputs of this scan.
#[derive(Clone, Debug)]
pub struct Combined {
    /// The constraint that it is part of.
    pub constraint: ConstraintId,
    /// The whole product.
    pub product: Product<Atom>,
    /// Who gives way when it would be TRUE, and to what: MC0 and MC1 of the paper. Every relief
    /// opposes one of the product's literals (property 0).
    pub reliefs: Vec<(OutputId, bool)>,
}

impl Combined {
    /// The part of the product over read-only values.
    pub fn readings(&self) -> Product<Atom> {
        self.product.retain(|a| !matches!(a, Atom::Output(_)))
    }
}

/// A model's constraints, sorted by what the filter does about them.
#[derive(Clone, Debug, Default)]
pub struct Reliefs {
    /// The simple products, in the order of the constraints.
    pub forcings: Vec<Forcing>,
    /// The combined products, in the order of the constraints.
    pub combined: Vec<Combined>,
    /// For each combined product, in how many rounds at most it can be violated: 1 for one that no
    /// relief can set off. In round r, counted from 0, only products with more than r rounds need
    /// to be looked at.
    pub rounds: Vec<usize>,
    /// Groups of combined products whose reliefs set each other off in a cycle (property 2).
    pub cycles: Vec<Vec<usize>>,
}

impl Reliefs {
    /// Sorts the products and measures the graph GO.
    pub fn of(safety: &Safety) -> Reliefs {
        let mut all = Reliefs::default();
        for (id, constraint) in safety.constraints.iter() {
            for product in &constraint.products {
                let outputs: Vec<(OutputId, bool)> = outputs_of(product).collect();
                if let [(output, negated)] = outputs[..] {
                    let condition = product.retain(|a| a != Atom::Output(output));
                    all.forcings.push(Forcing { constraint: id, output, value: negated, condition });
                } else {
                    let reliefs = outputs.into_iter().filter(|(o, _)| constraint.yields.contains(o)).collect();
                    all.combined.push(Combined { constraint: id, product: product.clone(), reliefs });
                }
            }
        }
        all.measure();
        all
    }

    /// The number of rounds after which no combined product can be violated any more: the longest
    /// path of GO. A cycle counts as many nodes as it has products, or as it has outputs that yield
    /// if these are fewer: reliefs stay, so each round in which it is violated relieves another one.
    pub fn depth(&self) -> usize {
        self.rounds.iter().copied().max().unwrap_or(0)
    }

    fn measure(&mut self) {
        let mut graph = DiGraph::<(), ()>::new();
        let nodes: Vec<_> = self.combined.iter().map(|_| graph.add_node(())).collect();
        // Only products that name an output can be set off by its relief.
        let mut naming: Vec<(OutputId, bool, usize)> = Vec::new();
        for (j, c) in self.combined.iter().enumerate() {
            naming.extend(outputs_of(&c.product).map(|(o, negated)| (o, negated, j)));
        }
        naming.sort();
        for (i, c) in self.combined.iter().enumerate() {
            let readings = c.readings();
            for &(output, value) in &c.reliefs {
                // Forcing to FALSE can make a product true that names the output negated.
                let from = naming.partition_point(|&(o, n, _)| (o, n) < (output, !value));
                for &(_, _, j) in naming[from..].iter().take_while(|&&(o, n, _)| (o, n) == (output, !value)) {
                    if readings.times(&self.combined[j].readings()).is_some() {
                        graph.update_edge(nodes[i], nodes[j], ());
                    }
                }
            }
        }
        self.rounds = vec![0; self.combined.len()];
        // Tarjan yields components with those first that others lead to; walked backwards, every
        // component comes after all that lead to it.
        for component in tarjan_scc(&graph).iter().rev() {
            let before = component
                .iter()
                .flat_map(|&n| graph.neighbors_directed(n, petgraph::Direction::Incoming))
                .map(|n| self.rounds[n.index()])
                .max()
                .unwrap_or(0);
            let mut yielding: Vec<OutputId> =
                component.iter().flat_map(|n| self.combined[n.index()].reliefs.iter().map(|(o, _)| *o)).collect();
            yielding.sort_unstable();
            yielding.dedup();
            for &n in component {
                self.rounds[n.index()] = before + component.len().min(yielding.len());
            }
            if component.len() > 1 {
                let mut members: Vec<usize> = component.iter().map(|n| n.index()).collect();
                members.sort_unstable();
                self.cycles.push(members);
            }
        }
        self.cycles.sort();
    }
}
