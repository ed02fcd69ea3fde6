//! Points measured on a deployed sheet, compared with its equilibrium path; section 4.4.

use crate::measured_points::MeasuredPoint;
use crate::path_fit::{Fit, MIN_POINTS, PathFit};
use crate::shape_path::ShapePath;
use design::geometry::similarity::Scale;
use std::collections::HashSet;
use support::{Fault, ensure, fault, refuse};

/// A measured sheet and its path.
#[derive(Debug)]
pub struct MeasuredSheet {
    /// The state of the path that fits best.
    pub best: Fit,
    /// The last state of the path, with the motion that fits it to the same points.
    pub full: Fit,
    /// Standard error of the load factor of `best`, if the errors of the points are independent;
    /// `None` if the points do not determine the load factor.
    pub load_factor_error: Option<f64>,
}

impl MeasuredSheet {
    /// Compares the points, finite ones of different marks of the sheet, with the path; see the
    /// head of this file.
    pub fn new(path: &ShapePath, points: &[MeasuredPoint], scale: Scale) -> Result<Self, Fault> {
        let mut panels = HashSet::new();
        let alone = points.iter().all(|point| panels.insert(point.mark.panel));
        ensure!(
            points.len() >= MIN_POINTS,
            "{} measured points: at least {MIN_POINTS} are needed for pose, scale and load factor",
            points.len()
        );
        if scale == Scale::Free && path.end() > 0.0 && alone {
            refuse!(
                "without two points on one panel, a larger scale and a wider opening look alike: measure corners, or measure in mm, \
     cm or m"
            );
        }
        let problem = PathFit { path, points, scale };
        let best = problem.fit(problem.best_position());
        let full = problem.fit(path.end());
        let coincide = || fault!("the measured points coincide");
        let (best, full) = best.zip(full).ok_or_else(coincide)?;
        Ok(Self { load_factor_error: problem.load_factor_error(&best), best, full })
    }
}
