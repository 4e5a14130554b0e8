//! SFC to drawing: a spanning tree of steps, each above the branches that leave it.
//!
//! Rows have one height: a step in row 2d, its transitions in row 2d + 1, what follows them in row
//! 2d + 2. Blocks of steps move together until their outlines touch, so a short branch stands beside
//! a long one and the main sequence runs straight down.
//!
//! # Which branch a step stands under
//!
//! The one that leads to it on the longest way from the initial step, ways back left aside. So a
//! sequence stays a sequence when a transition skips a part of it: the skipping one jumps.

use super::{MARGIN, Structure, text_width};
use crate::ir::drawing::{Drawing, Element, ElementId, LINE, Point, Rect, SfcShape, Wire};
use crate::ir::expr::{Expr, IEC};
use crate::ir::plc::{GlobalId, Project};
use crate::ir::sfc::{Sfc, StepId};

/// Height of a row; the highest thing in it is a step.
const ROW: i32 = 30;
/// From the top of one row to that of the next.
const PITCH: i32 = 60;
/// Between neighbours in a row.
const GAP: i32 = 20;
const TRANSITION: (i32, i32) = (20, 2);
const CONDITION_HEIGHT: i32 = 24;
const JUMP: (i32, i32) = (12, 14);
/// What a line that runs down through a row keeps free on either side.
const LANE: i32 = 6;

/// Draws `sfc`. Every step must be reachable from the initial one.
pub fn draw(project: &Project, sfc: &Sfc, structure: Structure) -> Drawing<SfcShape> {
    let exits = exits(sfc, structure);
    let last = match structure {
        Structure::Jumps => None,
        Structure::Balanced => last_target(sfc, &exits),
    };
    let texts = sfc.transitions.iter().map(|t| condition(project, &t.condition)).collect();
    let shifts = exits.iter().map(|e| vec![0; e.len()]).collect();
    let mut drawer =
        Drawer { project, sfc, structure, exits, last, texts, shifts, drawing: Drawing::new(), extent: (0, 0) };

    let outline = drawer.measure(sfc.initial());
    let left = outline.iter().map(|r| r.left).min().unwrap_or(0);
    let right = outline.iter().map(|r| r.right).max().unwrap_or(0);
    let axis = MARGIN - left;
    let end = drawer.place(sfc.initial(), axis, 0, None);
    drawer.finish(end);
    drawer.drawing.width = (right - left + 2 * MARGIN).max(drawer.extent.0 + MARGIN);
    drawer.drawing.height = drawer.extent.1 + MARGIN;
    drawer.drawing
}

fn condition(project: &Project, e: &Expr<GlobalId>) -> String {
    let mut text = String::new();
    e.write(&mut text, &IEC, &mut |&g, f| f.write_str(&project.globals[g].name)).expect("a String takes everything");
    text
}

/// A way out of a step.
#[derive(Clone, Copy)]
struct Exit {
    /// Index of the transition; nothing for one that never fires, where blocks must not end open.
    transition: Option<usize>,
    to: StepId,
    /// Whether the target stands below.
    continues: bool,
}

/// The ways out of each step, in order of priority, with those marked that lead into the tree.
fn exits(sfc: &Sfc, structure: Structure) -> Vec<Vec<Exit>> {
    let outgoing = sfc.outgoing();
    let order = topological(sfc, &outgoing);
    let mut rank = vec![usize::MAX; sfc.steps.len()];
    for (i, s) in order.iter().enumerate() {
        rank[s.index()] = i;
    }
    assert!(order.len() == sfc.steps.len(), "every step is reachable from the initial one");

    let mut length = vec![0usize; sfc.steps.len()];
    let mut entry: Vec<Option<usize>> = vec![None; sfc.steps.len()];
    for from in &order {
        for &t in &outgoing[from.index()] {
            let to = sfc.transitions[t].to.index();
            let forward = rank[from.index()] < rank[to];
            if forward && length[to] < length[from.index()] + 1 {
                length[to] = length[from.index()] + 1;
                entry[to] = Some(t);
            }
        }
    }

    let mut exits: Vec<Vec<Exit>> = Vec::with_capacity(outgoing.len());
    for leaving in &outgoing {
        let exit = |&t: &usize| {
            let to = sfc.transitions[t].to;
            Exit { transition: Some(t), to, continues: entry[to.index()] == Some(t) }
        };
        let mut ways: Vec<Exit> = leaving.iter().map(exit).collect();
        if ways.is_empty() && structure == Structure::Balanced {
            ways.push(Exit { transition: None, to: sfc.initial(), continues: false });
        }
        exits.push(ways);
    }
    exits
}

