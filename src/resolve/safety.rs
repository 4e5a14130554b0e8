//! Written constraints and assumptions to sums of products.

use super::Resolver;
use super::expressions::Context;
use super::names::describe;
use crate::base::{Code, Diagnostic, Span, iec, limits};
use crate::ir::chart::{self, Atom, FilterMode, Guard, Relief, outputs_of};
use crate::ir::{ast, sop::Product, sop::Sum};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

pub fn resolve(r: &mut Resolver, tree: &ast::Machine) {
    let mut names: HashMap<String, Span> = HashMap::new();
    for (i, safety) in tree.safety.iter().enumerate() {
        assert!(safety.forbids.is_empty() && safety.derives.is_empty(), "constraints are derived before");
        if i > 0 {
            r.diagnostics.push(
                Diagnostic::new(Code::Repeated, "the safety part is given more than once")
                    .label(safety.mode.span, "given again")
                    .label(tree.safety[0].mode.span, "first given here"),
            );
        }
        head(r, safety);
        let constraints = safety.constraints.iter().chain(&safety.assumptions).map(|c| &c.name);
        for name in constraints.chain(safety.unkept.iter().map(|f| &f.name)) {
            r.legal(name);
            match names.entry(iec::fold(&name.text)) {
                Entry::Vacant(entry) => {
                    entry.insert(name.span);
                }
                Entry::Occupied(entry) => {
                    let first = *entry.get();
                    r.duplicate(name, first);
                }
            }
        }
        for written in &safety.unkept {
            let (name, text) = (written.name.text.clone(), describe(&written.text));
            r.machine.safety.unkept.push(chart::Forbidden { name, text, span: written.name.span });
        }
        for written in &safety.assumptions {
            let never = r.guard(&written.never, &Context::Assumption);
            if let Some(extra) = written.yields.first() {
                r.diagnostics.push(
                    Diagnostic::new(Code::BadAssumption, "nothing yields to an assumption")
                        .label(extra.span, "the filter does not enforce it"),
                );
            }
            let Some(products) = products(r, written, &never) else { continue };
            r.machine.safety.assumptions.push(chart::Assumption {
                name: written.name.text.clone(),
                text: describe(&written.text),
                never,
                written: written.never.written.clone(),
                products,
                span: written.name.span,
            });
        }
        for written in &safety.constraints {
            constraint(r, written);
        }
    }
}

/// What stands before the braces.
fn head(r: &mut Resolver, written: &ast::Safety) {
    let span = written.mode.span;
    let mode = mode(r, &written.mode);
    let reset = written.reset.as_ref().and_then(|name| r.input(name));
    match (mode, &written.reset) {
        (Some(FilterMode::Blocking), None) => {
            let d = Diagnostic::new(Code::BadReset, "nothing ends the stop of a blocking filter")
                .label(span, "the first violation stops the machine")
                .help("name an input: `safety blocking reset by Acknowledge { … }`");
            r.diagnostics.push(d);
        }
        (Some(FilterMode::Controller), Some(name)) => {
            let d = Diagnostic::new(Code::BadReset, "there is nothing to reset")
                .label(name.span, "a controller's corrections are normal, and none of them is remembered")
                .help("leave it out, or write `supervisor` if corrections should be noted");
            r.diagnostics.push(d);
        }
        _ => {}
    }
    let relief = if written.in_order.is_some() { Relief::InOrder { sweeps: 0 } } else { Relief::Together };
    let safety = &mut r.machine.safety;
    (safety.mode, safety.span, safety.relief, safety.reset) = (mode, span, relief, reset);
}

fn mode(r: &mut Resolver, written: &ast::Name) -> Option<FilterMode> {
    match written.text.as_str() {
        "blocking" => Some(FilterMode::Blocking),
        "supervisor" => Some(FilterMode::Supervisor),
        "controller" => Some(FilterMode::Controller),
        other => {
            r.diagnostics.push(
                Diagnostic::new(Code::UnknownName, format!("there is no filter mode `{other}`"))
                    .label(written.span, "not known")
                    .help("`supervisor`: outputs are corrected, the program goes on, each correction is an alarm")
                    .help("`controller`: the same, and a correction is normal")
                    .help("`blocking reset by INPUT`: a violation stops the machine until the input rises"),
            );
            None
        }
    }
}

