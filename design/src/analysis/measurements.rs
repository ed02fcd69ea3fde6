//! What is measured on a cut sheet: marked points at full load, and displacements and loads on the way.

use crate::analysis::marks::MeasuredPoint;
use crate::geometry::similarity::Scale;

/// Points measured at full load.
#[derive(Clone, Debug)]
pub struct PointData {
    /// Where they were found.
    pub points: Vec<MeasuredPoint>,
    /// Whether the scale of the measurement is known.
    pub scale: Scale,
    /// Standard error of one coordinate (mm).
    pub error: f64,
}

/// Displacements and loads read on the way, as in [`ActuationCurve`](crate::analysis::actuation_curve::ActuationCurve).
#[derive(Clone, Debug)]
pub struct LoadData {
    /// (displacement, load) in ascending order, from the sheet before its loads: mm and N, or rad and N mm.
    pub readings: Vec<[f64; 2]>,
    /// Whether they are mm and N.
    pub translational: bool,
    /// Standard error of what the sheet answers with: of the load if its motion is prescribed, of the displacement if its loads
    /// are; relative to its largest reading.
    pub error: f64,
    /// Whether the displacements count from a reading of the sheet before its loads, whose error they then share.
    pub from_reading: bool,
}

/// The measurements on one sheet.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    /// Of its shape.
    pub points: Option<PointData>,
    /// Of its loads.
    pub loads: Option<LoadData>,
}
