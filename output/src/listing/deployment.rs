//! The ideal deployment in numbers.

use crate::listing::Listing;
use design::{
    objective::design_problem::{DesignError, DesignProblem},
    pattern::design_vector::DesignVector,
    sheet::{
        ideal_deployment::{check_opening, ideal_deployment},
        kinematics::{deployed_corners, hinge_deformations},
        opening_limits::{CONTACT, Span},
        validity::overlap,
    },
};
use serde_json::json;
use support::table::Table;

/// Lists the sheet with the same opening angle `theta` (rad) at every hinge; panel 0 keeps its
/// centroid.
pub fn deployment(
    problem: &DesignProblem,
    design: &DesignVector,
    theta: f64,
) -> Result<Listing, DesignError> {
    check_opening(theta)?;
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
        // (panel, corner) on the outline, counter-clockwise from the south-west, and their deployed
        // positions (mm).
        "outline_panel_corner": outline,
        "outline_vertices": outline.iter().map(|&(k, c)| panel_corners[k][c]).collect::<Vec<_>>(),
        // The outline corners that belong to no hinge.
        "outline_free_panel_corner": sheet.free_outline_corners(),
        // Opening angles at which panels touch (deg).
        "contact_deg": [touching, closed],
        // Maximum overlap of two panels, relative to the mean panel area.
        "overlap": overlap,
        // lambda of (6), and distances of panels as functions of the opening, across the columns
        // and across the rows.
        "stretch": stretch,
        "spans": spans,
    });
    let mut table = Table::new(["", "", ""]).left(&[0, 2]);
    let contact = format!("contact at {touching} and {closed}");
    table.row(["opening, deg", &format!("{:.2}", theta.to_degrees()), &contact]);
    table.row(["overlap", &format!("{overlap:.1e}"), "of a panel"]);
    for (i, name) in ["lambda across columns", "lambda across rows"].into_iter().enumerate() {
        let (stretch, span) = (stretch[i], spans[i]);
        let (theta, most) = (span.theta_max.to_degrees(), span.lambda_max);
        let most = format!("at most {most:.4}, at {theta:.1} deg");
        table.row([name, &format!("{stretch:.4}"), &most]);
    }
    Ok(Listing { numbers, document: table.into() })
}
