//! A panel between its finished edges: the edges of cuts are half a slit inside of their lines.

use design::geometry::polygon::{distance, edges};
use design::sheet::cut_sheet::Sheet;
use design::sheet::topology::HingeSite;
use support::Point;

/// Distance from the line of a cut over the width of its slit up to which an edge is at the cut.
const AT_CUT: f64 = 0.75;
/// Distance over the width of a slit up to which corners move with their edges.
const FARTHEST: f64 = 4.0;
/// Rounding of lengths (mm).
const ROUNDING: f64 = 1e-3;

/// The finished edges of a panel, counter-clockwise.
pub(crate) struct FinishedPanel {
    edges: Vec<FinishedEdge>,
    slit: f64,
}

#[derive(Clone, Copy)]
struct FinishedEdge {
    /// Where it begins before the cut (mm).
    begin: Point,
    /// A point of the finished edge (mm), and its direction.
    on: Point,
    direction: Point,
    /// The side of the cell on whose line it is.
    side: Option<usize>,
}

impl FinishedPanel {
    pub(crate) fn new(sheet: &Sheet, panel: usize) -> Self {
        let slit = sheet.options.process.slit_width;
        let cell = sheet.panels[panel].corners;
        let sides = edges(&cell).enumerate().map(|(side, ends)| {
            let inside = if is_cut(sheet, panel, side) { 0.5 * slit } else { 0.0 };
            (
                FinishedEdge { side: Some(side), ..FinishedEdge::new(ends, inside) },
                2.0 * AT_CUT * inside + ROUNDING,
            )
        });
        let sides: Vec<(FinishedEdge, f64)> = sides.collect();
        let mut finished: Vec<FinishedEdge> = Vec::new();
        for ends in edges(&sheet.panels[panel].boundary) {
            let edge = FinishedEdge::new(ends, 0.0);
            let on_side = |(side, reach): &&(FinishedEdge, f64)| {
                let [along, _] = side.local(edge.direction, [0.0; 2]);
                let off = |point: Point| side.local(point, side.begin)[1].abs();
                along > 0.0 && off(ends.0) < *reach && off(ends.1) < *reach
            };
            let side = sides.iter().find(on_side);
            let edge = side.map_or(edge, |(side, _)| FinishedEdge { begin: edge.begin, ..*side });
            if !finished.last().is_some_and(|last| last.continues_in(&edge)) {
                finished.push(edge);
            }
        }
        if finished[finished.len() - 1].continues_in(&finished[0]) {
            finished.remove(0);
        }
        let mut panel = Self { edges: finished, slit };
        while let Some(edge) = panel.vanished() {
            panel.edges.remove(edge);
        }
        panel
    }

    /// An edge of which the finished edges next to it leave nothing.
    fn vanished(&self) -> Option<usize> {
        let corners = self.corners();
        edges(&corners).position(|(from, to)| distance(from, to) < ROUNDING)
    }

    /// Each edge with the one before it.
    fn pairs(&self) -> impl Iterator<Item = (&FinishedEdge, &FinishedEdge)> {
        std::iter::zip(self.edges.iter().cycle().skip(self.edges.len() - 1), &self.edges)
    }

    /// Where its edges meet, counter-clockwise (mm).
    pub(crate) fn corners(&self) -> Vec<Point> {
        self.pairs().map(|(one, next)| one.meets(next, FARTHEST * self.slit)).collect()
    }

    /// The number, among its corners, of a corner of the cell; `None` if that is trimmed away.
    pub(crate) fn number_of(&self, corner: usize) -> Option<usize> {
        let sides = [Some((corner + 3) % 4), Some(corner)];
        self.pairs().position(|(one, next)| [one.side, next.side] == sides)
    }

    /// A point of the panel; if it lies on the line of a cut, the nearest point of the finished
    /// edge.
    pub(crate) fn nearest(&self, point: Point) -> Point {
        let corners = self.corners();
        edges(&corners).fold(point, |at, ends| {
            let edge = FinishedEdge::new(ends, 0.0);
            let [along, depth] = edge.local(at, edge.begin);
            let along_it = (-self.slit..distance(ends.0, ends.1) + self.slit).contains(&along);
            if along_it && depth.abs() <= self.slit { edge.inwards(at, -depth) } else { at }
        })
    }
}

impl FinishedEdge {
    /// The edge between two points, moved inwards.
    fn new((from, to): (Point, Point), inside: f64) -> Self {
        let length = distance(from, to);
        let direction = [0, 1].map(|axis| (to[axis] - from[axis]) / length);
        let edge = Self { begin: from, on: from, direction, side: None };
        Self { on: edge.inwards(from, inside), ..edge }
    }

    fn inwards(&self, [x, y]: Point, by: f64) -> Point {
        [x - by * self.direction[1], y + by * self.direction[0]]
    }

    /// A point seen from another one: along the edge and inwards.
    fn local(&self, to: Point, from: Point) -> Point {
        let ([c, s], [x, y]) = (self.direction, [to[0] - from[0], to[1] - from[1]]);
        [c * x + s * y, c * y - s * x]
    }

    fn continues_in(&self, next: &Self) -> bool {
        self.side.is_some() && self.side == next.side
    }

    /// The corner between this edge and the next: their intersection, or if that is farther than
    /// `most` from the corner before the cut, the point of the moved edge nearest to that.
    fn meets(&self, next: &Self, most: f64) -> Point {
        let (from, to) = (self.local(next.on, self.on)[1], self.local(next.direction, [0.0; 2])[1]);
        let met = [0, 1].map(|axis| next.on[axis] - from / to * next.direction[axis]);
        let moved = if self.side.is_some() { self } else { next };
        match (self.side, next.side) {
            (None, None) => next.begin,
            _ if distance(met, next.begin) < most => met,
            _ => moved.inwards(next.begin, -moved.local(next.begin, moved.on)[1]),
        }
    }
}

/// Whether a side of a panel's cell is the edge of a slit.
fn is_cut(sheet: &Sheet, panel: usize, side: usize) -> bool {
    let ends = [(panel, side), (panel, (side + 1) % 4)];
    let at_slit = |site: &HingeSite| ends.contains(&site.a) || ends.contains(&site.b);
    let mut hinges = sheet.hinges.iter().filter(|hinge| hinge.set_back > hinge.w_lig);
    sheet.topology.beyond(panel, side).is_some() || hinges.any(|hinge| at_slit(&hinge.site))
}
