//! Constraints to the rungs of the filter: the corrected algorithm of the paper on logical
//! constraints, its rounds unrolled.
//!
//! In round r the selection of an output is
//! `Sel = not Off and (not Yield and Cmd or Raise) or On`, where `Off` and `On` come from simple
//! constraints (fs0, fs1) and `Yield` and `Raise` gather the reliefs of all rounds before (fc0, fc1).
//! The combined products are evaluated on the selections, all together, so that the order in which
//! constraints are written means nothing. There are as many rounds as the graph GO is deep; a product
//! is evaluated only in rounds in which it can still be violated. What the last round selects is
//! written to the outputs, in the last rungs.
//!
//! With `relief in-order` the rounds are sweeps ([`order`]). What the filter remembers, and what makes a
//! blocking one take commands as FALSE, is in [`memory`].

mod memory;
mod order;

use super::context::{Condition, Context};
use super::rungs::rung;
use crate::ir::chart::{Atom, ConstraintId, FilterMode, OutputId, Relief};
use crate::ir::expr::Expr;
use crate::ir::ladder::{CoilKind, Ladder, Rung};
use crate::ir::plc::{GlobalId, Origin, Role};
use crate::ir::relief::{Combined, Reliefs};
use crate::ir::sop::Product;
use std::collections::BTreeMap;

pub fn lower(context: &mut Context<'_>) -> Ladder {
    let machine = context.machine;
    let reliefs = Reliefs::of(&machine.safety);
    let mut filter = Filter {
        rungs: Vec::new(),
        taken: context.commands.clone(),
        off: vec![None; machine.outputs.len()],
        on: vec![None; machine.outputs.len()],
        yields: vec![None; machine.outputs.len()],
        raised: vec![None; machine.outputs.len()],
        selected: vec![None; machine.outputs.len()],
        alarms: vec![Vec::new(); machine.safety.constraints.len()],
    };
    filter.assumptions(context);
    let blocking = machine.safety.mode == Some(FilterMode::Blocking);
    if blocking {
        filter.stop(context);
    }
    filter.forcings(context, &reliefs);
    match machine.safety.relief {
        Relief::Together => (0..reliefs.depth()).for_each(|round| filter.round(context, &reliefs, round)),
        Relief::InOrder { sweeps } => (0..sweeps).for_each(|sweep| filter.sweep(context, &reliefs, sweep)),
    }
    if !blocking {
        let acted = filter.alarms(context);
        filter.remember(context, &acted);
    }
    for output in machine.outputs.ids() {
        let selection = match (machine.safety.relief, filter.selected[output.index()]) {
            (Relief::InOrder { .. }, Some(selected)) => Expr::Atom(selected),
            (Relief::Together | Relief::InOrder { .. }, _) => filter.selection(output),
        };
        let coil = context.outputs[output.index()];
        let comment = context.globals[coil].description.clone();
        rung(context, &mut filter.rungs, (coil, CoilKind::Plain), &selection, comment);
    }
    Ladder { rungs: filter.rungs }
}

struct Filter {
    rungs: Vec<Rung>,
    /// For each output, the command that counts.
    taken: Vec<GlobalId>,
    /// For each output, whether simple constraints force it off or on: fs0 and fs1.
    off: Vec<Option<GlobalId>>,
    on: Vec<Option<GlobalId>>,
    /// For each output, whether combined constraints have relieved it so far: fc0 and fc1.
    yields: Vec<Option<GlobalId>>,
    raised: Vec<Option<GlobalId>>,
    /// For each output, the coil of its selection in this round, if it has one already.
    selected: Vec<Option<GlobalId>>,
    /// For each constraint, what shows that it had to act.
    alarms: Vec<Vec<Condition>>,
}

impl Filter {
    fn coil(
        &mut self,
        context: &mut Context<'_>,
        name: (&str, &str),
        role: Role,
        origin: Origin,
        text: String,
        condition: &Condition,
    ) -> GlobalId {
        let name = context.names.give(name.0, name.1);
        let id = context.global(name, role, text.clone(), origin);
        rung(context, &mut self.rungs, (id, CoilKind::Plain), condition, text);
        id
    }

