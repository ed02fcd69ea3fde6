//! The flat sheet in numbers.

use design::objective::design_problem::{DesignError, DesignProblem};
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::CutPattern;
use design::pattern::design_vector::DesignVector;
use design::pattern::grid::Endpoint;
use design::sheet::cut_sheet::Hinge;
use design::sheet::opening_limits::Span;
use design::sheet::validity::Validity;
use serde::Serialize;
use std::fmt;

/// Pattern, panels and hinges of a design.
#[derive(Clone, Debug, Serialize)]
pub struct PatternListing {
    /// Number of columns, panels along x.
    #[serde(rename = "M")]
    pub m: usize,
    /// Number of rows, panels along y.
    #[serde(rename = "N")]
    pub n: usize,
    /// Corners SW, SE, NE, NW of the outline (mm).
    pub outline_corners: [[f64; 2]; 4],
    /// z and ell.
    #[serde(flatten)]
    pub coordinates: PatternCoordinates,
    /// Void aspect ratios of the interior cuts, row by row.
    pub r: Vec<f64>,
    /// Boundary positions on the edges bottom, right, top, left, as fractions of the edge.
    pub tau: [Vec<f64>; 4],
    /// x_ij of every vertex, row by row (mm).
    pub points_x: Vec<[f64; 2]>,
    /// x'_ij of every vertex, row by row (mm).
    pub points_xp: Vec<[f64; 2]>,
    /// Corners SW, SE, NE, NW of every panel (mm).
    pub panel_corners: Vec<[[f64; 2]; 4]>,
    /// Area of every panel (mm^2).
    pub panel_area: Vec<f64>,
    /// Reference point of the rotation of every panel (mm).
    pub panel_centroid: Vec<[f64; 2]>,
    /// All hinges, ordered by vertex, row by row; at each vertex x before x'.
    pub hinges: Vec<HingeListing>,
    /// The sides r L and (1 - r) L of the void of every interior cut (mm).
    pub void_sides: Vec<[f64; 2]>,
    /// Measures of whether the sheet can be cut and modelled.
    pub validity: Validity,
    /// Spans across the columns and across the rows.
    pub spans: [Span; 2],
}

/// A hinge in the flat sheet; the frame is (e_sec, its counter-clockwise normal).
#[derive(Clone, Debug, Serialize)]
pub struct HingeListing {
    /// Panel A.
    pub k: usize,
    /// Panel B.
    pub l: usize,
    /// Corner of panel A at the hinge, counter-clockwise from the south-west.
    pub corner_k: usize,
    /// Corner of panel B at the hinge, counter-clockwise from the south-west.
    pub corner_l: usize,
    /// The vertex (i, j) of the secondary cut.
    pub vertex: [usize; 2],
    /// The endpoint of the secondary cut at the hinge: `x` or `x'`.
    pub endpoint: &'static str,
    /// The ideal corner, shared by the two panels (mm).
    pub position: [f64; 2],
    /// The tip O of the main cut (mm).
    pub tip: [f64; 2],
    /// Unit vector along the secondary cut.
    pub e_sec: [f64; 2],
    /// Unit vector from the corner along the main cut.
    pub m_hat: [f64; 2],
    /// Angle between the cuts, measured into the material (rad).
    pub alpha: f64,
    /// Ligament width (mm).
    pub w_lig: f64,
}

impl PatternListing {
    /// Cuts a design and lists its flat sheet.
    pub fn new(problem: &DesignProblem, design: &DesignVector) -> Result<Self, DesignError> {
        let (pattern, sheet) = problem.cut(design)?;
        let side = |endpoint: fn(&CutPattern, usize, usize) -> [f64; 2]| {
            let vertices = pattern.grid.vertices();
            vertices.map(|(i, j)| endpoint(&pattern, i, j)).collect()
        };
        Ok(Self {
            m: pattern.grid.m,
            n: pattern.grid.n,
            outline_corners: pattern.outline.corners,
            coordinates: design.pattern.clone(),
            points_x: side(CutPattern::x),
            points_xp: side(CutPattern::x_prime),
            panel_corners: sheet.panels.iter().map(|panel| panel.corners).collect(),
            panel_area: sheet.panels.iter().map(|panel| panel.area).collect(),
            panel_centroid: sheet.panels.iter().map(|panel| panel.centroid).collect(),
            hinges: sheet.hinges.iter().map(HingeListing::new).collect(),
            void_sides: pattern.void_sides(),
            validity: Validity::new(&pattern, &sheet, problem.model.domain()),
            spans: Span::of_sheet(&sheet),
            r: pattern.r,
            tau: pattern.tau,
        })
    }
}

impl HingeListing {
    fn new(hinge: &Hinge) -> Self {
        let site = hinge.site;
        Self {
            k: site.a.0,
            l: site.b.0,
            corner_k: site.a.1,
            corner_l: site.b.1,
            vertex: site.vertex,
            endpoint: match site.endpoint {
                Endpoint::X => "x",
                Endpoint::XPrime => "x'",
            },
            position: hinge.corner,
            tip: hinge.tip,
            e_sec: hinge.e_sec,
            m_hat: hinge.main,
            alpha: hinge.alpha,
            w_lig: hinge.w_lig,
        }
    }
}

impl fmt::Display for PatternListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
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
        } = self.validity;
        let (panels, hinges) = (self.panel_area.len(), self.hinges.len());
        writeln!(
            f,
            "{} x {} panels ({panels}), {hinges} hinges",
            self.m, self.n
        )?;
        writeln!(f, "min. panel area      {least_panel_area:>12.4} mm^2")?;
        writeln!(f, "area error           {area_error:>12.1e}")?;
        writeln!(f, "overlap              {overlap:>12.1e} of a panel")?;
        writeln!(f, "min. void side       {least_void_side:>12.4} mm")?;
        writeln!(
            f,
            "min. hinge spacing   {least_hinge_spacing:>12.4} mm (windows: 2 x {r_win} mm; \
             {crowded_hinges} of {hinges} hinges closer)"
        )?;
        write!(f, "cut angles           {min:>12.1} to {max:.1} deg")?;
        match trained_alpha_deg {
            Some([min, max]) => writeln!(
                f,
                " (trained on {min:.1} to {max:.1}; {untrained_hinges} of {hinges} hinges \
                 outside in angle or width)"
            )?,
            None => writeln!(f)?,
        }
        for (name, span) in std::iter::zip(["across columns", "across rows"], &self.spans) {
            let (lambda, theta) = (span.lambda_max, span.theta_max.to_degrees());
            writeln!(f, "{name:<20} {lambda:>12.4} lambda_max at {theta:.1} deg")?;
        }
        Ok(())
    }
}
