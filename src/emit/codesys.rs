//! PLC project to PLCopen XML as CODESYS V3, TwinCAT 3 and their kin take it (TC6 v2.0).
//!
//! The file looks like one that such an IDE exports. Its editors place everything themselves, so no
//! element has a place; what carries the meaning instead:
//!
//! - An SFC is a strictly nested block structure with a jump as its last element. Numbers ascend
//!   without gaps. Lines from a step or a divergence to a transition, and all lines into a
//!   convergence, carry the formal parameter `sfc`. Names and settings stand in vendor attributes.
//! - A ladder has one left rail, numbered 0, and one right rail, which nothing reaches. A comment
//!   and a network title begin each network.
//! - A function is a box of an operator: EN comes from the rail, so that it always runs, and its result
//!   is written at its output pin. Pins are called by their place.
//! - Programs see globals without declaring them.
//!
//! # Where globals and the task stand
//!
//! An import inserts objects below the selected node, which for programs and variable lists is the
//! application. In exports of its children, programs stand in `types/pous` and variable lists in
//! vendor data of the project. A `configuration` is refused below the application, and with it all
//! that it holds, while programs and vendor lists arrive (a public report on V3.5 SP21; no IDE was
//! run for this project). So `configurations` is empty and the variables are a list in vendor data
//! `globalvars`.
//!
//! No export of children names a task. The task stands where an export of a whole application has
//! it, in vendor data `application`. An import below the application has no place for it, as for a
//! configuration; but whoever reads the file finds in it which programs the task calls, and in which
//! order. After such an import the programs have to be put under the task by hand, in that order.

use super::xml::{Tag, Xml};
use super::{operand_text, position, timer, unused_name};
use crate::ir::drawing::{LadderShape, SfcShape, Wire};
use crate::ir::ladder::{CoilKind, Function, Ladder, Timer};
use crate::ir::plc::{Body, Global, Program, Project};
use crate::ir::sfc::Sfc;
use crate::layout::{self, Branches, Structure};

const XHTML: &str = "http://www.w3.org/1999/xhtml";

/// The number of the right rail, which real exports keep clear of all others.
const RIGHT_RAIL: u32 = 2_147_483_646;

/// The root element, still open for attributes.
pub fn root(xml: &mut Xml) -> Tag<'_> {
    xml.tag("project").attr("xmlns", "http://www.plcopen.org/xml/tc6_0200")
}

/// Vendor data of the content header.
pub fn project_information(xml: &mut Xml) {
    xml.element("addData", |xml| {
        let data = data(xml, "http://www.3s-software.com/plcopenxml/projectinformation");
        data.with(|xml| xml.tag("ProjectInformation").empty());
    });
}

/// The declarations of a program: it has none of its own.
pub fn interface(xml: &mut Xml, program: &Program) {
    xml.element("interface", |xml| {
        let timers = program.timers();
        if timers.is_empty() {
            xml.tag("localVars").empty();
        } else {
            xml.element("localVars", |xml| timers.iter().for_each(|name| timer(xml, name)));
        }
        documentation(xml, &program.description);
    });
}

/// What follows the body of a program.
pub fn after_body(xml: &mut Xml, program: &Program) {
    match program.body {
        Body::Sfc(_) => xml.element("addData", sfc_settings),
        Body::Ladder(_) => {}
    }
}

/// The empty configurations, then variables and task as vendor data of the project.
pub fn instances(xml: &mut Xml, project: &Project) {
    xml.element("instances", |xml| xml.tag("configurations").empty());
    xml.element("addData", |xml| {
        data(xml, "http://www.3s-software.com/plcopenxml/globalvars").with(|xml| globals(xml, project));
        data(xml, "http://www.3s-software.com/plcopenxml/application").with(|xml| {
            xml.tag("resource").attr("name", "Application").with(|xml| task(xml, project));
        });
    });
}

fn globals(xml: &mut Xml, project: &Project) {
    xml.tag("globalVars").attr("name", unused_name(project, "GVL")).with(|xml| {
        for global in project.globals.values() {
            variable(xml, global);
        }
    });
}

fn variable(xml: &mut Xml, global: &Global) {
    xml.tag("variable").attr("name", &global.name).attr_opt("address", global.address.as_deref()).with(|xml| {
        xml.element("type", |xml| xml.tag(global.initial.type_name()).empty());
        if let Some(value) = global.initial.literal() {
            xml.element("initialValue", |xml| xml.tag("simpleValue").attr("value", &value).empty());
        }
        documentation(xml, &global.description);
    });
}