    fn assumptions(&mut self, context: &mut Context<'_>) {
        let machine = context.machine;
        for (i, a) in machine.safety.assumptions.iter().enumerate() {
            let sum = a.products.iter().map(|p| self.product(context, p)).collect::<Vec<_>>();
            let text =
                if a.text.is_empty() { format!("the plant breaks assumption {}", a.name) } else { a.text.clone() };
            self.coil(context, ("Broken", &a.name), Role::Alarm, Origin::Assumption(i), text, &Expr::any(sum));
        }
    }

    /// One rung per simple constraint and output, then one per output and direction.
    fn forcings(&mut self, context: &mut Context<'_>, reliefs: &Reliefs) {
        let machine = context.machine;
        let mut targets: BTreeMap<(ConstraintId, OutputId, bool), Vec<Condition>> = BTreeMap::new();
        for f in &reliefs.forcings {
            let condition = self.product(context, &f.condition);
            targets.entry((f.constraint, f.output, f.value)).or_default().push(condition);
        }
        let mut count: BTreeMap<ConstraintId, usize> = BTreeMap::new();
        targets.keys().for_each(|(c, ..)| *count.entry(*c).or_default() += 1);
        let mut forced: BTreeMap<(OutputId, bool), Vec<Condition>> = BTreeMap::new();
        for ((id, output, value), conditions) in targets {
            let (constraint, name) = (&machine.safety.constraints[id], &machine.outputs[output].name);
            let path = if count[&id] > 1 { format!("{}_{name}", constraint.name) } else { constraint.name.clone() };
            let (word, verb) = if value { ("Keep", "holds") } else { ("Ban", "forbids") };
            let reason = if constraint.text.is_empty() { String::new() } else { format!(": {}", constraint.text) };
            let text = format!("{} {verb} {name}{reason}", constraint.name);
            let coil =
                self.coil(context, (word, &path), Role::Filter, Origin::Constraint(id), text, &Expr::any(conditions));
            forced.entry((output, value)).or_default().push(Expr::Atom(coil));
            let command = Expr::Atom(self.taken[output.index()]);
            let against = if value { command.not() } else { command };
            self.alarms[id.index()].push(Expr::all([Expr::Atom(coil), against]));
        }
        for ((output, value), conditions) in forced {
            let signal = &machine.outputs[output];
            let (word, text) = if value { ("On", "must stay on") } else { ("Off", "must be off") };
            let text = format!("{} {text}", signal.name);
            let coil = self.coil(
                context,
                (word, &signal.name),
                Role::Filter,
                Origin::Output(output),
                text,
                &Expr::any(conditions),
            );
            let slot = if value { &mut self.on } else { &mut self.off };
            slot[output.index()] = Some(coil);
        }
    }

    /// Evaluates the combined products that can be violated in this round and gathers reliefs.
    fn round(&mut self, context: &mut Context<'_>, reliefs: &Reliefs, round: usize) {
        let machine = context.machine;
        let mut relieved: BTreeMap<(OutputId, bool), Vec<Condition>> = BTreeMap::new();
        let due = |j: usize| reliefs.rounds[j] > round;
        let paths = Self::paths(context, reliefs);
        for ((_, c), path) in reliefs.combined.iter().enumerate().zip(paths).filter(|((j, _), _)| due(*j)) {
            let constraint = &machine.safety.constraints[c.constraint];
            for literal in c.product.literals() {
                if let Atom::Output(o) = literal.atom {
                    self.select(context, o, round);
                }
            }
            let condition = self.product(context, &c.product);
            let text = format!("{} would be violated in round {}", constraint.name, round + 1);
            let hit = self.coil(
                context,
                (&format!("Hit{}", round + 1), &path),
                Role::Filter,
                Origin::Constraint(c.constraint),
                text,
                &condition,
            );
            self.alarms[c.constraint.index()].push(Expr::Atom(hit));
            for &(output, value) in &c.reliefs {
                relieved.entry((output, value)).or_default().push(Expr::Atom(hit));
            }
        }
        for ((output, value), hits) in relieved {
            let signal = &machine.outputs[output];
            let so_far = if value { self.raised[output.index()] } else { self.yields[output.index()] };
            let condition = Expr::any(so_far.map(Expr::Atom).into_iter().chain(hits));
            let (word, text) = if value { ("Raise", "goes on") } else { ("Yield", "goes off") };
            let text = format!("{} {text} after {} round{}", signal.name, round + 1, if round == 0 { "" } else { "s" });
            let coil = self.coil(
                context,
                (&format!("{word}{}", round + 1), &signal.name),
                Role::Filter,
                Origin::Output(output),
                text,
                &condition,
            );
            let slot = if value { &mut self.raised } else { &mut self.yields };
            slot[output.index()] = Some(coil);
            self.selected[output.index()] = None;
        }
    }

