//! The panels of a drawing: squares of the even pattern, laid over the drawing while open, with
//! rigid parts added where squares are missing at its edge, trimmed to it.
//!
//! A hinge counts if its window is in the drawing. Kept are the loops of four squares whose hinges
//! count, and of them the largest set joined by pairs: a mechanism with one degree of freedom.
//! Lengths are in sides of a square.

use super::even_pattern::{
    GridIndex, HingedSquares, Opening, centre, corners, hinge, moved, neighbours, pair, pairs,
    squares,
};
use design::geometry::plane::{complex, point};
use design::geometry::polygon::{distance, distance_to_outline, distance_to_polygon};
use design::geometry::region::{Corners, Region, Ring};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Rows of missing squares that become parts of panels.
pub(super) const RINGS: usize = 2;
/// How far the part of the drawing that counts for a square is from its edges.
pub(super) const REACH: f64 = RINGS as f64 + 0.5;
/// The smallest area of the drawing for which a missing square becomes a part.
const LEAST_PART: f64 = 0.02;
/// By how much the edges of a panel are simplified.
pub(super) const TOLERANCE: f64 = 6e-3;
/// Half the width of a gap between parts of a panel that is a rounding error.
const HAIR: f64 = 1e-3;
/// Width of the differences between drawing and sheet that a viewer does not miss, in sides of a
/// panel, and the part of the area of the drawing that is missed.
const SLIVER: f64 = 0.25;
const MISSED: f64 = 0.01;
/// Area of a gap between opened panels at most, in squares.
const VOID: f64 = 1.5;
/// Area of a hole that is a rounding error.
const FILLED: f64 = 1e-4;
/// Distance from an edge of a square up to which a point is on it: offsets leave corners off it by up
/// to 2e-6.
pub(super) const ON_EDGE: f64 = 1e-5;
/// How far a window is outside the drawing at most: the border of a drawing may be an edge of squares.
const ON_BORDER: f64 = 0.03;
/// Points on the arc of a window in a square.
const ARC: u32 = 4;

/// What bounds the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Width and height of the stock.
    pub stock: [f64; 2],
    /// The opening of every hinge.
    pub opening: Opening,
    /// How far a window reaches from its corner.
    pub window: f64,
    /// Smallest width of a part of a panel.
    pub width: f64,
    /// Smallest distance of two panels that do not hang together, on the way.
    pub gap: f64,
    /// Width of a slit, which is between squares side by side that do not hang together.
    pub slit: f64,
}

/// The flat panels of squares.
pub(super) type FlatPanels = BTreeMap<GridIndex, Region>;

/// The largest set of loops, joined by pairs of squares, whose windows are in an opened drawing.
pub(super) fn loops(
    bounds: [[f64; 2]; 2],
    limits: &Limits,
    inside: &impl Fn([f64; 2]) -> bool,
) -> BTreeSet<GridIndex> {
    let [from, to] = bounds.map(|corner| limits.opening.square_at(corner));
    let all = (from[1] - 1..=to[1]).flat_map(|j| (from[0] - 1..=to[0]).map(move |i| [i, j]));
    largest_joined(all.filter(|at| counts(*at, limits, inside)).collect())
}

/// Whether the hinges of a loop count.
pub(super) fn counts(at: GridIndex, limits: &Limits, inside: &impl Fn([f64; 2]) -> bool) -> bool {
    let is_inside =
        |pair: HingedSquares, cell| window(cell, hinge(pair), limits).into_iter().all(inside);
    pairs(at).into_iter().all(|pair| pair.into_iter().all(|cell| is_inside(pair, cell)))
}

/// The largest set of some loops that is joined by pairs of squares.
pub(super) fn largest_joined(mut left: BTreeSet<GridIndex>) -> BTreeSet<GridIndex> {
    let mut largest = BTreeSet::new();
    while let Some(first) = left.pop_first() {
        let (mut joined, mut next) = (BTreeSet::from([first]), vec![first]);
        while let Some(at) = next.pop() {
            let found: Vec<GridIndex> =
                neighbours(at).into_iter().filter(|c| left.remove(c)).collect();
            joined.extend(&found);
            next.extend(found);
        }
        if joined.len() > largest.len() {
            largest = joined;
        }
    }
    largest
}

/// Points around the part of a window in one of its squares when the pattern is open, a little
/// inside.
fn window(cell: GridIndex, corner: GridIndex, limits: &Limits) -> Vec<[f64; 2]> {
    let (motion, centre) = (limits.opening.motion(cell), centre(cell));
    let inner = |at: [f64; 2]| [0, 1].map(|c| at[c] + ON_BORDER * (centre[c] - at[c]).signum());
    sector(cell, corner, limits).into_iter().map(|at| moved(motion, inner(at))).collect()
}

