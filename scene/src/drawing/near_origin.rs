//! Moves a drawing whose coordinates are far from zero to the origin, before usvg rounds them to 24
//! bits: a map in metres of a national grid has its outline at 5 600 000, where these bits end at
//! half a metre.

use crate::drawing::css_geometry::edited;
use design::geometry::polygon;
use std::fmt::Write;
use svgtypes::{PointsParser, SimplePathSegment, SimplifyingPathParser};
use usvg::roxmltree::{Document, Node};

/// Largest coordinate over the size of an outline from which it is moved: nearer ones keep a
/// millionth of their size.
const FAR: f64 = 8.0;

/// The text of a drawing with all its paths, polygons and polylines moved to the returned origin;
/// `None` if no outline is far from zero.
pub(super) fn moved(document: &Document) -> Option<(String, [f64; 2])> {
    let outlines: Vec<_> = document.descendants().filter_map(Outline::of).collect();
    let origin = outlines.iter().find_map(Outline::far_start)?;
    let edit = |outline: &Outline| (outline.written.clone(), outline.moved_by(origin));
    Some((edited(document.input_text(), outlines.iter().map(edit).collect()), origin))
}

/// The largest coordinate of points over the longer side of their bounding box.
pub(super) fn distance_over_size(points: &[[f64; 2]]) -> f64 {
    let [width, height] = polygon::size(polygon::bounds(points.iter().copied()));
    let largest = points.as_flattened().iter().map(|c| c.abs());
    largest.fold(0.0, f64::max) / width.max(height)
}

/// The data of an element that draws an outline, as absolute segments.
struct Outline {
    /// A path has commands, a polygon only points.
    is_path: bool,
    segments: Vec<SimplePathSegment>,
    /// Where the data stand in the text.
    written: std::ops::Range<usize>,
}

impl Outline {
    fn of(element: Node) -> Option<Self> {
        let (is_path, name) = match element.tag_name().name() {
            "path" => (true, "d"),
            "polygon" | "polyline" => (false, "points"),
            _ => return None,
        };
        let data = element.attribute_node(name)?;
        let segments = if is_path {
            let segments = SimplifyingPathParser::from(data.value());
            segments.map_while(Result::ok).collect()
        } else {
            let points = PointsParser::from(data.value());
            points.map(|(x, y)| SimplePathSegment::LineTo { x, y }).collect()
        };
        Some(Self { is_path, segments, written: data.range_value() })
    }

    /// Its first point, if it is far from zero.
    fn far_start(&self) -> Option<[f64; 2]> {
        use SimplePathSegment::{ClosePath, CurveTo, LineTo, MoveTo, Quadratic};
        let ends = self.segments.iter().filter_map(|segment| match *segment {
            MoveTo { x, y } | LineTo { x, y } => Some([x, y]),
            Quadratic { x, y, .. } | CurveTo { x, y, .. } => Some([x, y]),
            ClosePath => None,
        });
        let ends: Vec<[f64; 2]> = ends.collect();
        (distance_over_size(&ends) > FAR).then(|| ends[0])
    }

    /// Its data, from another origin.
    fn moved_by(&self, [x0, y0]: [f64; 2]) -> String {
        use SimplePathSegment::{ClosePath, CurveTo, LineTo, MoveTo, Quadratic};
        let mut text = String::new();
        for segment in &self.segments {
            let (command, points) = match *segment {
                MoveTo { x, y } => ("M", vec![[x, y]]),
                LineTo { x, y } => ("L", vec![[x, y]]),
                Quadratic { x1, y1, x, y } => ("Q", vec![[x1, y1], [x, y]]),
                CurveTo { x1, y1, x2, y2, x, y } => ("C", vec![[x1, y1], [x2, y2], [x, y]]),
                ClosePath => ("Z", Vec::new()),
            };
            if self.is_path {
                text += command;
            }
            for [x, y] in points {
                let _ = write!(text, "{} {} ", x - x0, y - y0);
            }
        }
        text
    }
}
