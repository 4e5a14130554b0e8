//! The plant and the scenarios of a machine: how its parts react, and what is expected of it.
//!
//! The program knows nothing of either. All times are in scans of the machine's cycle.
//!
//! # What a plant means, scan by scan
//!
//! A scan has two phases: the plant moves under the outputs that were written in the scan before, then
//! the program runs and writes outputs. Before the program's scan,
//!
//! 1. each [`Travel`] takes one step, and its sensors follow from where it is;
//! 2. the [`Rule`]s are tried in the order in which they are written. A rule whose condition holds
//!    while its target has another value counts; when its condition has held for [`Rule::delay`] scans
//!    more, the target changes. In all other cases its count begins anew.
//!
//! Conditions read outputs as they stand at the terminals, and inputs and hidden bits as they are at
//! that moment: what rules further down will change still has its value of the scan before.
//! [`Atom::PrevInput`] is what the program saw in the scan before, [`Atom::PrevOutput`] what stood at the
//! terminals a scan before. In the first scan nothing travels: the plant stands as [`Plant::initially`]
//! and [`Plant::places`] say, with all outputs FALSE, and the rules are tried; what they read has no other past than
//! itself then, and no edge.
//!
//! A scenario that forces an input holds its value, whatever the plant does; its rules rest meanwhile.
//!
//! # By steps
//!
//! A plant that goes [by steps](Plant::by_steps) has a life between readings of the inputs. A [`Happening`] whose condition holds
//! may happen, at any moment and any number of times, one at a time: between the reading of the inputs
//! and the writing of the outputs still under the old outputs, then under the new ones. Each is a
//! step of its own: it reads hidden values as they are before it. When the outputs are written, those rules are tried that are
//! [of a valve](Rule::is_of_valve). When the inputs are read, all other rules are, as above.
//!
//! A run by a scenario is the one in which, between writing and reading, each happening happens once whose condition holds after
//! the writing and still does when its turn comes, in the order in which they are written; in the first scan none does. In a
//! scenario that [tells](Scenario::tells) what happens, that happens and nothing else. What is always or never so
//! is looked at after each reading, writing and happening; what reads how it came to that, only after readings. Verification covers all courses; there an actuator that
//! travels takes its way step by step among the happenings.

use super::chart::{
    ActuatorId, Atom, ConstraintId, EventId, InputId, IntegerId, Machine, Mark, OutputId, StateId, TransitionId,
    VariableId,
};
use super::expr::Expr;
use super::number::{Comparison, Number, Range};
use crate::base::{Arena, Id, Span};

pub use super::ast::PropertyKind;

/// Names a hidden bit.
pub type BitId = Id<Bit>;

/// Names a hidden integer.
pub type CountId = Id<Count>;

/// Names a comparison that reads hidden integers.
pub type ComparedId = Id<Comparison<Counted>>;

/// How the machine's parts react.
#[derive(Clone, Debug, Default)]
pub struct Plant {
    /// What no sensor tells, in order of declaration.
    pub bits: Arena<Bit>,
    /// Hidden integers, in order of declaration.
    pub counts: Arena<Count>,
    /// What conditions ask of hidden integers, each comparison once.
    pub comparisons: Arena<Comparison<Counted>>,
    /// Whether it moves at any time, and not once before each reading of the inputs.
    pub by_steps: bool,
    /// What may happen, in order.
    pub happenings: Vec<Happening>,
    /// The bits of which nobody knows the value to begin with.
    pub unknown: Vec<BitId>,
    /// The inputs and bits that are given a value to begin with; all others are FALSE.
    pub initially: Vec<(Given, bool)>,
    /// The positions, by index, at which actuators begin; all others begin at their first.
    pub places: Vec<(ActuatorId, usize)>,
    /// Actuators that move, each once.
    pub travels: Vec<Travel>,
    /// The rules for other inputs and for bits, in order.
    pub rules: Vec<Rule>,
}

