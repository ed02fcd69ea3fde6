//! Shapes; lengths in mm, y upwards.

use design::geometry::polygon::{bounds, distance, edges};
use scene::drawing::bulged::{Vertex, flattened};
use std::f64::consts::TAU;
use support::Point;

/// One shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight line, from its first to its second end.
    Line([Point; 2]),
    /// An open line through points.
    Polyline(Vec<Point>),
    /// A circle.
    Circle {
        /// Its centre.
        centre: Point,
        /// Its radius.
        radius: f64,
    },
    /// A closed polygon.
    Polygon(Vec<Point>),
    /// A closed line of segments and arcs.
    Contour(Vec<Vertex>),
    /// A text of one line.
    Text(Text),
}

/// A horizontal text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The point to which `anchor` refers (mm).
    pub at: Point,
    /// The point of the text that is at `at`.
    pub anchor: Anchor,
    /// Height of the capitals (mm).
    pub height: f64,
    /// The text, one line.
    pub text: String,
}

/// The point of a text that its position refers to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// The left end of the baseline.
    Start,
    /// The middle of the baseline.
    Middle,
    /// The middle of the capitals.
    Centre,
}

/// Width of a character relative to the height of the capitals: an upper bound for digits of DejaVu
/// Sans, of Helvetica and of the stroke font of DXF readers.
const CHARACTER: f64 = 0.9;

impl Text {
    /// A text that begins at the point `at`.
    pub fn line(at: Point, height: f64, text: &str) -> Self {
        Self { at, anchor: Anchor::Start, height, text: text.to_owned() }
    }

    /// A text around the point `at`.
    pub fn centred(at: Point, height: f64, text: String) -> Self {
        Self { at, anchor: Anchor::Centre, height, text }
    }

    /// The anchor's place on the baseline (mm).
    pub(crate) fn baseline(&self) -> Point {
        let [x, y] = self.at;
        match self.anchor {
            Anchor::Start | Anchor::Middle => [x, y],
            Anchor::Centre => [x, y - 0.5 * self.height],
        }
    }

    /// Width and height of the text (mm), an upper bound for texts of digits.
    pub fn size(&self) -> [f64; 2] {
        let characters = self.text.chars().count() as f64;
        [CHARACTER * self.height * characters, self.height]
    }

    /// The lower left and the upper right corner of the text (mm).
    pub fn corners(&self) -> [Point; 2] {
        let ([x, y], [width, height]) = (self.baseline(), self.size());
        let left = match self.anchor {
            Anchor::Start => x,
            Anchor::Middle | Anchor::Centre => x - 0.5 * width,
        };
        [[left, y], [left + width, y + height]]
    }
}

impl Shape {
    /// A cross with arms of a length (mm).
    pub(crate) fn cross([x, y]: Point, arm: f64) -> [Self; 2] {
        [[[x - arm, y], [x + arm, y]], [[x, y - arm], [x, y + arm]]].map(Self::Line)
    }

    /// Where a tool begins and ends. A hole begins and ends at its centre, where the tool pierces
    /// the material.
    pub fn ends(&self) -> [Point; 2] {
        let at = |point: Option<&Point>| point.copied().unwrap_or_default();
        match self {
            Self::Line(ends) => *ends,
            Self::Polyline(points) => [at(points.first()), at(points.last())],
            Self::Circle { centre, .. } => [*centre; 2],
            Self::Polygon(corners) => [at(corners.first()); 2],
            Self::Contour(vertices) => [at(vertices.first().map(|vertex| &vertex.0)); 2],
            Self::Text(text) => [text.at; 2],
        }
    }

    /// Length of the line (mm); zero for a text.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line([from, to]) => distance(*from, *to),
            Self::Polyline(points) => {
                points.windows(2).map(|ends| distance(ends[0], ends[1])).sum()
            }
            Self::Circle { radius, .. } => TAU * radius,
            Self::Polygon(corners) => edges(corners).map(|(p, q)| distance(p, q)).sum(),
            Self::Contour(vertices) => Self::Polygon(flattened(vertices, true)).length(),
            Self::Text(_) => 0.0,
        }
    }

    /// Points with the same bounding box as the shape.
    fn extremes(&self) -> Vec<Point> {
        match self {
            Self::Line(ends) => ends.to_vec(),
            Self::Circle { centre, radius } => {
                [-radius, *radius].map(|r| centre.map(|x| x + r)).to_vec()
            }
            Self::Polyline(points) | Self::Polygon(points) => points.clone(),
            Self::Contour(vertices) => flattened(vertices, true),
            Self::Text(text) => text.corners().to_vec(),
        }
    }

    /// The bounding box of some shapes: its lower left and its upper right corner (mm).
    pub fn extent<'a>(shapes: impl Iterator<Item = &'a Self>) -> [Point; 2] {
        bounds(shapes.flat_map(Self::extremes))
    }

    /// Shifts the shape (mm).
    pub(crate) fn shift(&mut self, by: Point) {
        let shift = |point: &mut Point| *point = [point[0] + by[0], point[1] + by[1]];
        match self {
            Self::Line(ends) => ends.iter_mut().for_each(shift),
            Self::Circle { centre, .. } => shift(centre),
            Self::Polyline(points) | Self::Polygon(points) => points.iter_mut().for_each(shift),
            Self::Contour(vertices) => vertices.iter_mut().for_each(|vertex| shift(&mut vertex.0)),
            Self::Text(text) => shift(&mut text.at),
        }
    }
}

/// The corners of a rectangle, counter-clockwise from the lower left.
pub(crate) fn rectangle([low, high]: [Point; 2]) -> [Point; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}