fn task(xml: &mut Xml, project: &Project) {
    let task = &project.task;
    let seconds = format!("PT{}.{:03}", task.interval / 1000, task.interval % 1000);
    let interval = format!("{}S", seconds.trim_end_matches('0').trim_end_matches('.'));
    xml.tag("task").attr("name", &task.name).attr("interval", interval).attr("priority", 1).with(|xml| {
        for program in &project.programs {
            xml.tag("pouInstance").attr("name", &program.name).attr("typeName", "").with(|xml| {
                xml.element("documentation", |xml| xhtml(xml, ""));
            });
        }
        xml.element("addData", |xml| {
            data(xml, "http://www.3s-software.com/plcopenxml/tasksettings").with(|xml| {
                xml.tag("TaskSettings")
                    .attr("KindOfTask", "Cyclic")
                    .attr("Interval", format!("t#{}ms", task.interval))
                    .attr("IntervalUnit", "ms")
                    .attr("WithinSPSTimeSlicing", "true")
                    .with(|xml| {
                        xml.tag("Watchdog")
                            .attr("Enabled", "false")
                            .attr("TimeUnit", "ms")
                            .attr("Sensitivity", 1)
                            .empty();
                    });
            });
        });
    });
}

/// The body of a program in SFC.
pub fn sfc(xml: &mut Xml, project: &Project, sfc: &Sfc) {
    let drawing = layout::sfc::draw(project, sfc, Structure::Balanced);
    let mut numbers = Vec::with_capacity(drawing.elements.len());
    let (mut next, mut branches) = (0, 0);
    for (index, element) in drawing.elements.iter().enumerate() {
        let inputs = &element.inputs;
        let from = |wire: &Wire| numbers[wire.from];
        let follows = drawing.elements.get(index + 1).map(|e| &e.shape);
        match &element.shape {
            SfcShape::Step(id) => {
                let step = &sfc.steps[*id];
                let initial = *id == sfc.initial();
                xml.tag("step")
                    .attr("localId", next)
                    .attr_opt("initialStep", initial.then_some("true"))
                    .attr("name", &step.name)
                    .with(|xml| {
                        position(xml, "position", 0, 0);
                        connect_in(xml, None, inputs.iter().map(from));
                        xml.tag("connectionPointOut").attr("formalParameter", "sfc").empty();
                        if matches!(follows, Some(SfcShape::Action { .. })) {
                            xml.tag("connectionPointOutAction").attr("formalParameter", "x").empty();
                        }
                        let comment = (attribute::COMMENT, step.description.as_str());
                        let comment = (!step.description.is_empty()).then_some(comment);
                        let rest = [
                            (attribute::EXCLUDE, "FALSE"),
                            (attribute::SYMBOL, "0"),
                            (attribute::INITIAL_STEP, if initial { "TRUE" } else { "FALSE" }),
                            (attribute::DUPLICATION, "FALSE"),
                        ];
                        let name = (attribute::NAME, step.name.as_str());
                        attributes(xml, std::iter::once(name).chain(comment).chain(rest));
                    });
            }
            SfcShape::Action { flag } => {
                let name = project.globals[*flag].name.as_str();
                let action = next;
                // An action has a number of its own; that of its block comes after it.
                next += 1;
                xml.tag("actionBlock").attr("localId", next).with(|xml| {
                    position(xml, "position", 0, 0);
                    connect_in(xml, None, inputs.iter().map(from));
                    let tag = xml.tag("action").attr("localId", action).attr("qualifier", "N");
                    tag.attr("duration", "").attr("indicator", "").with(|xml| {
                        position(xml, "relPosition", 0, 0);
                        xml.tag("reference").attr("name", name).empty();
                        xml.tag("connectionPointOut").empty();
                        let list = [
                            (attribute::NAME, name),
                            (attribute::EXCLUDE, "FALSE"),
                            (attribute::SYMBOL, "0"),
                            (attribute::QUALIFIER, "N"),
                        ];
                        attributes(xml, list);
                    });
                });
            }
            SfcShape::Divergence { branches: ways } => {
                xml.tag("selectionDivergence").attr("localId", next).with(|xml| {
                    position(xml, "position", 0, 0);
                    connect_in(xml, None, inputs.iter().map(from));
                    for _ in ways {
                        xml.tag("connectionPointOut").attr("formalParameter", "sfc").empty();
                    }
                    let name = format!("Branch{branches}");
                    let list = [
                        (attribute::NAME, name.as_str()),
                        (attribute::EXCLUDE, "FALSE"),
                        (attribute::IS_PARALLEL, "FALSE"),
                    ];
                    attributes(xml, list);
                });
                branches += 1;
            }
            SfcShape::Condition { text } => {
                xml.tag("inVariable").attr("localId", next).with(|xml| {
                    position(xml, "position", 0, 0);
                    xml.tag("connectionPointOut").empty();
                    xml.tag("expression").text(text);
                });
            }
            SfcShape::Transition { transition } => {
                let (above, condition) = inputs.split_at(1);
                xml.tag("transition").attr("localId", next).with(|xml| {
                    position(xml, "position", 0, 0);
                    connect_in(xml, Some("sfc"), above.iter().map(from));
                    xml.element("condition", |xml| connect_in(xml, None, condition.iter().map(from)));
                    let text = match &drawing.elements[condition[0].from].shape {
                        SfcShape::Condition { text } => text.as_str(),
                        _ => "",
                    };
                    let description = transition.map_or("", |t| &sfc.transitions[t].description);
                    let comment = (!description.is_empty()).then_some((attribute::COMMENT, description));
                    let rest = [
                        (attribute::EXCLUDE, "FALSE"),
                        (attribute::SYMBOL, "0"),
                        (attribute::DUPLICATION, "FALSE"),
                        (attribute::PRIORITY, "0"),
                    ];
                    attributes(xml, [(attribute::NAME, text)].into_iter().chain(comment).chain(rest));
                });
            }
            SfcShape::Convergence { .. } => {
                xml.tag("selectionConvergence").attr("localId", next).with(|xml| {
                    position(xml, "position", 0, 0);
                    for wire in inputs {
                        connect_in(xml, Some("sfc"), [from(wire)]);
                    }
                    xml.tag("connectionPointOut").empty();
                });
            }
            SfcShape::Jump(to) => {
                let name = sfc.steps[*to].name.as_str();
                xml.tag("jumpStep").attr("localId", next).attr("targetName", name).with(|xml| {
                    position(xml, "position", 0, 0);
                    connect_in(xml, None, inputs.iter().map(from));
                    attributes(xml, [(attribute::NAME, name), (attribute::EXCLUDE, "FALSE")]);
                });
            }
        }
        numbers.push(next);
        next += 1;
    }
}

