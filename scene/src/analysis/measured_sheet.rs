//! Points measured on a deployed sheet, compared with its equilibrium path; section 4.4.

use crate::analysis::measured_points::{Mark, MeasuredPoint};
use crate::analysis::path_fit::{Fit, MIN_POINTS, Problem};
use crate::analysis::shape_path::ShapePath;
use design::geometry::similarity::Scale;
use std::collections::HashMap;

/// A measured sheet and its path.
#[derive(Clone, Debug)]
pub struct MeasuredSheet {
    /// The state of the path that fits best.
    pub best: Fit,
    /// The last state of the path, with the motion that fits it to the same points.
    pub full: Fit,
    /// Standard error of the load factor of `best`, if the errors of the points are independent; `None` if the
    /// points do not determine the load factor.
    pub load_factor_error: Option<f64>,
}

/// Why a measurement cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum MeasurementError {
    #[error("{mark} (point {index}): {fault}")]
    Point {
        index: usize,
        mark: Mark,
        fault: PointFault,
    },
    #[error(
        "{0} measured points: at least {MIN_POINTS} are needed for pose, scale and load factor"
    )]
    TooFew(usize),
    #[error("the measured points coincide")]
    Coincide,
    #[error(
        "without two points on one panel, a larger scale and a wider opening look alike: measure corners, or \
         measure in mm, cm or m and fix the scale (--scale given)"
    )]
    ScaleUnknown,
}

/// Why a point is not one of the sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum PointFault {
    #[error("the sheet has the panels 0 to {last}")]
    NoSuchPanel { last: usize },
    #[error("a panel has the corners 0 to 3")]
    NoSuchCorner,
    #[error("its position is not finite")]
    NotFinite,
    #[error("the mark is measured twice, first by point {first}")]
    Repeated { first: usize },
}

impl MeasuredSheet {
    /// Compares the points with the path; see the head of this file.
    pub fn new(
        path: &ShapePath,
        points: &[MeasuredPoint],
        scale: Scale,
    ) -> Result<Self, MeasurementError> {
        check(path, points, scale)?;
        let problem = Problem {
            path,
            points,
            scale,
        };
        let best = problem.fit(problem.best_position());
        let full = problem.fit(path.end());
        let (Some(best), Some(full)) = (best, full) else {
            return Err(MeasurementError::Coincide);
        };
        Ok(Self {
            load_factor_error: problem.load_factor_error(&best),
            best,
            full,
        })
    }
}

/// The points must be different marks of the sheet, at finite positions, and determine the unknowns.
fn check(path: &ShapePath, points: &[MeasuredPoint], scale: Scale) -> Result<(), MeasurementError> {
    let panels = path.sheet.panels.len();
    let mut seen = HashMap::new();
    let mut on_panel = vec![0; panels];
    for (index, &MeasuredPoint { mark, position }) in points.iter().enumerate() {
        let earlier = seen.insert(mark, index);
        let fault = if mark.panel >= panels {
            PointFault::NoSuchPanel { last: panels - 1 }
        } else if mark.corner.is_some_and(|corner| corner > 3) {
            PointFault::NoSuchCorner
        } else if !position.iter().all(|x| x.is_finite()) {
            PointFault::NotFinite
        } else if let Some(first) = earlier {
            PointFault::Repeated { first }
        } else {
            on_panel[mark.panel] += 1;
            continue;
        };
        return Err(MeasurementError::Point { index, mark, fault });
    }
    if points.len() < MIN_POINTS {
        return Err(MeasurementError::TooFew(points.len()));
    }
    if scale == Scale::Free && path.end() > 0.0 && on_panel.iter().all(|count| *count < 2) {
        return Err(MeasurementError::ScaleUnknown);
    }
    Ok(())
}
