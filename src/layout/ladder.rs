//! Ladder to drawing: each rung between two rails of its own, a product per row, the coil on the
//! right.
//!
//! A rung with a function shows the function between its operands and its result.
//!
//! Contacts of one rung stand in columns as wide as their longest name; the coils of all but very
//! long rungs stand in one column.

use super::{Branches, MARGIN, text_width};
use crate::ir::drawing::{CHAR, Drawing, Element, ElementId, LINE, LadderShape, Point, Rect, Wire};
use crate::ir::ladder::{Function, Ladder, Operand, Rung, Timer};
use crate::ir::plc::{GlobalId, Project};
use crate::ir::sop::Literal;

/// Width and height of contacts and coils.
const SYMBOL: (i32, i32) = (20, LINE);
const RAIL: i32 = 4;
/// From one row of a rung to the next: a name, a contact, air.
const ROW: i32 = 40;
/// Between rungs. Some PLC IDEs order rungs by height and count rungs closer than this as one.
const RUNG_GAP: i32 = 40;
/// Where lines branch off between a rail and the first contact, or the last contact and the coil.
const JUNCTION: i32 = 20;
/// Between the names of neighbours.
const GAP: i32 = 20;
/// A timer: how far above its upper pins it begins, how far below them the lower ones are, and its
/// lower edge.
const TIMER: (i32, i32, i32) = (LINE + SYMBOL.1 / 2, 28, 44);
/// A function: from its upper edge to the first pin, from pin to pin, from the last pin to the lower
/// edge; and its narrowest width.
const FUNCTION: (i32, i32, i32, i32) = (LINE + SYMBOL.1 / 2, 28, SYMBOL.1, 80);
/// Longest line of a comment, in characters.
const COMMENT: usize = 100;

/// Contacts up to this width leave the coil in the common column; coils up to the other do not widen
/// it. One long rung among short ones must not move all coils off the screen.
const COMMON: (i32, i32) = (800, 240);

/// Draws `ladder`.
pub fn draw(project: &Project, ladder: &Ladder, branches: Branches) -> Drawing<LadderShape> {
    let rungs: Vec<Plan> = ladder.rungs.iter().map(|r| plan(project, r, branches)).collect();
    let common = rungs.iter().fold((0, 0), |common, rung| {
        (common.0.max(rung.contacts.min(COMMON.0)), common.1.max(rung.coil.min(COMMON.1)))
    });

    let mut drawing = Drawing::new();
    let (mut y, mut right) = (MARGIN, 0);
    for (index, (rung, plan)) in ladder.rungs.iter().zip(&rungs).enumerate() {
        let frame = Frame::new(project, common.0.max(plan.contacts), common.1.max(plan.coil));
        right = right.max(frame.right + RAIL);
        y = frame.rung(&mut drawing, index, rung, plan, y) + RUNG_GAP;
    }
    let comments = drawing.elements.iter().filter(|e| matches!(e.shape, LadderShape::Comment { .. }));
    let widest = comments.map(|c| c.area.x + c.area.width).max().unwrap_or(0);
    drawing.width = drawing.width.max(right.max(widest) + MARGIN);
    drawing.height = y - RUNG_GAP + MARGIN;
    drawing
}

/// What a rung needs: its rows of contacts and widths.
struct Plan {
    rows: Vec<Vec<Literal<GlobalId>>>,
    /// Of each column of contacts.
    columns: Vec<i32>,
    /// Of all columns of contacts, and of the timer behind them.
    contacts: i32,
    /// How far behind the first contact the timer begins, and its width.
    timer: Option<(i32, i32)>,
    /// Of the coil.
    coil: i32,
}

fn plan(project: &Project, rung: &Rung, branches: Branches) -> Plan {
    debug_assert!(!rung.condition.is_zero(), "a coil that nothing feeds has no rung");
    let width = |g: GlobalId| text_width(&project.globals[g].name).max(SYMBOL.0) + GAP;
    let coil = width(rung.coil);
    if rung.condition.is_one() {
        return Plan { rows: Vec::new(), columns: Vec::new(), contacts: 0, timer: None, coil };
    }
    let mut rows: Vec<Vec<_>> = rung.condition.products().iter().map(|p| p.literals().to_vec()).collect();
    let series = rows.iter().any(|r| r.len() > 1);
    if series && branches == Branches::EqualShape {
        for row in rows.iter_mut().filter(|r| r.len() == 1) {
            row.push(row[0]);
        }
    }
    let mut columns: Vec<i32> = Vec::new();
    for row in &rows {
        for (i, literal) in row.iter().enumerate() {
            let width = width(literal.atom);
            match columns.get_mut(i) {
                Some(c) => *c = width.max(*c),
                None => columns.push(width),
            }
        }
    }
    let contacts: i32 = columns.iter().sum();
    let timer = rung
        .timer
        .as_ref()
        .map(|t| (contacts + JUNCTION + text_width(&t.literal()) + 2 * GAP, text_width(&t.instance) + 2 * GAP));
    let contacts = timer.map_or(contacts, |(x, width)| x + width);
    Plan { rows, columns, contacts, timer, coil }
}

