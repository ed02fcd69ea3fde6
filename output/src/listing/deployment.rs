//! The ideal deployment in numbers.

use design::objective::design_problem::{DesignError, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::sheet::ideal_deployment::ideal_deployment;
use design::sheet::kinematics::{Configuration, deployed_corners, hinge_deformations};
use design::sheet::opening_limits::{CONTACT, Span};
use design::sheet::topology::PanelCorner;
use design::sheet::validity::overlap;
use serde::Serialize;
use std::fmt;

/// The sheet with the same opening angle at every hinge; panel 0 keeps its centroid.
#[derive(Clone, Debug, Serialize)]
pub struct DeploymentListing {
    /// The opening angle (deg).
    pub theta_deg: f64,
    /// Motion (u_x, u_y, phi) of every panel (mm, mm, rad).
    pub q: Configuration,
    /// Deployed corners SW, SE, NE, NW of every panel (mm).
    pub panel_corners: Vec<[[f64; 2]; 4]>,
    /// (a, s, theta) of every hinge (mm, mm, rad).
    pub hinge_deformation: Vec<[f64; 3]>,
    /// (panel, corner) on the outline, counter-clockwise from the south-west.
    pub outline_panel_corner: Vec<PanelCorner>,
    /// Deployed positions of `outline_panel_corner` (mm).
    pub outline_vertices: Vec<[f64; 2]>,
    /// The outline corners that belong to no hinge.
    pub outline_free_panel_corner: Vec<PanelCorner>,
    /// Opening angles at which panels touch (deg).
    pub contact_deg: [f64; 2],
    /// Maximum overlap of two panels, relative to the mean panel area.
    pub overlap: f64,
    /// lambda of (6) across the columns and across the rows.
    pub stretch: [f64; 2],
    /// Distances of panels across the columns and across the rows as functions of the opening.
    pub spans: [Span; 2],
}

impl DeploymentListing {
    /// The listing at the opening angle `theta` (rad).
    pub fn new(
        problem: &DesignProblem,
        design: &DesignVector,
        theta: f64,
    ) -> Result<Self, DesignError> {
        if !theta.is_finite() {
            return Err(DesignError::Opening(theta));
        }
        let (_, sheet) = problem.cut(design)?;
        let q = ideal_deployment(&sheet, theta);
        let panel_corners = deployed_corners(&sheet, &q);
        let outline = sheet.outline_corners();
        let spans = Span::of_sheet(&sheet);
        let deformations = hinge_deformations(&sheet, &q);
        Ok(Self {
            theta_deg: theta.to_degrees(),
            hinge_deformation: deformations.iter().map(|eps| eps.to_array()).collect(),
            outline_vertices: outline.iter().map(|&(k, c)| panel_corners[k][c]).collect(),
            outline_panel_corner: outline,
            outline_free_panel_corner: sheet.free_outline_corners(),
            contact_deg: CONTACT.map(f64::to_degrees),
            overlap: overlap(&sheet, &q),
            stretch: spans.map(|span| span.stretch(theta)),
            spans,
            panel_corners,
            q,
        })
    }
}

impl fmt::Display for DeploymentListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [touching, closed] = self.contact_deg;
        writeln!(
            f,
            "opening  {:>10.2} deg (contact at {touching} and {closed})",
            self.theta_deg
        )?;
        writeln!(f, "overlap  {:>10.1e} of a panel", self.overlap)?;
        for (i, name) in ["across columns", "across rows"].into_iter().enumerate() {
            let (stretch, span) = (self.stretch[i], self.spans[i]);
            let theta = span.theta_max.to_degrees();
            let max = span.lambda_max;
            writeln!(
                f,
                "{name:<15} lambda {stretch:.4}, maximum {max:.4} at {theta:.1} deg"
            )?;
        }
        Ok(())
    }
}