/// The steps in reverse postorder: but for ways back, each stands after all that lead to it.
fn topological(sfc: &Sfc, outgoing: &[Vec<usize>]) -> Vec<StepId> {
    let mut seen = vec![false; sfc.steps.len()];
    let mut order = Vec::with_capacity(sfc.steps.len());
    let mut stack = vec![(sfc.initial(), 0)];
    seen[sfc.initial().index()] = true;
    while let Some((step, next)) = stack.pop() {
        match outgoing[step.index()].get(next) {
            Some(&t) => {
                stack.push((step, next + 1));
                let to = sfc.transitions[t].to;
                if !std::mem::replace(&mut seen[to.index()], true) {
                    stack.push((to, 0));
                }
            }
            None => order.push(step),
        }
    }
    order.reverse();
    order
}

/// Where the one jump goes that ends a balanced body: to the initial step if any branch goes there,
/// else where most branches go.
fn last_target(sfc: &Sfc, exits: &[Vec<Exit>]) -> Option<StepId> {
    let mut count = vec![0usize; sfc.steps.len()];
    for exit in exits.iter().flatten().filter(|e| !e.continues) {
        count[exit.to.index()] += 1;
    }
    if count[sfc.initial().index()] > 0 {
        return Some(sfc.initial());
    }
    let most = *count.iter().max()?;
    sfc.steps.ids().find(|s| count[s.index()] == most)
}

/// How far a block reaches from its axis in one row.
#[derive(Clone, Copy)]
struct Reach {
    left: i32,
    right: i32,
}

/// What a placed branch ends in.
#[derive(Clone, Copy)]
struct End {
    element: ElementId,
    axis: i32,
    /// The row below it.
    row: i32,
    /// Whether it is a jump: nothing follows.
    jumped: bool,
}

struct Drawer<'a> {
    project: &'a Project,
    sfc: &'a Sfc,
    structure: Structure,
    exits: Vec<Vec<Exit>>,
    last: Option<StepId>,
    texts: Vec<String>,
    /// For each exit of each step, how far its axis stands from the step's.
    shifts: Vec<Vec<i32>>,
    drawing: Drawing<SfcShape>,
    /// Rightmost and lowest point so far.
    extent: (i32, i32),
}

