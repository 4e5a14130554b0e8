//! Integers to variables of type INT: assignments and comparisons to rungs with one function each.
//!
//! A comparison that guards read is computed in `Conditions`, from integers as the scan before has left
//! them; one that drives, actions or constraints read in `Variables`, behind all assignments.
//!
//! Observers count before the charts do. What they compare is computed in `Observing`; what is compared of
//! their integers only, for whoever comes after them, in `Observed`, behind their assignments: until the
//! filter has decided these integers do not change again.
//!
//! Assignments come in two halves. First each value is computed into a variable of its own: from left
//! to right, one ADD or SUB for each operand, then LIMIT where the value may lie beyond the range. Then
//! for each integer, by SEL, the value that belongs to what has happened, the last one last. So all values are those from
//! before the step, whatever is assigned to whatever. What is written in no scan needs no half.

use super::context::Context;
use super::rungs::rung;
use crate::ir::chart::{Assignment, ChartKind, ComparisonId, Deeds, IntegerId, Machine, Phase, StateId, TransitionId};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Function, Ladder, Operand, Operator, Rung};
use crate::ir::number::{Comparison, Number, Range, Relation};
use crate::ir::plc::{Global, GlobalId, Origin, Role, Value};
use crate::ir::sop::Sum;
use std::collections::BTreeMap;

/// The globals of integers, and the comparisons asked for so far.
#[derive(Default)]
pub struct Integers {
    pub globals: Vec<GlobalId>,
    /// Comparisons as of the beginning of the scan, with their rungs.
    pub before: BTreeMap<ComparisonId, GlobalId>,
    pub comparing: Vec<Rung>,
    /// Comparisons as the transitions leave them, with their rungs.
    after: BTreeMap<ComparisonId, GlobalId>,
    compared: Vec<Rung>,
    /// Comparisons of what observers alone decide, as their transitions leave them, with their rungs.
    observed: BTreeMap<ComparisonId, GlobalId>,
    observing: Vec<Rung>,
    /// For each integer, whether a control chart assigns to it.
    controlled: Vec<bool>,
}

