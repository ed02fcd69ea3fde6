//! The objective of one design and its terms, as stored for each step and reported.

use crate::objective::design_problem::Evaluation;
use crate::objective::loss::Objective;
use crate::objective::outline_error::outline_error;
use serde::{Deserialize, Serialize};

/// The objective of one design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// L of (16) (mm^2).
    pub loss: f64,
    /// Root mean square distance of the deployed outline to the target (mm).
    pub outline_error: f64,
    /// The Chamfer distance including coverage (mm^2).
    pub chamfer: f64,
    /// The damage functional (17), unweighted.
    pub damage: f64,
    /// The compression functional (18), unweighted.
    pub compression: f64,
    /// The shear functional (19), unweighted.
    pub shear: f64,
    /// Panel shape penalty, unweighted; 0 if its weight is zero.
    pub panel_shape: f64,
    /// The barrier at the minimum panel width (mm^2); 0 without a minimum.
    #[serde(default)]
    pub panel_width: f64,
    /// Penalty on states outside the training domain, unweighted; 0 if its weight is zero.
    #[serde(default)]
    pub domain: f64,
    /// Fraction of the hinge states of the path inside the training domain of the hinge law.
    pub share_inside: f64,
}

impl Scores {
    /// The scores of an evaluated design.
    pub fn of(objective: &Objective, evaluation: &Evaluation) -> Self {
        let terms = &evaluation.terms;
        Self {
            loss: evaluation.loss,
            outline_error: outline_error(objective, &evaluation.deployment),
            chamfer: terms.chamfer,
            damage: terms.path.damage,
            compression: terms.path.compression,
            shear: terms.path.shear,
            panel_shape: terms.panel_shape,
            panel_width: terms.panel_width,
            domain: terms.domain,
            share_inside: evaluation.deployment.share_inside(),
        }
    }

    /// The terms of the loss by name, unweighted.
    pub fn terms(&self) -> [(&'static str, f64); 7] {
        [
            ("Chamfer (mm^2)", self.chamfer),
            ("damage", self.damage),
            ("compression", self.compression),
            ("shear", self.shear),
            ("panel shape", self.panel_shape),
            ("panel width (mm^2)", self.panel_width),
            ("outside domain", self.domain),
        ]
    }
}

/// A term as text: four digits after the point, or scientific notation if these do not show it.
pub fn shown(value: f64) -> String {
    match value != 0.0 && value.abs() < 1e-3 {
        true => format!("{value:.2e}"),
        false => format!("{value:.4}"),
    }
}