impl Drawer<'_> {
    fn step_width(&self, step: StepId) -> i32 {
        // Even, so that the axis is the middle.
        (text_width(&self.sfc.steps[step].name) + 20).max(60)
    }

    fn action_width(&self, step: StepId) -> Option<i32> {
        let flag = self.sfc.steps[step].flag?;
        Some(text_width(&self.project.globals[flag].name) + 50)
    }

    fn text(&self, exit: &Exit) -> &str {
        exit.transition.map_or("FALSE", |t| &self.texts[t])
    }

    fn is_open(&self, exit: &Exit) -> bool {
        !exit.continues && self.last == Some(exit.to)
    }

    /// Finds the shifts of all exits at and below `step` and returns how far the block reaches from
    /// its axis, row by row.
    fn measure(&mut self, step: StepId) -> Vec<Reach> {
        let half = self.step_width(step) / 2;
        let action = self.action_width(step).map_or(0, |w| GAP + w);
        let mut outline = vec![Reach { left: -half, right: half + action }];

        let mut blocks = Vec::with_capacity(self.exits[step.index()].len());
        let mut main = (0, 0);
        for i in 0..self.exits[step.index()].len() {
            let exit = self.exits[step.index()][i];
            let block = self.measure_branch(&exit);
            if exit.continues && block.len() > main.1 {
                main = (i, block.len());
            }
            blocks.push((exit, block));
        }
        let balanced = self.structure == Structure::Balanced && blocks.len() > 1;
        if balanced {
            // Lines run on down to the convergence.
            let rows = blocks.iter().map(|(_, b)| b.len()).max().unwrap_or(0);
            for (exit, block) in &mut blocks {
                if exit.continues || self.last == Some(exit.to) {
                    block.resize(rows, Reach { left: -LANE, right: LANE });
                }
            }
        }

        let shifts = pack(&mut outline, blocks.iter().map(|(_, b)| b.as_slice()), main.0);
        if balanced {
            let (first, last) = (shifts[0], shifts[shifts.len() - 1]);
            outline.push(Reach { left: first.min(0) - LANE, right: last.max(0) + LANE });
        }
        self.shifts[step.index()] = shifts;
        outline
    }

    fn measure_branch(&mut self, exit: &Exit) -> Vec<Reach> {
        let side = TRANSITION.0 / 2;
        let mut block = vec![Reach { left: -side - GAP - text_width(self.text(exit)) - GAP, right: side }];
        if exit.continues {
            block.extend(self.measure(exit.to));
        } else if !self.is_open(exit) {
            let label = text_width(&self.sfc.steps[exit.to].name);
            block.push(Reach { left: -JUMP.0 / 2, right: JUMP.0 / 2 + 4 + label });
        }
        block
    }

    fn push(&mut self, element: Element<SfcShape>) -> ElementId {
        for r in [Some(element.area), element.label].into_iter().flatten() {
            self.extent = (self.extent.0.max(r.x + r.width), self.extent.1.max(r.y + r.height));
        }
        self.drawing.push(element)
    }

    /// Places the block of `step` with its axis at `axis`, below the transition `from`.
    fn place(&mut self, step: StepId, axis: i32, row: i32, from: Option<ElementId>) -> End {
        let y = top(row);
        let width = self.step_width(step);
        let area = Rect { x: axis - width / 2, y, width, height: ROW };
        let inputs = from.map(|f| self.down(f, axis, y)).into_iter().collect();
        let id = self.push(Element { shape: SfcShape::Step(step), area, label: None, inputs });
        if let (Some(flag), Some(width)) = (self.sfc.steps[step].flag, self.action_width(step)) {
            let action = Rect { x: area.x + area.width + GAP, y, width, height: ROW };
            let wire = Wire { from: id, path: vec![area.right(), action.left()] };
            self.push(Element { shape: SfcShape::Action { flag }, area: action, label: None, inputs: vec![wire] });
        }

        let exits = self.exits[step.index()].clone();
        match exits.as_slice() {
            [] => End { element: id, axis, row: row + 1, jumped: false },
            [exit] => self.place_branch(exit, axis, row + 1, id),
            _ => self.place_branches(step, &exits, axis, row, id),
        }
    }

    fn place_branches(&mut self, step: StepId, exits: &[Exit], axis: i32, row: i32, from: ElementId) -> End {
        let axes: Vec<i32> = self.shifts[step.index()].iter().map(|s| axis + s).collect();
        let (first, last) = (axes[0], axes[axes.len() - 1]);
        let y = top(row) + ROW + (PITCH - ROW) / 2;
        let inputs = vec![self.down(from, axis, y)];
        let area = Rect { x: first, y, width: last - first, height: 1 };
        let divergence =
            self.push(Element { shape: SfcShape::Divergence { branches: axes.clone() }, area, label: None, inputs });

        let mut ends = Vec::with_capacity(exits.len());
        for (exit, &axis) in exits.iter().zip(&axes) {
            ends.push(self.place_branch(exit, axis, row + 1, divergence));
        }
        let row = ends.iter().map(|e| e.row).max().unwrap_or(row + 2);
        if self.structure == Structure::Jumps {
            return End { element: divergence, axis, row, jumped: true };
        }
        let y = top(row);
        let inputs = ends.iter().map(|e| if e.jumped { hidden(e) } else { self.down(e.element, e.axis, y) }).collect();
        let area = Rect { x: first, y, width: last - first, height: 1 };
        let convergence = self.push(Element { shape: SfcShape::Convergence { axis }, area, label: None, inputs });
        End { element: convergence, axis, row: row + 1, jumped: false }
    }

    fn place_branch(&mut self, exit: &Exit, axis: i32, row: i32, from: ElementId) -> End {
        let middle = top(row) + ROW / 2;
        let text = match exit.transition {
            Some(t) => std::mem::take(&mut self.texts[t]),
            None => self.text(exit).to_owned(),
        };
        let (width, height) = TRANSITION;
        let area = Rect { x: axis - width / 2, y: middle - height / 2, width, height };
        let text_width = text_width(&text) + GAP;
        let beside = Rect {
            x: area.x - GAP - text_width,
            y: middle - CONDITION_HEIGHT / 2,
            width: text_width,
            height: CONDITION_HEIGHT,
        };
        let condition =
            self.push(Element { shape: SfcShape::Condition { text }, area: beside, label: None, inputs: Vec::new() });
        let inputs =
            vec![self.down(from, axis, area.y), Wire { from: condition, path: vec![beside.right(), area.left()] }];
        let shape = SfcShape::Transition { transition: exit.transition };
        let transition = self.push(Element { shape, area, label: None, inputs });

        if exit.continues {
            self.place(exit.to, axis, row + 1, Some(transition))
        } else if self.is_open(exit) {
            End { element: transition, axis, row: row + 1, jumped: false }
        } else {
            self.place_jump(exit.to, axis, row + 1, transition)
        }
    }

    fn place_jump(&mut self, to: StepId, axis: i32, row: i32, from: ElementId) -> End {
        let (width, height) = JUMP;
        let area = Rect { x: axis - width / 2, y: top(row), width, height };
        let label =
            Rect { x: area.x + width + 4, y: area.y, width: text_width(&self.sfc.steps[to].name), height: LINE };
        let inputs = vec![self.down(from, axis, area.y)];
        let element = self.push(Element { shape: SfcShape::Jump(to), area, label: Some(label), inputs });
        End { element, axis, row: row + 1, jumped: true }
    }

    /// Ends a balanced body with its one jump.
    fn finish(&mut self, end: End) {
        if let (Some(to), false) = (self.last, end.jumped) {
            self.place_jump(to, end.axis, end.row, end.element);
        }
    }

    /// A line straight down from the lower edge of `from`.
    fn down(&self, from: ElementId, axis: i32, to: i32) -> Wire {
        let area = self.drawing.elements[from].area;
        let (start, end) = (Point { x: axis, y: area.y + area.height }, Point { x: axis, y: to });
        Wire { from, path: vec![start, end] }
    }
}

