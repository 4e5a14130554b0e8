//! An analysis to text for people, and its graphs to the language of Graphviz.

use super::analysis::{Analysis, ConstraintReport, Nature, ProductKind, ProductReport};
use super::graphs::Matrix;
use crate::base::count;
use std::fmt::{self, Display, Write};

/// Most columns of a matrix that is printed; larger ones are no use to a reader, and JSON has them.
const COLUMNS: usize = 24;

impl Display for Analysis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let products: Vec<&ProductReport> = self.constraints.iter().flat_map(|c| &c.products).collect();
        let combined = self.combined.len();
        writeln!(
            f,
            "{}: {}, {} ({} simple, {combined} combined), {}",
            self.machine,
            count(self.constraints.len(), "constraint"),
            count(products.len(), "product"),
            products.len() - combined,
            count(self.assumptions.len(), "assumption"),
        )?;
        if !products.is_empty() {
            writeln!(f, "\nConstraints")?;
        }
        let width = products.iter().map(|p| p.name.chars().count()).max().unwrap_or(0);
        let text = products.iter().map(|p| p.never.chars().count()).max().unwrap_or(0);
        for p in &products {
            let (kind, nature) = (kind(p.kind), nature(p.nature));
            let (name, never, forces) = (&p.name, &p.never, p.forces.join(", "));
            writeln!(f, "  {name:width$}  {kind} {nature}  never {never:text$}  {forces}")?;
        }
        for (name, never) in &self.assumptions {
            writeln!(f, "  {name:width$}  assumed       never {never}")?;
        }
        // Whoever looks for his own words finds them where products are not these.
        let whole = |c: &&ConstraintReport| c.products.iter().any(|p| p.never != c.never);
        let other: Vec<&ConstraintReport> = self.constraints.iter().filter(whole).collect();
        if !other.is_empty() {
            writeln!(f, "\nAs they are written, where that differs")?;
        }
        for c in other {
            writeln!(f, "  {:width$}  never {}", c.name, c.never)?;
        }
        writeln!(f, "\nOutputs")?;
        for o in &self.outputs {
            for (word, sum) in [("fs0", &o.fs0), ("fs1", &o.fs1), ("fc0", &o.fc0), ("fc1", &o.fc1)] {
                if !sum.is_empty() {
                    writeln!(f, "  {word}({}) = {}", o.name, sum.join(" or "))?;
                }
            }
        }
        if !self.untouched.is_empty() {
            writeln!(f, "  no constraint touches {}", self.untouched.join(", "))?;
        }
        if combined > 0 {
            self.matrices(f)?;
        }
        writeln!(f, "\nProperties")?;
        for p in &self.properties {
            let verdict = if p.holds { "holds" } else { "does not hold" };
            writeln!(f, "  {} {verdict}: {}", p.number, p.says)?;
            p.witnesses.iter().try_for_each(|w| writeln!(f, "      {w}"))?;
        }
        if !self.redundant.is_empty() {
            writeln!(f, "\nRedundant, each alone")?;
        }
        for r in &self.redundant {
            let by = if r.implied_by.is_empty() { "the assumptions".to_owned() } else { r.implied_by.join(", ") };
            writeln!(f, "  {} is implied by {by}", r.name)?;
        }
        Ok(())
    }
}

