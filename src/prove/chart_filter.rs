//! The safety filter as Boolean functions: the paper on logical constraints, figure 7, in its corrected form.
//!
//! Written from the algorithm, not from the rungs that it is compiled to: round after round the
//! selection is computed from commands, forcings and the reliefs gathered so far, combined products
//! that the selection violates add their reliefs, until a round violates nothing new. How many rounds
//! that takes is not assumed but proved, for all commands and readings at once ([`rounds`]).
//!
//! That also settles what happens when the plant breaks an assumption and a violated product cannot be
//! relieved: the filter stays with what it selects when no new product is violated any more.
//!
//! With `relief in-order` (the paper on ITS PLC) the machine says how many sweeps are made. That they suffice is
//! proved as well, under the assumptions.

use super::{chart_numbers, configuration};
use crate::bits::aig::{Aig, Lit};
use crate::bits::sat::{Answer, Budget, Sat};
use crate::bits::vector::Vector;
use crate::ir::chart::{Atom, FilterMode, Machine, OutputId, Relief};
use crate::ir::sop::{Literal, Product};
use std::collections::HashMap;

/// What the filter does in one scan.
pub struct Filtered {
    /// For each output, what is let through.
    pub outputs: Vec<Lit>,
    /// For each constraint, whether it had to act: a simple product forced an output against its
    /// command, or a combined one was violated in some round. In a blocking filter, whether the commands
    /// violate it.
    pub acted: Vec<Lit>,
    /// What is remembered, in the order of [`Safety::marks`](crate::ir::chart::Safety::marks).
    pub marks: Vec<Lit>,
    /// Whether what was noted before still is, because this is not the reset.
    pub held: Lit,
}

/// The filter with all reliefs gathered in `rounds` rounds; `marks` is what it remembers from before.
pub fn filter(
    aig: &mut Aig,
    machine: &Machine,
    commands: &[Lit],
    marks: &[Lit],
    read: &mut impl FnMut(&mut Aig, Atom) -> Lit,
    rounds: usize,
) -> Filtered {
    let safety = &machine.safety;
    let held = match (safety.reset, marks) {
        (Some(input), [noted, ..]) => {
            let (now, before) = (read(aig, Atom::Input(input)), read(aig, Atom::PrevInput(input)));
            let rises = aig.and(now, !before);
            aig.and(*noted, !rises)
        }
        _ => Lit::FALSE,
    };
    let (acted, mut run) = if safety.mode == Some(FilterMode::Blocking) {
        let mut judged = Run::new(aig, machine, commands, read);
        let violated = judged.violated(aig, commands);
        judged.note(aig, &violated);
        let acted = judged.acted(aig);
        let stopped = aig.any(&acted);
        let stopped = aig.or(stopped, held);
        let taken: Vec<Lit> = commands.iter().map(|&c| aig.and(c, !stopped)).collect();
        (Some(acted), Run::new(aig, machine, &taken, read))
    } else {
        (None, Run::new(aig, machine, commands, read))
    };
    let outputs = run.decide(aig, rounds);
    let acted = acted.unwrap_or_else(|| run.acted(aig));
    let mut after = Vec::new();
    if let Some((&noted, first)) = marks.split_first() {
        let any = aig.any(&acted);
        let begins = aig.and(any, !held);
        let stays = aig.and(noted, held);
        after.push(aig.or(begins, stays));
        after.extend(first.iter().zip(&acted).map(|(&was, &acts)| aig.select(held, was, acts)));
    }
    Filtered { outputs, acted, marks: after, held }
}

/// The number of rounds after which no product is newly violated, whatever commands and readings are; in
/// order, the machine's number of sweeps, if after them no product is violated as long as the assumptions
/// hold. Nothing if that is not so or the solver gave up.
pub fn rounds(machine: &Machine, sat: &mut Sat) -> Option<usize> {
    match machine.safety.relief {
        Relief::Together => rounds_together(machine, sat),
        Relief::InOrder { sweeps } => sweeps_suffice(machine, sat, sweeps).then_some(sweeps),
    }
}

