//! Polygons of any shape, with holes: union, difference, intersection, offset, area.

use crate::geometry::polygon;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};
use std::f64::consts::FRAC_PI_8;
use support::{Extremes, Point};

/// Angle of the pieces of an arc (rad).
const ARC: f64 = 0.2;
/// Distance of a corner from the line between its neighbours up to which it is straight, over the
/// distance of an offset.
const STRAIGHT: f64 = 1e-4;

/// The corners of a closed polygon.
pub type Ring = Vec<Point>;

/// Disjoint polygons. The contours of each are its outline, counter-clockwise, and its holes,
/// clockwise.
#[derive(Clone, Debug, Default)]
pub struct Region {
    /// The contours of each polygon.
    pub polygons: Vec<Vec<Ring>>,
}

/// How an offset region turns about its corners.
#[derive(Clone, Copy, Debug)]
pub enum Corners {
    /// In arcs.
    Round,
    /// In points.
    Sharp,
}

impl Region {
    /// The points around which contours in any order and direction go an odd number of times.
    pub fn even_odd(contours: Vec<Ring>) -> Self {
        Self { polygons: contours.simplify_shape(FillRule::EvenOdd) }
    }

    /// The union of polygons without holes, counter-clockwise.
    pub fn union_of(contours: Vec<Ring>) -> Self {
        Self { polygons: contours.simplify_shape(FillRule::NonZero) }
    }

    /// The points of this or of another region.
    pub fn union(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Union)
    }

    /// The points of this region that are not in another.
    pub fn minus(&self, other: &Self) -> Self {
        if other.polygons.is_empty() {
            return self.clone();
        }
        self.overlay(other, OverlayRule::Difference)
    }

    /// The points that are in both regions.
    pub fn common(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Intersect)
    }

    fn overlay(&self, other: &Self, rule: OverlayRule) -> Self {
        Self { polygons: self.polygons.overlay(&other.polygons, rule, FillRule::NonZero) }
    }

    /// All points nearer than a distance, or, if it is negative, the points that are as far from
    /// the outside.
    pub fn offset(&self, distance: f64, corners: Corners) -> Self {
        // The crate leaves a spike at a corner that is straight but for a rounding.
        let bent = |contour: &Ring| simplified(contour, STRAIGHT * distance.abs(), |_| false);
        let bent = |contours: &Vec<Ring>| contours.iter().map(bent).collect();
        let bent: Vec<Vec<Ring>> = self.polygons.iter().map(bent).collect();
        let join = match corners {
            Corners::Round => LineJoin::Round(ARC),
            Corners::Sharp => LineJoin::Miter(FRAC_PI_8),
        };
        let style = OutlineStyle::new(distance).line_join(join);
        Self { polygons: bent.outline(&style) }
    }

    /// The same with its corners kept.
    pub fn joined(&self, distance: f64) -> Self {
        self.offset(distance, Corners::Sharp).offset(-distance, Corners::Sharp)
    }

    /// Without the parts narrower than twice a distance.
    pub fn opened(&self, distance: f64) -> Self {
        self.offset(-distance, Corners::Sharp).offset(distance, Corners::Sharp)
    }

    /// Without holes.
    pub fn filled(&self) -> Self {
        let outer = |contours: &Vec<Ring>| contours[..1].to_vec();
        Self { polygons: self.polygons.iter().map(outer).collect() }
    }

    /// All contours.
    pub fn contours(&self) -> impl Iterator<Item = &Ring> {
        self.polygons.iter().flatten()
    }

    /// mm^2
    pub fn area(&self) -> f64 {
        self.contours().map(|contour| polygon::area(contour)).sum()
    }

    /// Lower left and upper right corner of the bounding box.
    pub fn bounds(&self) -> [Point; 2] {
        polygon::bounds(self.contours().flatten().copied())
    }

    /// Width and height of the bounding box.
    pub fn extent(&self) -> Point {
        let [low, high] = self.bounds();
        [0, 1].map(|c| high[c] - low[c])
    }

    /// The longer side of the bounding box.
    pub fn longer_side(&self) -> f64 {
        let [width, height] = self.extent();
        f64::max(width, height)
    }

    /// The area in common with another region over the area of both.
    pub fn likeness(&self, other: &Self) -> f64 {
        self.common(other).area() / self.union(other).area()
    }

    /// Whether the region contains a point; the border belongs to one of its sides.
    pub fn contains(&self, point: Point) -> bool {
        self.contours().filter(|contour| polygon::contains(contour, point)).count() % 2 == 1
    }

    /// The image under a map that keeps the orientation.
    pub fn map(&self, map: impl Fn(Point) -> Point) -> Self {
        let contour = |contour: &Ring| contour.iter().map(|point| map(*point)).collect();
        let polygons = self.polygons.iter();
        Self { polygons: polygons.map(|contours| contours.iter().map(contour).collect()).collect() }
    }

    /// Without the corners that are nearer than `tolerance` to the line between their neighbours
    /// (Douglas and Peucker, Cartographica 10, 1973, 112), unless they are `fixed`.
    pub fn simplified(&self, tolerance: f64, fixed: impl Fn(Point) -> bool) -> Self {
        let simple: Vec<Ring> =
            self.contours().map(|contour| simplified(contour, tolerance, &fixed)).collect();
        // A gap narrower than the tolerance has become a line.
        Self { polygons: simple.simplify_shape(FillRule::NonZero) }
    }
}

