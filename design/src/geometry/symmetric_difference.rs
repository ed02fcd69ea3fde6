//! The area of the symmetric difference of two closed polygons P and T, and its derivative for a
//! displacement u of the edges of P,
//!
//! ```text
//! A = int |w_P - w_T| dx dy,     dA = int over P of (|w| left of the edge - |w| right of it) (u_x - u_y dx/dy) |dy|
//! ```
//!
//! w_P, w_T: the winding numbers; w = w_P - w_T. For polygons that do not cross themselves A is the
//! area inside one of them and outside the other. A point that P encloses twice, or clockwise,
//! counts as often as it is enclosed too often. A is a distance of outlines: symmetric, with the
//! triangle inequality, and zero if they enclose the same.
//!
//! The plane is cut into slabs at the heights of all vertices and crossings. In a slab the edges do
//! not cross, and w is constant between neighbours: area and derivative are sums over trapezoids.
//! Edges that coincide enclose nothing, in any order. Heights are measured along an oblique axis:
//! an edge without height would have no derivative.

use crate::geometry::{
    plane::{complex, point, turn},
    polygon::{edges, side},
};
use support::Point;

/// Rotation of the polygons before they are cut into slabs (rad).
const OBLIQUE: f64 = 0.7;

/// A and its gradient in the vertices of P, the `outline`.
pub fn symmetric_difference(outline: &[Point], target: &[Point]) -> (f64, Vec<Point>) {
    let mut all = oblique_edges(target, -1);
    for edge in &mut all {
        edge.ends = None;
    }
    all.extend(oblique_edges(outline, 1));
    all.sort_by(|a, b| a.low[1].total_cmp(&b.low[1]));
    let heights = heights(&all);
    let (mut area, mut gradient) = (0.0, vec![[0.0; 2]; outline.len()]);
    for (slab, edges) in heights.windows(2).zip(by_slabs(&all, &heights)) {
        area += trapezoids([slab[0], slab[1]], &edges, &mut gradient);
    }
    let back = |slope: Point| point(complex(slope) * turn(-OBLIQUE));
    (area, gradient.into_iter().map(back).collect())
}

/// An edge with height.
struct ObliqueEdge {
    low: Point,
    high: Point,
    /// Change of w across the edge from left to right.
    step: i32,
    /// Indices of the lower and the upper end among the vertices; `None` for the edges of T.
    ends: Option<[usize; 2]>,
}

/// The edges of a rotated polygon inside which w is larger by `inside` if it is counter-clockwise.
fn oblique_edges(polygon: &[Point], inside: i32) -> Vec<ObliqueEdge> {
    let turned = |vertex: &Point| point(complex(*vertex) * turn(OBLIQUE));
    let turned: Vec<Point> = polygon.iter().map(turned).collect();
    let edge = |(i, (from, to)): (usize, (Point, Point))| {
        let next = (i + 1) % polygon.len();
        let (low, high, step, ends) = if from[1] < to[1] {
            (from, to, -inside, [i, next])
        } else {
            (to, from, inside, [next, i])
        };
        let ends = Some(ends);
        (low[1] < high[1]).then_some(ObliqueEdge { low, high, step, ends })
    };
    edges(&turned).enumerate().filter_map(edge).collect()
}

impl ObliqueEdge {
    fn slope(&self) -> f64 {
        (self.high[0] - self.low[0]) / (self.high[1] - self.low[1])
    }

    fn at(&self, height: f64) -> f64 {
        self.low[0] + self.slope() * (height - self.low[1])
    }

    /// The height at which another edge crosses this one.
    fn crossing(&self, other: &Self) -> Option<f64> {
        let [[left, right], [other_left, other_right]] =
            [self, other].map(|it| [it.low[0].min(it.high[0]), it.low[0].max(it.high[0])]);
        if left > other_right || right < other_left {
            return None;
        }
        let sides = |edge: &Self, other: &Self| {
            [other.low, other.high].map(|end| side((edge.low, edge.high), end))
        };
        let ([a, b], [p, q]) = (sides(self, other), sides(other, self));
        let crosses = a * b < 0.0 && p * q < 0.0;
        crosses.then(|| self.low[1] + p / (p - q) * (self.high[1] - self.low[1]))
    }
}

