//! The sheet of a drawing from an even pattern: where the drawing lies on the opened pattern, and
//! the panels there.

use super::even_pattern::{GridIndex, centre, moved, neighbours, squares};
use super::raster::Raster;
use super::trimmed::{
    FlatPanels, Limits, ON_EDGE, RINGS, TrimmedEdge, counts, largest_joined, loops, missing, opened,
};
use design::geometry::plane::{complex, point};
use design::geometry::polygon::{bounds, distance_to_outline, distance_to_segment, size};
use design::geometry::region::{Corners, Region, Ring, as_seen};
use design::geometry::similarity::Similarity;
use design::pattern::grid::Grid;
use design::sheet::topology::Topology;
use faer::c64;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_2, PI};
use support::{Fault, ensure, refuse};

/// Places that are tried along a pitch, and turns that are tried in a quarter turn.
const SHIFTS: u32 = 4;
const TURNS: u32 = 6;
/// Places along two pitches of the axis of a symmetric drawing: rows next to each other are hinged
/// above and below.
const ALONG: u32 = 16;
/// The search of a sheet, and a short one, which says whether there is one.
pub(super) const THOROUGH: Search = Search { compared: 32, rounds: 4, limbs: false };
pub(super) const QUICK: Search = Search { compared: 3, rounds: 0, limbs: false };
/// Openings at which a panel may not meet another one, and few of them, by which places are
/// compared; number of the places that are compared by all.
const OPENINGS: u32 = 24;
const FEW_OPENINGS: u32 = 2;
const MADE: usize = 3;
/// How far the best place is moved both ways: along x and y (pitches), by a turn (rad), in size
/// (parts). Every round halves these steps.
const STEPS: [f64; 4] = [0.125, 0.125, 0.13, 0.005];
const ALL_STEPS: [usize; 4] = [0, 1, 2, 3];
/// The steps that keep a symmetric drawing on its axis, which is upright.
const ON_AXIS: [usize; 2] = [1, 3];
/// Distance of the points of a raster in sides of a square.
const RASTER: f64 = 0.05;
/// The same where points are counted.
const COARSE: f64 = 0.25;
/// Tolerance of the drawing in sides of a square.
const TOLERANCE: f64 = 4e-3;
/// Part of the area of a drawing that its mirror image must cover: it is symmetric.
const SYMMETRIC: f64 = 0.97;
/// Points along the longer side of a drawing, and angles, for its axis.
const SAMPLES: f64 = 256.0;
const ANGLES: u32 = 360;
/// How far a limb reaches into what is seen, in sides of a square: the gaps there, and a panel.
const LIMB: f64 = 2.0;
/// Distance of a corner on the opened pattern from the drawing up to which it is on it.
const NEAR: f64 = 0.01;
/// What a symmetric sheet may lose of the seen area.
const FOR_SYMMETRY: f64 = 0.02;

/// A sheet of an even pattern that opens onto a drawing. Lengths are in sides of a square.
#[derive(Clone, Debug)]
pub struct EvenSheet {
    /// What bounds its panels.
    pub limits: Limits,
    /// The map from the drawing to the opened pattern.
    pub place: Similarity,
    /// The drawing there.
    pub(super) drawing: Region,
    loops: BTreeSet<GridIndex>,
    panels: FlatPanels,
    /// Intersection over union of what one sees of the opened panels and the drawing.
    pub seen: f64,
}

/// How many places are compared, how often the best one is moved, and whether panels have limbs.
#[derive(Clone, Copy)]
pub(super) struct Search {
    pub(super) compared: usize,
    pub(super) rounds: i32,
    pub(super) limbs: bool,
}

