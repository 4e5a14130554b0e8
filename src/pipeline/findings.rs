//! Answers to what was found, each in words that no other answer has and with the lines of which they speak.
//!
//! A sentence says what is so, never what one hopes for; what nobody knows ends in a question mark.

use super::run::Run;
use super::verify::{Answer, Question, Status};
use crate::base::{LineIndex, Span};
use crate::ir::chart::{ConstraintId, Machine, TransitionId};
use crate::ir::number::Range;
use crate::ir::scenario::{Acceptance, PropertyKind};
use crate::verify::Limit;

/// Values of an integer that are worth a word where they are gone through.
const WIDE: u64 = 256;

/// Something of a model of which an answer speaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// What it is called.
    pub name: String,
    /// Where it stands.
    pub span: Span,
}

/// Says what was found.
pub struct Findings<'m> {
    machine: &'m Machine,
    lines: LineIndex,
}

impl<'m> Findings<'m> {
    /// About the machine that this text describes.
    pub fn new(machine: &'m Machine, source: &str) -> Findings<'m> {
        Findings { machine, lines: LineIndex::new(source) }
    }

    /// What is so, or what nobody knows.
    pub fn sentence(&self, answer: &Answer) -> String {
        let when = answer.run.as_ref().map(when).unwrap_or_default();
        match answer.status {
            Status::Holds => self.fine(answer.question, &when),
            Status::Violated => self.wrong(answer.question, answer.run.as_ref(), &when),
            Status::Unknown(limit) => format!("{} ({limit})", self.open(answer.question)),
        }
    }

    /// What a run shows that answers a question.
    pub fn shown(&self, question: Question, run: &Run) -> String {
        match question.hopes_for_a_run(self.machine) {
            true => self.fine(question, &when(run)),
            false => self.wrong(question, Some(run), &when(run)),
        }
    }

    /// What is so where the answer is the one that one hopes for.
    fn fine(&self, question: Question, when: &str) -> String {
        let machine = self.machine;
        match question {
            Question::Declared(i) if machine.properties[i].kind == PropertyKind::Reachable => {
                format!("{}; the condition is TRUE{when}", self.property(i))
            }
            Question::Declared(i) => self.property(i),
            Question::Arises(i) => {
                let happens = match &machine.properties[i].after {
                    Some(_) => "what it waits for happens in a fair run",
                    None => "there is a fair run",
                };
                format!("says something: {}; {happens}", self.property(i))
            }
            Question::Violated(c) => format!("{}; no outputs violate it", self.constraint(c)),
            Question::Assumable => format!("{} leave inputs in every scan", self.assumptions()),
            Question::Moves => "it is always possible that some transition fires sooner or later".to_owned(),
            Question::Active(_) => format!("active{when}: {}", self.all(question)),
            Question::Fires(_) => format!("fires{when}: {}", self.all(question)),
            Question::Together(..) => format!("their order never decides: {}", self.all(question)),
            Question::Beyond(i) => format!("never assigned beyond {}: {}", self.range(i), self.all(question)),
            Question::Acts(c) => format!("the filter never acts for {}", self.constraint_name(c)),
        }
    }

    /// What is so where it is the opposite.
    fn wrong(&self, question: Question, run: Option<&Run>, when: &str) -> String {
        let machine = self.machine;
        let nothing = run.is_some_and(Run::is_empty);
        match question {
            Question::Declared(i) => format!("{}; {}", self.property(i), self.broken(i, run, when)),
            Question::Arises(i) => {
                let never = match &machine.properties[i].after {
                    Some(_) => "what it waits for happens in no fair run",
                    None => "there is no fair run",
                };
                format!("says nothing: {}; {never}", self.property(i))
            }
            Question::Violated(c) => format!("{}; the outputs violate it{when}", self.constraint(c)),
            Question::Assumable if nothing => format!("{} leave no inputs from the beginning", self.assumptions()),
            Question::Assumable => {
                format!("{} can leave no inputs: a run that ends{when} cannot go on", self.assumptions())
            }
            Question::Moves if nothing => "no transition can ever fire".to_owned(),
            Question::Moves => format!("no transition can fire any more: a run comes to that{when}"),
            Question::Active(_) => format!("never active: {}", self.all(question)),
            Question::Fires(_) => format!("never fires: {}", self.all(question)),
            Question::Together(a, _) if machine.transitions[a].internal => {
                format!("both happen{when}: {}; the last one decides what both write", self.all(question))
            }
            Question::Together(..) => {
                format!("both enabled{when}: {}; the first one fires", self.all(question))
            }
            Question::Beyond(i) => {
                let (range, integer) = (self.range(i), self.all(question));
                format!("assigned beyond {range}{when}: {integer}; it stops at the bound")
            }
            Question::Acts(c) => format!("the filter acts for {}{when}", self.constraint_name(c)),
        }
    }

    /// How a property is violated.
    fn broken(&self, property: usize, run: Option<&Run>, when: &str) -> String {
        match (self.machine.properties[property].kind, run) {
            (PropertyKind::Never, _) => format!("the condition is TRUE{when}"),
            (PropertyKind::Always, _) => format!("the condition is FALSE{when}"),
            (PropertyKind::Reachable, _) => "the condition is TRUE in no run".to_owned(),
            (PropertyKind::AlwaysPossible, Some(run)) if run.is_empty() => "it is never possible".to_owned(),
            (PropertyKind::AlwaysPossible, _) => format!("it can become impossible: a run comes to that{when}"),
            (PropertyKind::Eventually | PropertyKind::Fair, Some(Run { repeats: Some(begin), frames, .. })) => {
                match frames.len() {
                    last if last == *begin => {
                        format!("it need not come: scan {last} of a run can repeat itself for ever")
                    }
                    last => {
                        format!("it need not come: scans {begin} to {last} of a run can repeat themselves for ever")
                    }
                }
            }
            (PropertyKind::Eventually | PropertyKind::Fair, _) => "it need not come".to_owned(),
        }
    }

    /// What nobody knows.
    fn open(&self, question: Question) -> String {
        match question {
            Question::Declared(i) => format!("{}; is that so?", self.property(i)),
            Question::Arises(i) => format!("{}; does it say anything?", self.property(i)),
            Question::Violated(c) => format!("{}; do outputs violate it?", self.constraint(c)),
            Question::Assumable => format!("do {} leave inputs in every scan?", self.assumptions()),
            Question::Moves => "is it always possible that some transition fires sooner or later?".to_owned(),
            Question::Active(_) => format!("is it ever active: {}?", self.all(question)),
            Question::Fires(_) => format!("does it ever fire: {}?", self.all(question)),
            Question::Together(..) => format!("does their order ever decide: {}?", self.all(question)),
            Question::Beyond(i) => format!("is it ever assigned beyond {}: {}?", self.range(i), self.all(question)),
            Question::Acts(c) => format!("does the filter ever act for {}?", self.constraint_name(c)),
        }
    }

    /// The hint for an open answer.
    pub fn help(&self, answer: &Answer) -> Option<String> {
        match answer.status {
            Status::Unknown(limit) => self.hint(limit, answer.question),
            Status::Holds | Status::Violated => None,
        }
    }

    /// The hint for an answer that is open because of that limit.
    pub fn hint(&self, limit: Limit, question: Question) -> Option<String> {
        let mut hints = vec![match limit {
            Limit::Stopped => "where the time was up: `--time` gives more of it",
            Limit::Unshown => "where there is a run that is not shown: it is with more `--time`",
            Limit::Interrupted => "what was interrupted goes on for `--time` if it is let",
            Limit::Nodes => "where memory is short: `--memory` allows more of it",
            Limit::Steps => "where there are too many situations: `--engine exact` goes on until the time is up",
            Limit::Scans => "where nothing was found in the first scans: `--scans` looks further ahead",
            Limit::Conflicts | Limit::Plans => {
                "where no proof was found: `--engine exact` goes through all situations, with more `--time` and `--memory`"
            }
            Limit::Kind => "where another engine would tell: `--engine auto` takes each where it is best",
            // Who reads the reason is asked for something else.
            Limit::Replay | Limit::Certificate => return None,
        }
        .to_owned()];
        if question.hopes_for_a_run(self.machine) {
            hints.push("a scenario that comes there shows that it can".to_owned());
        }
        let wide = self.machine.integers.ids().filter(|&i| values(self.machine.integers[i].range) >= WIDE);
        let wide: Vec<String> = wide.map(|i| self.all(Question::Beyond(i))).collect();
        match &wide[..] {
            [] => {}
            [one] => hints.push(format!("{one} has a wide range, and a smaller one is gone through sooner")),
            [first, .., last] => {
                hints.push(format!(
                    "integers from {first} to {last} have wide ranges, and smaller ones are gone through sooner"
                ));
            }
        }
        Some(hints.join("; "))
    }

    /// The things of which a question speaks.
    pub fn places(&self, question: Question) -> Vec<Place> {
        let machine = self.machine;
        let place = |name: &str, span: Span| Place { name: name.to_owned(), span };
        let of = |t: TransitionId| Place { name: transition(machine, t), span: machine.transitions[t].span };
        match question {
            Question::Declared(i) | Question::Arises(i) => {
                vec![place(&machine.properties[i].name, machine.properties[i].span)]
            }
            Question::Violated(c) | Question::Acts(c) => {
                vec![place(&machine.safety.constraints[c].name, machine.safety.constraints[c].span)]
            }
            Question::Assumable => machine.safety.assumptions.iter().map(|a| place(&a.name, a.span)).collect(),
            Question::Moves => Vec::new(),
            Question::Active(s) => vec![place(&machine.state_path(s), machine.states[s].span)],
            Question::Fires(t) => vec![of(t)],
            Question::Together(a, b) => vec![of(a), of(b)],
            Question::Beyond(i) => vec![place(&machine.integers[i].name, machine.integers[i].span)],
        }
    }

    /// The things of which a question speaks, each with its line.
    fn all(&self, question: Question) -> String {
        let places: Vec<String> =
            self.places(question).iter().map(|p| format!("{} ({})", p.name, self.at(p))).collect();
        places.join(" and ")
    }

    /// Where something stands; the column, too, where another transition of that name begins on the same line.
    fn at(&self, place: &Place) -> String {
        let (line, column) = self.lines.position(place.span.start);
        let twin = |id: TransitionId| {
            let span = self.machine.transitions[id].span;
            span.start != place.span.start && self.line(span) == line && transition(self.machine, id) == place.name
        };
        if self.machine.transitions.ids().any(twin) {
            format!("line {line}, column {column}")
        } else {
            format!("line {line}")
        }
    }

    fn line(&self, span: Span) -> usize {
        self.lines.position(span.start).0
    }

    /// An accepted finding, with its line.
    pub fn acceptance(&self, acceptance: &Acceptance) -> String {
        format!("{} (line {})", acceptance.written, self.line(acceptance.span))
    }

    /// A property by its name and line, and what it says as it is written.
    pub fn property(&self, property: usize) -> String {
        let p = &self.machine.properties[property];
        format!("{} (line {}): {}", p.name, self.line(p.span), p.says)
    }

    /// A constraint by its name and line, and what must never be, as it is written.
    fn constraint(&self, constraint: ConstraintId) -> String {
        let says = &self.machine.safety.constraints[constraint].written;
        format!("{}: never {says}", self.constraint_name(constraint))
    }

    /// A constraint by its name and line, with what it is derived from.
    pub fn constraint_name(&self, constraint: ConstraintId) -> String {
        let c = &self.machine.safety.constraints[constraint];
        let from: Vec<String> =
            c.from.iter().map(|(name, span)| format!("{name} in line {}", self.line(*span))).collect();
        let derived = if from.is_empty() { String::new() } else { format!(", derived from {}", from.join(" and ")) };
        format!("{} (line {}{derived})", c.name, self.line(c.span))
    }

    fn assumptions(&self) -> String {
        let mut lines: Vec<usize> = self.machine.safety.assumptions.iter().map(|a| self.line(a.span)).collect();
        lines.dedup();
        let word = if lines.len() == 1 { "line" } else { "lines" };
        let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
        format!("the assumptions ({word} {})", lines.join(", "))
    }

    fn range(&self, integer: crate::ir::chart::IntegerId) -> String {
        let Range { lowest, highest } = self.machine.integers[integer].range;
        format!("{lowest}..{highest}")
    }
}

/// How many values there are.
fn values(Range { lowest, highest }: Range) -> u64 {
    highest.abs_diff(lowest) + 1
}

/// When a run shows something.
fn when(run: &Run) -> String {
    match (run.is_empty(), run.shortest) {
        (true, _) => " from the beginning".to_owned(),
        (false, true) => format!(" {}", run.end()),
        (false, false) => format!(" {}, perhaps sooner", run.end()),
    }
}

/// A transition in words: those that lead from one state to another in several ways through choices are told apart by number.
pub fn transition(machine: &Machine, id: TransitionId) -> String {
    let t = &machine.transitions[id];
    if t.internal {
        return format!("internal of {}", machine.state_path(t.source));
    }
    let same = machine.transitions.iter().filter(|(other, o)| {
        let ends = o.source == t.source && o.target == t.target && o.inside == t.inside;
        ends && o.span == t.span && !o.internal && machine.transitions[*other].scope == t.scope
    });
    let same: Vec<TransitionId> = same.map(|(other, _)| other).collect();
    let words = format!("{} to {}", machine.state_path(t.source), machine.destination(id));
    match same.iter().position(|&other| other == id) {
        Some(way) if same.len() > 1 => format!("{words} by way {} of {}", way + 1, same.len()),
        _ => words,
    }
}

/// What a run shows that answers a question, in words without a time.
pub(super) fn headline(machine: &Machine, question: Question) -> String {
    let property = |i: usize| format!("{}: {}", machine.properties[i].name, machine.properties[i].says);
    match question {
        Question::Declared(i) if machine.properties[i].kind == PropertyKind::Reachable => property(i),
        Question::Declared(i) => format!("violates {}", property(i)),
        Question::Arises(i) => format!("{} says something", machine.properties[i].name),
        Question::Violated(c) => {
            let c = &machine.safety.constraints[c];
            format!("violates {}: never {}", c.name, c.written)
        }
        Question::Assumable => "no inputs keep the assumptions any more".to_owned(),
        Question::Moves => "no transition can fire any more".to_owned(),
        Question::Active(s) => format!("active: {}", machine.state_path(s)),
        Question::Fires(t) => format!("fires: {}", transition(machine, t)),
        Question::Together(a, b) => {
            format!("both enabled: {} and {}", transition(machine, a), transition(machine, b))
        }
        Question::Beyond(i) => format!("assigned beyond its range: {}", machine.integers[i].name),
        Question::Acts(c) => format!("the filter acts for {}", machine.safety.constraints[c].name),
    }
}

/// Each of these hints once, in the order in which they first come.
pub fn once(hints: impl Iterator<Item = String>) -> Vec<String> {
    let mut all = Vec::new();
    for hint in hints {
        if !all.contains(&hint) {
            all.push(hint);
        }
    }
    all
}