fn sweeps_suffice(machine: &Machine, sat: &mut Sat, sweeps: usize) -> bool {
    let mut aig = Aig::new();
    let commands: Vec<Lit> = machine.outputs.values().map(|o| aig.leaf(&o.name)).collect();
    let active = configuration::active(&mut aig, machine);
    // What is counted stays within its range, as a part of the proof shows.
    let integers: Vec<Vector> = machine.integers.values().map(|i| configuration::within(&mut aig, i)).collect();
    let mut readings = HashMap::new();
    let mut read = |aig: &mut Aig, atom: Atom| match atom {
        Atom::In(s) => active[s.index()],
        Atom::Compare(c) => chart_numbers::compare(aig, &machine.comparisons[c], &integers),
        other => *readings.entry(other).or_insert_with(|| aig.leaf(machine.atom(other))),
    };
    let mut run = Run::new(&mut aig, machine, &commands, &mut read);
    let selected = run.decide(&mut aig, sweeps);
    let violated = run.violated(&mut aig, &selected);
    let mut goals = vec![aig.any(&violated)];
    for a in &machine.safety.assumptions {
        goals.push(!aig.expression(&a.never, &mut |aig, &atom| read(aig, atom)));
    }
    sat.forget();
    let answer = sat.ask(&aig, &goals, Budget::PROOF);
    sat.forget();
    matches!(answer, Answer::Never)
}

fn rounds_together(machine: &Machine, sat: &mut Sat) -> Option<usize> {
    let mut aig = Aig::new();
    let commands: Vec<Lit> = machine.outputs.values().map(|o| aig.leaf(&o.name)).collect();
    let mut readings = HashMap::new();
    let mut read = |aig: &mut Aig, atom: Atom| *readings.entry(atom).or_insert_with(|| aig.leaf(machine.atom(atom)));
    let mut run = Run::new(&mut aig, machine, &commands, &mut read);
    // Each round but the last violates one more product, so this ends.
    for rounds in 0.. {
        let selected = run.selection(&mut aig);
        let violated = run.violated(&mut aig, &selected);
        let news = violated.into_iter().zip(&run.combined).map(|(now, c)| aig.and(now, !c.ever));
        let news: Vec<Lit> = news.collect();
        let news = aig.any(&news);
        sat.forget();
        match sat.ask(&aig, &[news], Budget::PROOF) {
            Answer::Never => {
                sat.forget();
                return Some(rounds);
            }
            Answer::Sometimes(_) => run.round(&mut aig),
            Answer::GaveUp => return None,
        }
    }
    unreachable!("every round but the last violates one more product")
}

/// Whether each constraint and assumption, split into products, still says what is written; names the
/// first that does not.
pub fn products_say_what_is_written(machine: &Machine, sat: &mut Sat) -> Result<(), String> {
    let safety = &machine.safety;
    let constraints = safety.constraints.values().map(|c| (&c.name, &c.never, &c.products));
    let assumptions = safety.assumptions.iter().map(|a| (&a.name, &a.never, &a.products));
    for (name, never, products) in constraints.chain(assumptions) {
        let mut aig = Aig::new();
        let mut readings = HashMap::new();
        let mut read =
            |aig: &mut Aig, atom: Atom| *readings.entry(atom).or_insert_with(|| aig.leaf(machine.atom(atom)));
        let written = aig.expression(never, &mut |aig, &atom| read(aig, atom));
        let mut split = Vec::new();
        for product in products {
            let literals: Vec<Lit> = product.literals().iter().map(|l| read(&mut aig, l.atom).xor(l.negated)).collect();
            split.push(aig.all(&literals));
        }
        let split = aig.any(&split);
        let differ = aig.xor(written, split);
        sat.forget();
        if !matches!(sat.ask(&aig, &[differ], Budget::PROOF), Answer::Never) {
            return Err(format!("the products of {name} do not say what is written"));
        }
    }
    sat.forget();
    Ok(())
}

/// A product with several outputs of this scan, in a run of the filter.
struct Combined {
    constraint: usize,
    readings: Lit,
    /// The outputs that it names, each with whether it is negated.
    outputs: Vec<(OutputId, bool)>,
    /// Who gives way, and to which value.
    reliefs: Vec<(OutputId, bool)>,
    /// Whether it has been violated so far.
    ever: Lit,
}

struct Run {
    relief: Relief,
    commands: Vec<Lit>,
    /// fs0 and fs1: what simple products force off and on.
    forced: [Vec<Lit>; 2],
    /// fc0 and fc1: reliefs gathered so far.
    relieved: [Vec<Lit>; 2],
    combined: Vec<Combined>,
    /// For each constraint, whether a simple product of it forces an output against its command.
    against: Vec<Lit>,
}

