//! Geometry of the hinge window (section 2.4): a half-disc of radius r_win below the secondary
//! cut, without the main cut (a slot of the kerf's width) and the hole drilled about its tip O.
//!
//! Arc A runs from (-r_win, 0) to the kerf face on panel A, arc B from the kerf face on panel B
//! to (r_win, 0). All coordinates are in the hinge frame, in mm.

use hinge::HingeDesign;
use std::f64::consts::PI;
use support::Point;

/// The two panels of a hinge: A on the -x side of the main cut, B on the +x side.
#[derive(Clone, Copy, Debug)]
pub enum Side {
    /// Panel A, on the -x side of the main cut.
    A,
    /// Panel B, on the +x side of the main cut.
    B,
}

impl Side {
    /// Both, A first.
    pub const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Sign of x on the side of the panel, and of the kerf face's offset along [`Window::normal`],
    /// which points to B.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Side::A => -1.0,
            Side::B => 1.0,
        }
    }
}

/// The window of one hinge design. The design must be valid.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a>(pub &'a HingeDesign);

impl Window<'_> {
    /// Unit normal of the main cut, pointing to panel B.
    pub fn normal(&self) -> Point {
        let [x, y] = self.0.main_cut();
        [-y, x]
    }

    /// Where a kerf face meets the hole (mm).
    pub fn kerf_at_hole(&self, side: Side) -> Point {
        let half = 0.5 * self.0.kerf;
        let along = (self.0.fillet_radius().powi(2) - half * half).sqrt();
        self.on_kerf_face(side, along)
    }

    /// Where a kerf face meets the circle of radius `r` about the origin (mm); `r` > w_lig.
    pub fn kerf_at_radius(&self, side: Side, r: f64) -> Point {
        let start = self.on_kerf_face(side, 0.0);
        let b = dot(start, self.0.main_cut());
        let along = -b + (b * b - dot(start, start) + r * r).sqrt();
        self.on_kerf_face(side, along)
    }

    /// The point of a kerf face at the distance `along` (mm) from O along the main cut.
    fn on_kerf_face(&self, side: Side, along: f64) -> Point {
        let (o, u, n) = (self.0.tip(), self.0.main_cut(), self.normal());
        let across = 0.5 * self.0.kerf * side.sign();
        [0, 1].map(|i| o[i] + along * u[i] + across * n[i])
    }

    /// Half of the angle at O that the mouth of the main cut subtends on a circle of radius `rho`
    /// (mm) about O (rad).
    pub fn mouth_half_angle(&self, rho: f64) -> f64 {
        (0.5 * self.0.kerf / rho).asin()
    }

    /// The angle at the origin of the arc of radius r_win on a panel (rad).
    pub(crate) fn arc_angle(&self, side: Side) -> f64 {
        let angle = polar_angle(self.kerf_at_radius(side, self.0.r_win));
        match side {
            Side::A => angle + PI,
            Side::B => -angle,
        }
    }

    /// Points at equal angles on one panel's part of the circle `radius`, counter-clockwise.
    pub(crate) fn panel_arc(&self, side: Side, radius: f64, columns: usize) -> Vec<Point> {
        let kerf = self.kerf_at_radius(side, radius);
        let (from, to) = match side {
            Side::B => (polar_angle(kerf), 0.0),
            Side::A => (-PI, polar_angle(kerf)),
        };
        let at = |j: usize| {
            let angle = from + (to - from) * j as f64 / columns as f64;
            [radius * angle.cos(), radius * angle.sin()]
        };
        let mut points: Vec<_> = (0..=columns).map(at).collect();
        // The end points are set exactly, so that the free edge is straight and the kerf faces are
        // flat.
        let (free, cut) = match side {
            Side::B => (columns, 0),
            Side::A => (0, columns),
        };
        points[free] = [radius.copysign(points[free][0]), 0.0];
        points[cut] = kerf;
        points
    }

    /// Exact area of the window (mm^2), by Green's theorem over its arcs and segments.
    pub fn area(&self) -> f64 {
        let (rho, r) = (self.0.fillet_radius(), self.0.r_win);
        let (hole_a, hole_b) = (self.kerf_at_hole(Side::A), self.kerf_at_hole(Side::B));
        let (arc_a, arc_b) = (self.kerf_at_radius(Side::A, r), self.kerf_at_radius(Side::B, r));
        let hole_angle = 2.0 * (PI - self.mouth_half_angle(rho));
        sector(r, self.arc_angle(Side::A))
            + segment(arc_a, hole_a)
            + arc(self.0.tip(), rho, hole_a, hole_b, -hole_angle)
            + segment(hole_b, arc_b)
            + sector(r, self.arc_angle(Side::B))
    }
}

/// Polar angle about the origin (rad), in (-pi, pi].
pub(crate) fn polar_angle([x, y]: Point) -> f64 {
    y.atan2(x)
}

/// Half of the contour integral of x dy - y dx along a straight segment.
fn segment(from: Point, to: Point) -> f64 {
    0.5 * cross(from, to)
}

/// The same integral along an arc about the origin with the signed opening angle `angle`.
fn sector(radius: f64, angle: f64) -> f64 {
    0.5 * radius * radius * angle
}

/// The same integral along an arc about `centre`.
fn arc(centre: Point, radius: f64, from: Point, to: Point, angle: f64) -> f64 {
    let chord = [to[0] - from[0], to[1] - from[1]];
    sector(radius, angle) + 0.5 * cross(centre, chord)
}

pub(crate) fn minus(p: Point, q: Point) -> Point {
    [p[0] - q[0], p[1] - q[1]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The unit vector from `p` to `q`.
pub(crate) fn unit(p: Point, q: Point) -> Point {
    let [x, y] = minus(q, p);
    [x / x.hypot(y), y / x.hypot(y)]
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use hinge::HingeConstants;
    use proptest::prelude::*;

    pub(crate) fn design(w_lig: f64, alpha_deg: f64) -> HingeDesign {
        HingeConstants::PAPER.hinge(w_lig, alpha_deg.to_radians())
    }

    proptest! {
        /// A thin kerf removes its width times its length; the hole removes its disc.
        #[test]
        fn area_is_that_of_the_half_disc_without_the_hole_and_the_kerf(
            w in 5.0..25.0f64, alpha in 25.0..150.0f64
        ) {
            let design = HingeDesign { kerf: 1e-4, ..design(w, alpha) };
            let window = Window(&design);
            let rho = design.fillet_radius();
            let [x, y] = window.kerf_at_radius(Side::A, 100.0);
            let slot = x.hypot(y + w) - rho;
            let expected = PI * (0.5 * 1e4 - rho * rho) - design.kerf * slot;
            prop_assert!((window.area() - expected).abs() < 1e-7 * expected);
        }

        #[test]
        fn kerf_faces_lie_on_their_circles_and_on_their_side(
            w in 5.0..25.0f64, alpha in 25.0..150.0f64, r in 30.0..100.0f64
        ) {
            let design = design(w, alpha);
            let window = Window(&design);
            for (side, sign) in [(Side::A, -1.0), (Side::B, 1.0)] {
                let p = window.kerf_at_radius(side, r);
                let q = window.kerf_at_hole(side);
                prop_assert!((p[0].hypot(p[1]) - r).abs() < 1e-10);
                prop_assert!((q[0].hypot(q[1] + w) - design.fillet_radius()).abs() < 1e-12);
                let across = dot([p[0], p[1] + w], window.normal());
                prop_assert!((across - sign * 0.1).abs() < 1e-10);
            }
        }
    }
}
