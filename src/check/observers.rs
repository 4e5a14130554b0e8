//! Observers know only what observers decide, raise no events, and one that is tried again after the filter is
//! flat.

use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::chart::{Atom, ChartKind, Deeds, Guard, IntegerId, Machine, Phase};

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    reads(machine, found);
    events(machine, found);
    flat(machine, found);
}

/// What charts of that kind do once, each with where it is written.
fn deeds(machine: &Machine, kind: ChartKind) -> impl Iterator<Item = (&Deeds, Span)> {
    let transitions = machine.transitions.values().filter(move |t| machine.kind(t.scope) == kind);
    let states = machine.states.values().filter(move |s| machine.kind(s.region) == kind);
    let states = states.flat_map(|s| [(&s.entry, s.span), (&s.exit, s.span)]);
    transitions.map(|t| (&t.deeds, t.span)).chain(states)
}

/// For each variable and each integer, where a control chart writes it, if one does.
struct Charts {
    variables: Vec<Option<Span>>,
    integers: Vec<Option<Span>>,
}

impl Charts {
    fn of(machine: &Machine) -> Charts {
        let mut charts =
            Charts { variables: vec![None; machine.variables.len()], integers: vec![None; machine.integers.len()] };
        for (deeds, _) in deeds(machine, ChartKind::Control) {
            deeds.effects.iter().for_each(|e| charts.variables[e.variable.index()] = Some(e.span));
            deeds.assignments.iter().for_each(|a| charts.integers[a.integer.index()] = Some(a.span));
        }
        for action in machine.states.values().flat_map(|s| &s.actions) {
            charts.variables[action.variable.index()] = Some(action.span);
        }
        charts
    }
}

/// No observer reads what a control chart writes.
fn reads(machine: &Machine, found: &mut Diagnostics) {
    let charts = Charts::of(machine);
    let mut refuse = |what: &str, name: &str, span: Span, writer: Span| {
        found.push(
            Diagnostic::new(Code::ObserverReads, format!("`{name}` is {what} of a control chart"))
                .label(span, "an observer cannot see it")
                .label(writer, "a chart writes it here")
                .help("let the observer follow what the chart does to the outputs: `prev(…)`"),
        );
    };
    let mut integer = |i: IntegerId, span: Span| {
        if let Some(writer) = charts.integers[i.index()] {
            refuse("an integer", &machine.integers[i].name, span, writer);
        }
    };
    for (deeds, _) in deeds(machine, ChartKind::Observer) {
        deeds.assignments.iter().for_each(|a| a.value.for_each_value(&mut |&i| integer(i, a.span)));
    }
    for (guard, span) in guards(machine) {
        guard.for_each_atom(&mut |atom| {
            if let Atom::Compare(c) = *atom {
                let comparison = &machine.comparisons[c];
                comparison.left.for_each_value(&mut |&i| integer(i, span));
                comparison.right.for_each_value(&mut |&i| integer(i, span));
            }
        });
    }
    for (guard, span) in guards(machine) {
        guard.for_each_atom(&mut |atom| {
            if let Atom::Variable(v) = *atom
                && let Some(writer) = charts.variables[v.index()]
            {
                refuse("a variable", &machine.variables[v].name, span, writer);
            }
        });
    }
}

/// What observers read on their way, each with where it is written.
fn guards(machine: &Machine) -> impl Iterator<Item = (&Guard, Span)> {
    let transitions = machine.transitions.values().map(|t| (t.scope, &t.guard, t.span));
    let entries =
        machine.regions.iter().flat_map(|(id, r)| r.entries.iter().map(move |(guard, _)| (id, guard, r.span)));
    let all = transitions.chain(entries);
    all.filter(|(r, ..)| machine.kind(*r) == ChartKind::Observer).map(|(_, guard, span)| (guard, span))
}

/// Events are between charts: no observer reads or raises one.
fn events(machine: &Machine, found: &mut Diagnostics) {
    for (guard, span) in guards(machine) {
        guard.for_each_atom(&mut |atom| {
            if let Atom::Event(e) = *atom {
                let text = format!("`{}` is an event: charts raise it", machine.events[e].name);
                found.push(
                    Diagnostic::new(Code::ObserverReads, text)
                        .label(span, "an observer cannot see it")
                        .help("let the observer follow what the charts do to the outputs: `prev(…)`"),
                );
            }
        });
    }
    for (deeds, span) in deeds(machine, ChartKind::Observer) {
        if let Some(&e) = deeds.raises.first() {
            let text = format!("an observer does not raise events, such as `{}`", machine.events[e].name);
            found.push(
                Diagnostic::new(Code::ObserverActs, text)
                    .label(span, "raised here")
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
