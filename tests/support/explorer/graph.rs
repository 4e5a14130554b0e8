//! All runs as a graph, and what is true of them.

use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;
use std::collections::{HashMap, VecDeque};

/// A step from state to state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edge {
    pub to: usize,
    /// What is so in it, a bit for each fact.
    pub facts: u128,
    /// What it does for a run to be fair, likewise.
    pub fair: u64,
}

/// What is asked, over facts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    Never(usize),
    Possible(usize),
    NeverStuck,
    /// With nothing to come, nothing comes.
    Comes {
        after: usize,
        then: Option<usize>,
    },
}

/// All runs: states by number, each with the steps that lead on.
#[derive(Default)]
pub struct Graph {
    pub starts: Vec<usize>,
    pub edges: Vec<Vec<Edge>>,
    pub asks: Vec<Ask>,
    /// All that makes a run fair.
    pub fair: u64,
}

/// Whether it is so; else how many steps the shortest run has that shows it, if that is asked.
pub type Truth = Result<(), Option<usize>>;

impl Graph {
    /// What is true, question by question.
    pub fn truths(&self) -> Vec<Truth> {
        let mut depth = vec![usize::MAX; self.edges.len()];
        let mut open: VecDeque<usize> = VecDeque::new();
        for &start in &self.starts {
            depth[start] = 0;
            open.push_back(start);
        }
        while let Some(at) = open.pop_front() {
            for edge in &self.edges[at] {
                if depth[edge.to] == usize::MAX {
                    depth[edge.to] = depth[at] + 1;
                    open.push_back(edge.to);
                }
            }
        }
        let shortest = |wrong: &dyn Fn(usize) -> bool, more: usize| {
            (0..depth.len()).filter(|&s| wrong(s)).map(|s| depth[s] + more).min().map_or(Ok(()), |n| Err(Some(n)))
        };
        let shows = |s: usize, fact: usize| self.edges[s].iter().any(|e| e.facts >> fact & 1 == 1);
        let truth = |ask: &Ask| match *ask {
            Ask::Never(fact) => shortest(&|s| shows(s, fact), 1),
            Ask::NeverStuck => shortest(&|s| self.edges[s].is_empty(), 0),
            Ask::Possible(fact) => {
                let mut saved: Vec<bool> = (0..depth.len()).map(|s| shows(s, fact)).collect();
                let mut back: HashMap<usize, Vec<usize>> = HashMap::new();
                for (from, edges) in self.edges.iter().enumerate() {
                    edges.iter().for_each(|e| back.entry(e.to).or_default().push(from));
                }
                let mut open: Vec<usize> = (0..depth.len()).filter(|&s| saved[s]).collect();
                while let Some(at) = open.pop() {
                    for &from in back.get(&at).into_iter().flatten() {
                        if !std::mem::replace(&mut saved[from], true) {
                            open.push(from);
                        }
                    }
                }
                shortest(&|s| !saved[s], 0)
            }
            Ask::Comes { after, then } => {
                if self.comes(after, then) {
                    Ok(())
                } else {
                    Err(None)
                }
            }
        };
        self.asks.iter().map(truth).collect()
    }

    /// Whether in all fair runs `then` comes `after`: no set of states that lead to each other while the answer is open
    /// has among its steps all that makes a run fair.
    fn comes(&self, after: usize, then: Option<usize>) -> bool {
        let is = |e: &Edge, fact: usize| e.facts >> fact & 1 == 1;
        let opens = |e: &Edge, open: bool| (open || is(e, after)) && !then.is_some_and(|then| is(e, then));
        // Twice each state: with the answer open or not.
        let mut reached = vec![false; 2 * self.edges.len()];
        let mut todo: Vec<usize> = self.starts.iter().map(|s| 2 * s).collect();
        todo.iter().for_each(|&s| reached[s] = true);
        let mut waits: DiGraph<usize, u64> = DiGraph::new();
        let mut node = HashMap::new();
        while let Some(at) = todo.pop() {
            let open = at % 2 == 1;
            for edge in &self.edges[at / 2] {
                let still = opens(edge, open);
                let to = 2 * edge.to + usize::from(still);
                if open && still {
                    let ends = [at, to].map(|n| *node.entry(n).or_insert_with(|| waits.add_node(n)));
                    waits.add_edge(ends[0], ends[1], edge.fair);
                }
                if !std::mem::replace(&mut reached[to], true) {
                    todo.push(to);
                }
            }
        }
        !tarjan_scc(&waits).into_iter().any(|circle| {
            let inside: std::collections::HashSet<_> = circle.iter().copied().collect();
            let steps = circle.iter().flat_map(|&n| waits.edges(n));
            let steps = steps.filter(|e| inside.contains(&petgraph::visit::EdgeRef::target(e)));
            steps.map(|e| *e.weight()).reduce(|a, b| a | b) == Some(self.fair)
        })
    }
}
