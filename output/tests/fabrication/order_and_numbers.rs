//! Cutting order and idle travel of random drawings, and numbers clear of all cuts.

use super::{KERF, irregular_sheets, length};
use output::cut_file::{CutDrawing, Layer};
use output::display::{Shape, Text};
use proptest::prelude::*;

fn point() -> impl Strategy<Value = [f64; 2]> {
    [0.0..1000.0, 0.0..1000.0]
}

fn hole() -> impl Strategy<Value = Shape> {
    (point(), 1.0..5.0).prop_map(|(centre, radius)| Shape::Circle { centre, radius })
}

fn slit() -> impl Strategy<Value = Shape> {
    [point(), point()].prop_map(Shape::Line)
}

/// The shape as text, the same for both directions of cutting.
pub(super) fn undirected(shape: &Shape) -> String {
    match shape {
        Shape::Line([a, b]) if a > b => format!("{:?}", Shape::Line([*b, *a])),
        Shape::Polygon(corners) => {
            let mut corners = corners.clone();
            corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
            format!("{corners:?}")
        }
        other => format!("{other:?}"),
    }
}

fn is_ordered(before: &CutDrawing, after: &CutDrawing) {
    let layers: Vec<Layer> = after.shapes.iter().map(|(layer, _)| *layer).collect();
    assert!(layers.is_sorted(), "{layers:?}");
    let all = |drawing: &CutDrawing| {
        let shapes = drawing.shapes.iter();
        let shapes = shapes.map(|(layer, shape)| (*layer, undirected(shape)));
        let mut all: Vec<_> = shapes.collect();
        all.sort();
        all
    };
    assert_eq!(all(before), all(after));
}

proptest! {
    #[test]
    fn every_cut_is_cut_once_in_the_order_of_the_layers(
        holes in prop::collection::vec(hole(), 0..30),
        slits in prop::collection::vec(slit(), 0..30),
    ) {
        let mut drawing = CutDrawing::default();
        let mut corners = vec![[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]];
        corners.rotate_left(slits.len() % 4);
        drawing.add(Layer::Outline, Shape::Polygon(corners));
        for slit in slits {
            drawing.add(Layer::Cut, slit);
        }
        for hole in holes {
            drawing.add(Layer::Holes, hole);
        }
        is_ordered(&drawing, &drawing.in_cutting_order([0.0; 2]));
    }

    #[test]
    fn the_travel_within_a_layer_is_at_most_that_of_the_given_order(
        slits in prop::collection::vec(slit(), 1..60),
        home in point(),
    ) {
        let mut drawing = CutDrawing::default();
        for slit in slits {
            drawing.add(Layer::Cut, slit);
        }
        let [before, after] =
            [&drawing, &drawing.in_cutting_order(home)].map(|drawing| drawing.idle_travel(home));
        prop_assert!(after <= before + 1e-9, "{after} {before}");
    }
}

#[test]
fn the_idle_travel_of_sheets_is_reduced() {
    for (_, cuts, drawing) in irregular_sheets() {
        let mut cut = drawing.numbered.clone();
        cut.shapes.retain(|(layer, _)| layer.is_cut());
        is_ordered(&cuts.drawing(), &cut);
        let totals = &drawing.totals;
        assert_eq!(totals.pierces, cuts.holes.len() + cuts.slits.len() + 1);
        let home = cuts.tool_outlines()[0][0];
        assert!(totals.idle_m <= 1e-3 * cuts.drawing().idle_travel(home));
        assert_eq!(1e-3 * drawing.numbered.idle_travel(home), totals.idle_m);
    }
}

/// Whether a segment comes nearer than `radius` to a rectangle, in the maximum norm.
fn meets([low, high]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2], radius: f64) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (low, high) = (low[axis] - radius, high[axis] + radius);
        let step = q[axis] - p[axis];
        if step == 0.0 {
            if p[axis] < low || p[axis] > high {
                return false;
            }
            continue;
        }
        let [a, b] = [(low - p[axis]) / step, (high - p[axis]) / step];
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    from < to
}

#[test]
fn numbers_touch_neither_cuts_nor_each_other() {
    for (sheet, cuts, drawing) in irregular_sheets() {
        let texts: Vec<&Text> = (drawing.numbered.on(Layer::Annotation))
            .filter_map(|shape| match shape {
                Shape::Text(text) => Some(text),
                _ => None,
            })
            .collect();
        assert_eq!(texts.len(), sheet.panels.len() + sheet.hinges.len());
        for (i, text) in texts.iter().enumerate() {
            let corners = text.corners();
            for slit in &cuts.slits {
                let met = meets(corners, cuts.tool_slit(slit), 0.5 * KERF);
                assert!(!met, "{text:?} {slit:?}");
            }
            for hole in &cuts.holes {
                let met = meets(corners, [hole.centre; 2], hole.radius);
                assert!(!met, "{text:?} {hole:?}");
            }
            for other in &texts[..i] {
                let [low, high] = other.corners();
                assert!(!meets(corners, [low, high], 0.0), "{text:?} {other:?}");
            }
            assert!(corners.iter().flatten().all(|x| *x > 0.0));
        }
        // A hinge's number is nearer to its own hole than to any other.
        for (h, text) in texts[sheet.panels.len()..].iter().enumerate() {
            let to = |hole: usize| length([text.at, cuts.holes[hole].centre]);
            assert_eq!(text.text, h.to_string());
            let nearest = (0..cuts.holes.len()).min_by(|a, b| to(*a).total_cmp(&to(*b)));
            assert_eq!(nearest, Some(h));
        }
    }
}
