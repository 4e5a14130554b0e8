//! What is asked of a machine: what it declares itself, and what is worth knowing of any.

use super::super::aig::{Aig, Lit};
use super::super::system::Property;
use super::rivals::rivals;
use super::{Program, Subject, View};
use crate::ir::chart::{Atom, ConstraintId, Guard, IntegerId, Machine, Mark, StateId, StateKind, TransitionId};
use crate::ir::scenario::{Condition, Counted, PropertyKind, Seen};
use crate::prove::chart_numbers::{compare, compare_of};
use std::collections::BTreeSet;

/// One question. Where nothing else is said, the claim of the system says that it never is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// A property of the machine, by index.
    Declared(usize),
    /// Whether what the property of that index speaks of, its `after`, happens in some fair run; else it says nothing.
    Arises(usize),
    /// Whether the outputs violate the constraint in spite of the filter.
    Violated(ConstraintId),
    /// Whether inputs that the assumptions allow always exist; the claim says that no run gets stuck.
    Assumable,
    /// Whether some transition can always fire sooner or later; the claim says that this is always possible.
    Moves,
    /// Whether the state is ever active.
    Active(StateId),
    /// Whether the transition ever fires.
    Fires(TransitionId),
    /// Whether two transitions of one source are ever enabled together, so that the first one fires only because of the
    /// order of the text, and something would be different if the second one did.
    Together(TransitionId, TransitionId),
    /// Whether the integer is ever to become something beyond its range.
    Beyond(IntegerId),
    /// Whether the filter ever has to act for the constraint.
    Acts(ConstraintId),
}

/// What is found, and may be meant so or be wrong: that is for people to judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A property says nothing.
    Void,
    /// A state is never active.
    Unreachable,
    /// A transition never fires.
    Silent,
    /// Only the order of two transitions decides.
    Overlap,
    /// An integer stops at a bound of its range.
    Saturates,
    /// The filter acts.
    Acts,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 6] =
        [Kind::Void, Kind::Unreachable, Kind::Silent, Kind::Overlap, Kind::Saturates, Kind::Acts];

    /// Its word on the command line, in models and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Void => "void",
            Kind::Unreachable => "unreachable",
            Kind::Silent => "silent",
            Kind::Overlap => "overlap",
            Kind::Saturates => "saturates",
            Kind::Acts => "acts",
        }
    }
}

impl Question {
    /// Whether a run that shows it is what one hopes for.
    pub fn hopes_for_a_run(self, machine: &Machine) -> bool {
        match self {
            Question::Declared(i) => machine.properties[i].kind == PropertyKind::Reachable,
            Question::Active(_) | Question::Fires(_) | Question::Arises(_) => true,
            Question::Violated(_)
            | Question::Assumable
            | Question::Moves
            | Question::Together(..)
            | Question::Beyond(_)
            | Question::Acts(_) => false,
        }
    }

    /// What is found if the answer is not what one hopes for; nothing if the machine is wrong then.
    pub fn kind(self) -> Option<Kind> {
        match self {
            Question::Declared(_) | Question::Violated(_) | Question::Assumable | Question::Moves => None,
            Question::Arises(_) => Some(Kind::Void),
            Question::Active(_) => Some(Kind::Unreachable),
            Question::Fires(_) => Some(Kind::Silent),
            Question::Together(..) => Some(Kind::Overlap),
            Question::Beyond(_) => Some(Kind::Saturates),
            Question::Acts(_) => Some(Kind::Acts),
        }
    }

    /// A word for what it is about; that of its kind, if it has one.
    pub fn word(self) -> &'static str {
        match (self, self.kind()) {
            (_, Some(kind)) => kind.word(),
            (Question::Violated(_), _) => "constraint",
            (Question::Assumable, _) => "assumptions",
            (Question::Moves, _) => "moves",
            (_, None) => "property",
        }
    }
}

