//! Points measured on a deployed sheet, compared with its equilibrium path; section 4.4.

use crate::measured_points::MeasuredPoint;
use crate::path_fit::{Fit, MIN_POINTS, Problem};
use crate::shape_path::ShapePath;
use design::geometry::similarity::Scale;
use std::collections::HashSet;

/// A measured sheet and its path.
#[derive(Clone, Debug)]
pub struct MeasuredSheet {
    /// The state of the path that fits best.
    pub best: Fit,
    /// The last state of the path, with the motion that fits it to the same points.
    pub full: Fit,
    /// Standard error of the load factor of `best`, if the errors of the points are independent;
    /// `None` if the points do not determine the load factor.
    pub load_factor_error: Option<f64>,
}

/// Why a measurement cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum MeasurementError {
    #[error(
        "{0} measured points: at least {MIN_POINTS} are needed for pose, scale and load factor"
    )]
    TooFew(usize),
    #[error("the measured points coincide")]
    Coincide,
    #[error(
        "without two points on one panel, a larger scale and a wider opening look alike: measure corners, or \
         measure in mm, cm or m"
    )]
    ScaleUnknown,
}

impl MeasuredSheet {
    /// Compares the points, finite ones of different marks of the sheet, with the path; see the
    /// head of this file.
    pub fn new(
        path: &ShapePath,
        points: &[MeasuredPoint],
        scale: Scale,
    ) -> Result<Self, MeasurementError> {
        check(path, points, scale)?;
        let problem = Problem { path, points, scale };
        let best = problem.fit(problem.best_position());
        let full = problem.fit(path.end());
        let (Some(best), Some(full)) = (best, full) else {
            return Err(MeasurementError::Coincide);
        };
        Ok(Self { load_factor_error: problem.load_factor_error(&best), best, full })
    }
}

/// The points must determine the unknowns.
fn check(path: &ShapePath, points: &[MeasuredPoint], scale: Scale) -> Result<(), MeasurementError> {
    if points.len() < MIN_POINTS {
        return Err(MeasurementError::TooFew(points.len()));
    }
    let mut panels = HashSet::new();
    let alone = points.iter().all(|point| panels.insert(point.mark.panel));
    if scale == Scale::Free && path.end() > 0.0 && alone {
        return Err(MeasurementError::ScaleUnknown);
    }
    Ok(())
}
