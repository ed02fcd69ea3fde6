//! How far the ideal deployment opens a sheet; (6) for any pattern.
//!
//! Panels turn by -theta/2 and +theta/2, so that the vector between two of them is, in complex
//! numbers, d(theta) = e^(i theta/2) p + e^(-i theta/2) q, and
//!
//! ```text
//! lambda(theta) = |d(theta)| / |d(0)|,     lambda_max = (|p| + |q|) / |p + q|     at theta = arg(q / p)
//! ```
//!
//! which is (6) in the uniform sheet, with cos(psi) = |p + q| / (|p| + |q|). Every void is a parallelogram
//! with the angles theta and pi - theta: whatever the pattern, its panels touch at theta = 0 and at
//! theta = pi, and at no angle between.

use crate::ideal_deployment::ideal_deployment;
use crate::plane::{I, complex};
use crate::sheet::Sheet;
use faer::c64;
use serde::Serialize;
use std::f64::consts::PI;

/// Openings at which panels touch (rad).
pub const CONTACT: [f64; 2] = [0.0, PI];

/// The distance between the centroids of two panels in the ideal deployment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// mm
    pub flat: f64,
    /// Greatest distance over the flat one.
    pub lambda_max: f64,
    /// Where it is reached (rad); negative if the distance falls on opening.
    pub theta_max: f64,
    #[serde(skip)]
    turning: [c64; 2],
}

impl Span {
    /// Between two panels.
    pub fn between(sheet: &Sheet, from: usize, to: usize) -> Self {
        let at = |theta: f64| {
            let configuration = ideal_deployment(sheet, theta);
            let centre = |k: usize| {
                let [x, y, _] = configuration[k];
                complex(sheet.panels[k].centroid) + c64::new(x, y)
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

    /// From the middle of the west edge to that of the east edge, and from south to north.
    pub fn of_sheet(sheet: &Sheet) -> [Self; 2] {
        let grid = sheet.grid;
        let (p, q) = (grid.m / 2, grid.n / 2);
        [
            Self::between(sheet, grid.panel(0, q), grid.panel(grid.m - 1, q)),
            Self::between(sheet, grid.panel(p, 0), grid.panel(p, grid.n - 1)),
        ]
    }

    /// lambda of (6) at the opening theta (rad).
    pub fn stretch(&self, theta: f64) -> f64 {
        let [p, q] = self.turning;
        (c64::cis(0.5 * theta) * p + c64::cis(-0.5 * theta) * q).norm() / self.flat
    }
}