    /// For each combined product, the name of its constraint, numbered from its second one on.
    fn paths(context: &Context<'_>, reliefs: &Reliefs) -> Vec<String> {
        let mut nth: BTreeMap<ConstraintId, usize> = BTreeMap::new();
        let path = |c: &Combined| {
            let n = nth.entry(c.constraint).or_default();
            *n += 1;
            let name = &context.machine.safety.constraints[c.constraint].name;
            if *n > 1 { format!("{name}_{n}") } else { name.clone() }
        };
        reliefs.combined.iter().map(path).collect()
    }

    /// Gives the output's selection in this round a coil, unless nothing has changed since the last.
    fn select(&mut self, context: &mut Context<'_>, output: OutputId, round: usize) {
        if self.selected[output.index()].is_some() {
            return;
        }
        let condition = self.selection(output);
        let coil = match condition {
            // A command that nothing corrects is its own selection.
            Expr::Atom(command) => command,
            condition => {
                let signal = &context.machine.outputs[output];
                let text = format!("{} as selected in round {}", signal.name, round + 1);
                self.coil(
                    context,
                    (&format!("Sel{}", round + 1), &signal.name),
                    Role::Filter,
                    Origin::Output(output),
                    text,
                    &condition,
                )
            }
        };
        self.selected[output.index()] = Some(coil);
    }

    fn selection(&self, output: OutputId) -> Condition {
        let i = output.index();
        let is = |slot: Option<GlobalId>| slot.map_or(Expr::FALSE, Expr::Atom);
        let command = Expr::all([is(self.yields[i]).not(), Expr::Atom(self.taken[i])]);
        Expr::any([Expr::all([is(self.off[i]).not(), Expr::any([command, is(self.raised[i])])]), is(self.on[i])])
    }

    /// One flag per constraint: it had to act in this scan.
    fn alarms(&mut self, context: &mut Context<'_>) -> Vec<GlobalId> {
        let machine = context.machine;
        let (word, role) = if machine.safety.alarms() { ("Alarm", Role::Alarm) } else { ("Acts", Role::Acted) };
        let mut flags = Vec::new();
        for (id, constraint) in machine.safety.constraints.iter() {
            let reasons = std::mem::take(&mut self.alarms[id.index()]);
            let text = if constraint.text.is_empty() {
                format!("{} had to correct the commands", constraint.name)
            } else {
                constraint.text.clone()
            };
            flags.push(self.coil(
                context,
                (word, &constraint.name),
                role,
                Origin::Constraint(id),
                text,
                &Expr::any(reasons),
            ));
        }
        flags
    }

    /// A product over selections, inputs, previous values, variables and observers.
    fn product(&self, context: &mut Context<'_>, product: &Product<Atom>) -> Condition {
        Expr::all(product.literals().iter().map(|l| {
            let value = match l.atom {
                Atom::Output(o) => {
                    Expr::Atom(self.selected[o.index()].expect("outputs of a product are selected first"))
                }
                // Of an observer, which has taken its step.
                Atom::In(s) => Expr::Atom(context.flags[s.index()]),
                Atom::Compare(c) => Expr::Atom(context.compared_after(c)),
                other => context.value(other),
            };
            if l.negated { value.not() } else { value }
        }))
    }
}
