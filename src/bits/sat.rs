//! Questions about literals of a graph, answered by a SAT solver.
//!
//! Only the cone of what is asked becomes clauses (Tseitin, 1968: three per conjunction). Clauses stay
//! until [`Sat::forget`]; many small questions, each to a fresh solver, are far cheaper than one large
//! question or one solver that is asked everything.

use super::aig::{Aig, Lit, Node};
use batsat::{Callbacks, ClauseKind, Solver, SolverInterface, SolverOpts, lbool};
use std::collections::BTreeMap;

/// Conflicts after which a question is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget(pub u64);

impl Budget {
    /// Enough for all that a compiler run should ask; seconds rather than minutes.
    pub const PROOF: Budget = Budget(400_000);
    /// For questions whose answer would help but is not needed.
    pub const ATTEMPT: Budget = Budget(5_000);
}

/// What came of a question.
#[derive(Clone, Debug)]
pub enum Answer {
    /// No assignment makes all literals TRUE.
    Never,
    /// This one does.
    Sometimes(Model),
    /// The budget was spent first.
    GaveUp,
}

/// An assignment of those leaves that matter to what was asked; the others may be anything.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Model {
    leaves: BTreeMap<u32, bool>,
}

impl FromIterator<(u32, bool)> for Model {
    fn from_iter<I: IntoIterator<Item = (u32, bool)>>(leaves: I) -> Self {
        Model { leaves: leaves.into_iter().collect() }
    }
}

impl Model {
    /// The value of the leaf of that number, FALSE where it does not matter.
    pub fn leaf(&self, leaf: u32) -> bool {
        self.leaves.get(&leaf).copied().unwrap_or(false)
    }

    /// The leaves that matter and their values, in order.
    pub fn iter(&self) -> impl Iterator<Item = (u32, bool)> + '_ {
        self.leaves.iter().map(|(&l, &v)| (l, v))
    }

    /// Every node's value under this assignment.
    pub fn evaluate(&self, aig: &Aig) -> Vec<u64> {
        let words: Vec<u64> = (0..aig.leaves().len() as u32).map(|l| if self.leaf(l) { u64::MAX } else { 0 }).collect();
        let mut values = Vec::new();
        aig.simulate(&words, &mut values);
        values
    }
}

/// How much has been asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Questions that reached the solver.
    pub questions: u64,
    /// Variables over all fresh solvers.
    pub variables: u64,
    /// Conflicts.
    pub conflicts: u64,
}

/// A solver, with the part of a graph that it has been told.
pub struct Sat {
    solver: Solver<Limit>,
    /// For each node, the solver's variable; valid if `told` is the current round.
    variable: Vec<batsat::Var>,
    told: Vec<u32>,
    round: u32,
    leaves: Vec<(u32, batsat::Var)>,
    /// Whether a goal of the last question was FALSE by itself.
    hopeless: bool,
    effort: Effort,
}

impl Default for Sat {
    fn default() -> Self {
        Sat::new()
    }
}

impl Sat {
    /// A solver that knows nothing.
    pub fn new() -> Self {
        Sat {
            solver: fresh(),
            variable: Vec::new(),
            told: Vec::new(),
            round: 1,
            leaves: Vec::new(),
            hopeless: false,
            effort: Effort::default(),
        }
    }

    /// Forgets all clauses. To be called before another graph is asked about.
    pub fn forget(&mut self) {
        self.effort.conflicts += self.solver.num_conflicts();
        self.effort.variables += u64::from(self.solver.num_vars());
        self.solver = fresh();
        self.round += 1;
        self.leaves.clear();
    }

    /// How much has been asked so far.
    pub fn effort(&self) -> Effort {
        let mut effort = self.effort;
        effort.conflicts += self.solver.num_conflicts();
        effort.variables += u64::from(self.solver.num_vars());
        effort
    }

    /// Whether all of `goals` can be TRUE together.
    pub fn ask(&mut self, aig: &Aig, goals: &[Lit], budget: Budget) -> Answer {
        self.hopeless = goals.contains(&Lit::FALSE);
        if self.hopeless {
            return Answer::Never;
        }
        self.effort.questions += 1;
        self.tell(aig, goals);
        let assumptions: Vec<batsat::Lit> =
            goals.iter().filter(|&&l| l != Lit::TRUE).map(|&l| self.literal(l)).collect();
        self.solver.cb_mut().0 = budget.0;
        let outcome = self.solver.solve_limited(&assumptions);
        if outcome == lbool::TRUE {
            let solver = &self.solver;
            // A leaf that the solver left open does not matter.
            let leaves = self.leaves.iter().map(|&(leaf, v)| (leaf, solver.value_var(v) == lbool::TRUE));
            Answer::Sometimes(leaves.collect())
        } else if outcome == lbool::FALSE {
            Answer::Never
        } else {
            Answer::GaveUp
        }
    }