/// The body of a program in LD.
pub fn ladder(xml: &mut Xml, project: &Project, ladder: &Ladder) {
    let drawing = layout::ladder::draw(project, ladder, Branches::AsWritten);
    let mut numbers: Vec<u32> = Vec::with_capacity(drawing.elements.len());
    let mut next = 1;
    let mut number = || {
        next += 1;
        next - 1
    };

    xml.tag("leftPowerRail").attr("localId", 0).with(|xml| {
        position(xml, "position", 0, 0);
        xml.tag("connectionPointOut").attr("formalParameter", "none").empty();
    });
    for element in &drawing.elements {
        let from = |wire: &Wire| numbers[wire.from];
        let id = match element.shape {
            LadderShape::LeftRail { rung, .. } => {
                network(xml, &ladder.rungs[rung].comment, &mut number);
                0
            }
            // It stands at the beginning of the network.
            LadderShape::Comment { .. } => 0,
            LadderShape::Contact(literal) => {
                let id = number();
                let negated = if literal.negated { "true" } else { "false" };
                let tag = xml.tag("contact").attr("localId", id).attr("negated", negated);
                tag.attr("storage", "none").attr("edge", "none").with(|xml| {
                    position(xml, "position", 0, 0);
                    connect_in(xml, None, element.inputs.iter().map(from));
                    xml.tag("connectionPointOut").empty();
                    xml.tag("variable").text(&project.globals[literal.atom].name);
                });
                id
            }
            LadderShape::Preset { rung } => {
                let (id, timer) = (number(), &ladder.rungs[rung].timer);
                xml.tag("inVariable").attr("localId", id).with(|xml| {
                    position(xml, "position", 0, 0);
                    xml.tag("connectionPointOut").empty();
                    xml.tag("expression").text(&timer.as_ref().map(Timer::literal).unwrap_or_default());
                });
                id
            }
            LadderShape::Timer { rung } => {
                let (id, timer) = (number(), &ladder.rungs[rung].timer);
                let instance = timer.as_ref().map(|t| t.instance.as_str());
                let tag = xml.tag("block").attr("localId", id).attr("typeName", "TON");
                tag.attr_opt("instanceName", instance).with(|xml| {
                    position(xml, "position", 0, 0);
                    let (preset, condition) = element.inputs.split_at(1);
                    xml.element("inputVariables", |xml| {
                        for (pin, wires) in [("IN", condition), ("PT", preset)] {
                            xml.tag("variable")
                                .attr("formalParameter", pin)
                                .with(|xml| connect_in(xml, None, wires.iter().map(from)));
                        }
                    });
                    xml.tag("inOutVariables").empty();
                    xml.element("outputVariables", |xml| {
                        for pin in ["Q", "ET"] {
                            xml.tag("variable")
                                .attr("formalParameter", pin)
                                .with(|xml| xml.tag("connectionPointOut").empty());
                        }
                    });
                    xml.element("addData", |xml| {
                        data(xml, "http://www.3s-software.com/plcopenxml/fbdcalltype")
                            .with(|xml| xml.tag("CallType").attr("xmlns", "").text("functionblock"));
                    });
                });
                id
            }
            LadderShape::Operand { rung, operand } => {
                let id = number();
                xml.tag("inVariable").attr("localId", id).with(|xml| {
                    position(xml, "position", 0, 0);
                    xml.tag("connectionPointOut").empty();
                    xml.tag("expression").text(&operand_text(project, &ladder.rungs[rung], operand));
                });
                id
            }
            LadderShape::Function { rung } => {
                let (id, rung) = (number(), &ladder.rungs[rung]);
                if let Some(function) = &rung.function {
                    let operands: Vec<u32> = element.inputs.iter().map(from).collect();
                    operator(xml, id, function, &operands, &project.globals[rung.coil].name);
                }
                id
            }
            // It stands at the output pin.
            LadderShape::Result { .. } => 0,
            LadderShape::Coil { rung } => {
                let (id, rung) = (number(), &ladder.rungs[rung]);
                let storage = match rung.kind {
                    CoilKind::Plain => "none",
                    CoilKind::Set => "set",
                    CoilKind::Reset => "reset",
                };
                let tag = xml.tag("coil").attr("localId", id).attr("negated", "false").attr("storage", storage);
                tag.with(|xml| {
                    position(xml, "position", 0, 0);
                    let pin = rung.timer.as_ref().map(|_| "Q");
                    connect_in(xml, pin, element.inputs.iter().map(from));
                    xml.tag("connectionPointOut").empty();
                    xml.tag("variable").text(&project.globals[rung.coil].name);
                });
                id
            }
            LadderShape::RightRail => RIGHT_RAIL,
        };
        numbers.push(id);
    }
    xml.tag("rightPowerRail").attr("localId", RIGHT_RAIL).with(|xml| {
        position(xml, "position", 0, 0);
        xml.tag("connectionPointIn").empty();
    });
}

