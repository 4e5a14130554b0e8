//! The safety filter as Boolean functions: seed 001, figure 7, in its corrected form.
//!
//! Written from the algorithm, not from the rungs that it is compiled to: round after round the
//! selection is computed from commands, forcings and the reliefs gathered so far, combined products
//! that the selection violates add their reliefs, until a round violates nothing new. How many rounds
//! that takes is not assumed but proved, for all commands and readings at once ([`rounds`]).
//!
//! That also settles what happens when the plant breaks an assumption and a violated product cannot be
//! relieved: the filter stays with what it selects when no new product is violated any more.

use crate::bits::aig::{Aig, Lit};
use crate::bits::sat::{Answer, Budget, Sat};
use crate::ir::chart::{Atom, Machine, OutputId};
use crate::ir::sop::{Literal, Product};
use std::collections::HashMap;

/// What the filter does in one scan.
pub struct Filtered {
    /// For each output, what is let through.
    pub outputs: Vec<Lit>,
    /// For each constraint, whether it had to act: a simple product forced an output against its
    /// command, or a combined one was violated in some round.
    pub acted: Vec<Lit>,
}

/// The filter with all reliefs gathered in `rounds` rounds.
pub fn filter(
    aig: &mut Aig,
    machine: &Machine,
    commands: &[Lit],
    read: &mut impl FnMut(&mut Aig, Atom) -> Lit,
    rounds: usize,
) -> Filtered {
    let mut run = Run::new(aig, machine, commands, read);
    for _ in 0..rounds {
        run.round(aig);
    }
    run.end(aig)
}

/// The number of rounds after which no product is newly violated, whatever commands and readings are;
/// nothing if the solver gave up.
pub fn rounds(machine: &Machine, sat: &mut Sat) -> Option<usize> {
    let mut aig = Aig::new();
    let commands: Vec<Lit> = machine.outputs.values().map(|o| aig.leaf(&o.name)).collect();
    let mut readings = HashMap::new();
    let mut read = |aig: &mut Aig, atom: Atom| *readings.entry(atom).or_insert_with(|| aig.leaf(machine.atom(atom)));
    let mut run = Run::new(&mut aig, machine, &commands, &mut read);
    // Each round but the last violates one more product, so this ends.
    for rounds in 0.. {
        let violated = run.violated(&mut aig);
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
    commands: Vec<Lit>,
    /// fs0 and fs1: what simple products force off and on.
    forced: [Vec<Lit>; 2],
    /// fc0 and fc1: reliefs gathered so far.
    relieved: [Vec<Lit>; 2],
    combined: Vec<Combined>,
    acted: Vec<Lit>,
}

impl Run {
    fn new(aig: &mut Aig, machine: &Machine, commands: &[Lit], read: &mut impl FnMut(&mut Aig, Atom) -> Lit) -> Run {
        let count = machine.outputs.len();
        let constraints = &machine.safety.constraints;
        let mut run = Run {
            commands: commands.to_vec(),
            forced: [vec![Lit::FALSE; count], vec![Lit::FALSE; count]],
            relieved: [vec![Lit::FALSE; count], vec![Lit::FALSE; count]],
            combined: Vec::new(),
            acted: vec![Lit::FALSE; constraints.len()],
        };
        for (id, constraint) in constraints.iter() {
            for product in &constraint.products {
                let (outputs, readings) = split(aig, product, read);
                if let [(output, negated)] = outputs[..] {
                    // A product with `o` forces `o` off, one with `not o` forces it on.
                    let forced = &mut run.forced[usize::from(negated)][output.index()];
                    *forced = aig.or(*forced, readings);
                    let acts = aig.and(readings, commands[output.index()].xor(negated));
                    let acted = &mut run.acted[id.index()];
                    *acted = aig.or(*acted, acts);
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

    /// `SI(k) := not fs0(k) and ((not fc0(k) and g1(k)) or fc1(k)) or fs1(k)`
    fn selection(&self, aig: &mut Aig, output: usize) -> Lit {
        let wanted = aig.and(!self.relieved[0][output], self.commands[output]);
        let wanted = aig.or(wanted, self.relieved[1][output]);
        let allowed = aig.and(!self.forced[0][output], wanted);
        aig.or(allowed, self.forced[1][output])
    }

    /// `v(j) := CSc_j(SI, Y)`
    fn violated(&self, aig: &mut Aig) -> Vec<Lit> {
        let each = self.combined.iter().map(|c| {
            let mut parts = vec![c.readings];
            for &(output, negated) in &c.outputs {
                parts.push(self.selection(aig, output.index()).xor(negated));
            }
            aig.all(&parts)
        });
        each.collect()
    }

    fn round(&mut self, aig: &mut Aig) {
        let violated = self.violated(aig);
        for (c, now) in self.combined.iter_mut().zip(violated) {
            c.ever = aig.or(c.ever, now);
            for &(output, value) in &c.reliefs {
                let relieved = &mut self.relieved[usize::from(value)][output.index()];
                *relieved = aig.or(*relieved, now);
            }
        }
    }

    fn end(mut self, aig: &mut Aig) -> Filtered {
        for c in &self.combined {
            let acted = &mut self.acted[c.constraint];
            *acted = aig.or(*acted, c.ever);
        }
        let outputs = (0..self.commands.len()).map(|k| self.selection(aig, k)).collect();
        Filtered { outputs, acted: self.acted }
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
