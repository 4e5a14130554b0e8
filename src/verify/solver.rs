//! A SAT solver that is told more and more: clauses over literals of a graph, and assumptions.
//!
//! The searches for runs and for proofs ask thousands of questions that differ little, so this one
//! keeps what it has learnt, unlike [`sat`](super::sat), which checks what they come up with.

use super::aig::{Aig, Lit, Node};
use super::limits::Stop;
use batsat::{Callbacks, ClauseKind, SolverInterface, SolverOpts, lbool};

/// A literal of the solver.
pub type SatLit = batsat::Lit;

/// What came of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It can be.
    Sometimes,
    /// It cannot.
    Never,
    /// The solver spent its conflicts, or was told to stop.
    GaveUp,
}

/// A solver for one graph, which may grow.
pub struct Solver<'a> {
    solver: batsat::Solver<Limit<'a>>,
    /// For each node, its variable once it has been told.
    variable: Vec<Option<batsat::Var>>,
    /// Whether what it was told contradicts itself.
    broken: bool,
}

impl<'a> Solver<'a> {
    /// A solver that knows nothing.
    pub fn new(stop: Stop<'a>) -> Self {
        let limit = Limit { left: u64::MAX, stop };
        Solver { solver: batsat::Solver::new(SolverOpts::default(), limit), variable: Vec::new(), broken: false }
    }

    /// A literal that stands for nothing, to switch clauses on by.
    pub fn fresh(&mut self) -> SatLit {
        SatLit::new(self.solver.new_var_default(), true)
    }

    /// What stands for the literal of the graph. Its cone becomes clauses (Tseitin, 1968).
    pub fn literal(&mut self, aig: &Aig, l: Lit) -> SatLit {
        self.tell(aig, l.node());
        SatLit::new(self.variable[l.node()].expect("it has just been told"), !l.is_negated())
    }

    /// Demands that one of them be TRUE.
    pub fn clause(&mut self, clause: &[SatLit]) {
        self.broken |= !self.solver.add_clause_reuse(&mut clause.to_vec());
    }

    /// Demands that it be TRUE.
    pub fn demand(&mut self, aig: &Aig, l: Lit) {
        let l = self.literal(aig, l);
        self.clause(&[l]);
    }

    /// Whether all that was demanded and assumed can be. Counts down the conflicts that it may meet, a question
    /// for one at least.
    pub fn solve(&mut self, assumptions: &[SatLit], conflicts: &mut u64) -> Outcome {
        if self.broken {
            return Outcome::Never;
        }
        if *conflicts == 0 {
            return Outcome::GaveUp;
        }
        self.solver.cb_mut().left = *conflicts;
        let outcome = self.solver.solve_limited(assumptions);
        *conflicts = self.solver.cb_mut().left.min(*conflicts - 1);
        if outcome == lbool::TRUE {
            Outcome::Sometimes
        } else if outcome == lbool::FALSE {
            Outcome::Never
        } else {
            Outcome::GaveUp
        }
    }

    /// After [`Outcome::Sometimes`]: the value of a literal; FALSE where it does not matter.
    pub fn value(&self, l: Lit) -> bool {
        let known = self.variable.get(l.node()).copied().flatten();
        known.is_some_and(|v| (self.solver.value_var(v) == lbool::TRUE) != l.is_negated())
    }

    /// After [`Outcome::Never`]: whether this assumption was among those that exclude each other.
    pub fn was_needed(&self, assumption: SatLit) -> bool {
        // The solver keeps the opposites of the assumptions that clash.
        !self.broken && self.solver.unsat_core_contains_lit(!assumption)
    }

    /// How many variables there are.
    pub fn variables(&self) -> u32 {
        self.solver.num_vars()
    }

    fn tell(&mut self, aig: &Aig, node: usize) {
        self.variable.resize(aig.len(), None);
        let mut fresh = Vec::new();
        let mut open = vec![node];
        while let Some(n) = open.pop() {
            if self.variable[n].is_some() {
                continue;
            }
            // A mark only; variables are given in order below, inputs first.
            self.variable[n] = Some(batsat::Var::UNDEF);
            fresh.push(n);
            if let Node::And(a, b) = aig.node(n) {
                open.extend([a.node(), b.node()]);
            }
        }
        fresh.sort_unstable();
        for n in fresh {
            let var = self.solver.new_var_default();
            self.variable[n] = Some(var);
            let l = SatLit::new(var, true);
            let known = |l: Lit| SatLit::new(self.variable[l.node()].expect("operands come first"), !l.is_negated());
            match aig.node(n) {
                Node::False => self.clause(&[!l]),
                Node::Leaf(_) => {}
                Node::And(a, b) => {
                    let (a, b) = (known(a), known(b));
                    self.clause(&[!l, a]);
                    self.clause(&[!l, b]);
                    self.clause(&[l, !a, !b]);
                }
            }
        }
    }
}

/// Counts down conflicts by the clauses learnt from them, and asks whether to stop.
struct Limit<'a> {
    left: u64,
    stop: Stop<'a>,
}

impl Callbacks for Limit<'_> {
    fn on_new_clause(&mut self, _: &[batsat::Lit], kind: ClauseKind) {
        if kind == ClauseKind::Learnt {
            self.left = self.left.saturating_sub(1);
        }
    }
    fn stop(&self) -> bool {
        self.left == 0 || (self.stop)()
    }
}