/// Where the columns of a rung stand.
struct Frame<'a> {
    project: &'a Project,
    /// Left edge of the first column of contacts.
    first: i32,
    /// Where lines of several branches join.
    join: i32,
    /// Middle of the coil.
    coil: i32,
    /// Left edge of the right rail.
    right: i32,
}

impl<'a> Frame<'a> {
    /// For contacts and a coil of these widths.
    fn new(project: &'a Project, contacts: i32, coil: i32) -> Self {
        let first = MARGIN + RAIL + JUNCTION;
        let column = first + contacts + JUNCTION;
        let right = column + coil + JUNCTION;
        Frame { project, first, join: column - JUNCTION / 2, coil: column + coil / 2, right }
    }

    /// Draws a rung from `y` downwards and returns where it ends.
    fn rung(&self, drawing: &mut Drawing<LadderShape>, index: usize, rung: &Rung, plan: &Plan, y: i32) -> i32 {
        let comment = comment_area(&rung.comment, y);
        let y = comment.map_or(y, |c| c.y + c.height + LINE / 2);
        let rows = ROW * i32::try_from(plan.rows.len().max(1)).expect("a rung has less than 2^31 branches");
        let level = y + LINE + SYMBOL.1 / 2;
        let height = match (&rung.timer, &rung.function) {
            (Some(_), _) => rows.max(LINE + SYMBOL.1 / 2 + TIMER.2),
            (None, Some(function)) => function_height(function),
            (None, None) => rows,
        };

        let area = Rect { x: MARGIN, y, width: RAIL, height };
        let rail = drawing.push(Element {
            shape: LadderShape::LeftRail { rung: index, outlet: level },
            area,
            label: None,
            inputs: Vec::new(),
        });
        if let Some(area) = comment {
            drawing.push(Element {
                shape: LadderShape::Comment { rung: index },
                area,
                label: None,
                inputs: Vec::new(),
            });
        }
        if let Some(function) = &rung.function {
            self.function(drawing, (index, function), rung.coil, y);
            return y + height;
        }
        let start = Point { x: MARGIN + RAIL, y: level };

        let coil = self.symbol(self.coil, level, rung.coil);
        let mut feeds = Vec::with_capacity(plan.rows.len().max(1));
        let mut row_level = level;
        for row in &plan.rows {
            let (last, from) = self.row(drawing, row, &plan.columns, (rail, start), row_level);
            feeds.push(Wire { from: last, path: bend(from, self.join, coil.0.left()) });
            row_level += ROW;
        }
        if feeds.is_empty() {
            feeds.push(Wire { from: rail, path: vec![start, coil.0.left()] });
        }
        if let (Some(timer), Some((x, width))) = (&rung.timer, plan.timer) {
            let top = Point { x: self.first + x, y: level };
            feeds = vec![draw_timer(drawing, index, timer, feeds, (top, width), coil.0.left())];
        }
        let (area, label) = coil;
        let id =
            drawing.push(Element { shape: LadderShape::Coil { rung: index }, area, label: Some(label), inputs: feeds });

        let rail = Rect { x: self.right, y, width: RAIL, height };
        let wire = Wire { from: id, path: vec![area.right(), Point { x: rail.x, y: level }] };
        drawing.push(Element { shape: LadderShape::RightRail, area: rail, label: None, inputs: vec![wire] });
        y + height
    }

    /// Draws a function from `y` downwards, between its operands and what takes its result.
    fn function(
        &self,
        drawing: &mut Drawing<LadderShape>,
        (rung, function): (usize, &Function),
        result: GlobalId,
        y: i32,
    ) {
        let (first, next, _, narrowest) = FUNCTION;
        let name = |g: GlobalId| self.project.globals[g].name.as_str();
        let texts: Vec<String> = function
            .operands
            .iter()
            .map(|o| match o {
                Operand::Const(n) => n.to_string(),
                Operand::Global(g) => name(*g).to_owned(),
            })
            .collect();
        let widest = texts.iter().map(|t| text_width(t)).max().unwrap_or(0) + GAP;
        let x = self.first + widest + GAP;
        let mut inputs = Vec::with_capacity(texts.len());
        let mut level = y + first;
        for (operand, text) in texts.iter().enumerate() {
            let width = text_width(text) + GAP;
            let area = Rect { x: x - GAP - width, y: level - LINE / 2, width, height: LINE };
            let shape = LadderShape::Operand { rung, operand };
            let from = drawing.push(Element { shape, area, label: None, inputs: Vec::new() });
            inputs.push(Wire { from, path: vec![area.right(), Point { x, y: level }] });
            level += next;
        }
        let area = Rect { x, y, width: narrowest, height: function_height(function) };
        let from = drawing.push(Element { shape: LadderShape::Function { rung }, area, label: None, inputs });
        let start = Point { x: x + narrowest, y: y + first };
        let text = text_width(name(result)) + GAP;
        let area = Rect { x: start.x + GAP, y: start.y - LINE / 2, width: text, height: LINE };
        let wire = Wire { from, path: vec![start, area.left()] };
        drawing.push(Element { shape: LadderShape::Result { rung }, area, label: None, inputs: vec![wire] });
        drawing.width = drawing.width.max(area.x + area.width + MARGIN);
    }

