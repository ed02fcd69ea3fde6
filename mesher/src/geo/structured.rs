//! The structured mesh: transfinite, recombined patches, one patch per column.
//!
//! Block 1 is an O-grid from the hole to a half-disc a little larger, of radius 1.5 w_lig for most
//! holes. A small hole has a collar of rings in between. Block 2 continues from the arcs of block 1
//! to the window's arcs. Columns are numbered counter-clockwise about O, from the kerf face on B
//! over the free edge to the kerf face on A. One patch per side instead of one per column would
//! fold elements at small alpha.

use super::Script;
use crate::{Side, Structured, Window, minus, polar_angle};
use std::f64::consts::PI;
use support::Point;

/// Radius of block 1 over w_lig. It is only slightly larger than the hole, so that the rings of
/// block 2 begin where the panels still bend. With 2.2, an oblique hinge in compression is 8 % too
/// stiff.
const INNER_RADIUS: f64 = 1.5;
/// Block 1 reaches a diameter of the hole and this, over w_lig, beyond the tip: closer to a large
/// hole elements fold.
const ROOM: f64 = 0.17;
/// Radius over w_lig of the circle that block 1 begins at where the hole is smaller.
const COLLAR: f64 = 0.08;
/// Ratio of the radii of two circles of the collar, at most.
const COLLAR_GROWTH: f64 = 2.0;
/// The least growth of a collar, as a part of a doubling of the radius.
const THINNEST_RING: f64 = 0.5;
/// Weight of the true polar angle, relative to equal angles, in the spacing of columns at a hole up
/// to [`LARGE_HOLE`]. It grows to 1 at twice that: columns oblique to a large hole fold.
const ANGLE_BLEND: f64 = 0.5;
/// A large hole over w_lig.
const LARGE_HOLE: f64 = 0.2;

/// The boundary of a window that was added to a script.
pub(super) struct WindowCurves {
    /// The hole about the tip.
    pub hole: Vec<i32>,
    /// The arc on panel A.
    pub rim_a: Rim,
    /// The arc on panel B.
    pub rim_b: Rim,
}

/// An arc of a window, counter-clockwise about its origin.
#[derive(Clone)]
pub(super) struct Rim {
    /// Its points in the script, one more than arcs.
    pub points: Vec<i32>,
    /// Its curves in the script.
    pub arcs: Vec<i32>,
    /// Its ends in the hinge frame (mm).
    pub ends: [Point; 2],
}

/// Adds the patches of `window`.
pub(super) fn add(geo: &mut Script, window: &Window, recipe: &Structured) -> WindowCurves {
    let design = window.0;
    let [centre, tip] = [[0.0, 0.0], design.tip()].map(|point| geo.point(point));
    let outer = inner_half_disc(window, recipe);
    let columns = outer.len() - 1;
    let outer_ids = geo.points(&outer);
    let mut circle = |radius| {
        let points = circle_points(window, &outer, radius);
        let ids = geo.points(&points);
        let arcs = geo.arcs(tip, &ids);
        (points, ids, arcs)
    };
    let mut circles: Vec<_> = collar_radii(window).into_iter().map(&mut circle).collect();
    for pair in circles.windows(2) {
        let [(_, from, inner), (_, to, outer)] = pair else { continue };
        let rays = geo.rays(from, to, 1, |_| 1.0);
        geo.patches(&rays, outer, inner);
    }
    let (inner, inner_ids, inner_arcs) = &circles[circles.len() - 1];
    let top = recipe.arc_columns..columns - recipe.arc_columns;
    let edge = |c: usize| {
        let [from, to] = [outer_ids[c], outer_ids[c + 1]];
        let edge = if top.contains(&c) { geo.line(from, to) } else { geo.arc(from, centre, to) };
        geo.divide(edge, 1, 1.0)
    };
    let outer_edges: Vec<_> = (0..columns).map(edge).collect();
    let first = (design.w_lig - inner_circle(window)) / recipe.inner_rings as f64;
    let rays = geo.rays(inner_ids, &outer_ids, recipe.inner_rings, |c| {
        let [x, y] = minus(outer[c], inner[c]);
        growth_ratio(x.hypot(y) / first, recipe.inner_rings)
    });
    geo.patches(&rays, &outer_edges, inner_arcs);
    let growth = (design.r_win / (inner_radius(design.fillet_ratio) * design.w_lig))
        .powf(1.0 / recipe.outer_rings as f64);
    let mut rim = |side, start: usize| {
        let positions = window.panel_arc(side, design.r_win, recipe.arc_columns);
        let points = geo.points(&positions);
        let rays = geo.rays(&outer_ids[start..], &points, recipe.outer_rings, |_| growth);
        let arcs = geo.arcs(centre, &points);
        geo.patches(&rays, &arcs, &outer_edges[start..]);
        let ends = [positions[0], positions[recipe.arc_columns]];
        Rim { points, arcs, ends }
    };
    WindowCurves {
        rim_b: rim(Side::B, 0),
        rim_a: rim(Side::A, top.end),
        hole: circles.swap_remove(0).2,
    }
}