impl EvenSheet {
    /// The best sheet of a drawing that a search finds. Flat, its longer side is as many
    /// squares long as one of `sizes`, the largest of which comes first. `None` if none fits into
    /// its stock, and if the drawing is narrower than two squares everywhere.
    pub(super) fn new(
        drawing: &Region,
        sizes: &[f64],
        limits: Limits,
        search: Search,
    ) -> Option<Self> {
        let [low, high] = drawing.bounds();
        let by_size = limits.opening.pitch() / drawing.longer_side();
        let scales = sizes.iter().map(|size| size * by_size);
        let drawing = drawing.simplified(TOLERANCE / (sizes[0] * by_size), |_| false);
        let middle = [0, 1].map(|c| 0.5 * (low[c] + high[c]));
        let symmetric = mirror_axis(&drawing).and_then(|(angle, centroid)| {
            let turn = FRAC_PI_2 - angle;
            let along = |scale| {
                let places = (0..ALONG).map(|v| [0.0, 2.0 * f64::from(v) / f64::from(ALONG)]);
                places.map(move |at| placed(centroid, scale, turn, at, &limits))
            };
            best(&drawing, limits, scales.clone().flat_map(along).collect(), search, &ON_AXIS)
        });
        let value = |sheet: &Option<Self>| sheet.as_ref().map_or(0.0, |sheet| sheet.seen);
        if value(&symmetric) + FOR_SYMMETRY >= 1.0 {
            return symmetric;
        }
        let turn = |k: u32| FRAC_PI_2 * f64::from(k) / f64::from(TURNS);
        let turned = scales.flat_map(|scale| (0..TURNS).map(move |k| (scale, turn(k))));
        let shift = |k: u32| f64::from(k) / f64::from(SHIFTS);
        let shifts = |(scale, turn)| {
            let all = (0..2 * SHIFTS).flat_map(|u| (0..SHIFTS).map(move |v| [u, v]));
            all.map(move |[u, v]| placed(middle, scale, turn, [shift(u), shift(v)], &limits))
        };
        let any = best(&drawing, limits, turned.flat_map(shifts).collect(), search, &ALL_STEPS);
        if value(&symmetric) + FOR_SYMMETRY >= value(&any) { symmetric } else { any }
    }

    /// The sheet of these loops at a place of a drawing, less the square at a point of it, or with
    /// a square there and those that it needs to hang on.
    pub(super) fn toggled(
        drawing: &Region,
        place: Similarity,
        limits: Limits,
        mut loops: BTreeSet<GridIndex>,
        at: [f64; 2],
    ) -> Result<Self, Fault> {
        let drawing = drawing.map(|at| moved(place, at)).simplified(TOLERANCE, |_| false);
        let [i, j] = limits.opening.square_at(moved(place, at));
        let around = [[i - 1, j - 1], [i, j - 1], [i - 1, j], [i, j]];
        let before = squares(&loops);
        if before.contains(&[i, j]) {
            loops.retain(|it| !around.contains(it));
        } else {
            let more = |it: &GridIndex| &squares(&BTreeSet::from([*it])) - &before;
            let inside = |at| drawing.contains(at);
            let in_drawing =
                |cell: &GridIndex| inside(moved(limits.opening.motion(*cell), centre(*cell)));
            let fits =
                |it: &&GridIndex| more(it).iter().all(in_drawing) || counts(**it, &limits, &inside);
            let fit = around.iter().filter(fits);
            let Some(fewest) = fit.clone().map(|it| more(it).len()).min() else {
                refuse!(
                    "a panel there, or those that it needs next to it, are outside of the target"
                );
            };
            let needed = fit.filter(|it| more(it).len() == fewest);
            loops.extend(needed.take(if fewest == 1 { 4 } else { 1 }));
        }
        ensure!(
            !loops.is_empty() && largest_joined(loops.clone()) == loops,
            "the sheet would be no mechanism of one piece: each panel is one of four around a gap, and gaps are joined by two panels"
        );
        let panels = FlatPanels::new();
        let sheet = Self { limits, place, drawing, loops, panels, seen: 0.0 };
        Ok(sheet.with_panels(OPENINGS, true))
    }

    /// How many points of the drawing are so near to the squares that panels may have them; `None`
    /// if the flat sheet does not fit into the stock with them.
    fn in_reach(&self, points: &[[f64; 2]]) -> Option<usize> {
        let mut owners: BTreeMap<GridIndex, GridIndex> =
            squares(&self.loops).into_iter().map(|it| (it, it)).collect();
        for _ in 0..RINGS {
            for (cell, owner) in owners.clone() {
                for next in neighbours(cell) {
                    owners.entry(next).or_insert(owner);
                }
            }
        }
        let opening = self.limits.opening;
        let flat = points.iter().filter_map(|at| {
            let there = moved(self.place, *at);
            let owner = owners.get(&opening.square_at(there))?;
            Some(point(opening.motion(*owner).back(complex(there))))
        });
        let flat: Ring = flat.collect();
        self.fits(&flat).then_some(flat.len())
    }

    /// The same with panels, and, with `limbs`, where the drawing is too narrow for squares, rigid parts
    /// of any length if they fit into the stock.
    fn with_panels(mut self, openings: u32, limbs: bool) -> Self {
        let edge = TrimmedEdge::new(&self.drawing, &self.loops, &self.limits);
        self.panels = edge.panels(openings);
        let mut seen = as_seen(self.opened(1.0), &self.drawing);
        for limb in limbs.then(|| missing(&self.drawing, &seen)).into_iter().flatten() {
            let limb = limb.offset(LIMB, Corners::Round).common(&self.drawing);
            let Some(panels) = edge.with_limb(&self.panels, &limb, openings) else { continue };
            let without = std::mem::replace(&mut self.panels, panels);
            if self.fits(&self.opened(0.0).concat()) {
                seen = as_seen(self.opened(1.0), &self.drawing);
            } else {
                self.panels = without;
            }
        }
        self.seen = seen.likeness(&self.drawing);
        self
    }

