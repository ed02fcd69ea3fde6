//! Numbers of panels and hinges, clear of all cuts.
//!
//! No slit enters a panel: a text inside of it is clear of all slits. A hinge's number is inside one
//! of its two panels, as near to its hole as the cuts allow.

use crate::{
    cut_file::cut_lines::CutLines,
    display::{Text, rectangle},
};
use design::{
    geometry::polygon::{contains, distance_to_outline},
    sheet::cut_sheet::Sheet,
};
use std::iter::zip;
use support::Point;

/// Height of panel numbers relative to the root of the panel's area, and its maximum (mm).
const PANEL_HEIGHT: f64 = 0.1;
const MAX_HEIGHT: f64 = 40.0;
/// Places where the number of a panel is tried, from its middle, relative to that root.
const PLACES: [f64; 5] = [0.0, 0.2, -0.2, 0.35, -0.35];
/// Height of hinge numbers relative to the ligament width, and its minimum if there is room (mm).
const HINGE_HEIGHT: f64 = 0.5;
const MIN_HEIGHT: f64 = 2.5;
/// Clearance of a number from the cuts and from other numbers, relative to its height.
const CLEAR: f64 = 0.5;
/// Directions from a hole in which its number is tried, from the direction of the main cut (deg).
const DIRECTIONS_DEG: [f64; 7] = [60.0, 75.0, 45.0, 90.0, 105.0, 30.0, 130.0];
/// Distances from the edge of a hole at which its number is tried, relative to its height.
const DISTANCES: [f64; 8] = [1.2, 1.6, 2.0, 2.5, 3.0, 4.0, 5.5, 7.0];
/// A number that has no room is tried again at smaller heights.
const HEIGHTS: [f64; 6] = [1.0, 0.7, 0.5, 0.35, 0.25, 0.15];

/// The number `P<k>` of every panel in its middle and the number of every hinge next to its hole:
/// panels first, row by row.
pub(super) fn numbers(cuts: &CutLines, sheet: &Sheet) -> (Vec<Text>, Vec<Text>) {
    let mut panels: Vec<Taken> =
        (0..sheet.panels.len()).map(|k| Taken::new(cuts, sheet, k)).collect();
    let of_panels = zip(0.., &sheet.panels).map(|(k, panel)| {
        let ([x, y], side) = (panel.centroid, panel.area.sqrt());
        let height = f64::min(PANEL_HEIGHT * side, MAX_HEIGHT);
        let places = || PLACES.iter().flat_map(|u| PLACES.map(|v| [x + side * u, y + side * v]));
        let texts = HEIGHTS.iter().flat_map(|scale| {
            places().map(move |at| Text::centred(at, scale * height, format!("P{k}")))
        });
        widest(texts, |text| panels[k].clearance(text))
    });
    let of_panels: Vec<Text> = of_panels.collect();
    for (taken, text) in zip(&mut panels, &of_panels) {
        taken.texts.push(text.corners());
    }
    let of_hinges = zip(0.., &sheet.hinges).map(|(number, hinge)| {
        let sides = [hinge.panel_b(), hinge.panel_a()];
        let candidates = HEIGHTS.iter().flat_map(|scale| {
            let room = sides.map(|k| PANEL_HEIGHT * sheet.panels[k].area.sqrt());
            let height = f64::max(HINGE_HEIGHT * hinge.w_lig, MIN_HEIGHT).min(room[0].min(room[1]));
            let places = DISTANCES.iter().flat_map(move |d| {
                DIRECTIONS_DEG.iter().flat_map(move |deg| sides.map(|k| (*d, *deg, k)))
            });
            places.map(move |(d, deg, k)| (scale * height, d, deg, k))
        });
        let candidates = candidates.map(|(height, far, deg, k)| {
            let reach = cuts.holes[number].radius + far * height;
            let (sin, cos) = deg.to_radians().sin_cos();
            let [x, y] = hinge.main;
            // The normal of the main cut that points into the panel.
            let (tip, middle) = (hinge.tip, sheet.panels[k].centroid);
            let side = x * (middle[1] - tip[1]) - y * (middle[0] - tip[0]);
            let [u, v] = [-y, x].map(|n| n * side.signum());
            let at = [tip[0] + reach * (cos * x + sin * u), tip[1] + reach * (cos * y + sin * v)];
            (k, Text::centred(at, height, number.to_string()))
        });
        let (k, text) = widest(candidates, |(k, text)| panels[*k].clearance(text));
        panels[k].texts.push(text.corners());
        text
    });
    let of_hinges = of_hinges.collect();
    (of_panels, of_hinges)
}

/// What a number inside a panel has to keep clear of.
struct Taken {
    boundary: Vec<Point>,
    /// Half the width of the slits along the edges (mm).
    edge: f64,
    /// Centre and radius of the holes at and in the panel (mm).
    holes: Vec<(Point, f64)>,
    /// Lower left and upper right corners of the numbers in the panel (mm).
    texts: Vec<[Point; 2]>,
}

impl Taken {
    fn new(cuts: &CutLines, sheet: &Sheet, k: usize) -> Self {
        let hinges = zip(&sheet.hinges, &cuts.holes);
        let holes = hinges
            .filter(|(hinge, _)| hinge.panels().contains(&k))
            .map(|(_, hole)| (hole.centre, hole.radius));
        let attached = cuts.attachments.iter().filter(|attached| attached.panel == k);
        let attached = attached.filter_map(|it| Some((it.at, 0.5 * it.hole?)));
        Self {
            boundary: sheet.panels[k].boundary.clone(),
            edge: 0.5 * cuts.slit_width,
            holes: holes.chain(attached).collect(),
            texts: Vec::new(),
        }
    }

    /// Distance of a text from all that it has to keep clear of, at most [`CLEAR`] of its height;
    /// negative if it meets something.
    fn clearance(&self, text: &Text) -> f64 {
        let [low, high] = text.corners();
        let box_corners = rectangle([low, high]);
        let to_edges = box_corners.map(|corner| {
            let off = distance_to_outline(corner, &self.boundary);
            if contains(&self.boundary, corner) { off - self.edge } else { -off }
        });
        // Gap between two rectangles; a point is one without extent.
        let gap = |[from, to]: [Point; 2]| {
            let along = [0, 1].map(|axis| f64::max(low[axis] - to[axis], from[axis] - high[axis]));
            if along[0].max(along[1]) < 0.0 {
                along[0].max(along[1])
            } else {
                f64::hypot(along[0].max(0.0), along[1].max(0.0))
            }
        };
        let to_holes = self.holes.iter().map(|(centre, radius)| gap([*centre; 2]) - radius);
        let to_texts = self.texts.iter().map(|corners| gap(*corners));
        let to_notches = self.boundary.iter().map(|corner| gap([*corner; 2]) - self.edge);
        let all = to_edges.into_iter().chain(to_notches).chain(to_holes).chain(to_texts);
        all.fold(CLEAR * text.height, f64::min) / text.height
    }
}

/// The first of the candidates with the largest clearance relative to its height.
fn widest<T>(candidates: impl IntoIterator<Item = T>, clearance: impl Fn(&T) -> f64) -> T {
    let mut candidates = candidates.into_iter();
    let first = candidates.next().expect("there are places to try");
    let mut best = (clearance(&first), first);
    for candidate in candidates {
        if best.0 >= CLEAR {
            break;
        }
        let free = clearance(&candidate);
        if free > best.0 {
            best = (free, candidate);
        }
    }
    best.1
}