/// The part of a window in one of its squares.
fn sector(cell: GridIndex, corner: GridIndex, limits: &Limits) -> Ring {
    let (corner, centre) = (corner.map(f64::from), centre(cell));
    let side = [0, 1].map(|c| limits.window * (centre[c] - corner[c]).signum());
    let arc = (0..=ARC).map(|k| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(k) / f64::from(ARC)).sin_cos();
        [corner[0] + side[0] * cos, corner[1] + side[1] * sin]
    });
    arc.chain([corner]).collect()
}

/// A square.
fn whole(cell: GridIndex) -> Region {
    Region::union_of(vec![corners(cell)])
}

/// Whether a point is on an edge of a square.
fn is_on_edge(cell: GridIndex, at: [f64; 2]) -> bool {
    (0..2).any(|c| {
        let along = at[c] - f64::from(cell[c]);
        (along - along.round()).abs() < ON_EDGE && (0.0..=1.0).contains(&along.round())
    })
}

/// The polygon of a region that has the most of another.
fn with_most_of(region: Region, other: &Region) -> Region {
    let single = |polygon| Region { polygons: vec![polygon] };
    let shared = |region: &Region| region.common(other).area();
    let polygons = region.polygons.into_iter().map(single);
    let most = polygons.max_by(|one, two| shared(one).total_cmp(&shared(two)));
    most.unwrap_or_default()
}

/// The squares of a drawing and what its edge needs.
pub(super) struct TrimmedEdge<'a> {
    limits: &'a Limits,
    squares: BTreeSet<GridIndex>,
    hinges: BTreeSet<HingedSquares>,
    /// The drawing around each square that is not inside, as the square sees it when the pattern is
    /// open.
    drawing: BTreeMap<GridIndex, Region>,
}

impl<'a> TrimmedEdge<'a> {
    /// The squares of `loops` in an opened drawing.
    pub(super) fn new(drawing: &Region, loops: &BTreeSet<GridIndex>, limits: &'a Limits) -> Self {
        let hinges = loops.iter().flat_map(|at| pairs(*at)).collect();
        let edge = Self { limits, squares: squares(loops), hinges, drawing: BTreeMap::new() };
        let seen = |cell: &GridIndex| {
            let motion = limits.opening.motion(*cell);
            let at = moved(motion, centre(*cell));
            let is_inside = edge.hinges_of(*cell).count() == 4
                && drawing.contours().all(|edge| distance_to_outline(at, edge) > FRAC_1_SQRT_2);
            let around = || {
                let there = drawing.map(|at| point(motion.back(complex(at))));
                let out = |at: [f64; 2]| {
                    [0, 1].map(|c| at[c] + REACH * (2.0 * at[c] - 2.0 * centre(*cell)[c]))
                };
                there.common(&Region::union_of(vec![corners(*cell).into_iter().map(out).collect()]))
            };
            (!is_inside).then(|| (*cell, around()))
        };
        Self { drawing: edge.squares.iter().filter_map(seen).collect(), ..edge }
    }

    /// The flat panels of the squares, trimmed to the drawing, so that none meets another one at any
    /// of some openings.
    pub(super) fn panels(&self, openings: u32) -> FlatPanels {
        let parts = self.parts();
        // Small parts first: they leave the large ones less, and parts of one size, as a mirror
        // exchanges them, leave each other what both want.
        let size = |cell: &GridIndex| (1e3 * parts[cell].area()).round() as i64;
        let mut order: Vec<GridIndex> = self.squares.iter().copied().collect();
        order.sort_by_key(size);
        let mut done: FlatPanels = order.iter().map(|cell| (*cell, whole(*cell))).collect();
        for cell in order.into_iter().filter(|cell| self.drawing.contains_key(cell)) {
            let part = &parts[&cell];
            let of_other = |other: GridIndex| {
                if size(&other) == size(&cell) {
                    whole(other).union(&parts[&other])
                } else {
                    done[&other].clone()
                }
            };
            let panel = self.with_part(cell, &self.square(cell), part, openings, of_other);
            done.insert(cell, panel);
        }
        done
    }

