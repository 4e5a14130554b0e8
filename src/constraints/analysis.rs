//! All that is to be known about a machine's constraints, in names and texts.

use super::graphs::{self, Matrices, Matrix};
use super::properties::{self, Kind, Violation};
use super::{redundancy, words};
use crate::ir::chart::{Atom, Machine, OutputId, outputs_of};
use crate::ir::relief::Reliefs;
use crate::ir::sop::Product;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The analysis of a machine's constraints.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Analysis {
    /// The machine's name.
    #[serde(skip)]
    pub machine: String,
    /// The constraints, in the order in which they are written.
    pub constraints: Vec<ConstraintReport>,
    /// The assumptions, each with what it excludes, as it is written.
    pub assumptions: Vec<(String, String)>,
    /// What constraints do to each output.
    pub outputs: Vec<OutputReport>,
    /// The combined products, by name: what the matrices count.
    pub combined: Vec<String>,
    /// The matrices of combined products.
    pub matrices: Matrices,
    /// Those arcs of GO whose ends exclude each other by what they read: they never matter.
    pub impossible_arcs: Matrix,
    /// Properties 0 to 4, in order.
    pub properties: Vec<Property>,
    /// Constraints that others imply.
    pub redundant: Vec<Implied>,
    /// Outputs that no constraint touches.
    pub untouched: Vec<String>,
}

/// One constraint.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ConstraintReport {
    /// Its name.
    pub name: String,
    /// Why, in words for the operator.
    pub text: String,
    /// What must never be, as it is written.
    pub never: String,
    /// The actuators and forbidden positions that it is derived from; none if it is written.
    pub from: Vec<String>,
    /// What must never be, split into products.
    pub products: Vec<ProductReport>,
}

/// One product of a constraint.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ProductReport {
    /// The name of its constraint, with a number if that has several.
    pub name: String,
    /// The product.
    pub never: String,
    /// How many outputs it binds.
    pub kind: ProductKind,
    /// What it depends on.
    pub nature: Nature,
    /// What the filter makes of outputs when the product would be TRUE, such as `PUMP := 0`.
    pub forces: Vec<String>,
}

/// How many outputs of this scan a product binds (the paper on logical constraints).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ProductKind {
    /// One: a CSs.
    Simple,
    /// Several: a CSc.
    Combined,
}

/// What a product depends on (the paper on validation filters).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Nature {
    /// On nothing but outputs and their past: a static safety constraint.
    Static,
    /// On inputs, too: a combinatory dynamic one.
    Combinatory,
    /// On what the program has to remember, because no sensor tells: a sequential dynamic one.
    Sequential,
}

/// What constraints do to an output.
#[derive(Clone, Debug, Serialize)]
pub struct OutputReport {
    /// Its name.
    pub name: String,
    /// The products whose sum forces it off, and on: over read-only values.
    pub fs0: Vec<String>,
    /// See `fs0`.
    pub fs1: Vec<String>,
    /// The names of the combined products that relieve it by going off, and on.
    pub fc0: Vec<String>,
    /// See `fc0`.
    pub fc1: Vec<String>,
}

/// A property of the paper on logical constraints, decided.
#[derive(Clone, Debug, Serialize)]
pub struct Property {
    /// Its number there; 0 is what its graph takes for granted.
    pub number: u32,
    /// What it says.
    pub says: &'static str,
    /// Whether it holds.
    pub holds: bool,
    /// Why not, each with a case in which it happens.
    pub witnesses: Vec<String>,
}

/// A constraint that can be left out alone.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Implied {
    /// Its name.
    pub name: String,
    /// Those that imply it, together with the assumptions.
    pub implied_by: Vec<String>,
}

impl Analysis {
    /// Analyses the constraints of a machine. Only property 0 may be broken.
    pub fn of(machine: &Machine) -> Analysis {
        let reliefs = Reliefs::of(&machine.safety);
        let constraints: Vec<ConstraintReport> = machine
            .safety
            .constraints
            .values()
            .map(|c| {
                let many = c.products.len() > 1;
                let name = |i: usize| if many { format!("{}.{}", c.name, i + 1) } else { c.name.clone() };
                let products = c.products.iter().enumerate();
                let products = products.map(|(i, p)| product(machine, name(i), p, &c.yields)).collect();
                let (name, text, never) = (c.name.clone(), c.text.clone(), c.written.clone());
                let from = c.from.iter().map(|(source, _)| source.clone()).collect();
                ConstraintReport { name, text, never, from, products }
            })
            .collect();
        let all = constraints.iter().flat_map(|c| &c.products);
        let combined: Vec<String> = all.filter(|p| p.kind == ProductKind::Combined).map(|p| p.name.clone()).collect();
        let matrices = Matrices::of(&reliefs.combined);
        let excluded = |&(i, j): &(usize, usize)| {
            let readings = |i: usize| reliefs.combined[i].readings();
            readings(i).times(&readings(j)).is_none()
        };
        let impossible_arcs: Matrix = matrices.mc.iter().copied().filter(excluded).collect();
        let name = |id| machine.safety.constraints[id].name.clone();
        let redundant = redundancy::redundant(machine)
            .into_iter()
            .map(|r| Implied { name: name(r.constraint), implied_by: r.implied_by.into_iter().map(name).collect() });
        let assumed = machine.safety.assumptions.iter().map(|a| (a.name.clone(), a.written.clone()));
        Analysis {
            machine: machine.name.clone(),
            assumptions: assumed.collect(),
            outputs: outputs(machine, &reliefs, &combined),
            properties: decide(machine, &reliefs, &combined, &matrices, &impossible_arcs),
            redundant: redundant.collect(),
            untouched: untouched(machine),
            constraints,
            combined,
            matrices,
            impossible_arcs,
        }
    }
}

