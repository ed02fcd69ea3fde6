//! Whether panels of a sheet lie over each other.

use crate::{
    geometry::{
        polygon::{area, common},
        region::{Region, Ring},
    },
    sheet::{cut_sheet::Sheet, kinematics::deployed_boundaries},
};
use support::{Extremes, Point};

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
        shared.largest()
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
fn most_shared(polygons: Vec<Ring>) -> f64 {
    let regions = polygons.into_iter().map(|polygon| Region::union_of(vec![polygon]));
    let regions: Vec<_> = regions.map(|region| (region.bounds(), region)).collect();
    let met = |[low, high]: &[Point; 2], [from, to]: &[Point; 2]| {
        (0..2).all(|c| low[c] < to[c] && from[c] < high[c])
    };
    let shared = regions.iter().enumerate().flat_map(|(i, (bounds, one))| {
        let others = regions[..i].iter().filter(move |(other, _)| met(bounds, other));
        others.map(|(_, other)| one.common(other).area())
    });
    shared.largest()
}