/// Something that no sensor tells.
#[derive(Clone, Debug)]
pub struct Bit {
    /// Its name, unique among signals.
    pub name: String,
    /// What it means when TRUE.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// A number that no sensor tells.
#[derive(Clone, Debug)]
pub struct Count {
    /// Its name, unique among signals.
    pub name: String,
    /// What it can be; within the type INT.
    pub range: Range,
    /// Its value before the first scan; within the range.
    pub initial: i64,
    /// What it counts.
    pub description: String,
    /// Where it is declared.
    pub span: Span,
}

/// An integer that a scenario or property can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Counted {
    /// One of the program.
    Program(IntegerId),
    /// A hidden one.
    Hidden(CountId),
}

/// Something that may happen in a plant that goes by steps.
#[derive(Clone, Debug)]
pub struct Happening {
    /// What happens, in words.
    pub text: String,
    /// When it may.
    pub condition: Condition,
    /// What comes of it, in order; of several that change the same thing the last one counts whose condition
    /// holds. All conditions and values are read from before the step.
    pub outcomes: Vec<Outcome>,
    /// Where it is written.
    pub span: Span,
}

/// Something that comes of a happening.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What changes.
    pub change: Alteration,
    /// When.
    pub condition: Condition,
}

/// A change of something hidden.
#[derive(Clone, Debug)]
pub enum Alteration {
    /// A bit becomes TRUE or FALSE.
    Bit(BitId, bool),
    /// An integer takes a value; what would leave its range stops at the bound.
    Count(CountId, Number<CountId>),
}

/// What a plant or a scenario gives values to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Given {
    /// An input of the program.
    Input(InputId),
    /// A hidden bit.
    Bit(BitId),
}

/// An actuator that moves between its two positions.
#[derive(Clone, Debug)]
pub struct Travel {
    /// The actuator.
    pub actuator: ActuatorId,
    /// What its outputs do.
    pub valve: Valve,
    /// Whether it is known never to take longer, as long as it is ordered there and has what it needs.
    pub at_most: bool,
    /// Scans from the first position to the second; at least one.
    pub out: u32,
    /// Scans from the second position to the first; at least one.
    pub back: u32,
    /// What it needs to move; a spring works without.
    pub power: Condition,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Where it is written.
    pub span: Span,
}

/// What the outputs of an actuator that travels do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Valve {
    /// The last order of one output alone goes on: a valve with two coils.
    Keeps,
    /// It moves while one output alone is TRUE, else it stands: a valve with closed centre, a motor.
    WhileDriven,
    /// To the second position while the output is TRUE, else back to the first.
    Spring,
}

/// An input that says where an actuator is.
#[derive(Clone, Copy, Debug)]
pub struct Sensor {
    /// The input.
    pub input: InputId,
    /// The position that it confirms, by index.
    pub position: usize,
    /// Its value there; elsewhere it has the other one.
    pub there: bool,
}

/// An input or bit that changes when a condition has held for a while.
#[derive(Clone, Debug)]
pub struct Rule {
    /// What changes.
    pub target: Given,
    /// What it becomes.
    pub value: bool,
    /// When.
    pub condition: Condition,
    /// For how many scans after the first one the condition has to hold.
    pub delay: u32,
    /// Where it is written.
    pub span: Span,
}

/// A Boolean expression over all that can be seen from outside.
pub type Condition = Expr<Seen>;

/// What a condition of a plant or scenario can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Seen {
    /// What the machine reads, too. In scenarios it is read at the end of a scan; [`Atom::Output`] is
    /// what the filter has decided.
    Machine(Atom),
    /// A hidden bit.
    Bit(BitId),
    /// A hidden bit in the scan before.
    PrevBit(BitId),
    /// Whether the state was active at the end of the scan before; FALSE in the first scan. The program does not know.
    PrevIn(StateId),
    /// Whether a comparison of hidden integers holds.
    Compare(ComparedId),
    /// Whether the constraint had to act in this scan.
    Acted(ConstraintId),
    /// What the filter remembers.
    Mark(Mark),
    /// Whether the assumption of that index was broken in this scan.
    Broken(usize),
}

/// Something that is said of all runs of the machine, in its plant.
#[derive(Clone, Debug)]
pub struct Property {
    /// Its name, unique among properties.
    pub name: String,
    /// In which runs and how often.
    pub kind: PropertyKind,
    /// After what, if it says so.
    pub after: Option<Condition>,
    /// What, at the end of a scan.
    pub condition: Condition,
    /// All that it says, as it is written.
    pub says: String,
    /// The condition, as it is written.
    pub written: String,
    /// Why, in words.
    pub text: String,
    /// Where its name stands.
    pub span: Span,
}