    /// The panels with a limb, a part of the opened drawing, at the panel that has the most of it;
    /// `None` if none has most.
    pub(super) fn with_limb(
        &self,
        panels: &FlatPanels,
        limb: &Region,
        openings: u32,
    ) -> Option<FlatPanels> {
        let seen_by = |cell: &GridIndex| {
            let motion = self.limits.opening.motion(*cell);
            limb.map(|at| point(motion.back(complex(at))))
        };
        let at_edge = self.drawing.keys().copied();
        let touches = |cell: &GridIndex| seen_by(cell).common(&panels[cell]).area() > 0.0;
        let roots: Vec<GridIndex> = at_edge.filter(touches).collect();
        let mut bare = panels.clone();
        bare.extend(roots.iter().map(|cell| (*cell, self.square(*cell))));
        let limbs = roots.iter().map(|cell| {
            let limb = panels[cell].union(&seen_by(cell));
            (*cell, self.with_part(*cell, &bare[cell], &limb, openings, |it| bare[&it].clone()))
        });
        let more = |(cell, larger): &(GridIndex, Region)| larger.area() - bare[cell].area();
        let limbs = limbs.filter(|it| more(it) > 0.5 * limb.area());
        let (of, larger) = limbs.max_by(|one, other| more(one).total_cmp(&more(other)))?;
        bare.insert(of, larger);
        for cell in roots.into_iter().filter(|cell| *cell != of) {
            let of_other = |it| bare[&it].clone();
            let panel = self.with_part(cell, &bare[&cell], &panels[&cell], openings, of_other);
            bare.insert(cell, panel);
        }
        Some(bare)
    }

    /// A panel with a part as well, less what other panels pass through, if it needs no hole.
    fn with_part(
        &self,
        cell: GridIndex,
        panel: &Region,
        part: &Region,
        openings: u32,
        of_other: impl Fn(GridIndex) -> Region,
    ) -> Region {
        let taken =
            self.passed(cell, part, openings, of_other).offset(self.limits.gap, Corners::Round);
        let whole = panel.union(&part.minus(&taken));
        let wide = panel.union(&whole.opened(0.5 * self.limits.width).common(&whole));
        let larger = with_most_of(wide, panel).joined(HAIR);
        // A hole that another panel passes through cannot be filled.
        let is_passed = larger.filled().minus(&larger).common(&taken).area() > FILLED;
        let larger = if is_passed { panel.joined(HAIR) } else { larger }.filled();
        // Cuts run along the edges of the squares.
        let larger = larger.simplified(TOLERANCE, |at| is_on_edge(cell, at));
        with_most_of(larger, panel)
    }

    /// The hinges of a square.
    fn hinges_of(&self, cell: GridIndex) -> impl Iterator<Item = &HingedSquares> {
        let pairs = neighbours(cell).map(|other| pair(cell, other));
        pairs.into_iter().filter_map(|pair| self.hinges.get(&pair))
    }

    /// A square in the drawing, with the windows of its hinges, apart from neighbours with which it does not hang together.
    fn square(&self, cell: GridIndex) -> Region {
        let is_apart = |other: &GridIndex| {
            self.squares.contains(other) && !self.hinges.contains(&pair(cell, *other))
        };
        let strip = |other: GridIndex| {
            // Corners that are rounded in the scene come no nearer to the tip of a cut.
            let half = 0.495 * self.limits.slit;
            let [x, y] = corners(other)[0];
            vec![
                [x - half, y - half],
                [x + 1.0 + half, y - half],
                [x + 1.0 + half, y + 1.0 + half],
                [x - half, y + 1.0 + half],
            ]
        };
        let strips = neighbours(cell).into_iter().filter(is_apart).map(strip).collect();
        let square = whole(cell).minus(&Region::union_of(strips));
        let hinges = self.hinges_of(cell);
        let sectors = hinges.map(|pair| sector(cell, hinge(*pair), self.limits)).collect();
        let windows = Region::even_odd(sectors).common(&square);
        square.common(&self.drawing[&cell]).union(&windows)
    }

