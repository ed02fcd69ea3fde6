//! The design vector theta = (z, ell, omega) of (1) in unconstrained coordinates, and the chart of
//! the ligament widths, w_lig = w_minus + (w_plus - w_minus) sigma(omega).

use crate::pattern::{
    coordinates::{PatternCoordinates, logistic, logit},
    grid::Grid,
};
use serde::{Deserialize, Serialize};

/// All design variables, or a gradient in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DesignVector {
    /// (z, ell): the cut pattern.
    pub pattern: PatternCoordinates,
    /// The ligament widths, one logit per hinge.
    pub omega: Vec<f64>,
    /// The opening angle of the ideal deployment (rad), if it is a design variable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening: Option<f64>,
}

impl DesignVector {
    /// r = 1/2, evenly spaced outline cuts, each width at the middle of the chart.
    pub fn uniform(grid: Grid) -> Self {
        Self {
            pattern: PatternCoordinates::uniform(grid),
            omega: vec![0.0; grid.hinge_count()],
            opening: None,
        }
    }

    /// All coordinates as one vector: z, ell of the bottom, right, top, left edge, omega, opening.
    pub fn to_flat(&self) -> Vec<f64> {
        self.clone().coordinates_mut().map(|coordinate| *coordinate).collect()
    }

    /// This design with the coordinates of a vector ordered as by [`to_flat`](Self::to_flat);
    /// missing coordinates keep their values.
    pub fn with_flat(&self, flat: &[f64]) -> Self {
        let mut design = self.clone();
        std::iter::zip(design.coordinates_mut(), flat).for_each(|(to, value)| *to = *value);
        design
    }

    /// Whether all blocks have the same lengths.
    pub fn same_shape(&self, other: &Self) -> bool {
        let lengths = |Self { pattern, omega, opening }: &Self| {
            let ell = pattern.ell.each_ref().map(Vec::len);
            (pattern.z.len(), ell, omega.len(), opening.is_some())
        };
        lengths(self) == lengths(other)
    }

    fn coordinates_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let PatternCoordinates { z, ell } = &mut self.pattern;
        z.iter_mut().chain(ell.iter_mut().flatten()).chain(&mut self.omega).chain(&mut self.opening)
    }
}

/// The interval of admissible ligament widths (mm).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WidthChart {
    /// Minimum ligament width (mm).
    pub w_minus: f64,
    /// Maximum ligament width (mm).
    pub w_plus: f64,
}

impl WidthChart {
    /// w_lig (mm).
    pub fn width(&self, omega: f64) -> f64 {
        self.w_minus + (self.w_plus - self.w_minus) * logistic(omega)
    }

    /// The coordinate of a width strictly inside the interval (mm).
    pub fn omega(&self, w_lig: f64) -> f64 {
        logit((w_lig - self.w_minus) / (self.w_plus - self.w_minus))
    }

    /// dw_lig/domega (mm).
    pub fn slope(&self, omega: f64) -> f64 {
        let sigma = logistic(omega);
        (self.w_plus - self.w_minus) * sigma * (1.0 - sigma)
    }
}
