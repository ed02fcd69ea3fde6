//! The ideal deployment in numbers.

use crate::listing::Listing;
use design::objective::design_problem::{DesignError, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::sheet::ideal_deployment::ideal_deployment;
use design::sheet::kinematics::{deployed_corners, hinge_deformations};
use design::sheet::opening_limits::{CONTACT, Span};
use design::sheet::validity::overlap;
use serde_json::json;

/// Lists the sheet with the same opening angle `theta` (rad) at every hinge; panel 0 keeps its centroid.
pub fn deployment(
    problem: &DesignProblem,
    design: &DesignVector,
    theta: f64,
) -> Result<Listing, DesignError> {
    if !theta.is_finite() {
        return Err(DesignError::Opening(theta));
    }
    let (_, sheet) = problem.cut(design)?;
    let q = ideal_deployment(&sheet, theta);
    let panel_corners = deployed_corners(&sheet, &q);
    let outline = sheet.outline_corners();
    let spans = Span::of_sheet(&sheet);
    let deformations = hinge_deformations(&sheet, &q);
    let [touching, closed] = CONTACT.map(f64::to_degrees);
    let overlap = overlap(&sheet, &q);
    let stretch = spans.map(|span| span.stretch(theta));
    let numbers = json!({
        "theta_deg": theta.to_degrees(),
        // Motion (u_x, u_y, phi) of every panel (mm, mm, rad).
        "q": q,
        // Deployed corners SW, SE, NE, NW of every panel (mm).
        "panel_corners": panel_corners,
        // (a, s, theta) of every hinge (mm, mm, rad).
        "hinge_deformation": deformations.iter().map(|eps| eps.to_array()).collect::<Vec<_>>(),
        // (panel, corner) on the outline, counter-clockwise from the south-west, and their deployed positions (mm).
        "outline_panel_corner": outline,
        "outline_vertices": outline.iter().map(|&(k, c)| panel_corners[k][c]).collect::<Vec<_>>(),
        // The outline corners that belong to no hinge.
        "outline_free_panel_corner": sheet.free_outline_corners(),
        // Opening angles at which panels touch (deg).
        "contact_deg": [touching, closed],
        // Maximum overlap of two panels, relative to the mean panel area.
        "overlap": overlap,
        // lambda of (6), and distances of panels as functions of the opening, across the columns and across the rows.
        "stretch": stretch,
        "spans": spans,
    });
    let mut text = format!(
        "opening  {:>10.2} deg (contact at {touching} and {closed})\noverlap  {overlap:>10.1e} of a panel\n",
        theta.to_degrees()
    );
    for (i, name) in ["across columns", "across rows"].into_iter().enumerate() {
        let (stretch, span) = (stretch[i], spans[i]);
        let (theta, max) = (span.theta_max.to_degrees(), span.lambda_max);
        text += &format!("{name:<15} lambda {stretch:.4}, maximum {max:.4} at {theta:.1} deg\n");
    }
    Ok(Listing { numbers, text })
}