    /// Its place after a part of one of the [`STEPS`].
    fn stepped(&self, step: usize, part: f64) -> Similarity {
        let mut by = [0.0; STEPS.len()];
        by[step] = part * STEPS[step];
        let [x, y, turn, growth] = by;
        let turn = (1.0 + growth) * c64::cis(turn);
        let [low, high] = self.drawing.bounds().map(complex);
        let middle = 0.5 * (low + high);
        let shift = self.limits.opening.pitch() * complex([x, y]);
        Similarity {
            turn: turn * self.place.turn,
            shift: middle + turn * (self.place.shift - middle) + shift,
        }
    }

    /// Whether a flat sheet with these points fits into the stock.
    fn fits(&self, flat: &[[f64; 2]]) -> bool {
        let upright = c64::cis(-self.place.rotation());
        let turned = flat.iter().map(|at| point(upright * complex(*at)));
        growth(size(bounds(turned)), self.limits.stock) >= 1.0
    }

    /// How many squares the longer side of a drawing is long when flat.
    pub(super) fn size(&self, drawing: &Region) -> f64 {
        self.place.scale() * drawing.longer_side() / self.limits.opening.pitch()
    }

    /// The contours of the panels at a part of the opening.
    pub fn opened(&self, part: f64) -> Vec<Ring> {
        opened(&self.panels, self.limits.opening.part(part))
    }

    /// Columns and rows of the pattern, and the first cell of it: the kept squares and what is
    /// between them.
    pub(super) fn cells(&self) -> (Grid, GridIndex) {
        let squares = squares(&self.loops);
        let least = |c: usize| squares.iter().map(|cell| cell[c]).min().unwrap_or_default();
        let most = |c: usize| squares.iter().map(|cell| cell[c]).max().unwrap_or_default();
        let mut first = [least(0), least(1)];
        // Even squares stay even.
        first[0] -= (first[0] + first[1]).rem_euclid(2);
        let count = |c: usize| (most(c) - first[c] + 1) as usize;
        (Grid { m: count(0), n: count(1) }, first)
    }

    /// Its panels and hinges.
    pub fn topology(&self) -> Topology {
        let (grid, first) = self.cells();
        let kept = |[i, j]: [usize; 2]| {
            self.loops.contains(&[i as i32 - 1 + first[0], j as i32 - 1 + first[1]])
        };
        let interior = (1..grid.n).flat_map(|j| (1..grid.m).map(move |i| [i, j]));
        let voids: Vec<bool> = interior.map(kept).collect();
        let mut topology = Topology::of_voids(grid, &voids);
        for (panel, place) in topology.places.iter().enumerate() {
            let cell = [0, 1].map(|c| place[c] as i32 + first[c]);
            let corner = cell.map(f64::from);
            let in_cell = |at: &[f64; 2]| [0, 1].map(|c| snapped(at[c] - corner[c]));
            let boundary =
                distinct(self.panels[&cell].polygons[0][0].iter().map(in_cell).collect());
            let on_drawing = |at: &[f64; 2]| {
                let at = [0, 1].map(|c| at[c] + corner[c]);
                let there = moved(self.limits.opening.motion(cell), at);
                let mut pieces = self.drawing.polygons.iter();
                pieces.any(|contours| distance_to_outline(there, &contours[0]) < NEAR)
            };
            if boundary.len() != 4 || boundary.iter().flatten().any(|x| *x != 0.0 && *x != 1.0) {
                let outer = (0..boundary.len()).filter(|i| on_drawing(&boundary[*i]));
                topology.outer.extend(outer.map(|corner| (panel, corner)));
                topology.trims[panel] = Some(boundary.into());
            }
        }
        topology
    }
}

/// Without corners next to each other or on a straight edge, but with all of the cell.
fn distinct(mut boundary: Ring) -> Ring {
    let is_idle = |boundary: &Ring, i: usize| {
        let n = boundary.len();
        let [before, at, after] = [i + n - 1, i, i + 1].map(|k| boundary[k % n]);
        let is_of_cell = at.iter().all(|x| *x == 0.0 || *x == 1.0);
        let is_straight = distance_to_segment(at, before, after) < ON_EDGE;
        at == after || !is_of_cell && is_straight
    };
    while let Some(i) = (0..boundary.len()).find(|i| is_idle(&boundary, *i)) {
        boundary.remove(i);
    }
    boundary
}

