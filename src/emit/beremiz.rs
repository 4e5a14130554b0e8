//! PLC project to PLCopen XML as Beremiz, OpenPLC Editor and their kin take it (TC6 v2.01).
//!
//! Here the XML file *is* the project, and a code generator turns it into structured text that an
//! open compiler takes. What follows from that:
//!
//! - Elements stand at their places and connections run along drawn lines; the editor shows nothing
//!   else.
//! - A program declares every global that it uses as VAR_EXTERNAL, and one without variables is an
//!   error.
//! - Globals with an address stand before the others, whose names the list of addresses would
//!   otherwise take up.
//! - Transitions carry their priority, which makes those out of one step exclude each other.
//! - A step has one divergence, and branches end in jumps: the generator loses nested divergences
//!   and breaks on jumps into a convergence.
//! - Parallel branches of a rung are all single contacts or all series; it breaks on a mixture.
//! - A function has no EN: nothing but its operands feeds it, and its result goes to an outVariable.
//! - Texts stand in CDATA directly within `xhtml:p`.

use super::xml::{Tag, Xml};
use super::{operand_text, position, timer, unused_name};
use crate::ir::drawing::{LadderShape, Point, Rect, SfcShape, Wire};
use crate::ir::ladder::{CoilKind, Function, Ladder, Operator, Timer};
use crate::ir::plc::{Global, Program, Project};
use crate::ir::sfc::Sfc;
use crate::layout::{self, Branches, Structure};

/// What the local variable of a program is called that uses no global.
const UNUSED: &str = "Unused";

/// The root element, still open for attributes.
pub fn root(xml: &mut Xml) -> Tag<'_> {
    xml.tag("project")
        .attr("xmlns", "http://www.plcopen.org/xml/tc6_0201")
        .attr("xmlns:xhtml", "http://www.w3.org/1999/xhtml")
}

/// The declarations of a program.
pub fn interface(xml: &mut Xml, project: &Project, program: &Program) {
    let (used, timers) = (program.globals(), program.timers());
    xml.element("interface", |xml| {
        if !timers.is_empty() {
            xml.element("localVars", |xml| timers.iter().for_each(|name| timer(xml, name)));
        }
        if used.is_empty() {
            xml.element("localVars", |xml| {
                xml.tag("variable").attr("name", unused_name(project, UNUSED)).with(|xml| kind(xml, "BOOL"));
            });
        } else {
            xml.element("externalVars", |xml| {
                for global in used {
                    let global = &project.globals[global];
                    let variable = xml.tag("variable").attr("name", &global.name);
                    variable.with(|xml| kind(xml, global.initial.type_name()));
                }
            });
        }
    });
}

/// What follows the body of a program.
pub fn after_body(xml: &mut Xml, program: &Program) {
    documentation(xml, &program.description);
}

/// Configuration, resource, task and global variables.
pub fn instances(xml: &mut Xml, project: &Project) {
    let task = &project.task;
    xml.element("instances", |xml| {
        xml.element("configurations", |xml| {
            xml.tag("configuration").attr("name", &task.configuration).with(|xml| {
                xml.tag("resource").attr("name", &task.resource).with(|xml| {
                    xml.tag("task")
                        .attr("name", &task.name)
                        .attr("interval", format!("T#{}ms", task.interval))
                        .attr("priority", 0)
                        .with(|xml| {
                            for p in &project.programs {
                                xml.tag("pouInstance").attr("name", &p.instance).attr("typeName", &p.name).empty();
                            }
                        });
                    if !project.globals.is_empty() {
                        globals(xml, project);
                    }
                });
            });
        });
    });
}

fn globals(xml: &mut Xml, project: &Project) {
    xml.element("globalVars", |xml| {
        let located = project.globals.values().filter(|g| g.address.is_some());
        let others = project.globals.values().filter(|g| g.address.is_none());
        for global in located.chain(others) {
            variable(xml, global);
        }
    });
}

fn variable(xml: &mut Xml, global: &Global) {
    xml.tag("variable").attr("name", &global.name).attr_opt("address", global.address.as_deref()).with(|xml| {
        kind(xml, global.initial.type_name());
        if let Some(value) = global.initial.literal() {
            xml.element("initialValue", |xml| xml.tag("simpleValue").attr("value", &value).empty());
        }
        documentation(xml, &global.description);
    });
}