    /// Draws a product; returns its last contact and where the line leaves it.
    fn row(
        &self,
        drawing: &mut Drawing<LadderShape>,
        row: &[Literal<GlobalId>],
        columns: &[i32],
        (mut from, mut start): (ElementId, Point),
        level: i32,
    ) -> (ElementId, Point) {
        let mut x = self.first;
        for (literal, width) in row.iter().zip(columns) {
            let (area, label) = self.symbol(x + width / 2, level, literal.atom);
            let path = bend(start, self.first - JUNCTION / 2, area.left());
            let element = Element {
                shape: LadderShape::Contact(*literal),
                area,
                label: Some(label),
                inputs: vec![Wire { from, path }],
            };
            from = drawing.push(element);
            start = area.right();
            x += width;
        }
        (from, start)
    }

    /// The boxes of a contact or coil at `level` around `x`, and of its name above it.
    fn symbol(&self, x: i32, level: i32, global: GlobalId) -> (Rect, Rect) {
        let (width, height) = SYMBOL;
        let text = text_width(&self.project.globals[global].name);
        let y = level - height / 2;
        let area = Rect { x: x - width / 2, y, width, height };
        (area, Rect { x: x - text / 2, y: y - LINE, width: text, height: LINE })
    }
}

/// Draws a timer whose upper pins are at the height of `pin`, with its preset time; `feeds`, drawn to
/// the coil, end at it. Returns the line to the coil.
fn draw_timer(
    drawing: &mut Drawing<LadderShape>,
    rung: usize,
    timer: &Timer,
    feeds: Vec<Wire>,
    (pin, width): (Point, i32),
    coil: Point,
) -> Wire {
    let (above, preset, below) = TIMER;
    let area = Rect { x: pin.x, y: pin.y - above, width, height: above + below };
    let text = text_width(&timer.literal()) + GAP;
    let at = Point { x: pin.x, y: pin.y + preset };
    let value = Rect { x: pin.x - GAP - text, y: at.y - LINE / 2, width: text, height: LINE };
    let shape = LadderShape::Preset { rung };
    let value_id = drawing.push(Element { shape, area: value, label: None, inputs: Vec::new() });
    let mut inputs = vec![Wire { from: value_id, path: vec![value.right(), at] }];
    inputs.extend(feeds.into_iter().map(|mut wire| {
        for point in &mut wire.path {
            point.x = point.x.min(pin.x);
        }
        wire
    }));
    let id = drawing.push(Element { shape: LadderShape::Timer { rung }, area, label: None, inputs });
    Wire { from: id, path: vec![Point { x: pin.x + width, y: pin.y }, coil] }
}

fn function_height(function: &Function) -> i32 {
    let (first, next, last, _) = FUNCTION;
    let pins = i32::try_from(function.operands.len().max(1)).expect("a function has few operands");
    first + next * (pins - 1) + last
}

/// A line from `start` to `end`, which changes its height, if it has to, at `x`.
fn bend(start: Point, x: i32, end: Point) -> Vec<Point> {
    if start.y == end.y {
        return vec![start, end];
    }
    vec![start, Point { x, y: start.y }, Point { x, y: end.y }, end]
}

fn comment_area(comment: &str, y: i32) -> Option<Rect> {
    if comment.is_empty() {
        return None;
    }
    let (mut lines, mut widest) = (0, 0);
    for line in comment.lines() {
        let length = line.chars().count();
        widest = widest.max(length.min(COMMENT));
        // Lines break between words, so some of them stay shorter.
        lines += 1 + length / (COMMENT * 3 / 4);
    }
    let units = |n: usize| i32::try_from(n).expect("a comment is shorter than a source file");
    let width = units(widest) * CHAR + GAP;
    Some(Rect { x: MARGIN, y, width, height: units(lines.max(1)) * LINE + LINE / 2 })
}
