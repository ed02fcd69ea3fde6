//! The flat sheet in numbers.

use crate::listing::Listing;
use design::{
    objective::design_problem::{DesignError, DesignProblem},
    pattern::{design_vector::DesignVector, grid::Endpoint},
    sheet::{cut_sheet::Hinge, opening_limits::Span, validity::Validity},
};
use serde_json::{Value, json};
use support::{document::Document, table::Table};

/// Cuts a design and lists pattern, panels and hinges of its flat sheet.
pub fn pattern(problem: &DesignProblem, design: &DesignVector) -> Result<Listing, DesignError> {
    let (pattern, sheet) = problem.cut(design)?;
    let validity = Validity::new(&pattern, &sheet, problem.model.domain());
    let spans = Span::of_sheet(&sheet);
    let vertices = || pattern.grid.vertices();
    let panels = || sheet.panels.iter();
    let numbers = json!({
        // Number of columns, panels along x, and of rows.
        "M": pattern.grid.m,
        "N": pattern.grid.n,
        // Corners SW, SE, NE, NW (mm).
        "outline_corners": pattern.outline.corners,
        "z": design.pattern.z,
        "ell": design.pattern.ell,
        // Void aspect ratios of the interior cuts, row by row.
        "r": pattern.r,
        // Boundary positions on the edges bottom, right, top, left, as fractions of the edge.
        "tau": pattern.tau,
        // x_ij and x'_ij of every vertex, row by row (mm).
        "points_x": vertices().map(|(i, j)| pattern.x(i, j)).collect::<Vec<_>>(),
        "points_xp": vertices().map(|(i, j)| pattern.x_prime(i, j)).collect::<Vec<_>>(),
        // Corners SW, SE, NE, NW (mm), area (mm^2) and reference point of the rotation (mm) of
        // every panel.
        "panel_corners": panels().map(|panel| panel.corners).collect::<Vec<_>>(),
        "panel_area": panels().map(|panel| panel.area).collect::<Vec<_>>(),
        "panel_centroid": panels().map(|panel| panel.centroid).collect::<Vec<_>>(),
        // Ordered by vertex, row by row; at each vertex x before x'.
        "hinges": sheet.hinges.iter().map(hinge).collect::<Vec<_>>(),
        // The sides r L and (1 - r) L of the void of every interior cut (mm).
        "void_sides": pattern.void_sides(),
        // Whether the sheet can be cut and modelled.
        "validity": validity,
        // Across the columns and across the rows.
        "spans": spans,
    });
    Ok(Listing {
        numbers,
        document: document([pattern.grid.m, pattern.grid.n], sheet.hinges.len(), &validity, &spans),
    })
}

/// A hinge in the flat sheet; the frame is (e_sec, its counter-clockwise normal).
fn hinge(hinge: &Hinge) -> Value {
    let site = hinge.site;
    json!({
        // Panels A and B, and their corners at the hinge, counter-clockwise from the south-west.
        "k": site.a.0,
        "l": site.b.0,
        "corner_k": site.a.1,
        "corner_l": site.b.1,
        // The vertex (i, j) of the secondary cut, and its endpoint at the hinge.
        "vertex": site.vertex,
        "endpoint": match site.endpoint {
            Endpoint::X => "x",
            Endpoint::XPrime => "x'",
        },
        // The ideal corner, shared by the two panels, and the tip O of the main cut (mm).
        "position": hinge.corner,
        "tip": hinge.tip,
        // Unit vectors along the secondary cut, and from the corner along the main cut.
        "e_sec": hinge.e_sec,
        "m_hat": hinge.main,
        // Angle between the cuts, measured into the material (rad), and ligament width (mm).
        "alpha": hinge.alpha,
        "w_lig": hinge.w_lig,
    })
}

fn document([m, n]: [usize; 2], hinges: usize, validity: &Validity, spans: &[Span; 2]) -> Document {
    let Validity {
        least_panel_area,
        area_error,
        overlap,
        least_void_side,
        least_hinge_spacing,
        r_win,
        crowded_hinges,
        alpha_deg: [min, max],
        trained_alpha_deg,
        untrained_hinges,
    } = validity;
    let trained = trained_alpha_deg.map_or(String::new(), |[min, max]| {
        format!(
            " (trained on {min:.1} to {max:.1}; {untrained_hinges} of {hinges} hinges outside in angle or width)"
        )
    });
    let windows =
        format!("mm (windows: 2 x {r_win} mm; {crowded_hinges} of {hinges} hinges closer)");
    let mut table = Table::new(["", "", ""]).left(&[0, 2]);
    for (name, value, note) in [
        ("min. panel area", format!("{least_panel_area:.4}"), "mm^2"),
        ("area error", format!("{area_error:.1e}"), ""),
        ("overlap", format!("{overlap:.1e}"), "of a panel"),
        ("min. void side", format!("{least_void_side:.4}"), "mm"),
        ("min. hinge spacing", format!("{least_hinge_spacing:.4}"), &windows),
        ("cut angles", format!("{min:.1}"), &format!("to {max:.1} deg{trained}")),
    ] {
        table.row([name, &value, note]);
    }
    for (name, span) in
        std::iter::zip(["lambda_max across columns", "lambda_max across rows"], spans)
    {
        let at = format!("at {:.1} deg", span.theta_max.to_degrees());
        table.row([name, &format!("{:.4}", span.lambda_max), &at]);
    }
    let mut document = Document::default();
    document.text(format!("{m} x {n} panels ({}), {hinges} hinges", m * n));
    document.table(table);
    document
}