/// A coordinate in a cell; 0, without a sign, and 1 are on its edges.
fn snapped(x: f64) -> f64 {
    if (x - x.round()).abs() < ON_EDGE { x.round() + 0.0 } else { x }
}

/// A drawing turned about a point, which lies at a place in pitches.
fn placed(about: [f64; 2], scale: f64, turn: f64, at: [f64; 2], limits: &Limits) -> Similarity {
    let turn = scale * c64::cis(turn);
    Similarity { turn, shift: limits.opening.pitch() * complex(at) - turn * complex(about) }
}

/// The factor by which a sheet of some width and height may grow in a stock that lies or stands.
pub(super) fn growth([width, height]: [f64; 2], [one, other]: [f64; 2]) -> f64 {
    let in_stock = |x: f64, y: f64| f64::min(x / width, y / height);
    f64::max(in_stock(one, other), in_stock(other, one))
}

/// The best sheet of the places whose squares reach the most of a drawing, and of those around it
/// by some of the [`STEPS`].
fn best(
    drawing: &Region,
    limits: Limits,
    places: Vec<Similarity>,
    search: Search,
    steps: &[usize],
) -> Option<EvenSheet> {
    let [raster, coarse] =
        [RASTER, COARSE].map(|step| Raster::new(drawing, step / places[0].scale()));
    let points: Vec<_> = coarse.points().collect();
    let at = |place| {
        let drawing = drawing.map(|at| moved(place, at));
        let inside = |at| raster.contains(point(place.back(complex(at))));
        let loops = loops(drawing.bounds(), &limits, &inside);
        let panels = FlatPanels::new();
        let sheet = EvenSheet { limits, place, drawing, loops, panels, seen: 0.0 };
        Some((sheet.in_reach(&points)?, sheet))
    };
    let in_reach = |places: Vec<Similarity>| {
        let mut found: Vec<_> = places.into_par_iter().filter_map(at).collect();
        found.sort_by_key(|(in_reach, _)| Reverse(*in_reach));
        found.into_iter().map(|(_, sheet)| sheet).take(search.compared).collect()
    };
    let made = |places: Vec<EvenSheet>, openings| {
        let made = places.into_par_iter().map(|sheet| sheet.with_panels(openings, search.limbs));
        made.filter(|sheet| sheet.fits(&sheet.opened(0.0).concat())).collect()
    };
    let sort = |sheets: &mut Vec<EvenSheet>| {
        sheets.sort_by(|one, other| other.seen.total_cmp(&one.seen));
    };
    let mut sheets: Vec<EvenSheet> = made(in_reach(places), FEW_OPENINGS);
    for round in 0..search.rounds {
        sort(&mut sheets);
        let best = sheets.first()?;
        let part = 0.5f64.powi(round);
        let both_ways = steps.iter().flat_map(|step| [(*step, -part), (*step, part)]);
        let near = both_ways.map(|(step, part)| best.stepped(step, part)).collect();
        sheets.extend(made(in_reach(near), FEW_OPENINGS));
    }
    sort(&mut sheets);
    sheets.truncate(MADE);
    let mut sheets = made(sheets, OPENINGS);
    sort(&mut sheets);
    sheets.into_iter().next()
}

/// The mirror axis of a drawing: its angle from the x axis (rad) and the centroid, through which it
/// goes. Of several the one that is nearest to upright.
fn mirror_axis(drawing: &Region) -> Option<(f64, [f64; 2])> {
    /// Parts of the drawing that axes of equal right may differ by.
    const EQUAL: f64 = 0.004;
    let raster = Raster::new(drawing, drawing.longer_side() / SAMPLES);
    let points: Vec<c64> = raster.points().map(complex).collect();
    let centroid = points.iter().sum::<c64>() / points.len() as f64;
    let covered = |angle: f64| {
        let turn = c64::cis(2.0 * angle);
        let mirrored = points.iter().map(|z| centroid + turn * (z - centroid).conj());
        let inside = mirrored.filter(|z| raster.contains(point(*z)));
        (inside.count() as f64 / points.len() as f64, angle)
    };
    let angles = (0..ANGLES).into_par_iter().map(|k| PI * f64::from(k) / f64::from(ANGLES));
    let axes: Vec<(f64, f64)> = angles.map(covered).collect();
    let most = axes.iter().map(|(part, _)| *part).fold(SYMMETRIC, f64::max);
    let off_upright = |axis: &(f64, f64)| (axis.1 - FRAC_PI_2).abs();
    let equal = axes.into_iter().filter(|(part, _)| *part >= most - EQUAL && *part >= SYMMETRIC);
    let nearest = equal.min_by(|one, other| off_upright(one).total_cmp(&off_upright(other)))?;
    Some((nearest.1, point(centroid)))
}

#[cfg(test)]
mod tests;
