//! Criteria by which rows are rejected from the database. Rows are never repaired.

use crate::rows::Row;
use crate::schema::is_finite;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Limits that an accepted row satisfies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AcceptanceLimits {
    /// Maximum accepted [`hinge::HingeSample::energy_residual`]: relative difference of the
    /// solver's energy and the work of its reaction forces.
    pub energy_residual_max: f64,
}

impl Default for AcceptanceLimits {
    /// Converged rays stay below 1e-3; ten times this value is not explained by the error of the
    /// quadrature.
    fn default() -> Self {
        Self { energy_residual_max: 0.01 }
    }
}

/// Why a row was rejected: the first reason that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rejection {
    /// A number is not finite.
    NotFinite,
    /// The design cannot be cut; see [`hinge::HingeDesign::validate`].
    InvalidDesign,
    /// W < 0 or D < 0.
    Negative,
    /// The energy and the work of the reaction forces differ by more than the limit.
    EnergyResidual,
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a number is not finite",
            Self::InvalidDesign => "the hinge cannot be cut or is outside of the limits of its keys (lengths in mm, angles in rad?)",
            Self::Negative => "W or D is negative",
            Self::EnergyResidual => "the energy is not the work of the forces (units of W, forces and lengths?)",
        })
    }
}

impl AcceptanceLimits {
    /// Why `row` is rejected; `None` if it is accepted.
    pub fn rejection(&self, row: &Row) -> Option<Rejection> {
        let sample = &row.sample;
        if !is_finite(row) {
            Some(Rejection::NotFinite)
        } else if row.design.validate().is_err() {
            Some(Rejection::InvalidDesign)
        } else if sample.w < 0.0 || sample.d < 0.0 {
            Some(Rejection::Negative)
        } else if sample.energy_residual > self.energy_residual_max {
            Some(Rejection::EnergyResidual)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn each_limit_rejects_its_own_defect() {
        let limits = AcceptanceLimits::default();
        assert_eq!(limits.rejection(&row(0, 0.5)), None);
        type Change = fn(&mut Row);
        let with = |change: Change| {
            let mut row = row(0, 0.5);
            change(&mut row);
            limits.rejection(&row)
        };
        let cases: [(Change, Rejection); 5] = [
            (|row| row.sample.f_s = f64::NAN, Rejection::NotFinite),
            (|row| row.design.alpha = 4.0, Rejection::InvalidDesign),
            (|row| row.sample.w = -1e-9, Rejection::Negative),
            (|row| row.sample.d = -1e-9, Rejection::Negative),
            (|row| row.sample.energy_residual = 0.021, Rejection::EnergyResidual),
        ];
        for (change, expected) in cases {
            assert_eq!(with(change), Some(expected));
        }
    }
}