fn hidden(end: &End) -> Wire {
    Wire { from: end.element, path: Vec::new() }
}

fn top(row: i32) -> i32 {
    MARGIN + row * PITCH
}

/// Moves `blocks` beside each other, the one numbered `main` on the axis, until they nearly touch;
/// adds them to `outline` from its second row on and returns their shifts.
fn pack<'b>(outline: &mut Vec<Reach>, blocks: impl Iterator<Item = &'b [Reach]>, main: usize) -> Vec<i32> {
    let blocks: Vec<&[Reach]> = blocks.collect();
    let mut shifts = vec![0; blocks.len()];
    let mut all: Vec<Reach> = blocks.get(main).map(|b| b.to_vec()).unwrap_or_default();
    let merge = |all: &mut Vec<Reach>, block: &[Reach], shift: i32| {
        for (i, r) in block.iter().enumerate() {
            let r = Reach { left: r.left + shift, right: r.right + shift };
            match all.get_mut(i) {
                Some(a) => *a = Reach { left: a.left.min(r.left), right: a.right.max(r.right) },
                None => all.push(r),
            }
        }
    };
    for i in main + 1..blocks.len() {
        shifts[i] = all.iter().zip(blocks[i]).map(|(a, b)| a.right - b.left + GAP).max().unwrap_or(0);
        merge(&mut all, blocks[i], shifts[i]);
    }
    for i in (0..main).rev() {
        shifts[i] = all.iter().zip(blocks[i]).map(|(a, b)| a.left - b.right - GAP).min().unwrap_or(0);
        merge(&mut all, blocks[i], shifts[i]);
    }
    outline.extend(all);
    shifts
}