impl Script {
    fn points(&mut self, points: &[Point]) -> Vec<i32> {
        points.iter().map(|point| self.point(*point)).collect()
    }

    /// The arcs about `centre` between neighbours of `ends`, one element each.
    fn arcs(&mut self, centre: i32, ends: &[i32]) -> Vec<i32> {
        let arc = |pair: &[i32]| {
            let arc = self.arc(pair[0], centre, pair[1]);
            self.divide(arc, 1, 1.0)
        };
        ends.windows(2).map(arc).collect()
    }

    /// The lines from each point to its partner, divided with the growth of their number.
    fn rays(
        &mut self,
        from: &[i32],
        to: &[i32],
        elements: usize,
        growth: impl Fn(usize) -> f64,
    ) -> Vec<i32> {
        let ray = |(c, (from, to)): (usize, (&i32, &i32))| {
            let growth = growth(c);
            let ray = self.line(*from, *to);
            self.divide(ray, elements, growth)
        };
        std::iter::zip(from, to).enumerate().map(ray).collect()
    }

    /// The patches between neighbouring rays.
    fn patches(&mut self, rays: &[i32], outer: &[i32], inner: &[i32]) {
        for (c, pair) in rays.windows(2).enumerate() {
            self.patch([pair[0], outer[c], -pair[1], -inner[c]]);
        }
    }
}

/// Radius of block 1 over w_lig.
fn inner_radius(fillet_ratio: f64) -> f64 {
    INNER_RADIUS.max(1.0 + 2.0 * fillet_ratio + ROOM)
}

/// Radius of the circle about the tip that block 1 begins at (mm): the hole, or the rim of its
/// collar.
fn inner_circle(window: &Window) -> f64 {
    match collar_rings(window) {
        0 => window.0.fillet_radius(),
        _ => COLLAR * window.0.w_lig,
    }
}

/// Number of rings of the collar. A hole that is little smaller than the collar's rim has none: its
/// ring would be of slivers.
fn collar_rings(window: &Window) -> i32 {
    let doublings = (COLLAR / window.0.fillet_ratio).ln() / COLLAR_GROWTH.ln();
    if doublings < THINNEST_RING { 0 } else { doublings.ceil() as i32 }
}

/// Radii of the circles from the hole to the beginning of block 1 (mm), in constant ratio: the
/// hole's alone if it has no collar.
fn collar_radii(window: &Window) -> Vec<f64> {
    let (hole, last, rings) =
        (window.0.fillet_radius(), inner_circle(window), collar_rings(window));
    let growth = (last / hole).powf(1.0 / f64::from(rings.max(1)));
    (0..=rings).map(|ring| hole * growth.powi(ring)).collect()
}

/// Corners of the columns on the rim of block 1, counter-clockwise from the kerf face on B.
fn inner_half_disc(window: &Window, recipe: &Structured) -> Vec<Point> {
    let radius = inner_radius(window.0.fillet_ratio) * window.0.w_lig;
    let k = edge_grading(recipe, inner_radius(window.0.fillet_ratio));
    let edge = (1..recipe.edge_columns).map(|i| {
        let xi = 1.0 - 2.0 * i as f64 / recipe.edge_columns as f64;
        [radius * (k * xi).sinh() / k.sinh(), 0.0]
    });
    let mut rim = window.panel_arc(Side::B, radius, recipe.arc_columns);
    rim.extend(edge);
    rim.extend(window.panel_arc(Side::A, radius, recipe.arc_columns));
    rim
}