impl Context<'_> {
    /// Makes the globals of all integers.
    pub fn integers(&mut self) {
        for (id, i) in self.machine.integers.iter() {
            let global = self.globals.push(Global {
                name: i.name.clone(),
                address: None,
                initial: Value::Int(int(i.initial)),
                role: Role::Variable,
                description: i.description.clone(),
                origin: Origin::Integer(id),
            });
            self.integers.globals.push(global);
        }
        self.integers.controlled = written(self.machine, &happenings(self.machine, ChartKind::Control, Phase::Start));
    }

    /// Whether nothing changes the comparison from the step of the observers until the filter has decided.
    pub fn is_observed(&self, comparison: ComparisonId) -> bool {
        let Comparison { left, right, .. } = &self.machine.comparisons[comparison];
        let mut observed = self.machine.charts.iter().any(|c| c.kind == ChartKind::Observer);
        for side in [left, right] {
            side.for_each_value(&mut |i| observed &= !self.integers.controlled[i.index()]);
        }
        observed
    }

    /// Whether the comparison holds as the step of the observers has left it.
    pub fn compared_by_observers(&mut self, comparison: ComparisonId) -> GlobalId {
        if let Some(&id) = self.integers.observed.get(&comparison) {
            return id;
        }
        let mut rungs = std::mem::take(&mut self.integers.observing);
        let text = self.machine.comparison(comparison);
        let id = self.compare(&mut rungs, comparison, "Is", text);
        self.integers.observing = rungs;
        self.integers.observed.insert(comparison, id);
        id
    }

    /// Whether the comparison held when the scan began.
    pub fn compared_before(&mut self, comparison: ComparisonId) -> GlobalId {
        if let Some(&id) = self.integers.before.get(&comparison) {
            return id;
        }
        let mut rungs = std::mem::take(&mut self.integers.comparing);
        let text = format!("{} when the scan began", self.machine.comparison(comparison));
        let id = self.compare(&mut rungs, comparison, "If", text);
        self.integers.comparing = rungs;
        self.integers.before.insert(comparison, id);
        id
    }

    /// Whether the comparison holds as the transitions have left the integers.
    pub fn compared_after(&mut self, comparison: ComparisonId) -> GlobalId {
        if self.is_observed(comparison) {
            return self.compared_by_observers(comparison);
        }
        if let Some(&id) = self.integers.after.get(&comparison) {
            return id;
        }
        let mut rungs = std::mem::take(&mut self.integers.compared);
        let text = self.machine.comparison(comparison);
        let id = self.compare(&mut rungs, comparison, "Is", text);
        self.integers.compared = rungs;
        self.integers.after.insert(comparison, id);
        id
    }

    fn compare(&mut self, rungs: &mut Vec<Rung>, comparison: ComparisonId, word: &str, text: String) -> GlobalId {
        let machine = self.machine;
        let Comparison { left, relation, right } = &machine.comparisons[comparison];
        let name = self.names.give(word, &spelt(machine, &machine.comparisons[comparison]));
        let result = self.global(name.clone(), Role::Condition, text.clone(), Origin::Comparison(comparison));
        let mut sums = Sums { base: name, count: 0, of: result };
        let left = self.operand(rungs, left, &mut sums);
        let right = self.operand(rungs, right, &mut sums);
        self.function(rungs, Operator::Compare(*relation), vec![left, right], result, text);
        result
    }

    /// A constant or variable that holds the number, computed into interim values if it is a sum.
    /// Recursion is bounded by the nesting limit of the source.
    fn operand(&mut self, rungs: &mut Vec<Rung>, number: &Number<IntegerId>, sums: &mut Sums) -> Operand {
        let operands = match number {
            Number::Const(n) => return Operand::Const(*n),
            Number::Value(i) => return Operand::Global(self.integers.globals[i.index()]),
            Number::Sum(operands) => operands,
        };
        // A first operand that is added is there already.
        let (mut sum, rest) = match operands.as_slice() {
            [first, rest @ ..] if !first.negative => (self.operand(rungs, &first.value, sums), rest),
            all => (Operand::Const(0), all),
        };
        for operand in rest {
            let value = self.operand(rungs, &operand.value, sums);
            let operator = if operand.negative { Operator::Subtract } else { Operator::Add };
            sums.count += 1;
            let name = self.names.give(&format!("Sum{}", sums.count), &sums.base);
            let text = format!("part {} of {}", sums.count, sums.base);
            sum = self.interim(rungs, operator, vec![sum, value], name, sums.of, text);
        }
        sum
    }

    /// A new interim value on the way to `of`, and the rung that computes it.
    fn interim(
        &mut self,
        rungs: &mut Vec<Rung>,
        operator: Operator,
        operands: Vec<Operand>,
        name: String,
        of: GlobalId,
        text: String,
    ) -> Operand {
        let origin = self.globals[of].origin;
        let initial = Value::Int(0);
        let description = text.clone();
        let role = Role::Interim;
        let id = self.globals.push(Global { name, address: None, initial, role, description, origin });
        self.function(rungs, operator, operands, id, text);
        Operand::Global(id)
    }

    /// A rung with a function whose result `coil` takes.
    pub fn function(
        &self,
        rungs: &mut Vec<Rung>,
        operator: Operator,
        operands: Vec<Operand>,
        coil: GlobalId,
        comment: String,
    ) {
        rungs.push(Rung {
            comment,
            condition: Sum::one(),
            timer: None,
            function: Some(Function { operator, operands }),
            coil,
            kind: CoilKind::Plain,
            origin: self.globals[coil].origin,
        });
    }
}

/// Puts what is counted before what the ladder does: assignments, then comparisons of what has come of
/// them. All that asks for comparisons has to have run.
pub fn finish(context: &mut Context<'_>, kind: ChartKind, mut assigning: Vec<Rung>, ladder: &mut Ladder) {
    assigning.append(match kind {
        ChartKind::Observer => &mut context.integers.observing,
        ChartKind::Control => &mut context.integers.compared,
    });
    assigning.append(&mut ladder.rungs);
    ladder.rungs = assigning;
}

/// All assignments in the step of charts of that kind; called before the conditions of this step are
/// complete, since they ask who fires.
pub fn lower(context: &mut Context<'_>, kind: ChartKind) -> Vec<Rung> {
    let happenings = happenings(context.machine, kind, Phase::Start);
    assign(context, happenings, None)
}

/// All assignments after the filter, by the coils that say who fires.
pub fn after_filter(context: &mut Context<'_>, firing: &[(TransitionId, GlobalId)]) -> Vec<Rung> {
    let happenings = happenings(context.machine, ChartKind::Observer, Phase::End);
    assign(context, happenings, Some(firing))
}

