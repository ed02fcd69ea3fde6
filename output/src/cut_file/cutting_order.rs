//! The order of cutting: holes before slits, the outline last, so that the sheet holds what is cut.
//!
//! Within a layer the tool moves on to the nearest cut, which it begins at the nearer end.

use crate::{
    cut_file::cut_drawing::{CutDrawing, Layer},
    display::Shape,
};
use design::geometry::polygon::distance;
use support::{Extremes, Point};

impl CutDrawing {
    /// The shapes in cutting order, from a tool at `home`. The travel within a layer is at most the
    /// travel in the present order.
    pub fn in_cutting_order(&self, home: Point) -> Self {
        let mut at = home;
        let mut ordered = Self::default();
        for layer in Layer::all() {
            let mut shapes: Vec<Shape> = self.on(layer).cloned().collect();
            if layer.is_cut() {
                shapes.iter_mut().for_each(|shape| shape.begin_near(at));
                shapes = tour(&shapes, at);
            }
            if let Some(last) = shapes.last() {
                at = last.ends()[1];
            }
            ordered.shapes.extend(shapes.into_iter().map(|shape| (layer, shape)));
        }
        ordered
    }

    /// Length of the moves between the cuts, from a tool at `home` to the beginning of the last cut
    /// (mm).
    pub fn idle_travel(&self, home: Point) -> f64 {
        let mut at = home;
        let moves = self.cuts().map(|shape| {
            let [begin, end] = shape.ends();
            distance(std::mem::replace(&mut at, end), begin)
        });
        moves.sum()
    }
}

impl Shape {
    /// Begins a polygon or a contour at its corner nearest to a point.
    fn begin_near(&mut self, point: Point) {
        let nearest = |count: usize, at: &dyn Fn(usize) -> Point| {
            let off = |i: &usize| distance(at(*i), point);
            let nearest = (0..count).smallest_by(off);
            nearest.unwrap_or_default()
        };
        match self {
            Self::Polygon(corners) => {
                let first = nearest(corners.len(), &|i| corners[i]);
                corners.rotate_left(first);
            }
            Self::Contour(vertices) => {
                let first = nearest(vertices.len(), &|i| vertices[i].0);
                vertices.rotate_left(first);
            }
            _ => {}
        }
    }

    /// The shape cut in the direction in which it begins at `ends[0]`.
    fn along(&self, ends: [Point; 2]) -> Self {
        match self {
            Self::Line(_) => Self::Line(ends),
            other => other.clone(),
        }
    }
}

/// A cut of a tour: its index and its ends in the direction of cutting.
type Leg = (usize, [Point; 2]);

fn tour(shapes: &[Shape], from: Point) -> Vec<Shape> {
    let given: Vec<Leg> = shapes.iter().map(Shape::ends).enumerate().collect();
    let nearest = nearest_neighbours(&given, from);
    let tour = if travel(&nearest, from) < travel(&given, from) { nearest } else { given };
    let legs = tour.into_iter();
    legs.map(|(i, ends)| shapes[i].along(ends)).collect()
}

fn travel(tour: &[Leg], from: Point) -> f64 {
    let begins = tour.iter().map(|(_, [begin, _])| *begin);
    let ends = std::iter::once(from).chain(tour.iter().map(|(_, [_, end])| *end));
    ends.zip(begins).map(|(p, q)| distance(p, q)).sum()
}

fn nearest_neighbours(legs: &[Leg], from: Point) -> Vec<Leg> {
    let mut left = legs.to_vec();
    let mut at = from;
    let mut tour = Vec::with_capacity(legs.len());
    while !left.is_empty() {
        let to = |leg: &Leg| distance(at, leg.1[0]).min(distance(at, leg.1[1]));
        let nearest = (0..left.len()).smallest_by(|leg| to(&left[*leg]));
        let (i, [a, b]) = left.swap_remove(nearest.unwrap_or_default());
        let ends = if distance(at, b) < distance(at, a) { [b, a] } else { [a, b] };
        at = ends[1];
        tour.push((i, ends));
    }
    tour
}
