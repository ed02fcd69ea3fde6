//! Motions of the panels and openings of the hinges of a measured sheet.
//!
//! A panel with at least two measured marks has a measured rigid motion. The residuals of these
//! motions, with 2 n - 3 degrees of freedom for n marks, give the standard deviation of one
//! coordinate for any prediction: the errors of the measurement, and the bending of the panels.

use crate::path_fit::Fit;
use design::geometry::plane::{complex, point};
use design::geometry::polygon::distance;
use design::geometry::similarity::{Correspondence, Scale, Similarity};
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::hinge_deformations;
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use support::Point;

/// A panel with a measured position.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeasuredPanel {
    /// Number of the panel.
    pub panel: usize,
    /// Measured position of its reference point in the frame of the design (mm).
    pub centre: Point,
    /// Predicted position of its reference point (mm).
    pub predicted: Point,
    /// Measured rotation (rad); `None` if only its centre was measured.
    pub rotation: Option<f64>,
    /// Sum of the squared distances of its marks from their mean (mm^2).
    #[serde(skip)]
    lever: f64,
    /// Sum of the squared residuals of its rigid motion (mm^2), and their degrees of freedom.
    #[serde(skip)]
    misfit: (f64, f64),
}

/// A hinge with a measured opening.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeasuredOpening {
    /// Index of the hinge.
    pub hinge: usize,
    /// Panels A and B.
    pub panels: [usize; 2],
    /// Measured relative rotation of the panels (deg).
    pub measured_deg: f64,
    /// Predicted relative rotation (deg).
    pub predicted_deg: f64,
    /// Standard error of the measured rotation (deg).
    pub error_deg: f64,
}

impl MeasuredPanel {
    /// The panels whose centre, or two other marks, are measured.
    pub fn all(sheet: &Sheet, fit: &Fit) -> Vec<Self> {
        let mut marks: Vec<Vec<Correspondence>> = vec![Vec::new(); sheet.panels.len()];
        let mut centres = vec![None; sheet.panels.len()];
        for seen in &fit.points {
            let flat = complex(seen.mark.flat(sheet));
            marks[seen.mark.panel].push([flat, complex(seen.measured)]);
            if seen.mark.corner.is_none() {
                centres[seen.mark.panel] = Some(seen.measured);
            }
        }
        let panels = marks.iter().enumerate().filter_map(|(panel, marks)| {
            let reference = complex(sheet.panels[panel].reference);
            let motion = Similarity::least_squares(marks, Scale::Given).filter(|_| marks.len() > 1);
            let by_motion = || motion.map(|motion| point(motion.of(reference)));
            let [x, y, _] = fit.shape.configuration[panel];
            let residuals = motion
                .map_or(0.0, |motion| marks.iter().map(|pair| motion.residual(pair).powi(2)).sum());
            let mean = marks.iter().map(|[flat, _]| flat).sum::<faer::c64>() / marks.len() as f64;
            Some(Self {
                panel,
                centre: centres[panel].or_else(by_motion)?,
                predicted: [reference.re + x, reference.im + y],
                rotation: motion.map(|motion| motion.rotation()),
                lever: marks.iter().map(|[flat, _]| (flat - mean).norm_sqr()).sum(),
                misfit: (residuals, (2.0 * marks.len() as f64 - 3.0).max(0.0)),
            })
        });
        panels.collect()
    }

    /// Distance of the measured from the predicted centre (mm).
    pub fn distance(&self) -> f64 {
        distance(self.predicted, self.centre)
    }
}

impl MeasuredOpening {
    /// Measured minus predicted opening (deg).
    pub fn difference_deg(&self) -> f64 {
        self.measured_deg - self.predicted_deg
    }
}

/// Standard deviation of one measured coordinate about rigid panels (mm); `None` without a panel of
/// two marks.
pub fn scatter(panels: &[MeasuredPanel]) -> Option<f64> {
    let sum =
        |of: fn(&(f64, f64)) -> f64| panels.iter().map(|panel| of(&panel.misfit)).sum::<f64>();
    let (squares, free) = (sum(|misfit| misfit.0), sum(|misfit| misfit.1));
    (free > 0.0).then(|| (squares / free).sqrt())
}

/// The openings of the hinges between panels with a measured rotation.
pub fn openings(sheet: &Sheet, fit: &Fit, panels: &[MeasuredPanel]) -> Vec<MeasuredOpening> {
    let mut rotations = vec![None; sheet.panels.len()];
    for panel in panels {
        rotations[panel.panel] = panel.rotation.map(|rotation| (rotation, panel.lever));
    }
    let Some(sigma) = scatter(panels) else {
        return Vec::new();
    };
    let predicted = hinge_deformations(sheet, &fit.shape.configuration);
    let hinges = sheet.hinges.iter().zip(predicted).enumerate();
    let measured = hinges.filter_map(|(h, (hinge, predicted))| {
        let between = hinge.panels();
        let [(phi_a, lever_a), (phi_b, lever_b)] = [rotations[between[0]]?, rotations[between[1]]?];
        // Rotations are known up to full turns: the nearest to the prediction is meant.
        let ahead = (phi_b - phi_a - predicted.theta + PI).rem_euclid(TAU) - PI;
        Some(MeasuredOpening {
            hinge: h,
            panels: between,
            measured_deg: (predicted.theta + ahead).to_degrees(),
            predicted_deg: predicted.theta.to_degrees(),
            error_deg: (sigma * (1.0 / lever_a + 1.0 / lever_b).sqrt()).to_degrees(),
        })
    });
    measured.collect()
}

/// Motion of a panel between a measurement of the closed and one of the deployed sheet in the same
/// frame, less its predicted motion (mm): the slip of a support. `None` if the panel is not
/// measured in both.
pub fn slip(sheet: &Sheet, closed: &Fit, deployed: &Fit, panel: usize) -> Option<Point> {
    let seen = |fit: &Fit| {
        let panels = MeasuredPanel::all(sheet, fit);
        let found = panels.into_iter().find(|other| other.panel == panel)?;
        // Both are in the frame of the closed sheet.
        let image = closed.motion.back(fit.motion.of(complex(found.centre)));
        Some(image - complex(found.predicted))
    };
    Some(point(seen(deployed)? - seen(closed)?))
}
