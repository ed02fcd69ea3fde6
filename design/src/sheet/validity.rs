//! Whether a pattern and its ligament widths can be cut and modelled: areas, overlaps, void
//! sides, space for the windows, cut angles.

use crate::{
    geometry::{
        polygon::{area, common, distance},
        region::{Contour, Region},
    },
    pattern::cut_pattern::CutPattern,
    sheet::{cut_sheet::Sheet, kinematics::deployed_boundaries},
};
use hinge::{HingeDesign, TrainingDomain};
use serde::Serialize;

/// Measures of a flat sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validity {
    /// mm^2
    pub least_panel_area: f64,
    /// Sum of the panel areas minus the outline's area, relative to the latter: the sheet has
    /// neither gap nor overlap if both this and `overlap` vanish.
    pub area_error: f64,
    /// Maximum common area of two panels, relative to the mean panel area.
    pub overlap: f64,
    /// Shortest side r L or (1 - r) L of any void (mm).
    pub least_void_side: f64,
    /// Minimum distance between two hinges of one panel (mm).
    pub least_hinge_spacing: f64,
    /// mm
    pub r_win: f64,
    /// Number of hinges closer than 2 r_win, the space of two windows, to another hinge of their
    /// panels.
    pub crowded_hinges: usize,
    /// Minimum and maximum cut angle (deg).
    pub alpha_deg: [f64; 2],
    /// Range of cut angles that the hinge law was trained on (deg); `None` for a law without
    /// training.
    pub trained_alpha_deg: Option<[f64; 2]>,
    /// Number of hinges whose cut angle or ligament width is outside the training range of the law.
    pub untrained_hinges: usize,
}

impl Validity {
    /// `domain` is the training domain of the hinge law, if it has one.
    pub fn new(pattern: &CutPattern, sheet: &Sheet, domain: Option<&TrainingDomain>) -> Self {
        let areas = sheet.panels.iter().map(|panel| panel.area);
        let outline: f64 = sheet.outlines().iter().map(|outline| area(outline)).sum();
        let alphas = sheet.hinges.iter().map(|hinge| hinge.alpha.to_degrees());
        let spacings = hinge_spacings(sheet);
        let r_win = sheet.options.process.r_win;
        let untrained = |domain: &TrainingDomain| {
            let trained = |design: &&HingeDesign| domain.has_ligament(design);
            sheet.designs().iter().filter(|design| !trained(design)).count()
        };
        let flat = vec![[0.0; 3]; sheet.panels.len()];
        Self {
            least_panel_area: areas.clone().fold(f64::INFINITY, f64::min),
            area_error: (areas.sum::<f64>() - outline) / outline,
            overlap: overlap(sheet, &flat),
            least_void_side: (pattern.void_sides().as_flattened().iter().copied())
                .fold(f64::INFINITY, f64::min),
            crowded_hinges: spacings.iter().filter(|s| **s < 2.0 * r_win).count(),
            least_hinge_spacing: spacings.into_iter().fold(f64::INFINITY, f64::min),
            r_win,
            alpha_deg: [
                alphas.clone().fold(f64::INFINITY, f64::min),
                alphas.fold(f64::NEG_INFINITY, f64::max),
            ],
            trained_alpha_deg: domain.map(|domain| domain.alpha.map(f64::to_degrees)),
            untrained_hinges: domain.map_or(0, untrained),
        }
    }
}

/// [`overlap`] from which panels lie over each other: more than a slit and rounding leave.
pub const OVERLAP: f64 = 0.01;

/// The maximum common area of two panels in a configuration, relative to the mean panel area. Of a
/// sheet of all cells, panels that do not even share a corner are not compared.
pub fn overlap(sheet: &Sheet, configuration: &[[f64; 3]]) -> f64 {
    let mean = sheet.panels.iter().map(|panel| panel.area).sum::<f64>() / sheet.panels.len() as f64;
    let deployed = deployed_boundaries(sheet, configuration);
    let shared = if sheet.topology.is_full() {
        let neighbours = neighbours(sheet);
        let shared = neighbours.map(|(one, other)| area(&common(&deployed[one], &deployed[other])));
        shared.fold(0.0, f64::max)
    } else {
        most_shared(deployed)
    };
    shared / mean
}

/// Pairs of panels that share a corner.
fn neighbours(sheet: &Sheet) -> impl Iterator<Item = (usize, usize)> {
    sheet.topology.places.iter().enumerate().flat_map(|(panel, &[p, q])| {
        let west = p.checked_sub(1);
        let others = [(Some(p + 1), q), (Some(p), q + 1), (Some(p + 1), q + 1), (west, q + 1)];
        let others = others.into_iter().filter_map(|(p, q)| sheet.topology.panel(p?, q));
        others.map(move |other| (panel, other))
    })
}

/// The maximum common area of any two polygons (mm^2).
fn most_shared(polygons: Vec<Contour>) -> f64 {
    let regions = polygons.into_iter().map(|polygon| Region::union_of(vec![polygon]));
    let regions: Vec<_> = regions.map(|region| (region.bounds(), region)).collect();
    let met = |[low, high]: &[[f64; 2]; 2], [from, to]: &[[f64; 2]; 2]| {
        (0..2).all(|c| low[c] < to[c] && from[c] < high[c])
    };
    let shared = regions.iter().enumerate().flat_map(|(i, (bounds, one))| {
        let others = regions[..i].iter().filter(move |(other, _)| met(bounds, other));
        others.map(|(_, other)| one.common(other).area())
    });
    shared.fold(0.0, f64::max)
}

/// The distance of each hinge to the nearest other hinge of its two panels (mm).
fn hinge_spacings(sheet: &Sheet) -> Vec<f64> {
    let mut of_panel = vec![Vec::new(); sheet.panels.len()];
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        hinge.panels().into_iter().for_each(|panel| of_panel[panel].push(h));
    }
    let mut spacings = vec![f64::INFINITY; sheet.hinges.len()];
    for hinges in of_panel {
        for (i, &one) in hinges.iter().enumerate() {
            for &other in &hinges[..i] {
                let [p, q] = [one, other].map(|h| sheet.hinges[h].corner);
                let apart = distance(p, q);
                spacings[one] = spacings[one].min(apart);
                spacings[other] = spacings[other].min(apart);
            }
        }
    }
    spacings
}