/// The heights of all ends and crossings of edges, sorted by their lower ends.
fn heights(all: &[ObliqueEdge]) -> Vec<f64> {
    let ends = all.iter().flat_map(|edge| [edge.low[1], edge.high[1]]);
    let mut heights: Vec<f64> = ends.collect();
    for (i, edge) in all.iter().enumerate() {
        let overlapping = all[i + 1..].iter().take_while(|other| other.low[1] < edge.high[1]);
        heights.extend(overlapping.filter_map(|other| edge.crossing(other)));
    }
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    heights
}

/// The edges through each slab between neighbouring heights.
fn by_slabs<'a>(all: &'a [ObliqueEdge], heights: &[f64]) -> Vec<Vec<&'a ObliqueEdge>> {
    let mut slabs = vec![Vec::new(); heights.len().saturating_sub(1)];
    for edge in all {
        let first = heights.partition_point(|height| *height < edge.low[1]);
        let through = std::iter::zip(&mut slabs[first..], &heights[first..]);
        through
            .take_while(|(_, height)| **height < edge.high[1])
            .for_each(|(slab, _)| slab.push(edge));
    }
    slabs
}

/// The area within a slab; its gradient is added to `gradient`.
fn trapezoids([bottom, top]: [f64; 2], edges: &[&ObliqueEdge], gradient: &mut [[f64; 2]]) -> f64 {
    let (middle, height) = (0.5 * (bottom + top), top - bottom);
    let mut sorted: Vec<(f64, &ObliqueEdge)> =
        edges.iter().map(|it| (it.at(middle), *it)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut area, mut w, mut left) = (0.0, 0i32, 0.0);
    for (x, edge) in sorted {
        area += f64::from(w.abs()) * (x - left) * height;
        let fall = w.abs() - (w + edge.step).abs();
        if let Some([low, high]) = edge.ends {
            let along = (middle - edge.low[1]) / (edge.high[1] - edge.low[1]);
            let by_edge = f64::from(fall) * height;
            for (end, part) in [(low, 1.0 - along), (high, along)] {
                gradient[end][0] += part * by_edge;
                gradient[end][1] -= part * by_edge * edge.slope();
            }
        }
        w += edge.step;
        left = x;
    }
    area
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use testkit::derivatives::{TaylorRemainders, assert_close, assert_gradient};

    type Polygon = Vec<[f64; 2]>;

    fn square([x, y]: [f64; 2], side: f64) -> Polygon {
        vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    }

    /// Rotated about the origin, then shifted.
    fn moved(polygon: &[[f64; 2]], angle: f64, shift: [f64; 2]) -> Polygon {
        let moved = |p: &[f64; 2]| point(complex(*p) * turn(angle) + complex(shift));
        polygon.iter().map(moved).collect()
    }

    /// A star with `spikes` spikes and uneven radii.
    fn star(spikes: u32, phase: f64) -> Polygon {
        let vertex = |i: u32| {
            let radius = 2.0 + f64::from(i % 2) + 0.3 * (f64::from(i * i) + phase).sin();
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(spikes);
            point(turn(angle + 0.1 * phase) * radius)
        };
        (0..2 * spikes).map(vertex).collect()
    }

    fn difference(one: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
        symmetric_difference(one, other).0
    }

    #[test]
    fn closed_forms_of_squares() {
        let unit = square([0.0, 0.0], 1.0);
        let cases = [
            (unit.clone(), 0.0),                             // the same
            (square([0.5, 0.0], 1.0), 1.0),                  // two edges that coincide in part
            (square([1.0, 0.0], 1.0), 2.0),                  // a common edge
            (square([1.0, 1.0], 1.0), 2.0),                  // a common vertex
            (square([7.0, -5.0], 2.0), 5.0),                 // disjoint
            (square([0.25, 0.25], 0.5), 0.75),               // contained
            (square([0.0, 0.0], 0.5), 0.75),                 // contained, with a common corner
            (vec![[0.5, 0.5]; 4], 1.0),                      // a point
            (vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 1.0), // a segment
            (Vec::new(), 1.0),
        ];
        for (other, expected) in cases {
            for angle in [0.0, 0.3, std::f64::consts::FRAC_PI_2] {
                let [one, other] = [&unit, &other].map(|it| moved(it, angle, [30.0, -20.0]));
                assert_close(difference(&one, &other), expected, 1e-13);
            }
        }
        // A regular octagon is common to a square of side 2 and the same turned by 45 degrees.
        let [one, other] = [0.0, std::f64::consts::FRAC_PI_4]
            .map(|angle| moved(&square([-1.0, -1.0], 2.0), angle, [0.0; 2]));
        let octagon = 8.0 * std::f64::consts::FRAC_PI_8.tan();
        assert_close(difference(&one, &other), 2.0 * (4.0 - octagon), 1e-14);
    }

    #[test]
    fn it_is_a_distance_that_motions_do_not_change() {
        let (a, b) = (star(7, 0.0), star(5, 1.0));
        let c = moved(&star(7, 2.0), 0.4, [1.5, 0.3]);
        for (one, other) in [(&a, &b), (&b, &c), (&c, &a)] {
            let found = difference(one, other);
            assert!(found > 1.0);
            assert!((difference(other, one) - found).abs() < 1e-13);
            let [one, other] = [one, other].map(|it| moved(it, 2.1, [40.0, 7.0]));
            assert!((difference(&one, &other) - found).abs() < 1e-12);
        }
        assert!(difference(&a, &c) <= difference(&a, &b) + difference(&b, &c));
    }

    /// A bow tie of two unit triangles, the second clockwise, and a square traversed twice.
    #[test]
    fn what_is_enclosed_twice_or_clockwise_counts_as_often() {
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
        assert!((difference(&bow, &[]) - 2.0).abs() < 1e-14);
        // One triangle is outside the square with w = 1, the other inside it with w = -1 - 1.
        let one = difference(&bow, &square([0.0, 0.0], 2.0));
        assert!((one - 4.0).abs() < 1e-14, "{one}");
        let unit = square([0.0, 0.0], 1.0);
        let twice = [&unit[..], &unit[..]].concat();
        assert!((difference(&twice, &unit) - 1.0).abs() < 1e-14);
        let clockwise: Polygon = unit.iter().rev().copied().collect();
        assert!((difference(&clockwise, &unit) - 2.0).abs() < 1e-14);
    }

    fn assert_slopes(outline: &[[f64; 2]], target: &[[f64; 2]]) {
        let value = |x: &[f64]| difference(x.as_chunks().0, target);
        let x = outline.as_flattened();
        let (_, gradient) = symmetric_difference(outline, target);
        assert_gradient(value, x, gradient.as_flattened(), 1e-6, |_| 1e-8);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let target = star(5, 1.0);
        assert_slopes(&star(7, 0.0), &target);
        assert_slopes(&moved(&star(9, 2.0), 0.0, [2.0, 1.0]), &target);
        // Edges along the axes and a polygon that crosses itself.
        assert_slopes(&square([0.2, 0.3], 2.0), &square([0.0, 0.0], 2.0));
        assert_slopes(&[[0.0, 0.1], [2.0, 2.0], [2.2, 0.0], [0.0, 2.0]], &target);
        assert_slopes(&square([9.0, 0.0], 1.0), &target);
    }

    #[test]
    fn taylor_remainders_are_of_second_order() {
        let (outline, target) = (star(7, 0.0), star(5, 1.0));
        let x = outline.as_flattened();
        let (_, gradient) = symmetric_difference(&outline, &target);
        let direction: Vec<f64> = (0..x.len()).map(|i| (i as f64).cos()).collect();
        let value = |x: &[f64]| Ok::<_, Infallible>(difference(x.as_chunks().0, &target));
        let slopes = gradient.as_flattened();
        let Ok(remainders) = TaylorRemainders::new(value, x, slopes, &direction, 1e-3, 6);
        remainders.assert_orders(1.9..f64::INFINITY);
    }

    /// Edges that lie on edges of the target: the slope is one-sided, and the slope of either side
    /// is found.
    #[test]
    fn where_edges_coincide_the_slope_is_that_of_one_side() {
        let unit = square([0.0, 0.0], 1.0);
        let (area, gradient) = symmetric_difference(&unit, &unit);
        assert_eq!(area, 0.0);
        for slope in gradient.as_flattened() {
            assert!((slope.abs() - 0.5).abs() < 1e-12, "{slope}");
        }
    }
}