fn product(machine: &Machine, name: String, product: &Product<Atom>, yields: &[OutputId]) -> ProductReport {
    let outputs: Vec<(OutputId, bool)> = outputs_of(product).collect();
    let kind = if outputs.len() > 1 { ProductKind::Combined } else { ProductKind::Simple };
    let forced = outputs.iter().filter(|(o, _)| kind == ProductKind::Simple || yields.contains(o));
    let nature = product.literals().iter().map(|l| match l.atom {
        Atom::Output(_) | Atom::PrevOutput(_) => Nature::Static,
        Atom::Input(_) | Atom::PrevInput(_) => Nature::Combinatory,
        Atom::Variable(_) | Atom::Event(_) | Atom::Compare(_) | Atom::In(_) | Atom::Done(_) | Atom::After(..) => {
            Nature::Sequential
        }
    });
    ProductReport {
        name,
        never: words::product(machine, product),
        kind,
        nature: nature.max().unwrap_or(Nature::Static),
        forces: forced.map(|&(o, negated)| format!("{} := {}", machine.outputs[o].name, u8::from(negated))).collect(),
    }
}

fn outputs(machine: &Machine, reliefs: &Reliefs, combined: &[String]) -> Vec<OutputReport> {
    let mut fs: BTreeMap<(OutputId, bool), Vec<String>> = BTreeMap::new();
    let mut fc: BTreeMap<(OutputId, bool), Vec<String>> = BTreeMap::new();
    for f in &reliefs.forcings {
        fs.entry((f.output, f.value)).or_default().push(words::product(machine, &f.condition));
    }
    for (c, name) in reliefs.combined.iter().zip(combined) {
        c.reliefs.iter().for_each(|&relief| fc.entry(relief).or_default().push(name.clone()));
    }
    let mut take = |o, value| (fs.remove(&(o, value)).unwrap_or_default(), fc.remove(&(o, value)).unwrap_or_default());
    let report = |(id, output): (OutputId, &crate::ir::chart::Output)| {
        let ((fs0, fc0), (fs1, fc1)) = (take(id, false), take(id, true));
        OutputReport { name: output.name.clone(), fs0, fs1, fc0, fc1 }
    };
    machine.outputs.iter().map(report).collect()
}

fn untouched(machine: &Machine) -> Vec<String> {
    let products = machine.safety.constraints.values().flat_map(|c| &c.products);
    let touched: BTreeSet<OutputId> = products.flat_map(|p| outputs_of(p).map(|(o, _)| o)).collect();
    machine.outputs.iter().filter(|(id, _)| !touched.contains(id)).map(|(_, o)| o.name.clone()).collect()
}

fn decide(
    machine: &Machine,
    reliefs: &Reliefs,
    combined: &[String],
    matrices: &Matrices,
    impossible: &Matrix,
) -> Vec<Property> {
    let without: Vec<String> = reliefs
        .combined
        .iter()
        .zip(combined)
        .filter(|(c, _)| c.reliefs.is_empty())
        .map(|(_, name)| format!("nobody yields in {name}"))
        .collect();
    let arcs = matrices.mc.difference(impossible).copied().collect();
    let cycles = graphs::cycles(combined.len(), &arcs).into_iter().map(|cycle| {
        let names: Vec<&str> = cycle.iter().map(|&j| combined[j].as_str()).collect();
        format!("the reliefs of {} set each other off", names.join(", "))
    });
    let violations = if without.is_empty() { properties::violations(machine, reliefs) } else { Vec::new() };
    let those = |number: u32| -> Vec<String> {
        violations.iter().filter(|v| number_of(v.kind) == number).map(|v| describe(machine, v)).collect()
    };
    let property =
        |number, says, witnesses: Vec<String>| Property { number, says, holds: witnesses.is_empty(), witnesses };
    let mut all = vec![property(0, "every combined constraint has a relief that opposes one of its literals", without)];
    if all[0].holds {
        all.extend([
            property(1, "no output is forced both ways, and none is relieved both ways", those(1)),
            property(2, "the graph GO has no cycle", cycles.collect()),
            property(3, "no output that has to go off is held on", those(3)),
            property(4, "no output that has to go on is held off", those(4)),
        ]);
    }
    all
}

fn number_of(kind: Kind) -> u32 {
    match kind {
        Kind::Forced | Kind::Relieved => 1,
        Kind::Blocked { value: false } => 3,
        Kind::Blocked { value: true } => 4,
    }
}

fn describe(machine: &Machine, violation: &Violation) -> String {
    let [a, b] = violation.constraints.map(|c| &machine.safety.constraints[c].name);
    let output = &machine.outputs[violation.output].name;
    let case = violation.witness.show(machine);
    match violation.kind {
        Kind::Forced => format!("{a} forces {output} off and {b} forces it on: {case}"),
        Kind::Relieved => format!("{output} yields to {a} by going off and to {b} by going on: {case}"),
        Kind::Blocked { value } => {
            let (go, held) = if value { ("on", "off") } else { ("off", "on") };
            format!("{output} has to go {go} for {a} and {b} holds it {held}: {case}")
        }
    }
}