/// Corners of the columns on the circle of radius `rho` (mm) about the tip: a blend of the
/// directions of `outer` and equal angles.
fn circle_points(window: &Window, outer: &[Point], rho: f64) -> Vec<Point> {
    let (tip, mouth) = (window.0.tip(), window.mouth_half_angle(rho));
    let from = -window.0.alpha + mouth;
    let span = 2.0 * (PI - mouth);
    let directions: Vec<_> = outer
        .iter()
        // Rotated so that the mouth of the cut, where the angle jumps, is at +-pi.
        .map(|p| turned_angle([p[0] - tip[0], p[1] - tip[1]], PI - window.0.alpha))
        .collect();
    let blend = (ANGLE_BLEND * window.0.fillet_ratio / LARGE_HOLE).clamp(ANGLE_BLEND, 1.0);
    let last = outer.len() - 1;
    let range = directions[last] - directions[0];
    (0..=last)
        .map(|c| {
            let direction = (directions[c] - directions[0]) / range;
            let uniform = c as f64 / last as f64;
            let fraction = blend * direction + (1.0 - blend) * uniform;
            let angle = from + span * fraction;
            [tip[0] + rho * angle.cos(), tip[1] + rho * angle.sin()]
        })
        .collect()
}

/// Polar angle (rad) of `p` relative to an axis at the angle `axis`.
fn turned_angle(p: Point, axis: f64) -> f64 {
    let (sin, cos) = axis.sin_cos();
    polar_angle([p[0] * cos + p[1] * sin, p[1] * cos - p[0] * sin])
}

/// k of x = r sinh(k xi) / sinh(k) that makes the elements next to x = 0 `fold_size` w_lig wide.
fn edge_grading(recipe: &Structured, inner_radius: f64) -> f64 {
    let xi = 2.0 / recipe.edge_columns as f64;
    let target = recipe.fold_size / inner_radius;
    bisect(1e-6, 50.0, |k| target - (k * xi).sinh() / k.sinh())
}

/// q of 1 + q + ... + q^(n-1) = `total`, for `total` >= n.
fn growth_ratio(total: f64, n: usize) -> f64 {
    bisect(1.0, total.max(1.0), |q| (0..n).map(|i| q.powi(i as i32)).sum::<f64>() - total)
}

/// The root of an increasing function in [low, high], to machine precision; an end of the interval
/// if there is no root.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tier::{PlaneRecipe, Tier};
    use crate::window::tests::design;

    #[test]
    fn gradings_give_the_prescribed_first_element() {
        for tier in Tier::all() {
            let PlaneRecipe::Structured(recipe) = tier.recipe().plane else {
                continue;
            };
            let k = edge_grading(&recipe, INNER_RADIUS);
            let first = (2.0 * k / recipe.edge_columns as f64).sinh() / k.sinh();
            assert!((INNER_RADIUS * first - recipe.fold_size).abs() < 1e-12);
        }
        let q = growth_ratio(7.0, 3);
        assert!((q - 2.0).abs() < 1e-14);
        assert_eq!(growth_ratio(3.0, 3), 1.0);
    }

    #[test]
    fn columns_around_the_hole_do_not_cross() {
        for alpha in [25.0, 45.0, 90.0, 120.0, 150.0] {
            let design = design(25.0, alpha);
            let window = Window(&design);
            let recipe = Structured {
                inner_rings: 3,
                edge_columns: 14,
                arc_columns: 3,
                outer_rings: 4,
                fold_size: 0.1,
            };
            let outer = inner_half_disc(&window, &recipe);
            let hole = circle_points(&window, &outer, design.fillet_radius());
            let angle = |p: &[f64; 2]| turned_angle([p[0], p[1] + 25.0], PI - design.alpha);
            assert!(hole.windows(2).all(|p| angle(&p[0]) < angle(&p[1])));
            assert!(outer.windows(2).all(|p| angle(&p[0]) < angle(&p[1])));
            let mouth = window.kerf_at_hole(Side::B);
            assert!((hole[0][0] - mouth[0]).abs() + (hole[0][1] - mouth[1]).abs() < 1e-12);
        }
    }
}
