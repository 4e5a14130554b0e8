//! Expressions as functions of what can be read in a scan.

use super::Given;
use crate::bits::aig::{Aig, Lit};
use crate::bits::vector::Vector;
use crate::ir::chart::{Atom, Guard, RegionId, StateKind};
use crate::prove::chart_numbers as numbers;

/// What an expression reads where it stands.
pub(super) struct Reading<'a> {
    pub given: Given<'a>,
    pub active: &'a [Lit],
    pub variables: &'a [Lit],
    pub integers: &'a [Vector],
}

impl Reading<'_> {
    pub fn guard(&self, aig: &mut Aig, guard: &Guard) -> Lit {
        aig.expression(guard, &mut |aig, &atom| self.atom(aig, atom))
    }

    pub fn atom(&self, aig: &mut Aig, atom: Atom) -> Lit {
        match atom {
            Atom::Input(i) => self.given.inputs[i.index()],
            Atom::PrevInput(i) => self.given.before.inputs[i.index()],
            Atom::Output(o) => {
                self.given.outputs.expect("what reads outputs of this scan comes after the filter")[o.index()]
            }
            Atom::PrevOutput(o) => self.given.before.outputs[o.index()],
            Atom::Variable(v) => self.variables[v.index()],
            Atom::Event(e) => self.given.before.raised[e.index()],
            Atom::Compare(c) => numbers::compare(aig, &self.given.step.machine.comparisons[c], self.integers),
            Atom::In(s) => self.active[s.index()],
            Atom::After(s, ms) => self.given.elapsed[self.given.step.timers[&(s, ms)]],
            Atom::Done(s) => {
                let regions: Vec<Lit> =
                    self.given.step.machine.states[s].regions.iter().map(|&r| self.ended(aig, r)).collect();
                aig.all(&regions)
            }
        }
    }

    pub fn ended(&self, aig: &mut Aig, region: RegionId) -> Lit {
        let machine = self.given.step.machine;
        let states = machine.regions[region].states.iter();
        let last = states.filter(|&&s| machine.states[s].kind == StateKind::Final);
        let last: Vec<Lit> = last.map(|s| self.active[s.index()]).collect();
        aig.any(&last)
    }
}