fn kind(xml: &mut Xml, name: &'static str) {
    xml.element("type", |xml| xml.tag(name).empty());
}

fn documentation(xml: &mut Xml, text: &str) {
    if !text.is_empty() {
        xml.element("documentation", |xml| xml.tag("xhtml:p").cdata(text));
    }
}

/// The body of a program in SFC.
pub fn sfc(xml: &mut Xml, project: &Project, sfc: &Sfc) {
    let drawing = layout::sfc::draw(project, sfc, Structure::Jumps);
    let mut numbers = Numbers::new(drawing.elements.len());
    for (index, element) in drawing.elements.iter().enumerate() {
        let (area, inputs) = (&element.area, &element.inputs);
        match &element.shape {
            SfcShape::Step(id) => {
                let step = &sfc.steps[*id];
                let acts =
                    matches!(drawing.elements.get(index + 1), Some(e) if matches!(e.shape, SfcShape::Action { .. }));
                numbers
                    .tag(xml, "step", area)
                    .attr("name", &step.name)
                    .attr_opt("initialStep", (*id == sfc.initial()).then_some("true"))
                    .with(|xml| {
                        position(xml, "position", area.x, area.y);
                        for wire in inputs {
                            connect_in(xml, "connectionPointIn", area, area.top(), [wire], &numbers);
                        }
                        connect_out(xml, "connectionPointOut", Some(""), area, area.bottom());
                        if acts {
                            connect_out(xml, "connectionPointOutAction", Some(""), area, area.right());
                        }
                        documentation(xml, &step.description);
                    });
            }
            SfcShape::Action { flag } => {
                let action = numbers.reserve();
                numbers.tag(xml, "actionBlock", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.left(), inputs, &numbers);
                    xml.tag("action").attr("localId", action).attr("qualifier", "N").with(|xml| {
                        position(xml, "relPosition", 0, 0);
                        xml.tag("reference").attr("name", &project.globals[*flag].name).empty();
                    });
                });
            }
            SfcShape::Divergence { branches } => {
                numbers.tag(xml, "selectionDivergence", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.top(), inputs, &numbers);
                    for &x in branches {
                        let at = Point { x, y: area.y + area.height };
                        connect_out(xml, "connectionPointOut", Some(""), area, at);
                    }
                });
            }
            SfcShape::Condition { text } => {
                numbers.tag(xml, "inVariable", area).attr("negated", "false").with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_out(xml, "connectionPointOut", None, area, area.right());
                    xml.tag("expression").text(text);
                });
            }
            SfcShape::Transition { transition } => {
                let transition = transition.map(|t| &sfc.transitions[t]);
                let priority = transition.map(|t| t.priority);
                numbers.tag(xml, "transition", area).attr_opt("priority", priority).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    let (above, condition) = inputs.split_at(1);
                    connect_in(xml, "connectionPointIn", area, area.top(), above, &numbers);
                    connect_out(xml, "connectionPointOut", None, area, area.bottom());
                    xml.element("condition", |xml| {
                        connect_in(xml, "connectionPointIn", area, area.left(), condition, &numbers);
                    });
                    documentation(xml, transition.map_or("", |t| &t.description));
                });
            }
            SfcShape::Convergence { axis } => {
                numbers.tag(xml, "selectionConvergence", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    for wire in inputs {
                        connect_in(xml, "connectionPointIn", area, area.top(), [wire], &numbers);
                    }
                    let at = Point { x: *axis, y: area.y + area.height };
                    connect_out(xml, "connectionPointOut", None, area, at);
                });
            }
            SfcShape::Jump(to) => {
                let name = &sfc.steps[*to].name;
                numbers.tag(xml, "jumpStep", area).attr("targetName", name).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.top(), inputs, &numbers);
                });
            }
        }
        numbers.given(None);
    }
}

