//! Products in the words of the model.

use crate::ir::chart::{Atom, Machine};
use crate::ir::sop::Product;

/// A product as a model writes it.
pub fn product(machine: &Machine, product: &Product<Atom>) -> String {
    let literals: Vec<(Atom, bool)> = product.literals().iter().map(|l| (l.atom, !l.negated)).collect();
    self::literals(machine, &literals)
}

/// The conjunction of atoms with their values; a value and its opposite in the scan before are an edge.
pub fn literals(machine: &Machine, literals: &[(Atom, bool)]) -> String {
    let past = |atom| match atom {
        Atom::Input(i) => Some(Atom::PrevInput(i)),
        Atom::Output(o) => Some(Atom::PrevOutput(o)),
        _ => None,
    };
    let opposed = |now: (Atom, bool)| past(now.0).filter(|&p| literals.contains(&(p, !now.1)));
    let mut parts = Vec::new();
    for &(atom, value) in literals {
        // Said where the value of this scan stands.
        if literals.iter().any(|&now| opposed(now) == Some(atom)) {
            continue;
        }
        let name = machine.atom(atom);
        parts.push(match (opposed((atom, value)), value) {
            (Some(_), true) => format!("rise({name})"),
            (Some(_), false) => format!("fall({name})"),
            (None, true) => name,
            (None, false) => format!("not {name}"),
        });
    }
    if parts.is_empty() { "true".to_owned() } else { parts.join(" and ") }
}
