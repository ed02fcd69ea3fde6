//! Readings of displacement and load beside the curve of a sheet: one of the two is prescribed, the other is its answer.

use crate::analysis::actuation_curve::ActuationCurve;
use crate::analysis::data_error::{DataError, ReadingFault};
use crate::analysis::measurements::LoadData;
use crate::analysis::real_sheet::RealSheet;
use crate::objective::design_problem::{DesignError, DesignProblem};

/// Ratio of the largest measured answer and the predicted one, and its reciprocal, beyond which a reading is a mistake: a plate whose
/// ligaments of 2 mm are 0.3 mm narrower has half the load.
const IMPLAUSIBLE: f64 = 5.0;
/// By how much a reading may be beyond full load, where it counts as full load.
const FULL: f64 = 0.02;
/// The columns of a reading.
const WHAT: [&str; 2] = ["displacement", "load"];

/// The readings, divided into what is prescribed and the answer of the sheet.
pub(super) struct Answers {
    /// Parts of the actuation, in ascending order.
    pub parts: Vec<f64>,
    /// Which of displacement and load the sheet answers with.
    answer: usize,
    answers: Vec<f64>,
    /// Standard error of an answer.
    error: f64,
    /// Whether the answers count from a reading with an error of its own.
    floating: bool,
    unit: &'static str,
    /// Whether the other column could be what is prescribed.
    swapped: bool,
}

impl Answers {
    pub fn new(
        problem: &DesignProblem,
        sheet: &RealSheet,
        data: &LoadData,
    ) -> Result<Self, DataError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let curve = ActuationCurve::new(mechanics, sheet.designed());
        let curve = curve.ok_or(DataError::NothingMoves)?;
        if curve.translational != data.translational {
            return Err(DataError::OtherUnits(if curve.translational {
                "forces or translations: write displacement_mm and load_N or mass_g"
            } else {
                "couples or rotations: write displacement_deg and load_Nmm"
            }));
        }
        let full = curve
            .from_before_loads()
            .last()
            .ok_or(DataError::NothingMoves)?;
        let units = curve.units();
        let answer = sheet.answer();
        let given = 1 - answer;
        let is_part = |part: &f64| *part > 0.0 && *part <= 1.0 + FULL;
        let parts: Vec<f64> = (data.readings.iter())
            .map(|reading| reading[given] / full[given])
            .collect();
        let other = |reading: &[f64; 2]| is_part(&(reading[1 - given] / full[given]));
        let swapped = data.readings.iter().all(other);
        if let Some(index) = parts.iter().position(|part| !is_part(part)) {
            let fault = ReadingFault::OutOfRange {
                what: WHAT[given],
                unit: units[given],
                value: data.readings[index][given],
                full: full[given],
                swapped,
            };
            return Err(DataError::Reading { index, fault });
        }
        // A reading at full load is never quite at it.
        let parts: Vec<f64> = parts.into_iter().map(|part| part.min(1.0)).collect();
        if let Some(index) = parts.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(DataError::Reading {
                index: index + 1,
                fault: ReadingFault::NotAscending,
            });
        }
        let answers: Vec<f64> = data
            .readings
            .iter()
            .map(|reading| reading[answer])
            .collect();
        let largest = answers.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        Ok(Self {
            parts,
            answer,
            answers,
            error: data.error * largest,
            floating: data.from_reading && answer == 0,
            unit: units[answer],
            swapped,
        })
    }

    /// The largest answer must be like that of the drawing's sheet.
    pub fn check(&self, drawn: &ActuationCurve) -> Result<(), DataError> {
        let sizes = self.answers.iter().map(|value| value.abs());
        let index = sizes
            .enumerate()
            .max_by(|one, other| one.1.total_cmp(&other.1));
        let Some((index, _)) = index else {
            return Ok(());
        };
        let predicted = (drawn.from_before_loads())
            .nth(index)
            .ok_or(DataError::NothingMoves)?;
        let (value, predicted) = (self.answers[index], predicted[self.answer]);
        let ratio = value / predicted;
        if !(ratio > IMPLAUSIBLE.recip() && ratio < IMPLAUSIBLE) {
            let fault = ReadingFault::Implausible {
                what: WHAT[self.answer],
                unit: self.unit,
                value,
                predicted,
                swapped: self.swapped,
            };
            return Err(DataError::Reading { index, fault });
        }
        Ok(())
    }

    /// The residuals over their standard error, of a sheet with a curve. Answers that count from a reading have a mean residual of
    /// zero with it, as the zero of the scale is fitted.
    pub fn residuals(&self, curve: &ActuationCurve) -> Vec<f64> {
        let found = curve.from_before_loads().map(|point| point[self.answer]);
        let of_answers = std::iter::zip(&self.answers, found)
            .map(|(measured, found)| (measured - found) / self.error);
        let zero = self.floating.then_some(0.0);
        let mut residuals: Vec<f64> = zero.into_iter().chain(of_answers).collect();
        if self.floating {
            let mean = residuals.iter().sum::<f64>() / residuals.len() as f64;
            residuals.iter_mut().for_each(|residual| *residual -= mean);
        }
        residuals
    }

    /// Number of fitted zeros.
    pub fn zeros(&self) -> f64 {
        f64::from(u8::from(self.floating))
    }
}