/// The body of a program in LD.
pub fn ladder(xml: &mut Xml, project: &Project, ladder: &Ladder) {
    if ladder.rungs.is_empty() {
        return idle(xml, &unused_name(project, UNUSED));
    }
    let drawing = layout::ladder::draw(project, ladder, Branches::EqualShape);
    let mut numbers = Numbers::new(drawing.elements.len());
    for element in &drawing.elements {
        let (area, inputs) = (&element.area, &element.inputs);
        match element.shape {
            // A function is fed by its operands alone.
            LadderShape::LeftRail { rung, .. } if ladder.rungs[rung].function.is_some() => {
                numbers.skip();
                continue;
            }
            LadderShape::LeftRail { outlet, .. } => {
                numbers.tag(xml, "leftPowerRail", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    let at = Point { x: area.x + area.width, y: outlet };
                    connect_out(xml, "connectionPointOut", Some(""), area, at);
                });
            }
            LadderShape::Comment { rung } => {
                numbers.tag(xml, "comment", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    xml.element("content", |xml| xml.tag("xhtml:p").cdata(&ladder.rungs[rung].comment));
                });
            }
            LadderShape::Contact(literal) => {
                let negated = if literal.negated { "true" } else { "false" };
                numbers.tag(xml, "contact", area).attr("negated", negated).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.left(), inputs, &numbers);
                    connect_out(xml, "connectionPointOut", None, area, area.right());
                    xml.tag("variable").text(&project.globals[literal.atom].name);
                });
            }
            LadderShape::Preset { rung } => {
                let literal = ladder.rungs[rung].timer.as_ref().map(Timer::literal).unwrap_or_default();
                numbers.tag(xml, "inVariable", area).attr("negated", "false").with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_out(xml, "connectionPointOut", None, area, area.right());
                    xml.tag("expression").text(&literal);
                });
            }
            LadderShape::Timer { rung } => {
                let instance = ladder.rungs[rung].timer.as_ref().map(|t| t.instance.as_str());
                let tag = numbers.tag(xml, "block", area).attr("typeName", "TON").attr_opt("instanceName", instance);
                tag.with(|xml| timer_pins(xml, area, inputs, &numbers));
                numbers.given(Some("Q"));
                continue;
            }
            LadderShape::Operand { rung, operand } => {
                let text = operand_text(project, &ladder.rungs[rung], operand);
                numbers.tag(xml, "inVariable", area).attr("negated", "false").with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_out(xml, "connectionPointOut", None, area, area.right());
                    xml.tag("expression").text(&text);
                });
            }
            LadderShape::Function { rung } => {
                if let Some(Function { operator, .. }) = &ladder.rungs[rung].function {
                    let tag = numbers.tag(xml, "block", area).attr("typeName", operator.name());
                    tag.with(|xml| function_pins(xml, area, *operator, inputs, &numbers));
                }
                numbers.given(Some("OUT"));
                continue;
            }
            LadderShape::Result { rung } => {
                numbers.tag(xml, "outVariable", area).attr("negated", "false").with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.left(), inputs, &numbers);
                    xml.tag("expression").text(&project.globals[ladder.rungs[rung].coil].name);
                });
            }
            LadderShape::Coil { rung } => {
                let rung = &ladder.rungs[rung];
                let storage = match rung.kind {
                    CoilKind::Plain => None,
                    CoilKind::Set => Some("set"),
                    CoilKind::Reset => Some("reset"),
                };
                let tag = numbers.tag(xml, "coil", area).attr("negated", "false").attr_opt("storage", storage);
                tag.with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.left(), inputs, &numbers);
                    connect_out(xml, "connectionPointOut", None, area, area.right());
                    xml.tag("variable").text(&project.globals[rung.coil].name);
                });
            }
            LadderShape::RightRail => {
                numbers.tag(xml, "rightPowerRail", area).with(|xml| {
                    position(xml, "position", area.x, area.y);
                    connect_in(xml, "connectionPointIn", area, area.left(), inputs, &numbers);
                });
            }
        }
        numbers.given(None);
    }
}

/// The pins of a timer; `inputs` are its preset time, then what starts it.
fn timer_pins(xml: &mut Xml, area: &Rect, inputs: &[Wire], numbers: &Numbers) {
    position(xml, "position", area.x, area.y);
    let (preset, condition) = inputs.split_at(1);
    xml.element("inputVariables", |xml| {
        for (pin, wires) in [("IN", condition), ("PT", preset)] {
            xml.tag("variable").attr("formalParameter", pin).with(|xml| {
                connect_in(xml, "connectionPointIn", area, area.left(), wires, numbers);
            });
        }
    });
    xml.tag("inOutVariables").empty();
    let height = |wires: &[Wire]| wires.first().and_then(|w| w.path.last()).map_or(area.y, |p| p.y);
    xml.element("outputVariables", |xml| {
        for (pin, y) in [("Q", height(condition)), ("ET", height(preset))] {
            xml.tag("variable").attr("formalParameter", pin).with(|xml| {
                connect_out(xml, "connectionPointOut", None, area, Point { x: area.x + area.width, y });
            });
        }
    });
}

