//! Polylines of straight lines and arcs, as DXF has them: a vertex with its bulge, the tangent of a
//! quarter of the angle of the arc to the next vertex, positive counter-clockwise; 0 for a straight
//! line.

use design::geometry::plane::{I, complex, point};
use faer::c64;
use std::f64::consts::TAU;
use support::Point;

/// A vertex (mm) and its bulge.
pub type Vertex = (Point, f64);

/// Number of segments of a full circle.
const SEGMENTS: f64 = 128.0;

/// The centre of the arc between two points with a bulge, which is not 0.
pub fn centre(from: Point, to: Point, bulge: f64) -> Point {
    let [from, to] = [from, to].map(complex);
    point(0.5 * (from + to) + I * (to - from) * ((1.0 - bulge * bulge) / (4.0 * bulge)))
}

/// Points on the arc about a centre from the end of a radius through an angle.
pub(super) fn arc(centre: c64, radius: c64, angle: f64) -> Vec<Point> {
    let count = (SEGMENTS * angle.abs() / TAU).ceil().max(1.0) as usize;
    let at = |i: usize| point(centre + radius * c64::cis(angle * i as f64 / count as f64));
    (0..=count).map(at).collect()
}

/// The points of a polyline, with points on its arcs.
pub fn flattened(vertices: &[Vertex], closed: bool) -> Vec<Point> {
    let mut points = Vec::new();
    for (i, &(from, bulge)) in vertices.iter().enumerate() {
        points.push(from);
        let is_last = i + 1 == vertices.len();
        if bulge == 0.0 || (is_last && !closed) {
            continue;
        }
        let to = vertices[(i + 1) % vertices.len()].0;
        let centre = complex(centre(from, to, bulge));
        let on_arc = arc(centre, complex(from) - centre, 4.0 * bulge.atan());
        points.extend_from_slice(&on_arc[1..on_arc.len() - 1]);
    }
    points
}