/// A finding of verification that is meant so.
#[derive(Clone, Debug)]
pub struct Acceptance {
    /// Which.
    pub finding: Accepted,
    /// How a model says it, without the reason.
    pub written: String,
    /// Why it is meant so.
    pub reason: String,
    /// Where it is written.
    pub span: Span,
}

/// A finding by what it speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepted {
    /// The state is never active.
    Unreachable(StateId),
    /// The transition never fires.
    Silent(TransitionId),
    /// Only the order of the two decides; the one that is written first comes first.
    Overlap(TransitionId, TransitionId),
    /// The integer stops at a bound.
    Saturates(IntegerId),
    /// The filter acts for the constraint.
    Acts(ConstraintId),
    /// The property of that index says nothing.
    Void(usize),
}

/// A warning that is meant so.
#[derive(Clone, Debug)]
pub struct Excuse {
    /// Which.
    pub warning: Excused,
    /// How a model says it, without the reason.
    pub written: String,
    /// Why it is meant so.
    pub reason: String,
    /// Where it is written.
    pub span: Span,
}

/// A warning by what it speaks of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Excused {
    /// What is declared is not used in one of the ways in which it could be, or the output is never driven.
    Unused(Declared),
    /// The reliefs of these constraints, and of no others, set each other off; in order of declaration.
    Cyclic(Vec<ConstraintId>),
}

/// Something that the program declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declared {
    /// An input.
    Input(InputId),
    /// An output.
    Output(OutputId),
    /// A variable of type BOOL.
    Variable(VariableId),
    /// An event.
    Event(EventId),
    /// An integer.
    Integer(IntegerId),
}

/// A test of the machine.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name, unique in the machine.
    pub name: String,
    /// The scenario that is played before, by index.
    pub after: Option<usize>,
    /// What is done, in order.
    pub steps: Vec<Step>,
    /// Its name, where it is declared.
    pub span: Span,
}

/// One line of a scenario.
#[derive(Clone, Debug)]
pub struct Step {
    /// What is done.
    pub doing: Doing,
    /// Why, in the words of the model.
    pub text: String,
    /// Where it is written.
    pub span: Span,
}

/// Something that a scenario lets happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    /// Which of the plant's happenings, by index.
    pub happening: usize,
    /// Whether it happens before the outputs of the last scan are written, and not after that.
    pub before_writing: bool,
}

/// What a line of a scenario does. Only `Press`, `Wait` and `Until` let scans run.
#[derive(Clone, Debug)]
pub enum Doing {
    /// Gives values from the next scan on.
    Set(Vec<(Given, bool)>),
    /// Runs scans with these inputs TRUE; they are FALSE in the scan before and from the next one on.
    Press(Vec<Given>, u32),
    /// Holds inputs at values, whatever the plant does.
    Force(Vec<(InputId, bool)>),
    /// Holds them no more.
    Release(Vec<InputId>),
    /// Puts an actuator at a position.
    Place(ActuatorId, usize),
    /// Lets something happen, or nothing; what happens in the plant does so only when told.
    Happens(Option<Told>),
    /// Runs scans.
    Wait(u32),
    /// Runs one scan and more until the condition holds; it has to within that many.
    Until(Condition, u32),
    /// The condition has to hold after the last scan.
    Expect(Condition),
    /// From the next scan to the end of the scenario the condition has to have this value.
    Watch(Condition, bool),
    /// All that several times.
    Repeat(u32, Vec<Step>),
}

impl Scenario {
    /// Whether it tells what happens in the plant, so that nothing does by itself.
    pub fn tells(&self) -> bool {
        fn tell(steps: &[Step]) -> bool {
            steps.iter().any(|step| match &step.doing {
                Doing::Happens(_) => true,
                Doing::Repeat(_, inner) => tell(inner),
                Doing::Set(_)
                | Doing::Press(..)
                | Doing::Force(_)
                | Doing::Release(_)
                | Doing::Place(..)
                | Doing::Wait(_)
                | Doing::Until(..)
                | Doing::Expect(_)
                | Doing::Watch(..) => false,
            })
        }
        tell(&self.steps)
    }
}

