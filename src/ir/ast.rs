//! The syntax tree of a `.chart` file: what was written, where, and nothing more.
//!
//! Names are unresolved texts with their spans. The grammar, `grammar/chart.pest`, is the reference
//! for what can stand where.

use super::expr::Expr;
use super::number::{Comparison, Number};
pub use super::property::{Acceptance, Accepted, Leads, Property, PropertyKind};
use crate::base::Span;

mod functions;
mod mentions;
mod safety;
mod scenarios;
mod ways;
pub use functions::{Function, Job, Sequence, SequenceDoing, SequenceStep};
pub use mentions::mentions;
pub use safety::{Constraint, Derive, Forbid, Place, Safety, Valve};
pub use scenarios::{Doing, Scenario, Step};
pub use ways::{Branch, Choice, Source, Target};

/// A word with its place: a declared name or one part of a path.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name {
    /// The word as written.
    pub text: String,
    /// Where.
    pub span: Span,
}

/// A text in quotes, unescaped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// What stands between the quotes.
    pub value: String,
    /// Where, quotes included.
    pub span: Span,
}

/// A reference to a state, such as `Preparation.V.Down`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    /// The words between the dots; never empty.
    pub parts: Vec<Name>,
}

impl Path {
    /// From the first word to the last.
    pub fn span(&self) -> Span {
        self.parts[0].span.to(self.parts[self.parts.len() - 1].span)
    }
}

/// A whole file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// `machine NAME`.
    pub name: Name,
    /// The text behind the name.
    pub description: Option<Text>,
    /// `cycle 10ms`, every one that was written.
    pub cycles: Vec<Duration>,
    /// All `inputs { … }` in order.
    pub inputs: Vec<Signal>,
    /// All `outputs { … }` in order.
    pub outputs: Vec<Signal>,
    /// All `variables { … }` in order.
    pub variables: Vec<Variable>,
    /// All `events { … }` in order.
    pub events: Vec<Event>,
    /// All `actuator …` in order.
    pub actuators: Vec<Actuator>,
    /// All `function …` in order.
    pub functions: Vec<Function>,
    /// All `sequence …` in order.
    pub sequences: Vec<Sequence>,
    /// All `observer …` in order.
    pub observers: Vec<Observer>,
    /// All `chart …` in order.
    pub charts: Vec<Chart>,
    /// All `safety …` in order.
    pub safety: Vec<Safety>,
    /// What stands in all `properties { … }`, in order.
    pub properties: Vec<Property>,
    /// The findings that are accepted there.
    pub accepted: Vec<Acceptance>,
    /// All `plant { … }` in order.
    pub plants: Vec<Plant>,
    /// All `scenario …` in order.
    pub scenarios: Vec<Scenario>,
}

/// `H0 at %IX0.0 "horizontal cylinder in"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The signal's name.
    pub name: Name,
    /// The address as written, `%` included.
    pub address: Option<Name>,
    /// What it means.
    pub description: Option<Text>,
}

/// `StopRequest : BOOL := false "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// The variable's name.
    pub name: Name,
    /// What it can hold.
    pub kind: VariableKind,
    /// What it means.
    pub description: Option<Text>,
}

/// `JarPlaced "…"` among events.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// The event's name.
    pub name: Name,
    /// What it means.
    pub description: Option<Text>,
}

/// What a variable can hold, and what it holds before the first scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum VariableKind {
    /// `BOOL := true`; FALSE if not given.
    Bool(bool),
    /// `0..3 := 2`.
    Integer {
        /// The lowest value.
        lowest: i64,
        /// The highest value.
        highest: i64,
        /// The value before the first scan, if it is given, and where.
        initial: Option<(i64, Span)>,
        /// Where the range stands.
        span: Span,
    },
}

/// `actuator Vertical bistable "…" { position … }`, or `actuator Conveyor onoff by CMR "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Actuator {
    /// The actuator's name.
    pub name: Name,
    /// How its outputs act.
    pub technology: Technology,
    /// Where the technology stands.
    pub technology_span: Span,
    /// `valve …` and where its kind stands.
    pub valve: Option<(Valve, Span)>,
    /// `by OUTPUT` of the short form.
    pub by: Option<Name>,
    /// What it is.
    pub description: Option<Text>,
    /// Its positions in order.
    pub positions: Vec<Position>,
}

/// The technology of an actuator (the paper on statecharts, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technology {
    /// Two outputs, one per direction, each TRUE only while moving toward its position.
    Bistable,
    /// One output, TRUE while going to its position and while there; a spring leads back.
    Monostable,
    /// One output, TRUE while on.
    OnOff,
}

