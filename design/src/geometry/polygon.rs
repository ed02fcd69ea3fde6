//! Polygons: clipping, distances and intersections of convex ones, counter-clockwise;
//! self-crossings of any.

use crate::geometry::plane::{complex, cross, dot, point};
use faer::c64;
use support::{Extremes, Point};

/// The intersection of two convex polygons.
pub fn common(polygon: &[Point], other: &[Point]) -> Vec<Point> {
    edges(other).fold(polygon.to_vec(), |part, edge| clip(&part, |at| -side(edge, at)))
}

/// Area of any simple polygon, negative if it is clockwise (mm^2).
pub fn area(polygon: &[Point]) -> f64 {
    let twice: f64 = edges(polygon).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    0.5 * twice
}

/// The polygon with its vertices in counter-clockwise order.
pub fn counter_clockwise(polygon: &[Point]) -> Vec<Point> {
    let mut polygon = polygon.to_vec();
    if area(&polygon) < 0.0 {
        polygon.reverse();
    }
    polygon
}

/// The part of a convex polygon in which the linear function `height` is negative.
pub fn clip(polygon: &[Point], height: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::new();
    for (p, q) in edges(polygon) {
        let (below_p, below_q) = (height(p), height(q));
        if below_p <= 0.0 {
            kept.push(p);
        }
        if (below_p <= 0.0) != (below_q <= 0.0) {
            let f = below_p / (below_p - below_q);
            kept.push(between(p, q, f));
        }
    }
    kept
}

/// Whether a polygon contains a point; its border belongs to one of its sides.
pub fn contains(polygon: &[Point], [x, y]: Point) -> bool {
    let passed = edges(polygon).filter(|(p, q)| {
        (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])
    });
    passed.count() % 2 == 1
}

/// Distance from a point to a polygon; infinite if it is empty (mm).
pub fn distance_to_polygon(point: Point, polygon: &[Point]) -> f64 {
    if contains(polygon, point) {
        return 0.0;
    }
    edges(polygon).map(|(p, q)| distance_to_segment(point, p, q)).smallest()
}

/// Distance from a point, inside or outside, to the outline of a polygon with at least one corner
/// (mm).
pub fn distance_to_outline(point: Point, polygon: &[Point]) -> f64 {
    distance(point, nearest_on_outline(point, polygon))
}

/// Distance between two points (mm).
pub fn distance(p: Point, q: Point) -> f64 {
    vector(p, q).norm()
}

/// The mean of points.
pub fn mean(points: &[Point]) -> Point {
    let sum = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>();
    [sum(0), sum(1)].map(|sum| sum / points.len() as f64)
}

