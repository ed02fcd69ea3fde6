//! The amount of cutting.

use crate::{
    cut_file::cut_drawing::{CutDrawing, Layer},
    display::Shape,
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Totals of a drawing in cutting order.
#[derive(Clone, Debug, Serialize, derive_more::Display)]
#[display(
    "{holes} holes, {slits} slits, {pierces} pierces; {cut_m:.2} m of cuts, {idle_m:.2} m of idle travel"
)]
pub struct Totals {
    /// Number of holes.
    pub holes: usize,
    /// Number of slits, or of their pieces in a part of a sheet.
    pub slits: usize,
    /// Number of times that the tool is lowered: once a cut.
    pub pierces: usize,
    /// Length of all cuts (m).
    pub cut_m: f64,
    /// Length of the moves between the cuts, from the lower left corner of the sheet (m).
    pub idle_m: f64,
}

impl Totals {
    /// The totals of a drawing from a tool at `home`.
    pub fn new(ordered: &CutDrawing, home: [f64; 2]) -> Self {
        Self {
            pierces: ordered.cuts().count(),
            holes: ordered.on(Layer::Holes).count(),
            slits: ordered.on(Layer::Cut).count(),
            cut_m: 1e-3 * ordered.cuts().map(Shape::length).sum::<f64>(),
            idle_m: 1e-3 * ordered.idle_travel(home),
        }
    }
}

/// The numbers of holes by diameter, in steps of drills: 0.1 mm.
pub(super) fn holes_by_diameter(radii: impl Iterator<Item = f64>) -> BTreeMap<u64, usize> {
    let mut counts = BTreeMap::new();
    for radius in radii {
        *counts.entry((20.0 * radius).round() as u64).or_default() += 1;
    }
    counts
}
