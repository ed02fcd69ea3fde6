//! The window of a hinge: the half-disc of sheet on which its energy was condensed.
//!
//! The flat side is on the finished edge of the secondary cut and is centred at the foot of
//! the perpendicular from the tip O. Hinge energies are additive only if the windows are disjoint
//! and lie within the two panels that their hinges join.

use crate::{
    geometry::polygon::{clip, distance, distance_to_polygon},
    geometry::region::Region,
    sheet::cut_sheet::{Hinge, Panel, Sheet},
};
use std::f64::consts::PI;
use support::Point;

/// The window of a hinge in the flat sheet.
#[derive(Clone, Copy, Debug)]
pub struct HingeWindow {
    /// Foot of the perpendicular from O to the edge of the secondary cut: the origin of the hinge
    /// frame (mm).
    pub foot: Point,
    /// Unit vector along the secondary cut.
    pub e_sec: Point,
    /// Radius r_win (mm).
    pub radius: f64,
}

/// Points along the arc; the error of the polygon is below 0.03% of the radius.
const ARC: usize = 64;
/// Overlap, relative to the radius, up to which windows are disjoint: those on the two flanks of
/// one cut touch.
const TOUCH: f64 = 1e-6;
/// Area outside of the panels that is rounding, over the square of the radius.
const OUTSIDE: f64 = 1e-5;

impl HingeWindow {
    pub(crate) fn new(hinge: &Hinge, r_win: f64) -> Self {
        let [x, y] = hinge.e_sec;
        let foot = [hinge.tip[0] - hinge.w_lig * y, hinge.tip[1] + hinge.w_lig * x];
        Self { foot, e_sec: hinge.e_sec, radius: r_win }
    }

    /// The windows of all hinges of a sheet.
    pub fn of_sheet(sheet: &Sheet) -> Vec<Self> {
        let r_win = sheet.options.process.r_win;
        sheet.hinges.iter().map(|hinge| Self::new(hinge, r_win)).collect()
    }

    /// The point at hinge-frame coordinates (x, y) (mm).
    pub fn point(&self, x: f64, y: f64) -> Point {
        let [c, s] = self.e_sec;
        [self.foot[0] + c * x - s * y, self.foot[1] + s * x + c * y]
    }

    /// The half-disc as a convex polygon, from -x through the material to +x (mm).
    pub fn polygon(&self) -> Vec<Point> {
        (0..=ARC)
            .map(|i| {
                let (sin, cos) = (PI * i as f64 / ARC as f64).sin_cos();
                self.point(-self.radius * cos, -self.radius * sin)
            })
            .collect()
    }

    /// The part of the half-disc inside a panel (mm).
    pub fn inside(&self, panel: &Panel) -> Region {
        let panel = Region::union_of(vec![panel.boundary.clone()]);
        Region::union_of(vec![self.polygon()]).common(&panel)
    }

    /// Signed distance of a point above the flat side, on the side without material (mm).
    fn height(&self, [x, y]: Point) -> f64 {
        let [c, s] = self.e_sec;
        c * (y - self.foot[1]) - s * (x - self.foot[0])
    }

    /// Whether the areas of two windows overlap.
    pub fn overlaps(&self, other: &Self) -> bool {
        let touch = TOUCH * self.radius.max(other.radius);
        let apart = distance(self.foot, other.foot);
        if apart >= self.radius + other.radius - touch {
            return false;
        }
        let shared = clip(&self.polygon(), |point| other.height(point) + touch);
        distance_to_polygon(other.foot, &shared) < other.radius - touch
    }

    /// Whether the half-disc is in the two panels, except for a strip along the secondary cut.
    pub fn within(&self, a: &Panel, b: &Panel) -> bool {
        let panels = Region::union_of([a, b].map(|panel| panel.boundary.clone()).to_vec());
        let outside = Region::union_of(vec![self.polygon()[1..ARC].to_vec()]).minus(&panels);
        outside.area() < OUTSIDE * self.radius * self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(foot: [f64; 2], angle_deg: f64) -> HingeWindow {
        let (sin, cos) = f64::to_radians(angle_deg).sin_cos();
        HingeWindow { foot, e_sec: [cos, sin], radius: 100.0 }
    }

    #[test]
    fn the_material_is_below_the_secondary_cut() {
        let turned = window([10.0, 20.0], 90.0);
        let lowest = turned.polygon()[ARC / 2];
        assert!((lowest[0] - 110.0).abs() < 1e-9 && (lowest[1] - 20.0).abs() < 1e-9);
        assert!((turned.height(lowest) + 100.0).abs() < 1e-9);
    }

    #[test]
    fn windows_on_the_two_flanks_of_a_cut_only_touch() {
        let south = window([0.0, 0.0], 0.0);
        for shift in [0.0, 30.0, -150.0] {
            let north = window([shift, 0.0], 180.0);
            assert!(!south.overlaps(&north) && !north.overlaps(&south));
        }
    }

    #[test]
    fn half_discs_overlap_if_and_only_if_their_intersection_has_area() {
        let window_at = |x, y, angle| window([x, y], angle);
        let below = window([0.0, 0.0], 0.0);
        // (other window, whether it overlaps the half-disc below the x axis)
        let cases = [
            (window_at(199.0, 0.0, 0.0), true),
            (window_at(200.0, 0.0, 0.0), false),
            (window_at(0.0, -99.0, 0.0), true),
            // The discs overlap, the half-discs do not.
            (window_at(-120.0, -120.0, 0.0), false),
            (window_at(-60.0, -160.0, 180.0), true),
            // A disc that extends beyond the flat side, where it has no material.
            (window_at(0.0, 50.0, 180.0), false),
            (window_at(0.0, 50.0, 0.0), true),
        ];
        for (other, expected) in cases {
            assert_eq!(below.overlaps(&other), expected, "{other:?}");
            assert_eq!(other.overlaps(&below), expected, "{other:?}");
        }
    }

    #[test]
    fn a_window_that_extends_beyond_its_panels_is_detected() {
        let panel = |x: f64, width: f64| {
            let corners = [[x, -300.0], [x + width, -300.0], [x + width, 0.0], [x, 0.0]];
            Panel::new(0, corners, None).unwrap()
        };
        let (below, left) = (window([0.0, 0.0], 0.0), panel(-300.0, 300.0));
        assert!(below.within(&left, &panel(0.0, 300.0)));
        assert!(!below.within(&left, &panel(0.0, 90.0)));
        let mut dented = panel(0.0, 300.0);
        dented.boundary.splice(1..1, [[140.0, -300.0], [50.0, -80.0], [160.0, -300.0]]);
        assert!(!below.within(&left, &dented));
        dented.boundary[2] = [75.0, -75.0];
        assert!(below.within(&left, &dented));
    }
}