impl Subject<'_> {
    /// What can be asked whatever the program is.
    pub(super) fn ask_about_outputs(&mut self, program: Program) {
        let machine = self.machine;
        for (i, p) in machine.properties.iter().enumerate() {
            // Nobody can expect something of a program of which nothing is known.
            let eventually = matches!(p.kind, PropertyKind::Eventually | PropertyKind::Fair);
            if program == Program::Any && (eventually || reads_states(machine, &p.condition)) {
                continue;
            }
            let aig = &mut self.system.aig;
            let holds = self.view.holds(aig, machine, &p.condition);
            let looked = self.view.looked(machine, &p.condition);
            let (holds, fails) = (aig.and(holds, looked), aig.and(!holds, looked));
            let property = match p.kind {
                PropertyKind::Never | PropertyKind::Reachable => Property::Never(holds),
                PropertyKind::Always => Property::Never(fails),
                PropertyKind::AlwaysPossible => Property::AlwaysPossible(holds),
                PropertyKind::Eventually => {
                    let after = p.after.as_ref().map_or(Lit::TRUE, |after| {
                        let holds = self.view.holds(&mut self.system.aig, machine, after);
                        self.system.aig.and(holds, self.view.looked(machine, after))
                    });
                    let arises = Property::Eventually { after, then: Lit::FALSE };
                    self.ask(Question::Arises(i), format!("{} is void", p.name), arises);
                    Property::Eventually { after, then: holds }
                }
                PropertyKind::Fair => {
                    self.system.fairness(p.name.clone(), holds);
                    continue;
                }
            };
            self.ask(Question::Declared(i), p.name.clone(), property);
        }
        for (id, constraint) in machine.safety.constraints.iter() {
            let violated = self.view.constraint(&mut self.system.aig, &constraint.never);
            let violated = self.system.aig.and(violated, self.view.turn.reading);
            self.ask(Question::Violated(id), format!("{} is violated", constraint.name), Property::Never(violated));
        }
        if !machine.safety.assumptions.is_empty() {
            // A plant that goes by steps may always have one to take.
            let reading = self.view.turn.reading;
            let kept = if reading == Lit::TRUE { Property::NeverStuck } else { Property::AlwaysPossible(reading) };
            self.ask(Question::Assumable, "the assumptions can be kept".to_owned(), kept);
        }
    }

    /// What can be asked of charts.
    pub(super) fn ask_about_chart(&mut self) {
        let machine = self.machine;
        let some = self.system.aig.any(&self.view.scan.fires);
        if !machine.transitions.is_empty() {
            self.ask(Question::Moves, "some transition can fire".to_owned(), Property::AlwaysPossible(some));
        }
        for id in machine.states.ids() {
            let active = self.view.scan.after.active[id.index()];
            self.ask(Question::Active(id), format!("in({})", machine.state_path(id)), Property::Never(active));
        }
        for (id, _) in machine.transitions.iter() {
            let fires = self.view.scan.fires[id.index()];
            self.ask(Question::Fires(id), format!("{} fires", transition(machine, id)), Property::Never(fires));
        }
        for (a, b) in rivals(machine) {
            // Where another one comes before both, their order decides nothing.
            let scan = &self.view.scan;
            let both = self.system.aig.and(scan.fires[a.index()], scan.enabled[b.index()]);
            let name = format!("{} and {} together", transition(machine, a), transition(machine, b));
            self.ask(Question::Together(a, b), name, Property::Never(both));
        }
        for (id, integer) in machine.integers.iter() {
            let beyond = self.view.scan.beyond[id.index()];
            // What no assignment can do is no question.
            if beyond != Lit::FALSE {
                self.ask(Question::Beyond(id), format!("{} saturates", integer.name), Property::Never(beyond));
            }
        }
        for (id, constraint) in machine.safety.constraints.iter() {
            let acted = self.view.scan.acted[id.index()];
            self.ask(Question::Acts(id), format!("{} acts", constraint.name), Property::Never(acted));
        }
    }
}

/// Whether a condition asks for states of charts, of which an unknown program has none.
fn reads_states(machine: &Machine, condition: &Condition) -> bool {
    let mut reads = false;
    condition.for_each_atom(&mut |seen| {
        if let Seen::Machine(Atom::In(s) | Atom::Done(s)) | Seen::PrevIn(s) = *seen {
            reads |= !machine.observes(s);
        }
    });
    reads
}

