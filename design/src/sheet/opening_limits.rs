//! Maximum stretch of a sheet in the ideal deployment; (6) for any pattern.
//!
//! Panels rotate by -theta/2 and +theta/2, so the vector between two of them is, in complex
//! numbers, d(theta) = e^(i theta/2) p + e^(-i theta/2) q, and
//!
//! ```text
//! lambda(theta) = |d(theta)| / |d(0)|,     lambda_max = (|p| + |q|) / |p + q|     at theta = arg(q / p)
//! ```
//!
//! The uniform sheet has (6), with cos(psi) = |p + q| / (|p| + |q|). Every void is a
//! parallelogram with the angles theta and pi - theta. For any pattern, panels touch at theta = 0
//! and at theta = pi and at no angle between.

use crate::{
    geometry::plane::{I, complex},
    pattern::grid::Grid,
    sheet::{cut_sheet::Sheet, ideal_deployment::ideal_deployment},
};
use faer::c64;
use serde::Serialize;
use std::f64::consts::PI;

/// Opening angles at which panels touch (rad).
pub const CONTACT: [f64; 2] = [0.0, PI];

/// The distance between the centroids of two panels as a function of the opening angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// mm
    pub flat: f64,
    /// Maximum distance, relative to the flat one.
    pub lambda_max: f64,
    /// Opening angle at the maximum (rad); negative if the distance decreases on opening.
    pub theta_max: f64,
    #[serde(skip)]
    turning: [c64; 2],
}

impl Span {
    /// The span between two panels.
    pub fn between(sheet: &Sheet, from: usize, to: usize) -> Self {
        let at = |theta: f64| {
            let configuration = ideal_deployment(sheet, theta);
            let centre = |k: usize| {
                let [x, y, _] = configuration[k];
                complex(sheet.panels[k].reference) + c64::new(x, y)
            };
            centre(to) - centre(from)
        };
        let (flat, folded) = (at(0.0), at(PI));
        let p = (flat - I * folded) / 2.0;
        let q = (flat + I * folded) / 2.0;
        Self {
            flat: flat.norm(),
            lambda_max: (p.norm() + q.norm()) / flat.norm(),
            theta_max: (q * p.conj()).arg(),
            turning: [p, q],
        }
    }

    /// The spans between the first and the last panel of the middle row, and of the middle column.
    pub fn of_sheet(sheet: &Sheet) -> [Self; 2] {
        let Grid { m, n } = sheet.topology.grid;
        let (row, column) = ((0..m).map(|p| (p, n / 2)), (0..n).map(|q| (m / 2, q)));
        let ends = |panels: Vec<usize>| [panels[0], panels[panels.len() - 1]];
        let panel = |(p, q)| sheet.topology.panel(p, q);
        let lines = [row.filter_map(panel).collect(), column.filter_map(panel).collect()];
        lines.map(ends).map(|[from, to]| Self::between(sheet, from, to))
    }

    /// lambda of (6) at the opening angle theta (rad).
    pub fn stretch(&self, theta: f64) -> f64 {
        let [p, q] = self.turning;
        (c64::cis(0.5 * theta) * p + c64::cis(-0.5 * theta) * q).norm() / self.flat
    }
}