/// The minimum and maximum coordinates of points: the lower left and the upper right corner of
/// their bounding box.
pub fn bounds(points: impl IntoIterator<Item = Point>) -> [Point; 2] {
    let nothing = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.into_iter().fold(nothing, |[low, high], [x, y]| {
        [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
    })
}

/// Width and height of a rectangle from its lower left to its upper right corner.
pub fn size([low, high]: [Point; 2]) -> [f64; 2] {
    [high[0] - low[0], high[1] - low[1]]
}

/// Distance from a point to the segment from `a` to `b` (mm).
pub fn distance_to_segment(point: Point, a: Point, b: Point) -> f64 {
    distance(point, nearest_on_segment(point, a, b))
}

/// Distance between two segments; zero if they cross (mm).
pub fn distance_between_segments(s: [Point; 2], t: [Point; 2]) -> f64 {
    let separates =
        |[a, b]: [Point; 2], [p, q]: [Point; 2]| side((a, b), p) * side((a, b), q) < 0.0;
    if separates(s, t) && separates(t, s) {
        return 0.0;
    }
    let from_ends = |s: [Point; 2], t: [Point; 2]| {
        let [p, q] = s.map(|end| distance_to_segment(end, t[0], t[1]));
        p.min(q)
    };
    from_ends(s, t).min(from_ends(t, s))
}

/// The point of the segment from `a` to `b` nearest to `at`.
pub fn nearest_on_segment(at: Point, a: Point, b: Point) -> Point {
    let whole = vector(a, b);
    let square = whole.norm_sqr();
    let along = dot(whole, vector(a, at)) / square;
    if square > 0.0 { between(a, b, along.clamp(0.0, 1.0)) } else { a }
}

/// The vector from `p` to `q`.
fn vector(p: Point, q: Point) -> c64 {
    complex(q) - complex(p)
}

/// The point of the line from `p` to `q` at a fraction of their distance.
fn between(p: Point, q: Point, fraction: f64) -> Point {
    point(complex(p) + vector(p, q) * fraction)
}

/// The point on the border of a closed polygon nearest to `point`.
pub fn nearest_on_outline(point: Point, polygon: &[Point]) -> Point {
    let feet = edges(polygon).map(|(a, b)| {
        let foot = nearest_on_segment(point, a, b);
        (vector(point, foot).norm_sqr(), foot)
    });
    let nearest = feet.smallest_by(|(square, _)| *square);
    nearest.map_or(point, |(_, foot)| foot)
}

/// The edges of a closed polygon.
pub fn edges(polygon: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// A common point of two edges of a closed polygon, other than the vertices between neighbours.
pub fn self_crossing(points: &[Point]) -> Option<Point> {
    crossing([points])
}

/// A common point of two edges of closed polygons, other than the vertices between neighbours.
///
/// Neighbouring edges are near each other: parts of the outlines whose boxes do not overlap are not
/// compared.
pub fn crossing(polygons: impl IntoIterator<Item: AsRef<[Point]>>) -> Option<Point> {
    let (mut all, mut after): (Vec<Edge>, Vec<usize>) = Default::default();
    for polygon in polygons {
        let (first, count) = (all.len(), polygon.as_ref().len());
        all.extend(edges(polygon.as_ref()));
        after.extend((1..=count).map(|i| first + i % count));
    }
    let boxes = PartBoxes::of(&all);
    let neighbours = |i: usize, j: usize| after[i] == j || after[j] == i;
    let shared = |i: usize, j: usize| (!neighbours(i, j)).then(|| shared_point(all[i], all[j]))?;
    boxes.first(&shared)
}

/// The bounding boxes of the parts of an outline: part 1 is all of it, and part k consists of the
/// parts 2 k and 2 k + 1, down to the single edges.
struct PartBoxes {
    boxes: Vec<[Point; 2]>,
    /// Number of the parts that are single edges, a power of two; those beyond the last edge are
    /// empty.
    leaves: usize,
}

impl PartBoxes {
    fn of(edges: &[Edge]) -> Self {
        let leaves = edges.len().next_power_of_two();
        let mut boxes = vec![bounds([]); 2 * leaves];
        for (leaf, (p, q)) in boxes[leaves..].iter_mut().zip(edges) {
            *leaf = bounds([*p, *q]);
        }
        for part in (1..leaves).rev() {
            let ([low, high], [other_low, other_high]) = (boxes[2 * part], boxes[2 * part + 1]);
            boxes[part] = [
                [0, 1].map(|c| low[c].min(other_low[c])),
                [0, 1].map(|c| high[c].max(other_high[c])),
            ];
        }
        Self { boxes, leaves }
    }

    /// What `found` gives for the first pair of edges whose boxes overlap, of those for which it
    /// gives anything.
    fn first(&self, found: &impl Fn(usize, usize) -> Option<Point>) -> Option<Point> {
        (1..self.leaves).find_map(|part| self.first_pair(2 * part, 2 * part + 1, found))
    }

    /// What `found` gives for the first pair of edges, one of each of two parts of equal size,
    /// whose boxes overlap.
    fn first_pair(
        &self,
        part: usize,
        other: usize,
        found: &impl Fn(usize, usize) -> Option<Point>,
    ) -> Option<Point> {
        let [low, high] = self.boxes[part];
        let [other_low, other_high] = self.boxes[other];
        let overlap = |c: usize| high[c] >= other_low[c] && other_high[c] >= low[c];
        if !(overlap(0) && overlap(1)) {
            return None;
        }
        if part >= self.leaves {
            return found(part - self.leaves, other - self.leaves);
        }
        let halves = |part: usize| [2 * part, 2 * part + 1];
        halves(part).into_iter().find_map(|part| {
            let mut others = halves(other).into_iter();
            others.find_map(|other| self.first_pair(part, other, found))
        })
    }
}

type Edge = (Point, Point);

/// Distance of a point from the line of an edge times the length of the edge, positive on its left.
pub fn side((a, b): Edge, point: Point) -> f64 {
    cross(vector(a, b), vector(a, point))
}

/// A common point of two segments whose boxes overlap, unless one of them is on one side of the
/// other.
fn shared_point((p, q): Edge, (r, s): Edge) -> Option<Point> {
    let (side_p, side_q) = (side((r, s), p), side((r, s), q));
    if side_p * side_q > 0.0 || side((p, q), r) * side((p, q), s) > 0.0 {
        return None;
    }
    let along = if side_p == side_q { 0.0 } else { side_p / (side_p - side_q) };
    Some(between(p, q, along))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Long teeth side by side: each of the 60 000 edges overlaps all others in x.
    #[test]
    fn an_outline_of_very_many_points_needs_few_comparisons() {
        let mut teeth = Vec::new();
        for i in 0..15_000 {
            let y = f64::from(4 * i);
            teeth.extend([[0.0, y], [100.0, y + 1.0], [100.0, y + 2.0], [0.0, y + 3.0]]);
        }
        teeth.extend([[-1.0, 6e4], [-1.0, 0.0]]);
        let edges: Vec<Edge> = edges(&teeth).collect();
        let compared = Cell::new(0);
        PartBoxes::of(&edges).first(&|_, _| {
            compared.set(compared.get() + 1);
            None
        });
        assert!(compared.get() < 3 * edges.len(), "{}", compared.get());
        assert_eq!(self_crossing(&teeth), None);
        teeth[30_000] = [50.0, 10.0];
        assert!(self_crossing(&teeth).is_some());
    }

    #[test]
    fn distances_to_a_segment() {
        let (a, b) = ([0.0, 0.0], [10.0, 0.0]);
        assert_eq!(distance_to_segment([5.0, 3.0], a, b), 3.0);
        assert_eq!(distance_to_segment([13.0, 4.0], a, b), 5.0);
        assert_eq!(distance_to_segment([3.0, 4.0], a, a), 5.0);
    }

    #[test]
    fn distances_between_segments() {
        let s = [[0.0, 0.0], [10.0, 0.0]];
        let to = |t| distance_between_segments(s, t);
        assert_eq!(to([[4.0, 1.0], [5.0, -1.0]]), 0.0);
        assert_eq!(to([[4.0, 1.0], [5.0, 3.0]]), 1.0);
        assert_eq!(to([[13.0, -4.0], [13.0, 8.0]]), 3.0);
        assert_eq!(to([[12.0, 0.0], [15.0, 0.0]]), 2.0);
    }

    #[test]
    fn two_squares_share_a_quarter() {
        let square = |x: f64| [[x, x], [x + 2.0, x], [x + 2.0, x + 2.0], [x, x + 2.0]];
        assert_eq!(area(&common(&square(0.0), &square(1.0))), 1.0);
        assert_eq!(area(&common(&square(0.0), &square(3.0))), 0.0);
    }
}
