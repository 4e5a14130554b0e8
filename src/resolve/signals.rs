//! Declared inputs, outputs, variables, events and hidden bits to those of the machine, with their addresses.

use super::Resolver;
use super::names::{Symbol, describe};
use crate::base::{Code, Diagnostic, Span, iec};
use crate::ir::{ast, chart, scenario};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let mut taken = HashMap::new();
    for signal in &tree.inputs {
        let address = address(r, signal, 'I', &mut taken);
        let (name, span) = (signal.name.text.clone(), signal.name.span);
        let description = describe(&signal.description);
        let id = r.machine.inputs.push(chart::Input { name, address, description, span });
        r.declare_symbol(&signal.name, Symbol::Input(id));
    }
    for signal in &tree.outputs {
        let address = address(r, signal, 'Q', &mut taken);
        let (name, span) = (signal.name.text.clone(), signal.name.span);
        let description = describe(&signal.description);
        let id = r.machine.outputs.push(chart::Output { name, address, description, span });
        r.declare_symbol(&signal.name, Symbol::Output(id));
    }
    for variable in &tree.variables {
        let (name, span) = (variable.name.text.clone(), variable.name.span);
        let description = describe(&variable.description);
        let symbol = match &variable.kind {
            ast::VariableKind::Bool(initial) => Symbol::Variable(r.machine.variables.push(chart::Variable {
                name,
                initial: *initial,
                description,
                span,
            })),
            kind @ ast::VariableKind::Integer { .. } => {
                let (range, initial) = r.range(kind);
                let integer = chart::Integer { name, range, initial, description, span };
                Symbol::Integer(r.machine.integers.push(integer))
            }
        };
        r.declare_symbol(&variable.name, symbol);
    }
    for event in &tree.events {
        let (name, span) = (event.name.text.clone(), event.name.span);
        let id = r.machine.events.push(chart::Event { name, description: describe(&event.description), span });
        r.declare_symbol(&event.name, Symbol::Event(id));
    }
    // Declared here, so that a condition of the program that names one is told what it is.
    for hidden in tree.plants.iter().flat_map(|p| &p.hidden) {
        let (name, span) = (hidden.name.text.clone(), hidden.name.span);
        let description = describe(&hidden.description);
        let symbol = match &hidden.integer {
            None => Symbol::Bit(r.machine.plant.bits.push(scenario::Bit { name, description, span })),
            Some(kind) => {
                let (range, initial) = r.range(kind);
                let count = scenario::Count { name, range, initial, description, span };
                Symbol::Count(r.machine.plant.counts.push(count))
            }
        };
        r.declare_symbol(&hidden.name, symbol);
    }
}

/// The address in its one spelling, `%IX0.0`; reports one that does not fit or is taken.
fn address(
    r: &mut Resolver,
    signal: &ast::Signal,
    area: char,
    taken: &mut HashMap<String, (String, Span)>,
) -> Option<String> {
    let written = signal.address.as_ref()?;
    let Some(address) = iec::bit_address(&written.text, area) else {
        let kind = if area == 'I' { "an input" } else { "an output" };
        r.diagnostics.push(
            Diagnostic::new(Code::BadAddress, format!("`{}` is no address of {kind}", written.text))
                .label(written.span, "does not fit")
                .help(format!("write `%{area}X` and numbers with dots between them, such as `%{area}X0.3`")),
        );
        return None;
    };
    match taken.entry(address.clone()) {
        Entry::Vacant(entry) => {
            entry.insert((signal.name.text.clone(), written.span));
        }
        Entry::Occupied(entry) => {
            let (name, span) = entry.get();
            r.diagnostics.push(
                Diagnostic::new(
                    Code::DuplicateAddress,
                    format!("`{}` and `{name}` have one address", signal.name.text),
                )
                .label(written.span, "given again")
                .label(*span, format!("first given to `{name}` here")),
            );
        }
    }
    Some(address)
}
