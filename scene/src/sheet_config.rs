//! The flat sheet of a scene: outline, panels, ligaments, and the start pattern of the search.

use design::pattern::coordinates::{PatternCoordinates, logistic, partial_sums};
use design::pattern::cut_pattern::Outline;
use design::pattern::grid::Grid;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The flat sheet: a rectangle with a corner at the origin, or any convex quadrilateral, cut into
/// `panels` = [columns M, rows N].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SheetConfig {
    /// Sides [along x, along y] of a rectangle (mm).
    #[schemars(inner(range(min = 20.0, max = 2e4)))]
    pub size: Option<[f64; 2]>,
    /// Corners SW, SE, NE, NW of a convex quadrilateral (mm), instead of `size`.
    pub corners: Option<[[f64; 2]; 4]>,
    /// [columns M, rows N]; at most 100 000 panels.
    #[schemars(inner(range(min = 2, max = 50_000)))]
    pub panels: [usize; 2],
}

/// The ligament widths: their start value, and the interval of their chart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LigamentConfig {
    /// Start width of every hinge (mm), strictly inside `range`.
    pub start: f64,
    /// [w_minus, w_plus] of the chart (mm), 0.5 <= w_minus < w_plus <= 500.
    pub range: [f64; 2],
}

/// The start of the search. Omitted values are uniform.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StartConfig {
    /// Void aspect ratios of the interior cuts, row by row, each in (0, 1).
    pub r: Option<Vec<f64>>,
    /// Boundary positions on the edges bottom, right, top, left, increasing in (0, 1).
    pub tau: Option<[Vec<f64>; 4]>,
    /// Width of each hinge (mm), strictly inside `ligament.range`, instead of `ligament.start`.
    pub w_lig: Option<Vec<f64>>,
}

impl SheetConfig {
    /// Numbers of panels.
    pub fn grid(&self) -> Grid {
        let [m, n] = self.panels;
        Grid { m, n }
    }

    /// The outline; a rectangle of size zero if the section gives none.
    pub fn outline(&self) -> Outline {
        let [width, height] = self.size.unwrap_or_default();
        self.corners.map_or(Outline::rectangle(width, height), |corners| Outline { corners })
    }

    /// Area of the sheet divided by the number of panels (mm^2).
    pub fn mean_panel_area(&self) -> f64 {
        self.outline().area() / self.grid().panel_count() as f64
    }
}

impl StartConfig {
    /// The start at a pattern with the given ligament widths (mm).
    pub fn at(pattern: &PatternCoordinates, w_lig: Vec<f64>) -> Self {
        Self {
            r: Some(pattern.z.iter().map(|z| logistic(*z)).collect()),
            tau: Some(pattern.ell.each_ref().map(|ell| partial_sums(ell))),
            w_lig: Some(w_lig),
        }
    }

    /// The start pattern of the search.
    pub fn pattern(&self, grid: Grid) -> Result<PatternCoordinates, support::Fault> {
        let uniform = PatternCoordinates::uniform(grid);
        let start = PatternCoordinates {
            z: match &self.r {
                Some(r) => PatternCoordinates::z_of(r)?,
                None => uniform.z,
            },
            ell: match &self.tau {
                Some(tau) => PatternCoordinates::ell_of(tau)?,
                None => uniform.ell,
            },
        };
        start.check(grid)?;
        Ok(start)
    }
}
