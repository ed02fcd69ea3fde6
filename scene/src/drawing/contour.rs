//! A line in a drawing, and what makes it an outline.

use design::geometry::polygon;
use support::{Fault, Point, ensure, refuse};

/// Points closer than this fraction of the largest coordinate are merged: usvg rounds to f32.
pub(super) const WELD: f64 = 1e-6;
/// Largest coordinate over the size of an outline from which its rounding shows.
const TOO_FAR: f64 = 1000.0;
/// Maximum number of points of an outline, 3000 curves: the worst one of them is checked for
/// crossings in seconds.
pub(super) const MOST_POINTS: usize = 100_000;
/// Number of contours that a message lists.
pub(super) const LISTED: usize = 5;

/// A line of a drawing, flattened to segments.
#[derive(Debug, Default)]
pub(super) struct Contour {
    pub points: Vec<Point>,
    /// Whether its end is connected to its start.
    pub closed: bool,
    /// Whether its inside is filled: viewers close it.
    pub filled: bool,
    /// Whether it ends where more than two lines meet.
    pub branches: bool,
    /// Distance at which two points are one.
    pub rounding: f64,
}

impl Contour {
    /// The lower left and the upper right corner of its bounding box.
    pub(super) fn bounds(&self) -> [Point; 2] {
        polygon::bounds(self.points.iter().copied())
    }

    /// Width and height of its bounding box.
    pub(super) fn size(&self) -> [f64; 2] {
        polygon::size(self.bounds())
    }

    /// Whether it has an inside.
    pub(super) fn is_whole(&self) -> bool {
        self.closed || self.filled
    }

    /// It with each point once; one that returns to its start is closed.
    pub(super) fn merged(mut self) -> Self {
        let near = |p: Point, q: Point| polygon::distance(p, q) <= self.rounding;
        let mut last = [f64::NAN; 2];
        self.points.retain(|point| {
            let kept = !near(*point, last);
            if kept {
                last = *point;
            }
            kept
        });
        while self.points.len() > 2 && near(self.points[0], last) {
            self.points.pop();
            last = self.points[self.points.len() - 1];
            self.closed = true;
        }
        self
    }

    /// Checks that it is an outline; returns the length of the line that closes it. Lengths and
    /// coordinates are in the page of an SVG file (px), or in a DXF file (mm if it states its unit).
    pub(super) fn check(&self) -> Result<f64, Fault> {
        let found = self.points.len();
        let last = self.points[found - 1];
        let gap = match self.closed {
            true => 0.0,
            false => polygon::distance(self.points[0], last),
        };
        let [x, y] = last.map(rounded);
        ensure!(
            self.closed || !self.branches,
            "lines branch at ({x}, {y}), or lie on each other there in part: delete those that are not part of the outline"
        );
        ensure!(
            found > 2,
            "the path has {found} different points; draw an outline of at least 3 points"
        );
        ensure!(
            self.is_whole(),
            "the path ends open at ({x}, {y}), {} from its start; close it (in SVG data with Z), or correct the mistake in the data \
             after this point",
            rounded(gap)
        );
        let [width, height] = self.size();
        let times = self.rounding / WELD / width.max(height);
        ensure!(
            times <= TOO_FAR,
            "the outline is {times:.0} times its own size away from the origin of its coordinates, and is read with seven digits; \
             move it to the origin"
        );
        ensure!(
            found <= MOST_POINTS,
            "the path has {found} points; simplify the outline to at most {MOST_POINTS}"
        );
        if let Some([x, y]) = crossing(&[self]) {
            refuse!(
                "the path crosses or touches itself near ({x}, {y}); move its points until \
                 the outline is one simple loop"
            );
        }
        Ok(gap)
    }
}

/// A common point of the lines of contours. Coordinates are taken from a point of the last one:
/// numbers near zero have more digits.
pub(super) fn crossing(contours: &[&Contour]) -> Option<Point> {
    let [x0, y0] = contours.last()?.points[0];
    let near_zero = contours.iter().map(|contour| -> Vec<_> {
        contour.points.iter().map(|[x, y]| [x - x0, y - y0]).collect()
    });
    polygon::crossing(near_zero).map(|[x, y]| [x + x0, y + y0].map(rounded))
}

/// Number of segments of a flattened curve.
const SEGMENTS: usize = 32;

/// Appends a Bezier curve that starts at the last point, by de Casteljau's algorithm.
pub(super) fn flatten(points: &mut Vec<Point>, controls: &[Point]) {
    let start = points.last().copied();
    let controls: Vec<Point> = start.iter().chain(controls).copied().collect();
    for i in 1..=SEGMENTS {
        let t = i as f64 / SEGMENTS as f64;
        let mut level = controls.clone();
        while level.len() > 1 {
            level = (level.windows(2))
                .map(|pair| [0, 1].map(|c| (1.0 - t) * pair[0][c] + t * pair[1][c]))
                .collect();
        }
        points.push(level[0]);
    }
}

/// A coordinate of a message.
pub(super) fn rounded(x: f64) -> f64 {
    (1e5 * x).round() / 1e5
}
