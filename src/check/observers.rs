//! Observers know only what observers decide, do not count, and one that is tried again after the filter is
//! flat.

use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Atom, ChartKind, Machine, Phase};

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    reads(machine, found);
    events(machine, found);
    flat(machine, found);
    counts(machine, found);
}

/// Integers are the charts' business.
fn counts(machine: &Machine, found: &mut Diagnostics) {
    for t in machine.transitions.values().filter(|t| machine.kind(t.scope) == ChartKind::Observer) {
        let mut compares = false;
        t.guard.for_each_atom(&mut |atom| compares |= matches!(atom, Atom::Compare(_)));
        if compares || !t.deeds.assignments.is_empty() {
            found.push(
                Diagnostic::new(Code::ObserverCounts, "observers neither count nor compare")
                    .label(t.span, "this transition does")
                    .help("let a chart count what the observer tells: `in(STATE)`"),
            );
        }
    }
}

/// No observer reads a variable that a control chart writes.
fn reads(machine: &Machine, found: &mut Diagnostics) {
    let mut written = vec![None; machine.variables.len()];
    for t in machine.transitions.values().filter(|t| machine.kind(t.scope) == ChartKind::Control) {
        t.deeds.effects.iter().for_each(|e| written[e.variable.index()] = Some(e.span));
    }
    for state in machine.states.values() {
        state.actions.iter().for_each(|a| written[a.variable.index()] = Some(a.span));
        let once = state.entry.effects.iter().chain(&state.exit.effects);
        once.for_each(|e| written[e.variable.index()] = Some(e.span));
    }
    let transitions = machine.transitions.values().map(|t| (t.scope, &t.guard, t.span));
    let entries =
        machine.regions.iter().flat_map(|(id, r)| r.entries.iter().map(move |(guard, _)| (id, guard, r.span)));
    for (_, guard, span) in transitions.chain(entries).filter(|(r, ..)| machine.kind(*r) == ChartKind::Observer) {
        guard.for_each_atom(&mut |atom| {
            if let Atom::Variable(v) = *atom
                && let Some(writer) = written[v.index()]
            {
                let name = &machine.variables[v].name;
                found.push(
                    Diagnostic::new(Code::ObserverReads, format!("`{name}` is a variable of a control chart"))
                        .label(span, "an observer cannot see it")
                        .label(writer, "a chart writes it here")
                        .help("let the observer follow what the chart does to the outputs: `prev(…)`"),
                );
            }
        });
    }
}

/// Events are between charts: no observer reads or raises one.
fn events(machine: &Machine, found: &mut Diagnostics) {
    for t in machine.transitions.values().filter(|t| machine.kind(t.scope) == ChartKind::Observer) {
        t.guard.for_each_atom(&mut |atom| {
            if let Atom::Event(e) = *atom {
                let text = format!("`{}` is an event: charts raise it", machine.events[e].name);
                found.push(
                    Diagnostic::new(Code::ObserverReads, text)
                        .label(t.span, "an observer cannot see it")
                        .help("let the observer follow what the charts do to the outputs: `prev(…)`"),
                );
            }
        });
        if let Some(&e) = t.deeds.raises.first() {
            let text = format!("an observer does not raise events, such as `{}`", machine.events[e].name);
            found.push(
                Diagnostic::new(Code::ObserverActs, text)
                    .label(t.span, "raised here")
                    .help("let a chart ask for the observer's state by `in(STATE)` and raise the event"),
            );
        }
    }
}

/// What takes a second step in a scan is one region of elementary states that wait for no time.
fn flat(machine: &Machine, found: &mut Diagnostics) {
    let mut again = vec![None; machine.charts.len()];
    for t in machine.transitions.values().filter(|t| t.phase == Phase::End) {
        again[machine.regions[t.scope].chart].get_or_insert(t.span);
    }
    let mut refuse = |chart: usize, span: Span, label: &str, help: &str| {
        let Some(again) = again[chart] else { return };
        let name = &machine.charts[chart].name;
        let text = format!("`{name}` moves again after the filter, so it has to be flat and wait for no time");
        found.push(
            Diagnostic::new(Code::NotFlat, text).label(span, label).label(again, "tried after the filter").help(help),
        );
    };
    for (id, region) in machine.regions.iter() {
        if machine.charts[region.chart].regions[0] != id {
            refuse(region.chart, region.span, "one region more", "make an observer of each region");
        }
    }
    for region in machine.regions.values().filter(|r| !r.entries.is_empty()) {
        refuse(region.chart, region.span, "begins by a choice", "let it begin at an initial state");
    }
    for t in machine.transitions.values() {
        let mut waits = false;
        t.guard.for_each_atom(&mut |atom| waits |= matches!(atom, Atom::After(..)));
        if waits {
            let help = "let an observer of its own count the time, and ask for its state";
            refuse(machine.regions[t.scope].chart, t.span, "waits for a time", help);
        }
    }
}