impl Plant {
    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        let nothing = self.bits.is_empty() && self.counts.is_empty() && self.happenings.is_empty();
        nothing && self.initially.is_empty() && self.travels.is_empty() && self.rules.is_empty()
    }

    /// For each input, whether the plant gives its value.
    pub fn gives(&self, inputs: usize) -> Vec<bool> {
        let mut gives = vec![false; inputs];
        for sensor in self.travels.iter().flat_map(|t| &t.sensors) {
            gives[sensor.input.index()] = true;
        }
        for rule in &self.rules {
            if let Given::Input(input) = rule.target {
                gives[input.index()] = true;
            }
        }
        gives
    }
}

impl Rule {
    /// Whether it says how a valve follows its outputs: what changes is a hidden bit, at once, and
    /// the condition reads nothing but outputs. In a plant that goes by steps this happens when they are written.
    pub fn is_of_valve(&self) -> bool {
        let (mut reads, mut only) = (false, true);
        self.condition.for_each_atom(&mut |seen| {
            reads = true;
            only &= matches!(seen, Seen::Machine(Atom::Output(_)));
        });
        matches!(self.target, Given::Bit(_)) && self.delay == 0 && reads && only
    }
}

impl Comparison<Counted> {
    /// Whether it reads hidden integers only.
    pub fn is_hidden(&self) -> bool {
        let mut hidden = true;
        let mut look = |c: &Counted| hidden &= matches!(c, Counted::Hidden(_));
        self.left.for_each_value(&mut look);
        self.right.for_each_value(&mut look);
        hidden
    }
}

impl Seen {
    /// Whether it is of the scan before.
    pub fn is_past(self) -> bool {
        matches!(self, Seen::PrevBit(_) | Seen::PrevIn(_) | Seen::Machine(Atom::PrevInput(_) | Atom::PrevOutput(_)))
    }

    /// Whether it has a meaning in scans only, and none at a moment between two of them.
    pub fn is_of_scans(self) -> bool {
        self.is_past() || matches!(self, Seen::Machine(Atom::Event(_)) | Seen::Acted(_) | Seen::Broken(_))
    }
}

impl Machine {
    /// Whether it is of the plant alone, and changes between scans.
    pub fn is_hidden(&self, seen: Seen) -> bool {
        match seen {
            Seen::Bit(_) => true,
            Seen::Compare(c) => self.plant.comparisons[c].is_hidden(),
            Seen::Machine(_)
            | Seen::PrevBit(_)
            | Seen::PrevIn(_)
            | Seen::Mark(_)
            | Seen::Acted(_)
            | Seen::Broken(_) => false,
        }
    }

    /// What an input or hidden bit is called.
    pub fn given(&self, given: Given) -> &str {
        match given {
            Given::Input(i) => &self.inputs[i].name,
            Given::Bit(b) => &self.plant.bits[b].name,
        }
    }

    /// What a condition reads, as a model writes it.
    pub fn seen(&self, seen: Seen) -> String {
        match seen {
            Seen::Machine(atom) => self.atom(atom),
            Seen::Bit(b) => self.plant.bits[b].name.clone(),
            Seen::PrevBit(b) => format!("prev({})", self.plant.bits[b].name),
            Seen::PrevIn(s) => format!("prev(in({}))", self.state_path(s)),
            Seen::Compare(c) => {
                let mut out = String::new();
                let comparison = &self.plant.comparisons[c];
                let written = comparison.write(&mut out, &mut |&i, f| f.write_str(self.counted(i)));
                written.expect("writing to a string succeeds");
                out
            }
            Seen::Acted(c) => {
                let word = if self.safety.alarms() { "alarm" } else { "acts" };
                format!("{word}({})", self.safety.constraints[c].name)
            }
            Seen::Mark(mark) => self.mark(mark),
            Seen::Broken(a) => format!("alarm({})", self.safety.assumptions[a].name),
        }
    }

    /// What an integer is called.
    pub fn counted(&self, counted: Counted) -> &str {
        match counted {
            Counted::Program(i) => &self.integers[i].name,
            Counted::Hidden(c) => &self.plant.counts[c].name,
        }
    }
}