/// `position Down output OVC sensor V1 within 2s else set Late "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// The position's name.
    pub name: Name,
    /// The output that leads to it.
    pub output: Option<Name>,
    /// What is TRUE when it is reached.
    pub sensor: Option<Guard>,
    /// `within … else …`.
    pub limit: Option<Limit>,
    /// What it means.
    pub description: Option<Text>,
}

/// `within 2s else set Late`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limit {
    /// How long a movement may take.
    pub time: Duration,
    /// What happens if it takes longer.
    pub effects: Vec<Effect>,
    /// All of it.
    pub span: Span,
}

/// An expression with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guard {
    /// The expression.
    pub expr: Expr<Term>,
    /// As it is written, without comments, on one line; nothing if nobody has written it.
    pub written: String,
    /// Where.
    pub span: Span,
}

/// What an expression may mention.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// The value of something: `H0`, or a path, which cannot be a value but deserves a good message.
    Value(PathRef),
    /// `Layers + 1 < Limit`, and where.
    Compare(Comparison<Name>, Span),
    /// `prev(x)`.
    Prev(PathRef),
    /// `rise(x)`.
    Rise(PathRef),
    /// `fall(x)`.
    Fall(PathRef),
    /// `in(State)`.
    In(PathRef),
    /// `prev(in(State))`.
    PrevIn(PathRef),
    /// `rise(in(State))`.
    RiseIn(PathRef),
    /// `fall(in(State))`.
    FallIn(PathRef),
    /// `done(State)`.
    DoneOf(PathRef),
    /// `done`: the source of this transition.
    Done(Span),
    /// `acts(Constraint)`.
    Acts(PathRef),
    /// `first(Constraint)`.
    First(PathRef),
    /// `blocked`.
    Blocked(Span),
    /// `alarm(Constraint)`.
    Alarm(PathRef),
    /// `after 500ms`: the source of this transition has been active that long.
    After(Duration),
}

/// A time such as `500ms` or `2s`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Duration {
    /// In milliseconds; nothing when it does not fit a `u32`.
    pub milliseconds: Option<u32>,
    /// Where.
    pub span: Span,
}

/// A path inside an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PathRef {
    /// The words between the dots; never empty.
    pub parts: Vec<(String, Span)>,
}

impl PathRef {
    /// From the first word to the last.
    pub fn span(&self) -> Span {
        self.parts[0].1.to(self.parts[self.parts.len() - 1].1)
    }
}

/// `chart NAME "…" { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chart {
    /// The chart's name.
    pub name: Name,
    /// The actuator that its only region controls.
    pub controls: Option<Name>,
    /// What it is.
    pub description: Option<Text>,
    /// What stands between its braces.
    pub body: Body,
}

/// `observer NAME "…" { … after filter { … } }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Observer {
    /// The observer's name.
    pub name: Name,
    /// What it is.
    pub description: Option<Text>,
    /// What stands between its braces.
    pub body: Body,
    /// What stands between the braces of each `after filter`: transitions.
    pub after_filter: Vec<Body>,
}

/// What stands between the braces of a chart, state or region, sorted by kind. Order across kinds
/// means nothing; order within a kind is kept.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Body {
    /// `state …`.
    pub states: Vec<State>,
    /// `region …`, only in parallel states and charts.
    pub regions: Vec<Region>,
    /// `choice …`.
    pub choices: Vec<Choice>,
    /// `from … to …` and `move from … to …`.
    pub transitions: Vec<Transition>,
    /// `drives …`.
    pub drives: Vec<Drive>,
    /// `sets …` and `resets …`.
    pub actions: Vec<Action>,
    /// What stands behind `entry`, all of them in order.
    pub entry: Vec<Effect>,
    /// What stands behind `exit`, all of them in order.
    pub exit: Vec<Effect>,
    /// `internal …`.
    pub internals: Vec<Internal>,
    /// The braces and what is between them.
    pub span: Span,
}

/// `initial final parallel state NAME at POSITION controls ACTUATOR "…" { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// The state's name.
    pub name: Name,
    /// `initial`, where it stands.
    pub initial: Option<Span>,
    /// `final`, where it stands.
    pub is_final: Option<Span>,
    /// `parallel`, where it stands.
    pub parallel: Option<Span>,
    /// `at POSITION`.
    pub position: Option<Name>,
    /// `controls ACTUATOR`: bound to the state's own only region.
    pub controls: Option<Name>,
    /// What it is.
    pub description: Option<Text>,
    /// What stands between its braces, if it has any.
    pub body: Option<Body>,
}

/// `region NAME controls ACTUATOR "…" { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// The region's name.
    pub name: Name,
    /// `controls ACTUATOR`.
    pub controls: Option<Name>,
    /// What it is.
    pub description: Option<Text>,
    /// What stands between its braces.
    pub body: Body,
}

