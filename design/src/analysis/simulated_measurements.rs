//! Measurements on a cut sheet that is computed, for tests and to plan real ones.

use crate::analysis::calibration::{LoadData, Measurements, PointData};
use crate::analysis::marks::{Mark, MeasuredPoint};
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

impl Measurements {
    /// All corners of a cut sheet at full load and, if something moves it, `readings` displacements and loads at equal parts of its
    /// actuation, exact.
    pub fn exact(
        sheet: &RealSheet,
        cut: &Deviation,
        readings: u32,
        errors: StandardErrors,
    ) -> Result<Self, DesignError> {
        let parts: Vec<f64> = (1..=readings)
            .map(|i| f64::from(i) / f64::from(readings))
            .collect();
        let read = sheet.read(&sheet.reading_plan(&parts)?, cut)?;
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
                readings: curve.points[1..].to_vec(),
                translational: curve.translational,
                error: errors.reading,
            }),
        })
    }

    /// The same with independent normal errors of the stated size: of the points, and of what the sheet answers with.
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
            for reading in &mut data.readings {
                reading[answer] += size * error();
            }
        }
        self
    }
}
