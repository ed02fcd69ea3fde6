//! Cut patterns and flat sheets.

use crate::{
    arrays::{Argument, Array, Numbers, list, quadrilaterals, rows, shaped},
    errors,
};
use design::{
    Grid, Outline,
    pattern::{coordinates::PatternCoordinates, cut_pattern::CutPattern},
    sheet::{
        cut_sheet::{Hinge, HingePoint, SheetOptions},
        ideal_deployment::{check_opening, ideal_deployment},
        kinematics::{deployed_boundaries, deployed_corners},
    },
};
use hinge::HingeConstants;
use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::Arc;

/// A cut pattern that deploys rigidly, (2)-(5), of m x n panels.
///
/// Pattern(m, n, corners, r=None, tau=None)
///
/// corners: SW, SE, NE, NW of the outline (mm), shape (4, 2), or its (width, height), shape (2,);
/// r: void aspect ratios of the interior cuts in (0, 1), row by row, shape ((m-1)(n-1),), by
/// default 1/2; tau: positions of the cuts on the edges bottom, right, top, left as fractions of
/// the edge, shape (2(m-1) + 2(n-1),), by default evenly spaced.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Pattern(CutPattern);

/// A flat sheet: rigid panels joined by ligaments.
///
/// Sheet(pattern, w_lig, slit_width=0.2)
///
/// w_lig: ligament widths (mm), a number or an array of shape (hinges,); slit_width: width of the
/// slits (mm).
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Sheet(pub(crate) Arc<design::Sheet>);

#[pymethods]
impl Pattern {
    #[new]
    #[pyo3(signature = (m, n, corners, r=None, tau=None))]
    fn new(
        m: usize,
        n: usize,
        corners: &Argument,
        r: Option<&Argument>,
        tau: Option<&Argument>,
    ) -> PyResult<Self> {
        if m < 2 || n < 2 {
            let error = format!("a pattern has at least 2 x 2 panels, not {m} x {n}");
            return Err(PyValueError::new_err(error));
        }
        let grid = Grid { m, n };
        let given = Numbers::read(corners, "corners")?;
        let outline = match (given.shape.as_slice(), given.values.as_slice()) {
            ([2], [width, height]) => Outline::rectangle(*width, *height),
            ([4, 2], points) => {
                Outline { corners: std::array::from_fn(|k| [points[2 * k], points[2 * k + 1]]) }
            }
            _ => return Err(given.wrong_shape("(4, 2) or (2,)")),
        };
        let mut values = PatternCoordinates::uniform(grid).values();
        let interior = grid.aspect_ratio_count();
        let (ratios, positions) = values.split_at_mut(interior);
        for (part, argument, name) in [(ratios, r, "r"), (positions, tau, "tau")] {
            if let Some(argument) = argument {
                part.copy_from_slice(&shaped(argument, name, &[part.len()])?);
            }
        }
        let coordinates = PatternCoordinates::from_values(grid, &values).map_err(errors::design)?;
        Ok(Self(CutPattern::new(grid, outline, &coordinates).map_err(errors::design)?))
    }

    /// Void aspect ratios of the interior cuts, row by row.
    #[getter]
    fn r(&self) -> Array {
        list(self.0.r.clone())
    }

    /// Positions of the cuts on the edges bottom, right, top, left, as fractions of the edge.
    #[getter]
    fn tau(&self) -> Array {
        list(self.0.tau.concat())
    }

    /// Number of hinges.
    #[getter]
    fn hinges(&self) -> usize {
        self.0.grid.hinge_count()
    }

    fn __repr__(&self) -> String {
        format!("Pattern({} x {} panels)", self.0.grid.m, self.0.grid.n)
    }
}

#[pymethods]
impl Sheet {
    #[new]
    #[pyo3(signature = (pattern, w_lig, slit_width=0.2))]
    fn new(pattern: &Pattern, w_lig: &Argument, slit_width: f64) -> PyResult<Self> {
        let widths = Numbers::read(w_lig, "w_lig")?.filled(&[pattern.hinges()])?;
        let constants = HingeConstants { kerf: slit_width, ..HingeConstants::PAPER };
        let options = SheetOptions { hinge_point: HingePoint::CutTip, process: constants.into() };
        let sheet = design::Sheet::new(&pattern.0, &widths, options);
        Ok(Self(Arc::new(sheet.map_err(errors::design)?)))
    }

    /// Corners SW, SE, NE, NW of every panel (mm), row by row, shape (panels, 4, 2).
    #[getter]
    fn corners(&self) -> Array {
        let corners: Vec<_> = self.0.panels.iter().map(|panel| panel.corners).collect();
        quadrilaterals(&corners)
    }

    /// The polygons that the panels are (mm), one array of shape (points, 2) a panel: the corners of
    /// its cell, unless it is trimmed. With a configuration, the motions of the panels, deployed.
    #[pyo3(signature = (configuration=None))]
    fn boundaries(&self, configuration: Option<&Argument>) -> PyResult<Vec<Array>> {
        let shape = [self.0.panels.len(), 3];
        let read = |motions| shaped(motions, "configuration", &shape);
        let motions = configuration.map_or(Ok(vec![0.0; 3 * shape[0]]), read)?;
        let boundaries = deployed_boundaries(&self.0, motions.as_chunks().0);
        Ok(boundaries.into_iter().map(rows).collect())
    }

    /// The points of the panels whose motions are (u_x, u_y): centroids, or where a panel is held
    /// or pulled (mm), shape (panels, 2).
    #[getter]
    fn references(&self) -> Array {
        rows(self.0.panels.iter().map(|panel| panel.reference))
    }

    /// The two panels A and B of every hinge, shape (hinges, 2).
    #[getter]
    fn hinge_panels(&self) -> Vec<[usize; 2]> {
        self.0.hinges.iter().map(Hinge::panels).collect()
    }

    /// The tips O of the main cuts (mm), shape (hinges, 2).
    #[getter]
    fn tips(&self) -> Array {
        rows(self.0.hinges.iter().map(|hinge| hinge.tip))
    }

    /// Ligament widths (mm), shape (hinges,).
    #[getter]
    fn w_lig(&self) -> Array {
        list(self.0.hinges.iter().map(|hinge| hinge.w_lig).collect())
    }

    /// Cut angles alpha (rad), shape (hinges,).
    #[getter]
    fn alpha(&self) -> Array {
        list(self.0.hinges.iter().map(|hinge| hinge.alpha).collect())
    }

    /// Indices (panel, corner) of the corners on the outline, counter-clockwise, into `corners`.
    #[getter]
    fn outline(&self) -> Vec<(usize, usize)> {
        self.0.outline_corners()
    }

    /// The kinematic deployment with every hinge open by `opening` (rad): motions (u_x, u_y, phi)
    /// of the panels (mm, mm, rad), shape (panels, 3), and their corners, shape (panels, 4, 2).
    fn deploy(&self, opening: f64) -> PyResult<(Array, Array)> {
        check_opening(opening).map_err(errors::design)?;
        let configuration = ideal_deployment(&self.0, opening);
        let corners = deployed_corners(&self.0, &configuration);
        Ok((rows(configuration), quadrilaterals(&corners)))
    }

    fn __repr__(&self) -> String {
        let (panels, hinges) = (self.0.panels.len(), self.0.hinges.len());
        format!("Sheet({panels} panels, {hinges} hinges)")
    }
}
