//! The charts (5): unconstrained coordinates of the admissible patterns,
//!
//! ```text
//! r = sigma(z),     tau_(e,s) = sum over m <= s of softmax(ell_e)_m
//! ```

use crate::pattern::grid::Grid;
use serde::{Deserialize, Serialize};
use std::iter::zip;
use support::{Fault, fault, refuse};

/// Unconstrained coordinates of a pattern (5), or a gradient in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatternCoordinates {
    /// Logits of the void aspect ratios of the interior cuts, row by row.
    pub z: Vec<f64>,
    /// Logits of the intervals between the cuts on the edges bottom, right, top, left.
    pub ell: [Vec<f64>; 4],
}

impl PatternCoordinates {
    /// r = 1/2 everywhere, and evenly spaced cuts on the outline.
    pub fn uniform(grid: Grid) -> Self {
        Self {
            z: vec![0.0; grid.aspect_ratio_count()],
            ell: grid.edge_cut_counts().map(|count| vec![0.0; count + 1]),
        }
    }

    /// r and tau as one vector. They are unique to a pattern, whereas many logits give the same
    /// one.
    pub fn values(&self) -> Vec<f64> {
        let r = self.z.iter().map(|z| logistic(*z));
        r.chain(self.ell.iter().flat_map(|ell| partial_sums(ell))).collect()
    }

    /// Coordinates of the pattern with given [`values`](Self::values).
    pub fn from_values(grid: Grid, values: &[f64]) -> Result<Self, Fault> {
        let (r, mut rest) = values.split_at(grid.aspect_ratio_count().min(values.len()));
        let tau = grid.edge_cut_counts().map(|count| {
            let (edge, others) = rest.split_at(count.min(rest.len()));
            rest = others;
            edge.to_vec()
        });
        let coordinates = Self { z: Self::z_of(r)?, ell: Self::ell_of(&tau)? };
        coordinates.check(grid)?;
        Ok(coordinates)
    }

    /// The logits z of given aspect ratios.
    pub fn z_of(r: &[f64]) -> Result<Vec<f64>, Fault> {
        let inside = |r: f64| r > 0.0 && r < 1.0;
        match r.iter().position(|r| !inside(*r)) {
            Some(index) => Err(outside_interval("r", index, r[index])),
            None => Ok(r.iter().map(|r| logit(*r)).collect()),
        }
    }

    /// Logits of given boundary positions on the four edges: the logarithms of their intervals.
    pub fn ell_of(tau: &[Vec<f64>; 4]) -> Result<[Vec<f64>; 4], Fault> {
        for tau in tau {
            let widths = intervals(tau);
            if let Some(index) = widths.iter().position(|width| *width <= 0.0 || width.is_nan()) {
                let index = index.min(tau.len() - 1);
                return Err(outside_interval("tau", index, tau[index]));
            }
        }
        let logits = |tau: &Vec<f64>| intervals(tau).iter().map(|width| width.ln()).collect();
        Ok(tau.each_ref().map(logits))
    }

    /// An error unless the coordinates are finite and as many as the grid has.
    pub fn check(&self, grid: Grid) -> Result<(), Fault> {
        let expected = grid.edge_cut_counts().map(|count| count + 1);
        let blocks = [
            ("z", &self.z, grid.aspect_ratio_count()),
            ("ell of the bottom edge", &self.ell[0], expected[0]),
            ("ell of the right edge", &self.ell[1], expected[1]),
            ("ell of the top edge", &self.ell[2], expected[2]),
            ("ell of the left edge", &self.ell[3], expected[3]),
        ];
        for (name, values, expected) in blocks {
            if values.len() != expected {
                let (found, Grid { m, n }) = (values.len(), grid);
                refuse!("{name} has {found} entries; a sheet of {m} x {n} panels needs {expected}");
            }
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                let value = values[index];
                refuse!("{name}[{index}] = {value} is not a finite number");
            }
        }
        Ok(())
    }
}

fn outside_interval(name: &str, index: usize, value: f64) -> Fault {
    let range = format!("0 < {name} < 1, increasing along each edge");
    fault!("{name}[{index}] = {value} violates {range}")
}

/// The logistic function sigma of (5).
pub fn logistic(z: f64) -> f64 {
    1.0 / (1.0 + (-z).exp())
}

/// The inverse of [`logistic`].
pub fn logit(fraction: f64) -> f64 {
    (fraction / (1.0 - fraction)).ln()
}

/// Partial sums of softmax(ell) without the last, which is 1; (5).
pub fn partial_sums(ell: &[f64]) -> Vec<f64> {
    let max = ell.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = ell.iter().map(|logit| (logit - max).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    weights[..weights.len() - 1]
        .iter()
        .map(|weight| {
            sum += weight / total;
            sum
        })
        .collect()
}

/// The intervals between neighbouring boundary positions: the softmax weights.
pub fn intervals(tau: &[f64]) -> Vec<f64> {
    let ends = with_ends(tau);
    ends.clone().skip(1).zip(ends).map(|(b, a)| b - a).collect()
}

/// Boundary positions with the two ends of their edge.
pub(crate) fn with_ends(tau: &[f64]) -> impl Iterator<Item = f64> + Clone {
    std::iter::once(0.0).chain(tau.iter().copied()).chain(std::iter::once(1.0))
}

/// The gradient in ell from the gradient in tau.
pub fn partial_sums_pullback(tau: &[f64], gradient: &[f64]) -> Vec<f64> {
    let weights = intervals(tau);
    let mut by_weight = vec![0.0; weights.len()];
    for s in (0..gradient.len()).rev() {
        by_weight[s] = by_weight[s + 1] + gradient[s];
    }
    let mean: f64 = zip(&weights, &by_weight).map(|(w, g)| w * g).sum();
    zip(&weights, &by_weight).map(|(w, g)| w * (g - mean)).collect()
}