/// First all values, then what each integer takes of them.
fn assign(
    context: &mut Context<'_>,
    happenings: Vec<Happening<'_>>,
    firing: Option<&[(TransitionId, GlobalId)]>,
) -> Vec<Rung> {
    let written = written(context.machine, &happenings);
    let (mut values, mut choices) = (Vec::new(), Vec::new());
    for happening in happenings {
        let Some(happens) = happening.happens(context, &mut values, firing) else { continue };
        for assignment in &happening.deeds.assignments {
            let target = context.integers.globals[assignment.integer.index()];
            let value = value(context, &mut values, assignment, &written, &happening);
            let integer = &context.machine.integers[assignment.integer].name;
            let comment = format!("{}: {integer} := {}", happening.what, context.machine.number(&assignment.value));
            let operands = vec![Operand::Global(happens), Operand::Global(target), value];
            context.function(&mut choices, Operator::Select, operands, target, comment);
        }
    }
    values.append(&mut choices);
    values
}

/// For each integer, whether one of these assigns to it.
fn written(machine: &Machine, happenings: &[Happening<'_>]) -> Vec<bool> {
    let mut written = vec![false; machine.integers.len()];
    let all = happenings.iter().flat_map(|h| &h.deeds.assignments);
    all.for_each(|a| written[a.integer.index()] = true);
    written
}

/// Something that happens once and assigns to integers.
struct Happening<'m> {
    cause: Cause,
    deeds: &'m Deeds,
    /// In words.
    what: String,
}

/// What happens, in the order in which it does: internal transitions, those further out first, then states are left,
/// those further in first, then transitions fire, those further out first, then states are entered, those further out
/// first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Cause {
    Inside(u32, TransitionId),
    Left(std::cmp::Reverse<u32>, StateId),
    Fires(u32, TransitionId),
    Entered(u32, StateId),
}

/// What can happen in the step of charts of that kind, or after the filter.
fn happenings(machine: &Machine, kind: ChartKind, phase: Phase) -> Vec<Happening<'_>> {
    let mut all = Vec::new();
    for (id, state) in machine.states.iter().filter(|(_, s)| machine.kind(s.region) == kind) {
        let path = machine.state_path(id);
        let (left, entered) = (format!("when {path} is left"), format!("when {path} is entered"));
        all.push(Happening { cause: Cause::Left(std::cmp::Reverse(state.depth), id), deeds: &state.exit, what: left });
        all.push(Happening { cause: Cause::Entered(state.depth, id), deeds: &state.entry, what: entered });
    }
    let transitions = machine.transitions.iter().filter(|(_, t)| t.phase == phase && machine.kind(t.scope) == kind);
    for (id, t) in transitions {
        let depth = machine.regions[t.scope].parent.map_or(0, |p| machine.states[p].depth + 1);
        let path = machine.state_path(t.source);
        let (cause, what) = if t.internal {
            (Cause::Inside(depth, id), format!("when an internal transition of {path} happens"))
        } else {
            (Cause::Fires(depth, id), format!("when a transition from {path} fires"))
        };
        all.push(Happening { cause, deeds: &t.deeds, what });
    }
    all.retain(|happening| !happening.deeds.assignments.is_empty());
    all.sort_by_key(|happening| happening.cause);
    all
}

impl Happening<'_> {
    /// The coil that is TRUE when it happens; nothing if it never does. After the filter it is known who
    /// is firing.
    fn happens(
        &self,
        context: &mut Context<'_>,
        rungs: &mut Vec<Rung>,
        firing: Option<&[(TransitionId, GlobalId)]>,
    ) -> Option<GlobalId> {
        let machine = context.machine;
        let one_of = |coils: &[(TransitionId, GlobalId)], state: &dyn Fn(TransitionId) -> StateId, wanted: StateId| {
            let coils = coils.iter().filter(|(t, _)| state(*t) == wanted);
            Expr::any(coils.map(|&(_, coil)| Expr::Atom(coil)).collect::<Vec<_>>())
        };
        let (word, state, condition) = match (self.cause, firing) {
            (Cause::Inside(_, transition) | Cause::Fires(_, transition), None) => {
                return Some(context.fires(transition));
            }
            (Cause::Inside(_, transition) | Cause::Fires(_, transition), Some(coils)) => {
                return coils.iter().find(|(t, _)| *t == transition).map(|&(_, coil)| coil);
            }
            (Cause::Left(_, state), None) => ("Left", state, context.left(state)),
            (Cause::Entered(_, state), None) => ("Come", state, context.entered_now(state)),
            (Cause::Left(_, state), Some(coils)) => {
                ("Left", state, one_of(coils, &|t| machine.transitions[t].source, state))
            }
            (Cause::Entered(_, state), Some(coils)) => {
                ("Come", state, one_of(coils, &|t| machine.transitions[t].target, state))
            }
        };
        if condition == Expr::FALSE {
            return None;
        }
        let name = context.names.state(word, state);
        let place = Origin::State(state);
        let id = context.global(name, Role::Condition, self.what.clone(), place);
        rung(context, rungs, (id, CoilKind::Plain), &condition, self.what.clone());
        Some(id)
    }

    /// A new name for something about it.
    fn name(&self, context: &mut Context<'_>, word: &str) -> String {
        match self.cause {
            Cause::Inside(_, transition) | Cause::Fires(_, transition) => context.names.transition(word, transition),
            Cause::Left(_, state) => context.names.state(&format!("{word}_left"), state),
            Cause::Entered(_, state) => context.names.state(&format!("{word}_come"), state),
        }
    }
}