/// A transition in words.
pub fn transition(machine: &Machine, id: TransitionId) -> String {
    let t = &machine.transitions[id];
    format!("{} to {}", machine.state_path(t.source), machine.state_path(t.target))
}

impl View {
    /// Whether this is a moment at which a property is looked at. What reads hidden values, and what is seen of the
    /// last scan, is looked at after each step of a plant, too; what reads how it came to that, only after scans.
    fn looked(&self, machine: &Machine, condition: &Condition) -> Lit {
        let (mut hidden, mut scans) = (true, false);
        condition.for_each_atom(&mut |&seen| {
            scans |= seen.is_of_scans();
            hidden &= machine.is_hidden(seen);
        });
        match (scans, hidden) {
            (true, _) => self.turn.reading,
            (false, true) => Lit::TRUE,
            (false, false) => self.begun,
        }
    }

    /// A condition at the end of the scan.
    fn holds(&self, aig: &mut Aig, machine: &Machine, condition: &Condition) -> Lit {
        aig.expression(condition, &mut |aig, &seen| match seen {
            Seen::Machine(atom) => self.atom(aig, machine, atom),
            Seen::Bit(b) => self.bits[b.index()],
            Seen::PrevBit(b) => self.past_bits[b.index()],
            Seen::PrevIn(s) => self.past_active[s.index()],
            Seen::Compare(c) => compare_of(aig, &machine.plant.comparisons[c], &|&counted| match counted {
                Counted::Program(i) => self.scan.after.integers[i.index()].clone(),
                Counted::Hidden(c) => self.counts[c.index()].clone(),
            }),
            Seen::Mark(mark) => {
                self.scan.after.marks[match mark {
                    Mark::Noted => 0,
                    Mark::First(c) => 1 + c.index(),
                }]
            }
            Seen::Acted(c) => self.scan.acted[c.index()],
            Seen::Broken(a) => self.scan.broken[a],
        })
    }

    /// The condition of a constraint as it is when the outputs have been decided. Observers may still step after
    /// that.
    fn constraint(&self, aig: &mut Aig, never: &Guard) -> Lit {
        aig.expression(never, &mut |_, &atom| match atom {
            Atom::Output(o) => self.scan.after.outputs[o.index()],
            other => self.scan.readings[&other],
        })
    }

    fn signal(&self, atom: Atom) -> Option<Lit> {
        match atom {
            Atom::Input(i) => Some(self.inputs[i.index()]),
            Atom::PrevInput(i) => Some(self.past_inputs[i.index()]),
            Atom::Output(o) => Some(self.scan.after.outputs[o.index()]),
            Atom::PrevOutput(o) => Some(self.past_outputs[o.index()]),
            Atom::Variable(v) => Some(self.scan.after.variables[v.index()]),
            Atom::Event(e) => Some(self.scan.events[e.index()]),
            Atom::Compare(_) | Atom::In(_) | Atom::Done(_) | Atom::After(..) => None,
        }
    }

    fn atom(&self, aig: &mut Aig, machine: &Machine, atom: Atom) -> Lit {
        let active = &self.scan.after.active;
        match atom {
            Atom::In(s) => active[s.index()],
            Atom::Done(s) => {
                let mut ended = Vec::new();
                for &r in &machine.states[s].regions {
                    let last =
                        machine.regions[r].states.iter().filter(|&&s| machine.states[s].kind == StateKind::Final);
                    let last: BTreeSet<Lit> = last.map(|s| active[s.index()]).collect();
                    ended.push(aig.any(&last.into_iter().collect::<Vec<_>>()));
                }
                aig.all(&ended)
            }
            Atom::After(..) => Lit::FALSE,
            Atom::Compare(c) => compare(aig, &machine.comparisons[c], &self.scan.after.integers),
            other => self.signal(other).expect("it is a signal"),
        }
    }
}
