//! Syntax tree to machine: every name becomes an id, or an error.
//!
//! Gone after it: names as references, `any`, choices, joins, `move` (it is a state of its own with two
//! transitions), `rise` and `fall`, actuators' technology laws (they are drives), the short form of
//! actuators, transitions without a guard.
//!
//! The steps run in this order, each in a file of its own:
//!
//! 0. [`functions`]: functions and sequences become charts
//! 1. [`signals`]: inputs, outputs, variables, events; [`integers`] holds what is said of integers
//! 2. [`actuators`]: positions, outputs and sensors by technology
//! 3. [`states`]: observers, charts, regions and states, movements among them
//! 4. [`targets`]: where regions begin, where transitions lead
//! 5. [`transitions`]: transitions and what they do
//! 6. [`behaviour`]: what states drive, set and reset
//! 7. [`safety`]: constraints and assumptions, split into products
//! 8. [`plant`]: actuators that travel, rules for other inputs; [`hidden`] holds what may happen
//! 9. [`properties`]: what is said of all runs
//! 10. [`scenarios`]: tests of the machine, times in scans

mod accepted;
mod actuators;
mod behaviour;
mod expressions;
mod functions;
mod hidden;
mod integers;
mod names;
mod plant;
mod properties;
mod safety;
mod scenarios;
mod seen;
mod signals;
mod states;
mod targets;
mod transitions;

use crate::base::{Code, Diagnostic, Diagnostics, Id};
use crate::ir::number::Comparison;
use crate::ir::scenario::Condition;
use crate::ir::{ast, chart};
use names::{Braces, Names};
use std::collections::HashMap;

/// Resolves a tree, in which constraints have been derived. The machine is whole only if there is no error
/// among the diagnostics.
///
/// # Panics
///
/// If the tree still asks for constraints to be derived: without them, a machine would be less safe than it
/// is written.
pub fn resolve(tree: &ast::Machine) -> (chart::Machine, Diagnostics) {
    let resolver = resolved(tree);
    (resolver.machine, resolver.diagnostics)
}

/// A condition that stands outside of the tree, as a scenario of it would have it, with the machine to which its
/// ids belong: that of the tree, with the comparisons that the condition brings along. The places of what is
/// said of the condition are those in its own text.
///
/// # Panics
///
/// As [`resolve`] does.
pub fn condition(tree: &ast::Machine, guard: &ast::Guard) -> (chart::Machine, Condition, Diagnostics) {
    let mut resolver = resolved(tree);
    let condition = resolver.condition(guard, &expressions::Context::Expectation);
    (resolver.machine, condition, resolver.diagnostics)
}

/// All that a tree says, resolved.
fn resolved(tree: &ast::Machine) -> Resolver {
    let mut resolver = Resolver {
        machine: chart::Machine {
            name: tree.name.text.clone(),
            description: names::describe(&tree.description),
            ..chart::Machine::default()
        },
        names: Names::default(),
        comparisons: HashMap::new(),
        diagnostics: Diagnostics::new(),
    };
    resolver.legal(&tree.name);
    resolver.cycle(tree);
    let tree = &functions::expand(&mut resolver, tree);
    signals::resolve(&mut resolver, tree);
    actuators::resolve(&mut resolver, tree);
    let (bodies, mut choices) = states::resolve(&mut resolver, tree);
    targets::complete(&mut resolver, &choices);
    targets::begin(&mut resolver, &mut choices);
    transitions::resolve(&mut resolver, &bodies, &mut choices);
    targets::used(&mut resolver, &choices);
    behaviour::resolve(&mut resolver, &bodies);
    safety::resolve(&mut resolver, tree);
    plant::resolve(&mut resolver, tree);
    properties::resolve(&mut resolver, tree);
    accepted::resolve(&mut resolver, tree);
    scenarios::resolve(&mut resolver, tree);
    resolver
}

/// What the steps share.
struct Resolver {
    machine: chart::Machine,
    names: Names,
    /// Which comparisons there are so far; only looked up, never walked.
    comparisons: HashMap<Comparison<chart::IntegerId>, chart::ComparisonId>,
    diagnostics: Diagnostics,
}

/// The braces of a region or state, kept beside what they became, for the steps after the states.
struct ResolvedBody<'a> {
    body: &'a ast::Body,
    /// The region in which its transitions are written.
    region: Id<chart::Region>,
    /// Whether `region` is what the braces hold, so that `any` means its states.
    owns_region: bool,
    /// The state whose braces they are; nothing for a chart or a region.
    state: Option<Id<chart::State>>,
    /// When its transitions are tried.
    phase: chart::Phase,
    /// The movements written here, by index of their transition.
    movements: Vec<(usize, Id<chart::State>)>,
}

impl ResolvedBody<'_> {
    /// Where names of states in it are looked up first.
    fn braces(&self) -> Braces {
        match self.state {
            Some(state) if !self.body.regions.is_empty() => Braces::Parallel(state),
            _ => Braces::Region(self.region),
        }
    }
}

/// Cycle time of a model that does not give one, in milliseconds.
const DEFAULT_CYCLE: u32 = 10;

/// Longest cycle time, in milliseconds: one hour.
const LONGEST_CYCLE: u32 = 3_600_000;

/// Longest time that a state can wait for, in milliseconds: one day. PLCs count TIME in 32 bits.
const LONGEST_TIME: u32 = 86_400_000;

impl Resolver {
    fn cycle(&mut self, tree: &ast::Machine) {
        self.machine.cycle = DEFAULT_CYCLE;
        for (i, cycle) in tree.cycles.iter().enumerate() {
            if i > 0 {
                self.diagnostics.push(
                    Diagnostic::new(Code::Repeated, "the cycle time is given more than once")
                        .label(cycle.span, "given again")
                        .label(tree.cycles[0].span, "first given here"),
                );
            }
            match cycle.milliseconds {
                Some(ms @ 1..=LONGEST_CYCLE) => self.machine.cycle = ms,
                _ => self.diagnostics.push(
                    Diagnostic::new(Code::BadTime, "a cycle takes from 1 ms to one hour")
                        .label(cycle.span, "out of range"),
                ),
            }
        }
    }
}
