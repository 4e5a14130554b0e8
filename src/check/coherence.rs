//! The constraints leave the filter a way out: properties 1, 3 and 4 of seed 001 and the absence of
//! opposite reliefs, under the declared assumptions.
//!
//! With property 0, which resolving guarantees, these are sufficient for the corrected algorithm
//! (method.md, section 4) to end with every constraint met: while a combined product is violated its
//! relief is blocked by no forcing, so from the next round on one of its literals is FALSE for good.

use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::chart::{Atom, Machine, OutputId};
use crate::ir::relief::Reliefs;
use crate::ir::sop::{Literal, Product};

pub fn check(machine: &Machine, found: &mut Diagnostics) {
    let reliefs = Reliefs::of(&machine.safety);
    let assumed: Vec<&Product<Atom>> = machine.safety.assumptions.iter().flat_map(|a| &a.products).collect();
    let constraints = &machine.safety.constraints;
    let word = |value| if value { "on" } else { "off" };

    let mut forced: Vec<[Vec<usize>; 2]> = vec![Default::default(); machine.outputs.len()];
    for (i, f) in reliefs.forcings.iter().enumerate() {
        forced[f.output.index()][usize::from(f.value)].push(i);
    }
    for [off, on] in &forced {
        // One pair per output is enough to start with.
        for (&i, &j) in off.iter().flat_map(|i| on.iter().map(move |j| (i, j))) {
            let (a, b) = (&reliefs.forcings[i], &reliefs.forcings[j]);
            if let Some(witness) = meet(&a.condition, &b.condition, &assumed) {
                let name = &machine.outputs[a.output].name;
                found.push(
                    Diagnostic::new(
                        Code::ContradictingConstraints,
                        format!(
                            "`{}` forces `{name}` off while `{}` forces it on",
                            constraints[a.constraint].name, constraints[b.constraint].name
                        ),
                    )
                    .label(constraints[b.constraint].span, "forces it on")
                    .label(constraints[a.constraint].span, "forces it off")
                    .help(format!("both at once when {}", show(machine, &witness)))
                    .help("add a condition to one of them, or `assume` that this cannot happen"),
                );
                break;
            }
        }
    }

    let mut relieved: Vec<(OutputId, bool, usize)> = Vec::new();
    for (j, c) in reliefs.combined.iter().enumerate() {
        relieved.extend(c.reliefs.iter().map(|&(o, value)| (o, value, j)));
    }
    relieved.sort();
    for (i, &(output, value, j)) in relieved.iter().enumerate() {
        let name = &machine.outputs[output].name;
        let c = &reliefs.combined[j];
        for &(_, _, k) in relieved[i + 1..].iter().take_while(|(o, _, _)| *o == output).filter(|(_, v, _)| *v != value)
        {
            let d = &reliefs.combined[k];
            if let Some(witness) = meet(&c.readings(), &d.readings(), &assumed) {
                found.push(
                    Diagnostic::new(
                        Code::ContradictingReliefs,
                        format!(
                            "`{name}` yields to `{}` by going {} and to `{}` by going {}",
                            constraints[c.constraint].name,
                            word(value),
                            constraints[d.constraint].name,
                            word(!value)
                        ),
                    )
                    .label(constraints[d.constraint].span, format!("here it must go {}", word(!value)))
                    .label(constraints[c.constraint].span, format!("here it must go {}", word(value)))
                    .help(format!("both in one scan is possible when {}", show(machine, &witness)))
                    .help("let another output yield in one of them"),
                );
            }
        }
        for &f in &forced[output.index()][usize::from(!value)] {
            let f = &reliefs.forcings[f];
            if let Some(witness) = meet(&c.product, &f.condition, &assumed) {
                found.push(
                    Diagnostic::new(
                        Code::BlockedRelief,
                        format!(
                            "`{name}` cannot go {} for `{}`: `{}` holds it {}",
                            word(value),
                            constraints[c.constraint].name,
                            constraints[f.constraint].name,
                            word(!value)
                        ),
                    )
                    .label(constraints[c.constraint].span, format!("needs `{name}` to yield"))
                    .label(constraints[f.constraint].span, format!("holds `{name}` {}", word(!value)))
                    .help(format!("both at once when {}", show(machine, &witness)))
                    .help("let another output yield, or write the constraint with the edge of the one that yields, such as `rise(…)`"),
                );
            }
        }
    }

    if found.has_errors() {
        return; // What is said of a cycle holds only for constraints that are coherent.
    }
    for cycle in &reliefs.cycles {
        let mut names: Vec<&str> =
            cycle.iter().map(|&j| constraints[reliefs.combined[j].constraint].name.as_str()).collect();
        names.dedup();
        let first = constraints[reliefs.combined[cycle[0]].constraint].span;
        found.push(
            Diagnostic::new(Code::CyclicReliefs, format!("the reliefs of {} set each other off", names.join(", ")))
                .label(first, "one of them")
                .help("this is coherent, but the filter needs a round for each output in the cycle that yields"),
        );
    }
}

/// An assignment under which both products are TRUE and no assumed one is, if there is one.
fn meet(a: &Product<Atom>, b: &Product<Atom>, assumed: &[&Product<Atom>]) -> Option<Product<Atom>> {
    extend(a.times(b)?, assumed)
}

/// Adds literals to `product` until every assumed product is FALSE.
fn extend(product: Product<Atom>, assumed: &[&Product<Atom>]) -> Option<Product<Atom>> {
    let Some((first, rest)) = assumed.split_first() else { return Some(product) };
    let contradicted = |l: &Literal<Atom>| product.literal(l.atom).is_some_and(|m| m.negated != l.negated);
    if first.literals().iter().any(contradicted) {
        return extend(product, rest);
    }
    first.literals().iter().find_map(|l| {
        let opposite: Option<Product<Atom>> = [Literal { atom: l.atom, negated: !l.negated }].into_iter().collect();
        extend(product.times(&opposite?)?, rest)
    })
}

/// The product in the words of the model.
fn show(machine: &Machine, product: &Product<Atom>) -> String {
    product
        .literals()
        .iter()
        .map(|l| format!("{}{}", if l.negated { "not " } else { "" }, machine.atom(l.atom)))
        .collect::<Vec<_>>()
        .join(" and ")
}
