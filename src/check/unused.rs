//! What is declared is used.

use super::excuses::Excuses;
use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Atom, Deeds, Guard, Machine};
use crate::ir::expr::Expr;
use crate::ir::scenario::{Declared, Excused};

pub fn check(machine: &Machine, excuses: &mut Excuses<'_>, found: &mut Diagnostics) {
    let mut inputs = vec![false; machine.inputs.len()];
    let mut read = vec![false; machine.variables.len()];
    let mut written = vec![false; machine.variables.len()];
    let mut heard = vec![false; machine.events.len()];
    let mut raised = vec![false; machine.events.len()];
    let mut compared = vec![false; machine.comparisons.len()];
    let mut driven = vec![false; machine.outputs.len()];
    let mut look = |guard: &Guard| {
        guard.for_each_atom(&mut |atom| match *atom {
            Atom::Input(i) | Atom::PrevInput(i) => inputs[i.index()] = true,
            Atom::Variable(v) => read[v.index()] = true,
            Atom::Event(e) => heard[e.index()] = true,
            Atom::Compare(c) => compared[c.index()] = true,
            Atom::Output(_) | Atom::PrevOutput(_) | Atom::In(_) | Atom::Done(_) | Atom::After(..) => {}
        });
    };
    let mut write = |deeds: &Deeds| {
        deeds.effects.iter().for_each(|e| written[e.variable.index()] = true);
        deeds.raises.iter().for_each(|e| raised[e.index()] = true);
    };
    for t in machine.transitions.values() {
        look(&t.guard);
        write(&t.deeds);
    }
    machine.regions.values().flat_map(|r| &r.entries).for_each(|(g, _)| look(g));
    machine.states.values().flat_map(|s| [&s.entry, &s.exit]).for_each(write);
    for state in machine.states.values() {
        for d in &state.drives {
            look(&d.condition);
            driven[d.output.index()] = true;
        }
        for a in &state.actions {
            look(&a.condition);
            written[a.variable.index()] = true;
        }
    }
    machine.safety.constraints.values().for_each(|c| look(&c.never));
    machine.safety.reset.into_iter().for_each(|i| look(&Expr::Atom(Atom::Input(i))));
    machine.safety.assumptions.iter().for_each(|a| look(&a.never));
    machine.actuators.values().flat_map(|a| &a.positions).filter_map(|p| p.sensor.as_ref()).for_each(look);

    for (id, input) in machine.inputs.iter() {
        if !inputs[id.index()] {
            let d = Diagnostic::new(Code::NeverUsed, format!("the input `{}` is never read", input.name))
                .label(input.span, "declared here");
            excuses.warn(&Excused::Unused(Declared::Input(id)), d, found);
        }
    }
    // What a function brings along stands nowhere in the text, and may be for people only.
    let written_out = |name: &str, span: Span| span.range().len() == name.len();
    for (id, variable) in machine.variables.iter().filter(|(_, v)| written_out(&v.name, v.span)) {
        let problem = match (read[id.index()], written[id.index()]) {
            (true, true) => continue,
            (false, _) => "never read",
            (true, false) => "never set or reset",
        };
        let d = Diagnostic::new(Code::NeverUsed, format!("the variable `{}` is {problem}", variable.name))
            .label(variable.span, "declared here");
        excuses.warn(&Excused::Unused(Declared::Variable(id)), d, found);
    }
    for (id, event) in machine.events.iter().filter(|(_, e)| written_out(&e.name, e.span)) {
        let problem = match (heard[id.index()], raised[id.index()]) {
            (true, true) => continue,
            (false, _) => "never read",
            (true, false) => "never raised",
        };
        let d = Diagnostic::new(Code::NeverUsed, format!("the event `{}` is {problem}", event.name))
            .label(event.span, "declared here");
        excuses.warn(&Excused::Unused(Declared::Event(id)), d, found);
    }
    integers(machine, &compared, excuses, found);
    for (id, output) in machine.outputs.iter() {
        if !driven[id.index()] {
            let d = Diagnostic::new(Code::NeverDriven, format!("no state drives `{}`", output.name))
                .label(output.span, "stays FALSE unless a constraint forces it")
                .help("write `drives` in a state, or let a region control its actuator");
            excuses.warn(&Excused::Unused(Declared::Output(id)), d, found);
        }
    }
}

/// Integers: `compared` says which comparisons conditions of the program read.
fn integers(machine: &Machine, compared: &[bool], excuses: &mut Excuses<'_>, found: &mut Diagnostics) {
    let mut read = vec![false; machine.integers.len()];
    let mut written = vec![false; machine.integers.len()];
    for ((_, comparison), _) in machine.comparisons.iter().zip(compared).filter(|(_, compared)| **compared) {
        comparison.left.for_each_value(&mut |i| read[i.index()] = true);
        comparison.right.for_each_value(&mut |i| read[i.index()] = true);
    }
    let states = machine.states.values().flat_map(|s| [&s.entry, &s.exit]);
    let deeds = machine.transitions.values().map(|t| &t.deeds).chain(states);
    for assignment in deeds.flat_map(|d| &d.assignments) {
        written[assignment.integer.index()] = true;
        // What only keeps itself up is of no use to anything else.
        assignment.value.for_each_value(&mut |i| read[i.index()] |= *i != assignment.integer);
    }
    for (id, integer) in machine.integers.iter() {
        let problem = match (read[id.index()], written[id.index()]) {
            (true, true) => continue,
            (false, _) => "never compared with anything",
            (true, false) => "never given another value",
        };
        let d = Diagnostic::new(Code::NeverUsed, format!("the integer `{}` is {problem}", integer.name))
            .label(integer.span, "declared here");
        excuses.warn(&Excused::Unused(Declared::Integer(id)), d, found);
    }
}