/// What an integer takes: the value between the bounds, as it was before the step. `written` says which
/// integers something is assigned to.
fn value(
    context: &mut Context<'_>,
    rungs: &mut Vec<Rung>,
    assignment: &Assignment,
    written: &[bool],
    happening: &Happening<'_>,
) -> Operand {
    let machine = context.machine;
    let (integer, number) = (&machine.integers[assignment.integer], &assignment.value);
    let of = context.integers.globals[assignment.integer.index()];
    let inside = number.range(&|&i: &IntegerId| machine.integers[i].range).is_some_and(|r| integer.range.holds(r));
    let Range { lowest, highest } = integer.range;
    match number {
        Number::Const(n) => return Operand::Const((*n).clamp(lowest, highest)),
        Number::Value(i) if inside && !written[i.index()] => {
            return Operand::Global(context.integers.globals[i.index()]);
        }
        Number::Value(_) | Number::Sum(_) => {}
    }
    let name = happening.name(context, &format!("New_{}", integer.name));
    let text = format!("what {} becomes: {}", integer.name, machine.number(number));
    let base = name.strip_prefix("New_").unwrap_or(&name).to_owned();
    let value = context.operand(rungs, number, &mut Sums { base, count: 0, of });
    match number {
        Number::Sum(_) if inside => value,
        _ if inside => context.interim(rungs, Operator::Move, vec![value], name, of, text),
        _ => {
            let operands = vec![Operand::Const(lowest), value, Operand::Const(highest)];
            context.interim(rungs, Operator::Limit, operands, name, of, text)
        }
    }
}

/// The interim values of one expression.
struct Sums {
    /// What their names end in.
    base: String,
    count: usize,
    /// What they are on the way to.
    of: GlobalId,
}

/// An initial value or bound that is known to fit.
fn int(n: i64) -> i16 {
    i16::try_from(n).expect("a range lies within the type INT")
}

/// A comparison as a part of a name: `Jars_plus_1_ge_12`.
fn spelt(machine: &Machine, comparison: &Comparison<IntegerId>) -> String {
    let relation = match comparison.relation {
        Relation::Equal => "eq",
        Relation::Unequal => "ne",
        Relation::Less => "lt",
        Relation::LessOrEqual => "le",
        Relation::Greater => "gt",
        Relation::GreaterOrEqual => "ge",
    };
    let side = |number: &Number<IntegerId>| {
        let mut words = Vec::new();
        spell(machine, number, &mut words);
        words.join("_")
    };
    format!("{}_{relation}_{}", side(&comparison.left), side(&comparison.right))
}

fn spell(machine: &Machine, number: &Number<IntegerId>, words: &mut Vec<String>) {
    match number {
        Number::Const(n) if *n < 0 => words.extend(["minus".to_owned(), n.unsigned_abs().to_string()]),
        Number::Const(n) => words.push(n.to_string()),
        Number::Value(i) => words.push(machine.integers[*i].name.clone()),
        Number::Sum(operands) => {
            for (place, operand) in operands.iter().enumerate() {
                match (place, operand.negative) {
                    (_, true) => words.push("minus".to_owned()),
                    (0, false) => {}
                    (_, false) => words.push("plus".to_owned()),
                }
                spell(machine, &operand.value, words);
            }
        }
    }
}
