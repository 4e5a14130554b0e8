//! Declared inputs, outputs, variables, events and hidden bits to those of the machine, with their addresses.

use super::Resolver;
use super::names::{Symbol, describe};
use crate::base::{Code, Diagnostic, Span, iec};
use crate::ir::{ast, chart, scenario};
use std::collections::BTreeMap;

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let mut addresses = Addresses::default();
    for signal in &tree.inputs {
        let address = addresses.take(r, signal, 'I');
        let (name, span) = (signal.name.text.clone(), signal.name.span);
        let description = describe(&signal.description);
        let id = r.machine.inputs.push(chart::Input { name, address, description, span });
        r.declare_symbol(&signal.name, Symbol::Input(id));
    }
    for signal in &tree.outputs {
        let address = addresses.take(r, signal, 'Q');
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
    refuse_words(r);
}

/// Reports names that go into the PLC program as they are and are words there.
fn refuse_words(r: &mut Resolver) {
    let m = &r.machine;
    let inputs = m.inputs.values().map(|i| ('I', &i.name, i.span));
    let outputs = m.outputs.values().map(|o| ('Q', &o.name, o.span));
    let variables = m.variables.values().map(|v| ('M', &v.name, v.span));
    let integers = m.integers.values().map(|i| ('M', &i.name, i.span));
    let events = m.events.values().map(|e| ('E', &e.name, e.span));
    let all = inputs.chain(outputs).chain(variables).chain(integers).chain(events);
    let all: Vec<_> = all.map(|(letter, name, span)| (letter, name.clone(), span)).collect();
    for (letter, name, span) in all {
        r.refuse_word(&name, span, letter);
    }
}

/// The addresses that are taken, and by whom.
#[derive(Default)]
struct Addresses {
    taken: BTreeMap<(char, Vec<u16>), Taken>,
    /// In an area, the first address of one number, and the first of several.
    counted: BTreeMap<(char, bool), Taken>,
}

/// A signal and where its address is written.
#[derive(Clone)]
struct Taken {
    name: String,
    address: String,
    span: Span,
}

impl Addresses {
    /// The address in its one spelling, `%IX0.0`; reports one that does not fit or is, or may be, taken.
    fn take(&mut self, r: &mut Resolver, signal: &ast::Signal, area: char) -> Option<String> {
        let written = signal.address.as_ref()?;
        let (Some(address), Some(numbers)) =
            (iec::bit_address(&written.text, area), iec::bit_numbers(&written.text, area))
        else {
            let kind = if area == 'I' { "an input" } else { "an output" };
            r.diagnostics.push(
                Diagnostic::new(Code::BadAddress, format!("`{}` is no address of {kind}", written.text))
                    .label(written.span, "does not fit")
                    .help(format!("write `%{area}X` and one to four numbers below 65536 with dots between them, such as `%{area}X0.3`")),
            );
            return None;
        };
        let this = Taken { name: signal.name.text.clone(), address: address.clone(), span: written.span };
        let flat = numbers.len() == 1;
        let place = (area, numbers);
        let same = self
            .taken
            .get(&place)
            .map(|first| (first, format!("`{}` and `{}` have one address", this.name, first.name)));
        let nested = self.around(&place).map(|first| {
            let message =
                format!("`{}` and `{}` have addresses of which one begins with the other", this.name, first.name);
            (first, message)
        });
        let mixed = self.counted.get(&(area, !flat)).map(|first| {
            (
                first,
                format!("`{}` and `{}` may have one address: {address} and {}", this.name, first.name, first.address),
            )
        });
        if let Some((first, message)) = same.or(nested).or(mixed) {
            let again = if first.address == address { "given again" } else { "could be the same bit" };
            let mut d = Diagnostic::new(Code::DuplicateAddress, message)
                .label(written.span, again)
                .label(first.span, format!("first given to `{}` here", first.name));
            if first.address != address {
                d = d.help("count all inputs, and all outputs, in one way: as bits of bytes, `%QX1.0`, or as bits alone, `%QX8`");
            }
            r.diagnostics.push(d);
        }
        self.counted.entry((area, flat)).or_insert_with(|| this.clone());
        self.taken.entry(place).or_insert(this);
        Some(address)
    }

    /// The signal at a longer or shorter address that begins the same, if there is one.
    fn around(&self, place: &(char, Vec<u16>)) -> Option<&Taken> {
        let (area, numbers) = place;
        let shorter = (1..numbers.len()).find_map(|n| self.taken.get(&(*area, numbers[..n].to_vec())));
        let next = self.taken.range(place..).find(|(at, _)| *at != place);
        let longer = next.filter(|((a, n), _)| a == area && n.starts_with(numbers));
        shorter.or(longer.map(|(_, taken)| taken))
    }
}