    /// After [`Answer::Never`]: whether this goal was among those that already exclude each other.
    pub fn was_needed(&self, goal: Lit) -> bool {
        match goal.constant() {
            Some(value) => !value,
            // The solver keeps the opposites of the assumptions that clash.
            None => !self.hopeless && self.solver.unsat_core_contains_lit(!self.literal(goal)),
        }
    }

    fn literal(&self, l: Lit) -> batsat::Lit {
        batsat::Lit::new(self.variable[l.node()], !l.is_negated())
    }

    /// Adds the clauses of the cone of `roots` that are not there yet.
    fn tell(&mut self, aig: &Aig, roots: &[Lit]) {
        self.told.resize(aig.len(), 0);
        self.variable.resize(aig.len(), batsat::Var::UNDEF);
        let mut fresh_nodes = Vec::new();
        let mut open: Vec<usize> = roots.iter().map(|l| l.node()).collect();
        while let Some(n) = open.pop() {
            if std::mem::replace(&mut self.told[n], self.round) == self.round {
                continue;
            }
            fresh_nodes.push(n);
            if let Node::And(a, b) = aig.node(n) {
                open.extend([a.node(), b.node()]);
            }
        }
        // Inputs first: the solver breaks ties by the order of variables.
        fresh_nodes.sort_unstable();
        for &n in &fresh_nodes {
            self.variable[n] = self.solver.new_var_default();
            match aig.node(n) {
                Node::False => {
                    let no = batsat::Lit::new(self.variable[n], false);
                    self.solver.add_clause_reuse(&mut vec![no]);
                }
                Node::Leaf(number) => self.leaves.push((number, self.variable[n])),
                Node::And(a, b) => {
                    let (n, a, b) = (batsat::Lit::new(self.variable[n], true), self.literal(a), self.literal(b));
                    self.solver.add_clause_reuse(&mut vec![!n, a]);
                    self.solver.add_clause_reuse(&mut vec![!n, b]);
                    self.solver.add_clause_reuse(&mut vec![n, !a, !b]);
                }
            }
        }
    }
}

fn fresh() -> Solver<Limit> {
    Solver::new(SolverOpts::default(), Limit(u64::MAX))
}

/// Counts down conflicts by the clauses learnt from them. No clock, so that every run ends alike.
struct Limit(u64);

impl Callbacks for Limit {
    fn on_new_clause(&mut self, _: &[batsat::Lit], kind: ClauseKind) {
        if kind == ClauseKind::Learnt {
            self.0 = self.0.saturating_sub(1);
        }
    }
    fn stop(&self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_makes_the_goals_true() {
        let mut aig = Aig::new();
        let (a, b, c) = (aig.leaf("a"), aig.leaf("b"), aig.leaf("c"));
        let x = aig.xor(a, b);
        let y = aig.select(c, x, !a);
        let mut sat = Sat::new();
        let Answer::Sometimes(model) = sat.ask(&aig, &[y, c], Budget::PROOF) else { panic!("it is possible") };
        let values = model.evaluate(&aig);
        assert_eq!(super::super::aig::lanes(&values, y), u64::MAX);
        assert!(model.leaf(2));
        assert!(matches!(sat.ask(&aig, &[y, c, a, b], Budget::PROOF), Answer::Never));
        assert!(sat.was_needed(a) && sat.was_needed(b));
        assert!(matches!(sat.ask(&aig, &[c, !a, x, !b], Budget::PROOF), Answer::Never));
        assert!(!sat.was_needed(c) && sat.was_needed(x));
        // What was asked before leaves no trace.
        assert!(matches!(sat.ask(&aig, &[y], Budget::PROOF), Answer::Sometimes(_)));
    }

    #[test]
    fn a_spent_budget_is_said() {
        // Seven pigeons in six holes: hard for resolution.
        let mut aig = Aig::new();
        let at: Vec<Vec<Lit>> = (0..7).map(|p| (0..6).map(|h| aig.leaf(format!("{p}{h}"))).collect()).collect();
        let mut goals: Vec<Lit> = at.iter().map(|holes| aig.any(holes)).collect();
        for h in 0..6 {
            let column: Vec<Lit> = at.iter().map(|holes| holes[h]).collect();
            goals.push(!aig.two_or_more(&column));
        }
        assert!(matches!(Sat::new().ask(&aig, &goals, Budget(10)), Answer::GaveUp));
        assert!(matches!(Sat::new().ask(&aig, &goals, Budget::PROOF), Answer::Never));
    }
}