/// Intersection over union of what one sees of opened panels and a drawing with its holes: gaps up
/// to 8 % of the longer side of the drawing, or to the width of a panel, are closed.
pub fn seen(panels: Vec<Ring>, drawing: &Region) -> f64 {
    as_seen(panels, drawing).likeness(drawing)
}

/// What one sees of opened panels: without the gaps between them.
pub fn as_seen(panels: Vec<Ring>, drawing: &Region) -> Region {
    const GAP: f64 = 0.04;
    // Squares that are turned by a right angle are half a side from the middle of their gap; panels
    // are trimmed.
    const OF_PANEL: f64 = 0.6;
    let area: f64 = panels.iter().map(|panel| polygon::area(panel)).sum();
    let panel = (area / panels.len() as f64).sqrt();
    let gap = f64::max(GAP * drawing.longer_side(), OF_PANEL * panel);
    let opened = Region::union_of(panels);
    opened.offset(gap, Corners::Round).offset(-gap, Corners::Round)
}

fn simplified(contour: &[Point], tolerance: f64, fixed: impl Fn(Point) -> bool) -> Ring {
    let all = 0..contour.len();
    let mut ends: Vec<usize> = all.clone().filter(|i| fixed(contour[*i])).collect();
    let first = *ends.first().unwrap_or(&0);
    let from_first = |i: &usize| polygon::distance(contour[*i], contour[first]);
    let Some(far) = all.largest_by(from_first) else {
        return Ring::new();
    };
    ends.extend([first, far]);
    ends.sort_unstable();
    ends.dedup();
    let ring: Ring = contour.iter().chain(contour).copied().collect();
    let next = ends.iter().skip(1).copied().chain([contour.len() + ends[0]]);
    let mut kept = Ring::new();
    for (from, to) in std::iter::zip(&ends, next) {
        keep(&ring[*from..=to], tolerance, &mut kept);
    }
    kept
}

/// Adds the kept points of a line but its last.
fn keep(line: &[Point], tolerance: f64, kept: &mut Ring) {
    let (first, last) = (line[0], line[line.len() - 1]);
    let off = |i: &usize| polygon::distance_to_segment(line[*i], first, last);
    let farthest = (1..line.len() - 1).largest_by(off);
    match farthest.filter(|i| off(i) > tolerance) {
        Some(i) => {
            keep(&line[..=i], tolerance, kept);
            keep(&line[i..], tolerance, kept);
        }
        None => kept.push(first),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(at: f64, side: f64) -> Ring {
        vec![[at, at], [at + side, at], [at + side, at + side], [at, at + side]]
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6 * expected, "{found} {expected}");
    }

    #[test]
    fn areas_of_a_square_with_a_hole() {
        let ring = Region::even_odd(vec![square(0.0, 10.0), square(3.0, 4.0)]);
        close(ring.area(), 84.0);
        assert!(ring.contains([1.0, 5.0]) && !ring.contains([5.0, 5.0]));
        let other = Region::union_of(vec![square(5.0, 10.0)]);
        close(ring.common(&other).area(), 21.0);
        close(ring.minus(&other).area(), 63.0);
        close(ring.union(&other).area(), 163.0);
        close(ring.offset(-1.0, Corners::Sharp).area(), 64.0 - 36.0);
        assert!(ring.opened(1.6).polygons.is_empty());
    }

    #[test]
    fn points_on_a_straight_edge_are_left_out() {
        let edge = (0..100).map(|i| [0.1 * f64::from(i), 1e-3 * f64::from(i % 2)]);
        let contour: Ring = edge.chain([[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]).collect();
        let simple = Region { polygons: vec![vec![contour]] }.simplified(0.01, |_| false);
        assert_eq!(simple.polygons[0][0].len(), 4);
        close(simple.area(), 100.0);
    }

    #[test]
    fn panels_with_narrow_gaps_are_seen_as_one() {
        let panel =
            |[x, y]: [f64; 2]| square(0.0, 9.6).iter().map(|p| [p[0] + x, p[1] + y]).collect();
        let panels = |columns: i32| -> Vec<Ring> {
            let places = (0..columns).flat_map(|i| (0..3).map(move |j| [i, j]));
            places.map(|at| panel(at.map(|k| 10.0 * f64::from(k)))).collect()
        };
        let drawing = Region::union_of(vec![square(0.0, 29.6)]);
        assert!(seen(panels(3), &drawing) > 0.9999);
        assert!((seen(panels(2), &drawing) - 19.6 / 29.6).abs() < 1e-3);
    }

    /// Corners that are straight but for a rounding left a spike here: 104 mm^2 were lost.
    #[test]
    fn no_corner_is_lost_where_gaps_are_closed() {
        let panels = vec![
            vec![[96.0, -3.0], [66.0, -19.0], [87.0, -18.0]],
            vec![[119.0, 38.0], [143.975183833, 45.071046876], [128.3, 53.92]],
            vec![
                [128.418179656, 53.560035353],
                [144.149600486, 62.307795873],
                [151.090703686, 66.167530425],
                [151.3, 77.0],
            ],
            vec![[95.0, 208.0], [111.0, 199.0], [121.305496964, 217.809984478]],
        ];
        let drawing = Region::union_of(vec![square(0.0, 9.47 / 0.04)]);
        let seen = as_seen(panels.clone(), &drawing);
        for panel in panels {
            let alone = Region { polygons: vec![vec![panel]] };
            assert!(alone.minus(&seen).area() < 1e-3 * alone.area());
        }
    }
}
