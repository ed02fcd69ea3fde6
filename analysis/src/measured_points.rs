//! Points of the panels that can be measured on a deployed sheet.

use design::geometry::polygon::distance;
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::deployed;
use serde::Serialize;
use support::Point;

/// A point of a panel that can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, derive_more::Display)]
#[display("P{panel} {}", corner.map_or("centre".into(), |corner| format!("corner {corner}")))]
pub struct Mark {
    /// Number of the panel, row by row from the lower left.
    pub panel: usize,
    /// 0, 1, 2, 3: SW, SE, NE, NW in the flat sheet; `None` for the centroid of the panel.
    pub corner: Option<usize>,
}

/// A mark and its measured position.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredPoint {
    /// What was measured.
    pub mark: Mark,
    /// Its position in the frame of the measurement.
    pub position: Point,
}

/// A measured point and its prediction, both in the frame of the design (mm).
#[derive(Clone, Copy, Debug)]
pub struct FittedPoint {
    /// What was measured.
    pub mark: Mark,
    /// The measurement, moved into the frame of the design.
    pub measured: Point,
    /// The position of the mark on the path.
    pub predicted: Point,
}

impl Mark {
    /// All marks of a sheet: the corners of every panel, then its centre.
    pub fn all(sheet: &Sheet) -> impl Iterator<Item = Self> {
        sheet.panels.iter().enumerate().flat_map(|(panel, of)| {
            let corners = (0..4).filter(|corner| of.has_corner(*corner)).map(Some);
            corners.chain([None]).map(move |corner| Self { panel, corner })
        })
    }

    /// Its position in the flat sheet (mm).
    pub fn flat(self, sheet: &Sheet) -> Point {
        let panel = &sheet.panels[self.panel];
        self.corner.map_or(panel.centroid, |corner| panel.corners[corner])
    }

    /// Its position in a deployed sheet (mm).
    pub fn deployed(self, sheet: &Sheet, configuration: &[[f64; 3]]) -> Point {
        let (panel, motion) = (&sheet.panels[self.panel], configuration[self.panel]);
        deployed(panel, motion, self.flat(sheet))
    }
}

impl FittedPoint {
    /// Measured minus predicted position (mm).
    pub fn residual(&self) -> Point {
        [0, 1].map(|axis| self.measured[axis] - self.predicted[axis])
    }

    /// Distance of the measured from the predicted position (mm).
    pub fn distance(&self) -> f64 {
        distance(self.predicted, self.measured)
    }
}
