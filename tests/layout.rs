//! Drawings: nothing overlaps, lines run level or upright and through no box.

use crate::support::charts;
use chartwright::ir::drawing::{Drawing, LadderShape, Rect, Wire};
use chartwright::ir::plc::{Body, Project};
use chartwright::layout::{self, Branches, Structure};
use proptest::prelude::*;

/// Fails if two elements overlap, something leaves the page, or a line runs through a box.
fn assert_clear<S: std::fmt::Debug>(drawing: &Drawing<S>) {
    if let Some((a, b)) = drawing.overlap() {
        panic!("{:?} overlaps {:?}", drawing.elements[a], drawing.elements[b]);
    }
    for (id, element) in drawing.elements.iter().enumerate() {
        for rect in [Some(element.area), element.label].into_iter().flatten() {
            assert!(rect.x >= 0 && rect.y >= 0, "{element:?} leaves the page");
            assert!(rect.x + rect.width <= drawing.width && rect.y + rect.height <= drawing.height);
        }
        for wire in &element.inputs {
            assert!(wire.from < id, "lines come from what was drawn before");
            assert_runs_clear(drawing, id, wire);
        }
    }
}

fn assert_runs_clear<S: std::fmt::Debug>(drawing: &Drawing<S>, to: usize, wire: &Wire) {
    let touches = |r: Rect, p: chartwright::ir::drawing::Point| {
        (r.x..=r.x + r.width).contains(&p.x) && (r.y..=r.y + r.height).contains(&p.y)
    };
    if let (Some(first), Some(last)) = (wire.path.first(), wire.path.last()) {
        assert!(touches(drawing.elements[wire.from].area, *first), "a line begins at its element");
        assert!(touches(drawing.elements[to].area, *last), "a line ends at its element");
    }
    for pair in wire.path.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        assert!(a.x == b.x || a.y == b.y, "a section is level or upright");
        let section = Rect { x: a.x.min(b.x), y: a.y.min(b.y), width: (a.x - b.x).abs(), height: (a.y - b.y).abs() };
        for (id, element) in drawing.elements.iter().enumerate() {
            if id == to || id == wire.from {
                continue;
            }
            for rect in [Some(element.area), element.label].into_iter().flatten() {
                assert!(!rect.overlaps(&section), "a line to {to} runs through {element:?}");
            }
        }
    }
}

fn draw(project: &Project, structure: Structure, branches: Branches) {
    for program in &project.programs {
        match &program.body {
            Body::Sfc(sfc) => assert_clear(&layout::sfc::draw(project, sfc, structure)),
            Body::Ladder(ladder) => assert_clear(&layout::ladder::draw(project, ladder, branches)),
        }
    }
}

#[test]
fn an_overlap_is_found() {
    let project = crate::support::plc::sample();
    let Body::Ladder(ladder) = &project.programs[0].body else { panic!("the sample begins with a ladder") };
    let mut drawing = layout::ladder::draw(&project, ladder, Branches::AsWritten);
    assert_eq!(drawing.overlap(), None);
    drawing.elements[2].area = drawing.elements[3].area;
    assert_eq!(drawing.overlap(), Some((2, 3)));
}

proptest! {
    #[test]
    fn any_sfc_is_drawn_clear(project in charts::sfc()) {
        draw(&project, Structure::Jumps, Branches::AsWritten);
        draw(&project, Structure::Balanced, Branches::AsWritten);
    }

    #[test]
    fn rungs_stand_apart(project in charts::ladder()) {
        let Body::Ladder(ladder) = &project.programs[0].body else { panic!("a ladder") };
        let drawing = layout::ladder::draw(&project, ladder, Branches::EqualShape);
        let bottom = |e: &chartwright::ir::drawing::Element<_>| e.area.y + e.area.height;
        let mut end = None;
        for element in &drawing.elements {
            match element.shape {
                // Some IDEs take rungs that are closer for one, or order them by their height.
                LadderShape::LeftRail { .. } => prop_assert!(end.is_none_or(|end| element.area.y >= end + 40)),
                LadderShape::RightRail => end = Some(bottom(element)),
                LadderShape::Comment { .. }
                | LadderShape::Contact(_)
                | LadderShape::Preset { .. }
                | LadderShape::Timer { .. }
                | LadderShape::Operand { .. }
                | LadderShape::Result { .. }
                | LadderShape::Coil { .. } => {}
                // It has no right rail.
                LadderShape::Function { .. } => end = Some(bottom(element)),
            }
        }
    }

    #[test]
    fn any_ladder_is_drawn_clear(project in charts::ladder()) {
        draw(&project, Structure::Jumps, Branches::AsWritten);
        draw(&project, Structure::Jumps, Branches::EqualShape);
    }
}
