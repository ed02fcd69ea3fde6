//! Whether a pattern and its widths are a sheet that can be cut and modelled: areas, overlaps, void
//! sides, room for the windows, cut angles.

use crate::grid::Grid;
use crate::kinematics::deployed_corners;
use crate::pattern::CutPattern;
use crate::polygon::{area, common};
use crate::sheet::{Panel, Sheet};
use serde::Serialize;

/// Measures of a flat sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validity {
    /// mm^2
    pub least_panel_area: f64,
    /// Sum of the panel areas less the outline's, over the outline's: the sheet has neither gap nor
    /// overlap where it vanishes with `overlap`.
    pub area_error: f64,
    /// Greatest area that two panels share, over the mean panel area.
    pub overlap: f64,
    /// Shortest side r L or (1 - r) L of a void (mm).
    pub least_void_side: f64,
    /// Least distance between two hinges of one panel (mm); windows need about 2 r_win.
    pub least_hinge_spacing: f64,
    /// mm
    pub r_win: f64,
    /// Least and greatest cut angle (deg).
    pub alpha_deg: [f64; 2],
}

impl Validity {
    pub fn new(pattern: &CutPattern, sheet: &Sheet) -> Self {
        let areas = sheet.panels.iter().map(Panel::area);
        let outline = sheet.outline.area();
        let alphas = sheet.hinges.iter().map(|hinge| hinge.alpha.to_degrees());
        let flat = vec![[0.0; 3]; sheet.panels.len()];
        Self {
            least_panel_area: areas.clone().fold(f64::INFINITY, f64::min),
            area_error: (areas.sum::<f64>() - outline) / outline,
            overlap: overlap(sheet, &flat),
            least_void_side: (pattern.void_sides().as_flattened().iter().copied())
                .fold(f64::INFINITY, f64::min),
            least_hinge_spacing: least_hinge_spacing(sheet),
            r_win: sheet.options.process.r_win,
            alpha_deg: [
                alphas.clone().fold(f64::INFINITY, f64::min),
                alphas.fold(f64::NEG_INFINITY, f64::max),
            ],
        }
    }
}

/// The greatest area that two neighbouring panels share in a configuration, over the mean panel
/// area. Panels that are no neighbours, not even across a corner, are not compared.
pub fn overlap(sheet: &Sheet, configuration: &[[f64; 3]]) -> f64 {
    let Grid { m, n } = sheet.grid;
    let corners = deployed_corners(sheet, configuration);
    let panels = (0..n).flat_map(|q| (0..m).map(move |p| (p, q)));
    let pairs = panels.flat_map(|(p, q)| {
        let east = (p + 1 < m).then(|| (p + 1, q));
        let north = (q + 1 < n).then(|| (p, q + 1));
        let north_east = (p + 1 < m && q + 1 < n).then(|| (p + 1, q + 1));
        let north_west = (p > 0 && q + 1 < n).then(|| (p - 1, q + 1));
        let others = [east, north, north_east, north_west].into_iter().flatten();
        others.map(move |other| ((p, q), other))
    });
    let shared = pairs.map(|((p, q), (s, t))| {
        let [one, other] = [(p, q), (s, t)].map(|(p, q)| &corners[sheet.grid.panel(p, q)]);
        area(&common(one, other))
    });
    let mean = sheet.panels.iter().map(Panel::area).sum::<f64>() / sheet.panels.len() as f64;
    shared.fold(0.0, f64::max) / mean
}

fn least_hinge_spacing(sheet: &Sheet) -> f64 {
    let mut of_panel = vec![Vec::new(); sheet.panels.len()];
    for hinge in &sheet.hinges {
        of_panel[hinge.panel_a()].push(hinge.corner);
        of_panel[hinge.panel_b()].push(hinge.corner);
    }
    let mut least = f64::INFINITY;
    for corners in of_panel {
        for (i, p) in corners.iter().enumerate() {
            for q in &corners[..i] {
                least = least.min(f64::hypot(q[0] - p[0], q[1] - p[1]));
            }
        }
    }
    least
}