/// `from A to B priority 1 when G then set V "…"`, or with `move` before it and `as NAME` behind B.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transition {
    /// Where it starts.
    pub source: Source,
    /// Where it leads; one state for a movement.
    pub target: Target,
    /// Present for a movement.
    pub movement: Option<Movement>,
    /// `priority N`.
    pub priority: Option<(u32, Span)>,
    /// `when …`.
    pub guard: Option<Guard>,
    /// `then …`.
    pub effects: Vec<Effect>,
    /// Why it is there.
    pub description: Option<Text>,
    /// All of it.
    pub span: Span,
}

/// What makes a transition a movement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Movement {
    /// `move`.
    pub span: Span,
    /// `as NAME`.
    pub name: Option<Name>,
}

/// `internal when G then set V "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Internal {
    /// `when …`.
    pub guard: Guard,
    /// `then …`.
    pub effects: Vec<Effect>,
    /// Why it is there.
    pub description: Option<Text>,
    /// All of it.
    pub span: Span,
}

/// `set V`, `reset V`, `raise E` or `set N := …`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    /// The variable or event.
    pub variable: Name,
    /// What it becomes.
    pub value: EffectValue,
}

/// What a variable or event becomes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EffectValue {
    /// TRUE or FALSE.
    Bool(bool),
    /// Raised.
    Raised,
    /// The value of an expression, and where it stands.
    Integer(Number<Name>, Span),
}

/// `drives OUTPUT when …`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drive {
    /// The output.
    pub output: Name,
    /// Its condition.
    pub condition: Option<Guard>,
}

/// `sets V when …` or `resets V when …`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    /// The variable.
    pub variable: Name,
    /// What it becomes.
    pub value: bool,
    /// Its condition.
    pub condition: Option<Guard>,
}

/// A time: `100ms`, `2s`, `3 scans`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// The number; nothing when it does not fit a `u32`.
    pub value: Option<u32>,
    /// What it counts.
    pub unit: TimeUnit,
    /// The number with its unit.
    pub span: Span,
}

/// What a time counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// `ms`; seconds are turned into these.
    Milliseconds,
    /// `scan` or `scans`.
    Scans,
}

/// `plant { … }`, sorted by kind; the order of rules and of steps is kept.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plant {
    /// `by steps`.
    pub by_steps: Option<Span>,
    /// `hidden NAME "…"`.
    pub hidden: Vec<Hidden>,
    /// What stands in `initially { … }`.
    pub initially: Vec<Step>,
    /// `ACTUATOR travels …`.
    pub travels: Vec<Travel>,
    /// `INPUT follows …`, `INPUT rises when …`, `INPUT falls when …`.
    pub rules: Vec<Rule>,
    /// `step "…" when … then …`.
    pub steps: Vec<Happening>,
}

/// `step "the rod goes out" when O1 and Stroke < 4 then set Stroke := Stroke + 1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Happening {
    /// What happens.
    pub text: Text,
    /// When it may.
    pub condition: Guard,
    /// What comes of it, each with its own condition, if it has one.
    pub outcomes: Vec<(Effect, Option<Guard>)>,
}

/// `hidden Work "a jar stands at the work place"`, `hidden Stroke : 0..4 := 0 "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hidden {
    /// Its name.
    pub name: Name,
    /// Its range and value before the first scan, if it is an integer.
    pub integer: Option<VariableKind>,
    /// What it means when TRUE, or counts.
    pub description: Option<Text>,
}

/// `Vertical travels at most 300ms back 200ms while driven when ENP "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Travel {
    /// The actuator.
    pub actuator: Name,
    /// `at most`: it is never slower.
    pub at_most: bool,
    /// From the first position to the second.
    pub out: Time,
    /// From the second position to the first, if it takes another time.
    pub back: Option<Time>,
    /// `while driven`.
    pub driven: Option<Span>,
    /// `when …`: what it needs to move.
    pub power: Option<Guard>,
    /// Why.
    pub description: Option<Text>,
}

/// `ENP follows KEN after 50ms "…"`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// The input or hidden bit.
    pub target: Name,
    /// What becomes of it.
    pub change: Change,
    /// When.
    pub condition: Guard,
    /// `after …`.
    pub delay: Option<Time>,
    /// Why.
    pub description: Option<Text>,
}

/// What a rule of the plant does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// `follows`: takes the value of the condition.
    Follows,
    /// `rises when`: becomes TRUE when the condition holds.
    Rises,
    /// `falls when`: becomes FALSE when the condition holds.
    Falls,
}
