//! The residuals of one measured sheet: of its points at full load and of its readings, over their standard errors.

use crate::analysis::answers::Answers;
use crate::analysis::data_error::DataError;
use crate::analysis::measured_sheet::{MeasuredSheet, MeasurementError};
use crate::analysis::measurements::{Measurements, PointData};
use crate::analysis::real_sheet::{ReadingPlan, RealSheet};
use crate::analysis::shape_path::ShapePath;
use crate::geometry::plane::{complex, point};
use crate::geometry::similarity::{Pair, Similarity};
use crate::objective::design_problem::DesignProblem;
use crate::sheet::deviation::Deviation;

/// A sheet that was cut and measured.
#[derive(Clone, Copy)]
pub struct CutAndMeasured<'a> {
    /// Its design problem.
    pub problem: &'a DesignProblem,
    /// The sheet of the drawing.
    pub sheet: &'a RealSheet<'a>,
    /// The measurements.
    pub data: &'a Measurements,
}

/// Residuals over their standard errors, of the points and of the readings.
pub(super) type Residuals = [Vec<f64>; 2];

/// The residuals of a sheet as functions of its deviation.
pub(super) struct SheetResiduals<'a> {
    of: CutAndMeasured<'a>,
    /// The parts of the readings and, for points, full load.
    plan: ReadingPlan,
    answers: Option<Answers>,
}

impl<'a> SheetResiduals<'a> {
    /// The residuals; an error if the measurements are not those of the sheet.
    pub fn new(of: CutAndMeasured<'a>) -> Result<Self, DataError> {
        let CutAndMeasured {
            problem,
            sheet,
            data,
        } = of;
        if data.points.is_none() && data.loads.is_none() {
            return Err(DataError::NoData);
        }
        let answers = (data.loads.as_ref())
            .map(|loads| Answers::new(problem, sheet, loads))
            .transpose()?;
        let mut parts = (answers.as_ref()).map_or(Vec::new(), |answers| answers.parts.clone());
        // Points are at full load.
        if data.points.is_some() && parts.last() != Some(&1.0) {
            parts.push(1.0);
        }
        let plan = sheet.reading_plan(&parts)?;
        if let Some(answers) = &answers {
            answers.check(plan.drawn.as_ref().ok_or(DataError::NothingMoves)?)?;
        }
        if let Some(points) = &data.points {
            let (deployment, _) = sheet.deployed(&Deviation::default())?;
            let path = ShapePath::new(problem, &deployment);
            MeasuredSheet::new(&path, &points.points, points.scale)?;
        }
        Ok(Self { of, plan, answers })
    }

    /// All points are used, at any deviation.
    pub fn keep(&mut self, _: &Deviation) -> Result<bool, DataError> {
        Ok(false)
    }

    /// The residuals over the stated standard errors.
    pub fn at(&self, deviation: &Deviation) -> Result<Residuals, DataError> {
        let mut residuals = Residuals::default();
        let read = self.of.sheet.read(&self.plan, deviation)?;
        if let (Some(data), Some(full)) = (self.points(), read.steps.last()) {
            let pairs: Vec<Pair> = (data.points.iter())
                .map(|point| {
                    let predicted = point.mark.deployed(&read.sheet, &full.configuration);
                    [complex(predicted), complex(point.position)]
                })
                .collect();
            let motion = Similarity::least_squares(&pairs, data.scale);
            let motion = motion.ok_or(MeasurementError::Coincide)?;
            residuals[0] = (pairs.iter())
                .flat_map(|[predicted, measured]| {
                    point(motion.back(*measured) - predicted).map(|x| x / data.error)
                })
                .collect();
        }
        if let Some(answers) = &self.answers {
            residuals[1] = answers.residuals(&read.curve.ok_or(DataError::NothingMoves)?);
        }
        Ok(residuals)
    }

    /// Number of unknowns of the measurement alone: the rigid motion of the points, the zero of the readings.
    pub fn own_unknowns(&self) -> [f64; 2] {
        [
            self.points().map_or(0.0, |data| data.scale.unknowns()),
            self.answers.as_ref().map_or(0.0, Answers::zeros),
        ]
    }

    /// Standard errors as they were stated: of a point (mm), and of a reading relative to the largest.
    pub fn stated_errors(&self) -> [Option<f64>; 2] {
        let loads = self.of.data.loads.as_ref();
        [
            self.points().map(|data| data.error),
            loads.map(|data| data.error),
        ]
    }

    /// Number of points that are left out.
    pub fn outliers(&self) -> usize {
        0
    }

    fn points(&self) -> Option<&'a PointData> {
        self.of.data.points.as_ref()
    }
}