impl Analysis {
    fn matrices(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let m = &self.matrices;
        writeln!(f, "\nMatrices of combined products")?;
        if self.combined.len() > COLUMNS {
            writeln!(f, "  too wide to print: `--format json` has them")?;
        } else {
            let numbered: Vec<String> =
                self.combined.iter().enumerate().map(|(i, n)| format!("{} {n}", i + 1)).collect();
            writeln!(f, "  columns: {}", numbered.join(", "))?;
            let named = |(i, _): &(usize, &super::analysis::OutputReport)| {
                [&m.mx0, &m.mx1].iter().any(|m| m.range((*i, 0)..(*i + 1, 0)).next().is_some())
            };
            let outputs: Vec<(usize, &str)> =
                self.outputs.iter().enumerate().filter(named).map(|(i, o)| (i, o.name.as_str())).collect();
            let products: Vec<(usize, &str)> = self.combined.iter().map(String::as_str).enumerate().collect();
            for (name, matrix) in [("MX0", &m.mx0), ("MX1", &m.mx1), ("MC0", &m.mc0), ("MC1", &m.mc1)] {
                table(f, name, &outputs, self.combined.len(), matrix)?;
            }
            for (name, matrix) in [("MX", &m.mx), ("MC", &m.mc)] {
                table(f, name, &products, self.combined.len(), matrix)?;
            }
        }
        let name = |i: usize| self.combined[i].as_str();
        let edges: Vec<String> =
            m.mx.iter().filter(|(i, j)| i < j).map(|&(i, j)| format!("{} - {}", name(i), name(j))).collect();
        let arcs: Vec<String> = m
            .mc
            .iter()
            .map(|arc| {
                let never = if self.impossible_arcs.contains(arc) { " (never: they exclude each other)" } else { "" };
                format!("{} -> {}{never}", name(arc.0), name(arc.1))
            })
            .collect();
        writeln!(f)?;
        for (title, lines) in [("G", edges), ("GO", arcs)] {
            let list = if lines.is_empty() { "no edge".to_owned() } else { lines.join(", ") };
            writeln!(f, "  {title}: {list}")?;
        }
        Ok(())
    }

    /// The graphs G and GO for Graphviz. Arcs that never matter are dashed.
    pub fn dot(&self) -> String {
        let mut out = String::new();
        self.write_dot(&mut out).expect("writing to a string succeeds");
        out
    }

    fn write_dot(&self, f: &mut String) -> fmt::Result {
        let products = self.constraints.iter().flat_map(|c| &c.products);
        let nodes: Vec<String> = products
            .filter(|p| p.kind == ProductKind::Combined)
            .enumerate()
            .map(|(i, p)| format!("  {i} [label=\"{}\\n{}\\n{}\"];", p.name, p.never, p.forces.join(", ")))
            .collect();
        writeln!(f, "graph G {{\n  node [shape=box];")?;
        nodes.iter().try_for_each(|n| writeln!(f, "{n}"))?;
        for (i, j) in self.matrices.mx.iter().filter(|(i, j)| i < j) {
            writeln!(f, "  {i} -- {j};")?;
        }
        writeln!(f, "}}\ndigraph GO {{\n  node [shape=box];")?;
        nodes.iter().try_for_each(|n| writeln!(f, "{n}"))?;
        for arc in &self.matrices.mc {
            let style = if self.impossible_arcs.contains(arc) { " [style=dashed]" } else { "" };
            writeln!(f, "  {} -> {}{style};", arc.0, arc.1)?;
        }
        writeln!(f, "}}")
    }
}

fn table(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    rows: &[(usize, &str)],
    columns: usize,
    matrix: &Matrix,
) -> fmt::Result {
    if matrix.is_empty() {
        return writeln!(f, "\n  {name} = 0");
    }
    let width = rows.iter().map(|(_, r)| r.chars().count()).max().unwrap_or(0).max(name.len());
    let numbers: Vec<String> = (1..=columns).map(|i| format!("{i:2}")).collect();
    writeln!(f, "\n  {name:width$}  {}", numbers.join(" "))?;
    for &(i, row) in rows {
        let cells: Vec<&str> = (0..columns).map(|j| if matrix.contains(&(i, j)) { " 1" } else { " ." }).collect();
        writeln!(f, "  {row:width$}  {}", cells.join(" "))?;
    }
    Ok(())
}

fn kind(kind: ProductKind) -> &'static str {
    match kind {
        ProductKind::Simple => "CSs",
        ProductKind::Combined => "CSc",
    }
}

fn nature(nature: Nature) -> &'static str {
    match nature {
        Nature::Static => "static     ",
        Nature::Combinatory => "combinatory",
        Nature::Sequential => "sequential ",
    }
}
