//! Drawings: where the elements of an SFC or a ladder stand on a page.
//!
//! A drawing names the steps, transitions and rungs of one body by their ids and says where each
//! stands and how lines run between them. It holds whole numbers only: x grows rightwards, y
//! downwards, and a character of text is [`CHAR`] units wide. Elements stand in the order in which
//! they are read: a step before its transitions, a rung before the next one. Everything drawn of an
//! element lies within its [area](Element::area) and its [label](Element::label); no two elements
//! overlap.

use super::plc::GlobalId;
use super::sfc::StepId;
use super::sop::Literal;

/// Width of a character of text.
pub const CHAR: i32 = 8;

/// Height of a line of text.
pub const LINE: i32 = 16;

/// A place on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Point {
    /// From left to right.
    pub x: i32,
    /// From top to bottom.
    pub y: i32,
}

/// A box on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Left edge.
    pub x: i32,
    /// Upper edge.
    pub y: i32,
    /// Extent to the right.
    pub width: i32,
    /// Extent downwards.
    pub height: i32,
}

impl Rect {
    /// The middle of the upper edge.
    pub fn top(&self) -> Point {
        Point { x: self.x + self.width / 2, y: self.y }
    }

    /// The middle of the lower edge.
    pub fn bottom(&self) -> Point {
        Point { x: self.x + self.width / 2, y: self.y + self.height }
    }

    /// The middle of the left edge.
    pub fn left(&self) -> Point {
        Point { x: self.x, y: self.y + self.height / 2 }
    }

    /// The middle of the right edge.
    pub fn right(&self) -> Point {
        Point { x: self.x + self.width, y: self.y + self.height / 2 }
    }

    /// Whether both have a point inside in common; edges may touch.
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }
}

/// A body, drawn: shapes `S` are those of an SFC or those of a ladder.
#[derive(Clone, Debug)]
pub struct Drawing<S> {
    /// Extent to the right, margin included.
    pub width: i32,
    /// Extent downwards, margin included.
    pub height: i32,
    /// What stands on the page, in reading order.
    pub elements: Vec<Element<S>>,
}

/// Names an element: its place in [`Drawing::elements`].
pub type ElementId = usize;

/// One thing on the page.
#[derive(Clone, Debug)]
pub struct Element<S> {
    /// What it shows.
    pub shape: S,
    /// The box of the symbol itself.
    pub area: Rect,
    /// The box of a text that stands beside the symbol and not inside.
    pub label: Option<Rect>,
    /// The lines that end here, from left to right or from top to bottom.
    pub inputs: Vec<Wire>,
}

/// What an element of an SFC shows.
#[derive(Clone, Debug)]
pub enum SfcShape {
    /// A step of an SFC; lines leave it at the bottom, its action on the right.
    Step(StepId),
    /// The N action of the step that its line comes from.
    Action {
        /// What is TRUE while the step is active.
        flag: GlobalId,
    },
    /// Alternatives begin: a line with a branch at each of these places.
    Divergence {
        /// Where the branches leave, from left to right.
        branches: Vec<i32>,
    },
    /// The condition of a transition, as text.
    Condition {
        /// An expression in structured text.
        text: String,
    },
    /// A transition; its first input comes from above, its second from its condition.
    Transition {
        /// Its index in the SFC, or nothing for one that a drawing needs and that never fires.
        transition: Option<usize>,
    },
    /// Alternatives end; a branch that jumped away reaches it by a line without a path.
    Convergence {
        /// Where the line below leaves.
        axis: i32,
    },
    /// What follows is a step that stands elsewhere.
    Jump(StepId),
}

/// What an element of a ladder shows.
#[derive(Clone, Copy, Debug)]
pub enum LadderShape {
    /// The left power rail of a rung, the first element of it.
    LeftRail {
        /// The rung's index in the ladder.
        rung: usize,
        /// Height at which lines leave.
        outlet: i32,
    },
    /// The comment of a rung.
    Comment {
        /// Its index in the ladder.
        rung: usize,
    },
    /// A contact.
    Contact(Literal<GlobalId>),
    /// The preset time of a rung's timer.
    Preset {
        /// Its index in the ladder.
        rung: usize,
    },
    /// The timer of a rung: its first input is the preset time, the others its condition.
    Timer {
        /// Its index in the ladder.
        rung: usize,
    },
    /// An operand of a rung's function.
    Operand {
        /// The rung's index in the ladder.
        rung: usize,
        /// Which operand.
        operand: usize,
    },
    /// The function of a rung: its inputs are its operands, in order.
    Function {
        /// The rung's index in the ladder.
        rung: usize,
    },
    /// What takes the result of a rung's function.
    Result {
        /// The rung's index in the ladder.
        rung: usize,
    },
    /// The coil of a rung.
    Coil {
        /// Its index in the ladder.
        rung: usize,
    },
    /// The right power rail of a rung.
    RightRail,
}

/// A line from one element to another.
#[derive(Clone, Debug)]
pub struct Wire {
    /// Where it comes from.
    pub from: ElementId,
    /// The corners from its beginning to its end, both included, all sections upright or level.
    /// Empty for a line that is not drawn.
    pub path: Vec<Point>,
}

impl<S> Drawing<S> {
    /// An empty page.
    pub fn new() -> Self {
        Drawing { width: 0, height: 0, elements: Vec::new() }
    }

    /// Adds an element and names it.
    pub fn push(&mut self, element: Element<S>) -> ElementId {
        self.elements.push(element);
        self.elements.len() - 1
    }

    /// Two elements that overlap, if any do: a fault of the layout.
    pub fn overlap(&self) -> Option<(ElementId, ElementId)> {
        let mut boxes: Vec<(ElementId, Rect)> = Vec::new();
        for (id, e) in self.elements.iter().enumerate() {
            boxes.push((id, e.area));
            boxes.extend(e.label.map(|l| (id, l)));
        }
        // Swept from top to bottom, so that only boxes at the same height are compared.
        boxes.sort_by_key(|(id, r)| (r.y, *id));
        let mut open: Vec<(ElementId, Rect)> = Vec::new();
        for (id, rect) in boxes {
            open.retain(|(_, o)| o.y + o.height > rect.y);
            if let Some((other, _)) = open.iter().find(|(o, r)| *o != id && r.overlaps(&rect)) {
                return Some((*other, id));
            }
            open.push((id, rect));
        }
        None
    }
}

impl<S> Default for Drawing<S> {
    fn default() -> Self {
        Drawing::new()
    }
}