impl Run {
    fn new(aig: &mut Aig, machine: &Machine, commands: &[Lit], read: &mut impl FnMut(&mut Aig, Atom) -> Lit) -> Run {
        let count = machine.outputs.len();
        let constraints = &machine.safety.constraints;
        let mut run = Run {
            relief: machine.safety.relief,
            commands: commands.to_vec(),
            forced: [vec![Lit::FALSE; count], vec![Lit::FALSE; count]],
            relieved: [vec![Lit::FALSE; count], vec![Lit::FALSE; count]],
            combined: Vec::new(),
            against: vec![Lit::FALSE; constraints.len()],
        };
        for (id, constraint) in constraints.iter() {
            for product in &constraint.products {
                let (outputs, readings) = split(aig, product, read);
                if let [(output, negated)] = outputs[..] {
                    // A product with `o` forces `o` off, one with `not o` forces it on.
                    let forced = &mut run.forced[usize::from(negated)][output.index()];
                    *forced = aig.or(*forced, readings);
                    let acts = aig.and(readings, commands[output.index()].xor(negated));
                    let against = &mut run.against[id.index()];
                    *against = aig.or(*against, acts);
                } else {
                    let yields = outputs.iter().copied().filter(|(o, _)| constraint.yields.contains(o));
                    let reliefs = yields.collect();
                    run.combined.push(Combined {
                        constraint: id.index(),
                        readings,
                        outputs,
                        reliefs,
                        ever: Lit::FALSE,
                    });
                }
            }
        }
        run
    }

    /// What is selected after so many rounds or sweeps.
    fn decide(&mut self, aig: &mut Aig, rounds: usize) -> Vec<Lit> {
        match self.relief {
            Relief::Together => {
                (0..rounds).for_each(|_| self.round(aig));
                self.selection(aig)
            }
            Relief::InOrder { .. } => {
                // Nothing has been relieved yet: not fs0 and g1 or fs1.
                let mut selected = self.selection(aig);
                (0..rounds).for_each(|_| self.sweep(aig, &mut selected));
                selected
            }
        }
    }

    /// `SI(k) := not fs0(k) and ((not fc0(k) and g1(k)) or fc1(k)) or fs1(k)`
    fn selection(&self, aig: &mut Aig) -> Vec<Lit> {
        let one = |k: usize| {
            let wanted = aig.and(!self.relieved[0][k], self.commands[k]);
            let wanted = aig.or(wanted, self.relieved[1][k]);
            let allowed = aig.and(!self.forced[0][k], wanted);
            aig.or(allowed, self.forced[1][k])
        };
        (0..self.commands.len()).map(one).collect()
    }

    /// `v(j) := CSc_j(SI, Y)`
    fn violated(&self, aig: &mut Aig, selected: &[Lit]) -> Vec<Lit> {
        self.combined.iter().map(|c| c.holds(aig, selected)).collect()
    }

    fn round(&mut self, aig: &mut Aig) {
        let selected = self.selection(aig);
        let violated = self.violated(aig, &selected);
        self.note(aig, &violated);
        for (c, &now) in self.combined.iter().zip(&violated) {
            for &(output, value) in &c.reliefs {
                let relieved = &mut self.relieved[usize::from(value)][output.index()];
                *relieved = aig.or(*relieved, now);
            }
        }
    }

    /// In turn, and at once: an output that yields takes the other value unless a simple product holds it.
    fn sweep(&mut self, aig: &mut Aig, selected: &mut [Lit]) {
        for c in &mut self.combined {
            let now = c.holds(aig, selected);
            c.ever = aig.or(c.ever, now);
            for &(output, value) in &c.reliefs {
                let k = output.index();
                let changes = aig.and(now, !self.forced[usize::from(!value)][k]);
                selected[k] = aig.select(changes, Lit::of(value), selected[k]);
            }
        }
    }

    /// Which combined products have been violated.
    fn note(&mut self, aig: &mut Aig, violated: &[Lit]) {
        for (c, &now) in self.combined.iter_mut().zip(violated) {
            c.ever = aig.or(c.ever, now);
        }
    }

    fn acted(&self, aig: &mut Aig) -> Vec<Lit> {
        let mut acted = self.against.clone();
        for c in &self.combined {
            acted[c.constraint] = aig.or(acted[c.constraint], c.ever);
        }
        acted
    }
}

impl Combined {
    fn holds(&self, aig: &mut Aig, selected: &[Lit]) -> Lit {
        let outputs = self.outputs.iter().map(|&(output, negated)| selected[output.index()].xor(negated));
        let literals: Vec<Lit> = std::iter::once(self.readings).chain(outputs).collect();
        aig.all(&literals)
    }
}

/// The outputs of this scan that a product names, and the conjunction of what else it reads.
fn split(
    aig: &mut Aig,
    product: &Product<Atom>,
    read: &mut impl FnMut(&mut Aig, Atom) -> Lit,
) -> (Vec<(OutputId, bool)>, Lit) {
    let mut outputs = Vec::new();
    let mut readings = Vec::new();
    for &Literal { atom, negated } in product.literals() {
        match atom {
            Atom::Output(o) => outputs.push((o, negated)),
            other => readings.push(read(aig, other).xor(negated)),
        }
    }
    (outputs, aig.all(&readings))
}