/// The box of a function, which comes from the rail and writes `result`.
fn operator(xml: &mut Xml, id: u32, function: &Function, operands: &[u32], result: &str) {
    xml.tag("block").attr("localId", id).attr("typeName", function.operator.name()).with(|xml| {
        position(xml, "position", 0, 0);
        xml.element("inputVariables", |xml| {
            let pin = |xml: &mut Xml, name: &str, from: u32| {
                xml.tag("variable").attr("formalParameter", name).with(|xml| connect_in(xml, None, [from]));
            };
            pin(xml, "EN", 0);
            for (place, &from) in operands.iter().enumerate() {
                pin(xml, &format!("In{}", place + 2), from);
            }
        });
        xml.tag("inOutVariables").empty();
        xml.element("outputVariables", |xml| {
            xml.tag("variable").attr("formalParameter", "ENO").with(|xml| xml.tag("connectionPointOut").empty());
            xml.tag("variable").attr("formalParameter", "Out2").with(|xml| {
                xml.element("connectionPointOut", |xml| xml.tag("expression").text(result));
            });
        });
        xml.element("addData", |xml| {
            data(xml, "http://www.3s-software.com/plcopenxml/fbdcalltype")
                .with(|xml| xml.tag("CallType").attr("xmlns", "").text("operator"));
        });
    });
}