/// The pins of a function; `inputs` are its operands.
fn function_pins(xml: &mut Xml, area: &Rect, operator: Operator, inputs: &[Wire], numbers: &Numbers) {
    position(xml, "position", area.x, area.y);
    xml.element("inputVariables", |xml| {
        for (pin, wire) in operator.pins().iter().zip(inputs) {
            xml.tag("variable").attr("formalParameter", pin).with(|xml| {
                connect_in(xml, "connectionPointIn", area, area.left(), [wire], numbers);
            });
        }
    });
    xml.tag("inOutVariables").empty();
    let y = inputs.first().and_then(|w| w.path.last()).map_or(area.y, |p| p.y);
    xml.element("outputVariables", |xml| {
        xml.tag("variable").attr("formalParameter", "OUT").with(|xml| {
            connect_out(xml, "connectionPointOut", None, area, Point { x: area.x + area.width, y });
        });
    });
}

/// A rung that does nothing, for a ladder without rungs: a program has to have a body.
fn idle(xml: &mut Xml, variable: &str) {
    let mut numbers = Numbers::new(2);
    let rail = Rect { x: 40, y: 40, width: 4, height: 40 };
    let coil = Rect { x: 80, y: 52, width: 20, height: 16 };
    let wire = Wire { from: 0, path: vec![rail.right(), coil.left()] };
    numbers.tag(xml, "leftPowerRail", &rail).with(|xml| {
        position(xml, "position", rail.x, rail.y);
        connect_out(xml, "connectionPointOut", Some(""), &rail, rail.right());
    });
    numbers.given(None);
    numbers.tag(xml, "coil", &coil).with(|xml| {
        position(xml, "position", coil.x, coil.y);
        connect_in(xml, "connectionPointIn", &coil, coil.left(), [&wire], &numbers);
        connect_out(xml, "connectionPointOut", None, &coil, coil.right());
        xml.tag("variable").text(variable);
    });
}

/// The numbers by which the elements of a body refer to each other.
struct Numbers {
    /// Those of the elements so far, with the pin at which lines leave a box.
    given: Vec<(u32, Option<&'static str>)>,
    next: u32,
}

impl Numbers {
    fn new(elements: usize) -> Self {
        Numbers { given: Vec::with_capacity(elements), next: 1 }
    }

    /// A number for a part of the current element.
    fn reserve(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    /// Begins the current element.
    fn tag<'x>(&self, xml: &'x mut Xml, name: &'static str, area: &Rect) -> Tag<'x> {
        xml.tag(name).attr("localId", self.next).attr("height", area.height).attr("width", area.width)
    }

    /// The current element is not written; no line leaves it.
    fn skip(&mut self) {
        self.given.push((0, None));
    }

    /// The current element is written; lines leave it at `pin`.
    fn given(&mut self, pin: Option<&'static str>) {
        self.given.push((self.next, pin));
        self.next += 1;
    }
}

/// A point of `area` where lines end; `at` is where it is if none has a path.
fn connect_in<'w>(
    xml: &mut Xml,
    name: &'static str,
    area: &Rect,
    at: Point,
    wires: impl IntoIterator<Item = &'w Wire>,
    numbers: &Numbers,
) {
    let mut wires = wires.into_iter().peekable();
    let at = wires.peek().and_then(|w| w.path.last().copied()).unwrap_or(at);
    xml.element(name, |xml| {
        position(xml, "relPosition", at.x - area.x, at.y - area.y);
        for wire in wires {
            let (number, pin) = numbers.given[wire.from];
            xml.tag("connection").attr("refLocalId", number).attr_opt("formalParameter", pin).with(|xml| {
                for point in wire.path.iter().rev() {
                    position(xml, "position", point.x, point.y);
                }
            });
        }
    });
}

/// A point of `area` where lines begin.
fn connect_out(xml: &mut Xml, name: &'static str, parameter: Option<&str>, area: &Rect, at: Point) {
    xml.tag(name)
        .attr_opt("formalParameter", parameter)
        .with(|xml| position(xml, "relPosition", at.x - area.x, at.y - area.y));
}
