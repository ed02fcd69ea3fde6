//! Measurements on a cut sheet that is computed, for tests and to plan real ones.

use crate::analysis::marks::{Mark, MeasuredPoint};
use crate::analysis::measurements::{LoadData, Measurements, PointData};
use crate::analysis::real_sheet::RealSheet;
use crate::geometry::similarity::Scale;
use crate::objective::design_problem::DesignError;
use crate::sheet::deviation::Deviation;
use rand::{Rng, RngExt};
use support::statistics::normal;

/// The standard errors of measurements.
#[derive(Clone, Copy, Debug)]
pub struct StandardErrors {
    /// Of one coordinate of a point (mm).
    pub point: f64,
    /// Of what the sheet answers with, load or displacement, relative to the largest.
    pub reading: f64,
}

/// `count` equal parts of an actuation, to 1.
pub fn equal_parts(count: u32) -> Vec<f64> {
    (1..=count)
        .map(|i| f64::from(i) / f64::from(count))
        .collect()
}

impl Measurements {
    /// All corners of a cut sheet at full load and, if something moves it, displacements and loads at parts of its actuation, which
    /// ascend to 1, exact.
    pub fn exact(
        sheet: &RealSheet,
        cut: &Deviation,
        parts: &[f64],
        errors: StandardErrors,
    ) -> Result<Self, DesignError> {
        let read = sheet.read(&sheet.reading_plan(parts)?, cut)?;
        let configuration = read.steps.last().map(|full| &full.configuration);
        let corners = Mark::all(&read.sheet).filter(|mark| mark.corner.is_some());
        let points = configuration.map(|configuration| PointData {
            points: corners
                .map(|mark| MeasuredPoint {
                    mark,
                    position: mark.deployed(&read.sheet, configuration),
                })
                .collect(),
            scale: Scale::Given,
            error: errors.point,
        });
        Ok(Self {
            points,
            loads: read.curve.map(|curve| LoadData {
                readings: curve.from_before_loads().collect(),
                translational: curve.translational,
                error: errors.reading,
                from_reading: false,
            }),
        })
    }

    /// The same with independent normal errors of the stated size: of the points, of what the sheet answers with, and of the reading
    /// that the displacements count from.
    #[must_use]
    pub fn with_errors(mut self, sheet: &RealSheet, random: &mut impl Rng) -> Self {
        let mut error = || normal([random.random(), random.random()]);
        if let Some(data) = &mut self.points {
            for point in &mut data.points {
                point.position = point.position.map(|x| x + data.error * error());
            }
        }
        if let Some(data) = &mut self.loads {
            let answer = sheet.answer();
            let sizes = data.readings.iter().map(|reading| reading[answer].abs());
            let size = data.error * sizes.fold(0.0, f64::max);
            let shared = if data.from_reading { error() } else { 0.0 };
            for reading in &mut data.readings {
                reading[answer] += size * (error() - shared);
            }
        }
        self
    }
}