/// What begins a network: its comment, its title.
fn network(xml: &mut Xml, comment: &str, number: &mut impl FnMut() -> u32) {
    xml.tag("comment").attr("localId", number()).attr("height", 0).attr("width", 0).with(|xml| {
        position(xml, "position", 0, 0);
        xml.element("content", |xml| xhtml(xml, comment));
    });
    xml.tag("vendorElement").attr("localId", number()).with(|xml| {
        position(xml, "position", 0, 0);
        xml.element("alternativeText", |xml| xhtml(xml, ""));
        xml.element("addData", |xml| {
            data(xml, "http://www.3s-software.com/plcopenxml/fbdelementtype")
                .with(|xml| xml.tag("ElementType").attr("xmlns", "").text("networktitle"));
        });
    });
}

/// Where lines end that come from the elements numbered `from`.
fn connect_in(xml: &mut Xml, parameter: Option<&str>, from: impl IntoIterator<Item = u32>) {
    let mut from = from.into_iter().peekable();
    if from.peek().is_none() {
        xml.tag("connectionPointIn").empty();
        return;
    }
    xml.element("connectionPointIn", |xml| {
        for id in from {
            xml.tag("connection").attr("refLocalId", id).attr_opt("formalParameter", parameter).empty();
        }
    });
}

fn data<'x>(xml: &'x mut Xml, name: &str) -> Tag<'x> {
    xml.tag("data").attr("name", name).attr("handleUnknown", "implementation")
}

fn documentation(xml: &mut Xml, text: &str) {
    if !text.is_empty() {
        xml.element("documentation", |xml| xhtml(xml, text));
    }
}

fn xhtml(xml: &mut Xml, text: &str) {
    let tag = xml.tag("xhtml").attr("xmlns", XHTML);
    if text.is_empty() { tag.empty() } else { tag.text(text) }
}

/// Names of the vendor attributes of SFC elements.
mod attribute {
    pub const NAME: &str = "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8";
    pub const COMMENT: &str = "7d894980-aeea-405c-a0f6-e2b26429c58f";
    pub const EXCLUDE: &str = "01580b27-6378-448b-8ecb-0e4b795b58d6";
    pub const SYMBOL: &str = "bc882c11-1e91-4dd8-a6b8-2075724ed18b";
    pub const INITIAL_STEP: &str = "6844a48e-46c2-4cc8-a185-a478f3b99cc0";
    pub const DUPLICATION: &str = "62e1754b-7629-4e63-9cec-10ae0c536f1f";
    pub const QUALIFIER: &str = "e174fc0d-80b0-4a9e-a530-ca239c249a50";
    pub const PRIORITY: &str = "8294df19-5962-4dee-a874-1051dabb0e3e";
    pub const IS_PARALLEL: &str = "23bdaa98-72ec-41f7-817b-9dede5697086";
}

fn attributes<'a>(xml: &mut Xml, list: impl IntoIterator<Item = (&'a str, &'a str)>) {
    xml.element("addData", |xml| {
        data(xml, "http://www.3s-software.com/plcopenxml/sfc/element").with(|xml| {
            xml.tag("attributes").attr("xmlns", "").with(|xml| {
                for (guid, value) in list {
                    xml.tag("attribute").attr("guid", guid).text(value);
                }
            });
        });
    });
}

/// The implicit variables of an SFC: all declared, none used, as a new SFC has them.
fn sfc_settings(xml: &mut Xml) {
    const FLAGS: [&str; 15] = [
        "EnableLimit",
        "Init",
        "Reset",
        "QuitError",
        "Pause",
        "Error",
        "Trans",
        "ErrorStep",
        "ErrorPOU",
        "CurrentStep",
        "Tip",
        "TipMode",
        "MaxFlags",
        "SFCErrorAnalyzation",
        "SFCErrorAnalyzationTable",
    ];
    data(xml, "http://www.3s-software.com/plcopenxml/sfcsettings").with(|xml| {
        xml.element("SFCSettings", |xml| {
            xml.tag("LibTitle").text("IecSfc");
            xml.tag("LibCompany").text("System");
            xml.tag("LibVersion").text("3.4.2.0");
            xml.tag("LibNamespace").text("IecSfc");
            xml.tag("CalcActiveTransOnly").text("false");
            xml.tag("UseDefaults").text("false");
            xml.element("Flags", |xml| {
                for flag in FLAGS {
                    xml.tag(flag).attr("Declare", "true").attr("Use", "false").empty();
                }
            });
        });
    });
}