    /// The parts of every panel: missing squares, row by row, in the neighbour that has the most of
    /// the drawing there.
    fn parts(&self) -> BTreeMap<GridIndex, Region> {
        let mut owner: BTreeMap<GridIndex, GridIndex> =
            self.squares.iter().map(|c| (*c, *c)).collect();
        for _ in 0..RINGS {
            let around: BTreeSet<GridIndex> =
                owner.keys().flat_map(|cell| neighbours(*cell)).collect();
            let missing = around.into_iter().filter(|cell| !owner.contains_key(cell));
            let found: Vec<(GridIndex, GridIndex)> = missing
                .filter_map(|cell| {
                    let square = whole(cell);
                    let owners = neighbours(cell).into_iter().filter_map(|n| owner.get(&n));
                    let fits = owners.filter(|of| !self.is_beyond_hinge(**of, cell));
                    let area = |of: &GridIndex| self.drawing[of].common(&square).area();
                    let best = fits.map(|of| (area(of), *of));
                    let (area, of) = best.max_by(|one, two| one.0.total_cmp(&two.0))?;
                    (area > LEAST_PART).then_some((cell, of))
                })
                .collect();
            owner.extend(found);
        }
        let part = |cell: &GridIndex| {
            let own = owner.iter().filter(|(at, of)| *of == cell && *at != cell);
            let squares = own.map(|(at, _)| corners(*at)).collect();
            let drawing = self.drawing.get(cell);
            let common = drawing.map(|it| Region::union_of(squares).common(it));
            (*cell, common.unwrap_or_default())
        };
        self.squares.iter().map(part).collect()
    }

    /// Whether a missing square is on the far side of a hinge of a panel from its partner: it would
    /// close the cut along the window.
    fn is_beyond_hinge(&self, panel: GridIndex, missing: GridIndex) -> bool {
        self.hinges_of(panel).any(|pair| {
            let partner = if pair[0] == panel { pair[1] } else { pair[0] };
            let across = usize::from(pair[1][0] > pair[0][0]);
            let mut far = partner;
            let above = f64::from(hinge(*pair)[across]) > centre(partner)[across];
            far[across] += if above { 1 } else { -1 };
            far == missing
        })
    }

    /// What other panels pass through as a panel sees it, and the cuts along the windows of its
    /// hinges.
    fn passed(
        &self,
        cell: GridIndex,
        part: &Region,
        openings: u32,
        of_other: impl Fn(GridIndex) -> Region,
    ) -> Region {
        let mut passed: Vec<Ring> =
            self.hinges_of(cell).map(|pair| self.slit(cell, pair)).collect();
        let here = centre(cell);
        let widest = part.contours().flatten().map(|at| distance(here, *at)).fold(0.0, f64::max);
        for other in self.squares.iter().filter(|other| **other != cell) {
            let panel = of_other(*other);
            let [from, to] = panel.bounds();
            let middle = [0, 1].map(|c| 0.5 * (from[c] + to[c]));
            let reach = distance(middle, to) + self.limits.gap;
            // The centres move apart when the pattern opens.
            let there = centre(*other);
            if distance(here, there) - distance(there, middle) > widest + reach {
                continue;
            }
            for step in 0..=openings {
                let opening = self.limits.opening.part(f64::from(step) / f64::from(openings));
                let motion = opening.relative_motion(*other, cell);
                let there = moved(motion, middle);
                if part.contours().any(|edge| distance_to_polygon(there, edge) < reach) {
                    let outlines = panel.polygons.iter().map(|contours| contours[0].iter());
                    passed.extend(outlines.map(|it| it.map(|at| moved(motion, *at)).collect()));
                }
            }
        }
        Region::union_of(passed)
    }

    /// The cut along the flat side of a window, on the side without material.
    fn slit(&self, cell: GridIndex, pair: &HingedSquares) -> Ring {
        let along = usize::from(pair[1][0] == pair[0][0]);
        let (at, out) = (hinge(*pair).map(f64::from), 1 - along);
        let beyond = if at[out] > centre(cell)[out] { self.limits.gap } else { -self.limits.gap };
        let (mut from, mut to) = (at, at);
        from[along] -= self.limits.window;
        to[along] += self.limits.window;
        from[out] = at[out].min(at[out] + beyond);
        to[out] = at[out].max(at[out] + beyond);
        vec![from, [to[0], from[1]], to, [from[0], to[1]]]
    }
}

/// The parts of an opened drawing that are missed where a part of it is seen.
pub(super) fn missing(drawing: &Region, seen: &Region) -> Vec<Region> {
    let missing = drawing.minus(seen).opened(0.5 * SLIVER);
    let missed = f64::max(MISSED * drawing.area(), VOID);
    let parts = missing.polygons.into_iter().map(|part| Region { polygons: vec![part] });
    parts.filter(|part| part.area() > missed).collect()
}

/// The contours of opened panels.
pub(super) fn opened(panels: &FlatPanels, opening: Opening) -> Vec<Ring> {
    let moved = |(cell, panel): (&GridIndex, &Region)| {
        let motion = opening.motion(*cell);
        panel.map(|at| moved(motion, at)).polygons.into_iter().flatten()
    };
    panels.iter().flat_map(moved).collect()
}
