//! PLC project to text that PLC IDEs read: PLCopen XML (TC6), and a table of names.
//!
//! Two families of IDEs read PLCopen XML, with rules that exclude each other. Each has its writer,
//! `beremiz` and `codesys`; what both share is here: the headers, the frame of types and
//! programs. Both write elements in the order of the [drawing](crate::ir::drawing), and number them
//! as they go.

mod beremiz;
mod codesys;
pub mod names;
mod xml;

use crate::base::iec;
use crate::ir::ladder::{Operand, Rung};
use crate::ir::plc::{Body, Program, Project};
use std::collections::BTreeSet;
use xml::Xml;

/// A family of IDEs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// Beremiz, OpenPLC Editor and their kin.
    Beremiz,
    /// CODESYS V3, TwinCAT 3 and their kin.
    Codesys,
}

/// What the file says of its own making.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// When, as `xsd:dateTime`: `2024-02-29T12:00:00`. Not read from a clock here, so that the same
    /// model gives the same bytes.
    pub created: String,
    /// By which version of the compiler.
    pub version: String,
    /// What the reader of the file should know of it, such as that it was not proved.
    pub remark: Option<String>,
}

impl Default for Header {
    fn default() -> Self {
        Header {
            created: "1970-01-01T00:00:00".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            remark: None,
        }
    }
}

/// Writes `project` as PLCopen XML.
pub fn plcopen(project: &Project, dialect: Dialect, header: &Header) -> String {
    let mut xml = Xml::new();
    let root = match dialect {
        Dialect::Beremiz => beremiz::root(&mut xml),
        Dialect::Codesys => codesys::root(&mut xml),
    };
    root.with(|xml| {
        headers(xml, project, dialect, header);
        xml.element("types", |xml| {
            xml.tag("dataTypes").empty();
            xml.element("pous", |xml| {
                for program in &project.programs {
                    pou(xml, project, program, dialect);
                }
            });
        });
        match dialect {
            Dialect::Beremiz => beremiz::instances(xml, project),
            Dialect::Codesys => codesys::instances(xml, project),
        }
    });
    xml.finish()
}

fn headers(xml: &mut Xml, project: &Project, dialect: Dialect, header: &Header) {
    xml.tag("fileHeader")
        .attr("companyName", "")
        .attr("productName", "Chartwright")
        .attr("productVersion", &header.version)
        .attr("creationDateTime", &header.created)
        .attr_opt("contentDescription", header.remark.as_deref())
        .empty();
    xml.tag("contentHeader").attr("name", &project.name).attr("modificationDateTime", &header.created).with(|xml| {
        let notes = project.notes.iter().map(|note| format!("{} {}: {}", note.kind, note.name, note.text));
        let machine = Some(project.description.clone()).filter(|text| !text.is_empty());
        let comment: Vec<String> = machine.into_iter().chain(notes).collect();
        if !comment.is_empty() {
            xml.tag("Comment").text(&comment.join("\n"));
        }
        let scale = match dialect {
            // No grid: what is drawn stays where it is.
            Dialect::Beremiz => 0,
            Dialect::Codesys => 1,
        };
        xml.element("coordinateInfo", |xml| {
            for language in ["fbd", "ld", "sfc"] {
                xml.element(language, |xml| xml.tag("scaling").attr("x", scale).attr("y", scale).empty());
            }
        });
        if dialect == Dialect::Codesys {
            codesys::project_information(xml);
        }
    });
}

fn pou(xml: &mut Xml, project: &Project, program: &Program, dialect: Dialect) {
    xml.tag("pou").attr("name", &program.name).attr("pouType", "program").with(|xml| {
        match dialect {
            Dialect::Beremiz => beremiz::interface(xml, project, program),
            Dialect::Codesys => codesys::interface(xml, program),
        }
        xml.element("body", |xml| match &program.body {
            Body::Sfc(sfc) => xml.element("SFC", |xml| match dialect {
                Dialect::Beremiz => beremiz::sfc(xml, project, sfc),
                Dialect::Codesys => codesys::sfc(xml, project, sfc),
            }),
            Body::Ladder(ladder) => xml.element("LD", |xml| match dialect {
                Dialect::Beremiz => beremiz::ladder(xml, project, ladder),
                Dialect::Codesys => codesys::ladder(xml, project, ladder),
            }),
        });
        match dialect {
            Dialect::Beremiz => beremiz::after_body(xml, program),
            Dialect::Codesys => codesys::after_body(xml, program),
        }
    });
}

/// The operand of that index of a rung's function.
fn operand_text(project: &Project, rung: &Rung, index: usize) -> String {
    match rung.function.as_ref().and_then(|f| f.operands.get(index)) {
        Some(Operand::Const(n)) => n.to_string(),
        Some(Operand::Global(g)) => project.globals[*g].name.clone(),
        None => String::new(),
    }
}

/// The declaration of a timer.
fn timer(xml: &mut Xml, name: &str) {
    xml.tag("variable").attr("name", name).with(|xml| {
        xml.element("type", |xml| xml.tag("derived").attr("name", "TON").empty());
    });
}

/// Position `x`, `y`.
fn position(xml: &mut Xml, name: &'static str, x: i32, y: i32) {
    xml.tag(name).attr("x", x).attr("y", y).empty();
}

/// A name like `wish` that nothing in the project has.
fn unused_name(project: &Project, wish: &str) -> String {
    let mut taken = BTreeSet::new();
    let task = &project.task;
    taken.extend([&task.name, &task.configuration, &task.resource].map(|n| iec::fold(n)));
    taken.extend(project.globals.values().map(|g| iec::fold(&g.name)));
    for program in &project.programs {
        taken.extend([iec::fold(&program.name), iec::fold(&program.instance)]);
        if let Body::Sfc(sfc) = &program.body {
            taken.extend(sfc.steps.values().map(|s| iec::fold(&s.name)));
        }
    }
    let mut candidates = std::iter::once(wish.to_owned()).chain((1..).map(|n| format!("{wish}_{n}")));
    candidates.find(|c| !taken.contains(&iec::fold(c))).expect("names never run out")
}