/// The products of a condition; reports one that is constant or splits into too many.
fn products(r: &mut Resolver, written: &ast::Constraint, never: &Guard) -> Option<Vec<Product<Atom>>> {
    let Some(sum) = Sum::of(never, limits::CONSTRAINT_PRODUCTS) else {
        r.diagnostics.push(
            Diagnostic::new(
                Code::TooManyProducts,
                format!("`{}` splits into more than {} products", written.name.text, limits::CONSTRAINT_PRODUCTS),
            )
            .label(written.never.span, "too many cases")
            .help("split it into several constraints, each with its own name and reason"),
        );
        return None;
    };
    if sum.is_zero() || sum.is_one() {
        let what = if sum.is_one() { "is always violated" } else { "can never be violated" };
        // A name that could not be resolved reads FALSE; that has been said already.
        if !r.diagnostics.has_errors() {
            r.diagnostics.push(
                Diagnostic::new(Code::ConstantConstraint, format!("`{}` {what}", written.name.text))
                    .label(written.never.span, "does not depend on anything"),
            );
        }
        return None;
    }
    Some(sum.products().to_vec())
}

fn constraint(r: &mut Resolver, written: &ast::Constraint) {
    let never = r.guard(&written.never, &Context::Constraint);
    let yields: Vec<(chart::OutputId, Span)> =
        written.yields.iter().filter_map(|name| Some((r.output(name)?, name.span))).collect();
    let Some(products) = products(r, written, &never) else { return };
    let (name, whole) = (&written.name, written.never.span);
    if let Some(product) = products.iter().find(|p| outputs_of(p).next().is_none()) {
        let what = if products.len() > 1 { "one of its cases names" } else { "it names" };
        let d = Diagnostic::new(
            Code::NoOutputInConstraint,
            format!("the filter cannot keep `{}`: {what} no output of this scan", name.text),
        )
        .label(whole, "nothing here is for the filter to decide")
        .help("name the output that must not be TRUE (or FALSE) then; what the plant cannot do is an assumption: `assume NAME: never …`");
        debug_assert!(outputs_of(product).next().is_none());
        r.diagnostics.push(d);
        return;
    }
    let combined: Vec<&Product<Atom>> = products.iter().filter(|p| outputs_of(p).count() > 1).collect();
    let relieved = |product: &Product<Atom>| outputs_of(product).any(|(o, _)| yields.iter().any(|(y, _)| *y == o));
    if !combined.is_empty() && written.yields.is_empty() {
        let outputs: Vec<&str> = outputs_of(combined[0]).map(|(o, _)| r.machine.outputs[o].name.as_str()).collect();
        let d = Diagnostic::new(
            Code::NobodyYields,
            format!("`{}` joins {}: which of them gives way?", name.text, outputs.join(" and ")),
        )
        .label(whole, "a combined constraint")
        .help(format!("write `yields {}`", outputs[0]));
        r.diagnostics.push(d);
    } else if let Some(product) = combined.iter().find(|p| !relieved(p)) {
        let outputs: Vec<&str> = outputs_of(product).map(|(o, _)| r.machine.outputs[o].name.as_str()).collect();
        let fits = |(o, _): &(chart::OutputId, Span)| combined.iter().any(|p| outputs_of(p).any(|(q, _)| q == *o));
        // A name that fits nowhere is reported below.
        if yields.len() == written.yields.len() && yields.iter().all(fits) {
            let d = Diagnostic::new(
                Code::CannotYield,
                format!("in one case of `{}` only {} can give way", name.text, outputs.join(" or ")),
            )
            .label(whole, "nobody who yields occurs in that case")
            .help(format!("add one of them: `yields …, {}`", outputs[0]));
            r.diagnostics.push(d);
        }
    }
    for (output, span) in &yields {
        if !combined.iter().any(|p| outputs_of(p).any(|(o, _)| o == *output)) {
            let text = if combined.is_empty() {
                "a simple constraint forces its only output; nobody else can yield"
            } else {
                "it occurs in no combined case of this constraint"
            };
            let d = Diagnostic::new(
                Code::CannotYield,
                format!("`{}` cannot yield to `{}`", r.machine.outputs[*output].name, name.text),
            )
            .label(*span, text);
            r.diagnostics.push(d);
        }
    }
    r.machine.safety.constraints.push(chart::Constraint {
        written: written.never.written.clone(),
        from: written.from.iter().map(|n| (n.text.clone(), n.span)).collect(),
        name: name.text.clone(),
        text: describe(&written.text),
        never,
        products,
        yields: yields.into_iter().map(|(o, _)| o).collect(),
        span: name.span,
    });
}
