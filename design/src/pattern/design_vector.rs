//! The design vector theta = (z, ell, omega) of (1) in unconstrained coordinates, and the chart of
//! the ligament widths, w_lig = w_minus + (w_plus - w_minus) sigma(omega).

use crate::pattern::{
    coordinates::{PatternCoordinates, logistic, logit},
    fit_variables::FitVariables,
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
    /// How sheet and target are fitted to each other, if they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<FitVariables>,
}

impl DesignVector {
    /// r = 1/2, evenly spaced outline cuts, each width at the middle of the chart.
    pub fn uniform(grid: Grid) -> Self {
        Self {
            pattern: PatternCoordinates::uniform(grid),
            omega: vec![0.0; grid.hinge_count()],
            opening: None,
            fit: None,
        }
    }

    /// All coordinates as one vector: z, ell of the bottom, right, top, left edge, omega, opening,
    /// fit.
    pub fn to_flat(&self) -> Vec<f64> {
        let fit = self.fit.iter().flat_map(FitVariables::to_flat);
        self.blocks().flatten().copied().chain(fit).collect()
    }

    /// This design with the coordinates of a vector ordered as by [`to_flat`](Self::to_flat);
    /// missing coordinates keep their values.
    pub fn with_flat(&self, flat: &[f64]) -> Self {
        let mut design = self.clone();
        let mut values = flat.iter();
        let edges = design.pattern.ell.iter_mut().flatten();
        let coordinates = design.pattern.z.iter_mut().chain(edges);
        let fit = (design.fit.as_mut()).map(FitVariables::coordinates_mut);
        for coordinate in coordinates
            .chain(&mut design.omega)
            .chain(&mut design.opening)
            .chain(fit.into_iter().flatten())
        {
            if let Some(&value) = values.next() {
                *coordinate = value;
            }
        }
        design
    }

    /// Whether all blocks have the same lengths.
    pub fn same_shape(&self, other: &Self) -> bool {
        let lengths = |design: &Self| -> Vec<usize> { design.blocks().map(<[f64]>::len).collect() };
        lengths(self) == lengths(other) && self.fit.is_some() == other.fit.is_some()
    }

    fn blocks(&self) -> impl Iterator<Item = &[f64]> {
        std::iter::once(self.pattern.z.as_slice())
            .chain(self.pattern.ell.iter().map(Vec::as_slice))
            .chain([self.omega.as_slice(), self.opening.as_slice()])
    }
}

/// The interval of admissible ligament widths (mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
