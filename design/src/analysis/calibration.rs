//! What a cut sheet is, from measurements on it: the width that the cutter removed, the thickness, the stresses of the material.
//!
//! The unknowns p of a [`Deviation`] follow from the positions of marked points at full load and from readings of displacement and
//! load on the way, by least squares through the equilibrium (Gauss-Newton with step halving; differences instead of derivatives, two
//! equilibria an unknown). Residuals r are divided by the standard errors of the measurements. What was known before, the nominal
//! values p_0 with their standard deviations s ([`Quantity::guess`]), is a measurement, too:
//!
//! ```text
//! minimise |r(p)|^2 + sum ((p - p_0) / s)^2,     Cov(p) = (J^T J + 1 / s^2)^-1,     J = dr/dp
//! ```
//!
//! Loads alone cannot tell a softer material from a thinner sheet: each then has its part of the deviation, and a standard error that
//! says so. An unknown on which the measurements do not depend keeps its nominal value. The rigid motion of the points is fitted again at
//! every p, so that it has its part in J. If the residuals of the points, or those of the readings, are larger than their standard errors
//! (reduced chi^2 > 1), the model or the stated errors are wrong: the errors of that group are then multiplied by the root of chi^2
//! (Birge's ratio), which widens the covariance.
//! (Beck and Arnold, "Parameter Estimation in Engineering and Science", 1977.)

use crate::analysis::actuation_curve::ActuationCurve;
use crate::analysis::marks::MeasuredPoint;
use crate::analysis::measured_sheet::{MeasuredSheet, MeasurementError};
use crate::analysis::real_sheet::{ReadingPlan, RealSheet};
use crate::analysis::shape_path::ShapePath;
use crate::geometry::plane::{complex, point};
use crate::geometry::similarity::{Pair, Scale, Similarity};
use crate::objective::design_problem::{DesignError, DesignProblem};
use crate::sheet::deviation::Deviation;
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use serde::Serialize;

/// Maximum number of Gauss-Newton steps.
const MOST_STEPS: usize = 20;
/// The fit has converged when a step changes no unknown by more than this part of its guess.
const CONVERGED: f64 = 1e-4;
/// Differences for the derivatives, in guesses.
const DIFFERENCE: f64 = 0.02;
/// See [`Estimate::determined`], as a standard error in guesses.
const DETERMINED: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Ratio of the largest measured answer and the predicted one, and its reciprocal, beyond which a reading is a mistake: a plate whose
/// ligaments of 2 mm are 0.3 mm narrower has half the load.
const IMPLAUSIBLE: f64 = 5.0;
/// By how much a reading may be beyond full load, where it counts as full load.
const FULL: f64 = 0.02;
/// Largest step, in guesses, that the search may leave undone because none of its parts is better.
const UNDONE: f64 = 0.01;
/// Maximum number of times that the outliers among the points are looked for.
const MOST_OUTLIER_ROUNDS: usize = 5;

/// What is calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// The width that the cutter removes (mm).
    Kerf,
    /// The thickness of the sheet (mm).
    Thickness,
    /// All stresses at equal strain, modulus and yield together, relative to the material's.
    Stress,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Kerf, Self::Thickness, Self::Stress];

    /// Standard deviation of a sheet from its data before anything is measured: of the kerf a tenth of a millimetre, of a thickness
    /// from a data sheet 5 %, of the stresses of a plastic from another batch 20 %.
    pub fn guess(self, thickness: f64) -> f64 {
        match self {
            Self::Kerf => 0.1,
            Self::Thickness => 0.05 * thickness,
            Self::Stress => 0.2,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kerf => "kerf",
            Self::Thickness => "thickness",
            Self::Stress => "stress",
        }
    }

    fn of(self, deviation: &mut Deviation) -> &mut f64 {
        match self {
            Self::Kerf => &mut deviation.kerf,
            Self::Thickness => &mut deviation.thickness,
            Self::Stress => &mut deviation.stress,
        }
    }
}

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

/// Displacements and loads read on the way, as in [`ActuationCurve`].
#[derive(Clone, Debug)]
pub struct LoadData {
    /// (displacement, load) in ascending order: mm and N, or rad and N mm.
    pub readings: Vec<[f64; 2]>,
    /// Whether they are mm and N.
    pub translational: bool,
    /// Standard error of what the sheet answers with: of the load if its motion is prescribed, of the displacement if its loads
    /// are; relative to its largest reading.
    pub error: f64,
}

/// The measurements on one sheet.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    /// Of its shape.
    pub points: Option<PointData>,
    /// Of its loads.
    pub loads: Option<LoadData>,
}

/// Why a sheet is not calibrated.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum CalibrationError {
    #[error("nothing was measured: give points, or readings of displacement and load")]
    NoData,
    #[error(
        "thickness and stress are calibrated for a learned hinge law alone: use --fit kerf, or set hinge = \"surrogate\""
    )]
    NoLearnedLaw,
    #[error("nothing moves this sheet: loads cannot be compared")]
    NothingMoves,
    #[error("this sheet is moved by {0}")]
    OtherUnits(&'static str),
    #[error(
        "readings are not compared for a sheet that hangs: its weight moves it before its loads; measure points at full load"
    )]
    Hanging,
    #[error("reading {index}: {fault}")]
    Reading { index: usize, fault: ReadingFault },
    #[error(
        "the measurements say less about every quantity than is known already: measure more points and loads, or with smaller errors"
    )]
    Undetermined,
    #[error(
        "no sheet fits: the search ends after {0} steps without a minimum; check the measurements, and that they are of this design"
    )]
    NotConverged(usize),
    #[error(transparent)]
    Points(#[from] MeasurementError),
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// Why a reading is not one of the sheet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ReadingFault {
    #[error(
        "a {what} of {value:.4} {unit} is not above 0 and at most that at full load, {full:.4} {unit}{}",
        if *.swapped { "; the columns of displacement and load seem to be swapped" } else { "" }
    )]
    OutOfRange {
        what: &'static str,
        unit: &'static str,
        value: f64,
        full: f64,
        swapped: bool,
    },
    #[error("readings are in ascending order, but this one is not above the one before it")]
    NotAscending,
    #[error(
        "a {what} of {value:.4} {unit} is {:.3} times that of the drawing's sheet, {predicted:.4} {unit}: check the units{}",
        value / predicted,
        if *.swapped { ", and whether the columns of displacement and load are swapped" } else { "" }
    )]
    Implausible {
        what: &'static str,
        unit: &'static str,
        value: f64,
        predicted: f64,
        swapped: bool,
    },
}

/// A calibrated quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Which.
    pub quantity: Quantity,
    /// Its deviation from the nominal value (mm; relative for stresses).
    pub deviation: f64,
    /// Standard deviation of that.
    pub standard_error: f64,
    /// Whether the measurements halve the variance that it had before.
    pub determined: bool,
}

/// How well one kind of measurement fits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GroupFit {
    /// Number of measured values, without outliers.
    pub values: usize,
    /// Number of points left out as outliers.
    pub outliers: usize,
    /// Root mean square of the residuals of the sheet of the drawing and of the calibrated one: mm of one coordinate, or relative
    /// to the largest reading.
    pub residual: [f64; 2],
    /// Degrees of freedom: values that the fit could have missed.
    pub free: f64,
    /// Reduced chi^2 of the calibrated sheet: that over the degrees of freedom.
    pub chi_squared: f64,
}

/// A cut sheet as it was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// All quantities that were asked for.
    pub estimates: Vec<Estimate>,
    /// Correlations of the estimates.
    pub correlations: Vec<Vec<f64>>,
    /// Fit of the points.
    pub points: Option<GroupFit>,
    /// Fit of the readings.
    pub loads: Option<GroupFit>,
    /// Number of Gauss-Newton steps.
    pub steps: usize,
}

impl Calibration {
    /// The calibrated sheet.
    pub fn deviation(&self) -> Deviation {
        let mut deviation = Deviation::default();
        for estimate in &self.estimates {
            *estimate.quantity.of(&mut deviation) = estimate.deviation;
        }
        deviation
    }
}

/// The fit of `quantities` of a sheet to measurements on it. `progress` is called after every step.
pub fn calibrate(
    problem: &DesignProblem,
    sheet: &RealSheet,
    data: &Measurements,
    quantities: &[Quantity],
    progress: &mut dyn FnMut(),
) -> Result<Calibration, CalibrationError> {
    if data.points.is_none() && data.loads.is_none() {
        return Err(CalibrationError::NoData);
    }
    let needs_law = quantities
        .iter()
        .any(|quantity| *quantity != Quantity::Kerf);
    if needs_law && !sheet.has_similar_laws() {
        return Err(CalibrationError::NoLearnedLaw);
    }
    let loads = data.loads.as_ref();
    let loads = loads
        .map(|loads| Prescribed::new(problem, sheet, loads))
        .transpose()?;
    let mut parts = loads
        .as_ref()
        .map_or(Vec::new(), |loads| loads.parts.clone());
    if parts.last() != Some(&1.0) {
        parts.push(1.0);
    }
    // Points are at full load.
    let plan = sheet.reading_plan(&parts)?;
    if let Some(loads) = &loads {
        let drawn = plan.drawn.as_ref();
        loads.check(&drawn.ok_or(CalibrationError::NothingMoves)?.points[1..])?;
    }
    let mut fit = Fit {
        problem,
        sheet,
        thickness: sheet.thickness(),
        plan,
        data,
        loads,
        kept: Vec::new(),
        factors: [1.0; 2],
    };
    fit.run(quantities, progress)
}

/// The columns of a reading.
const WHAT: [&str; 2] = ["displacement", "load"];

/// The readings, divided into what is prescribed and the answer of the sheet.
struct Prescribed {
    /// Parts of the actuation.
    parts: Vec<f64>,
    /// Which of displacement and load the sheet answers with.
    answer: usize,
    answers: Vec<f64>,
    /// Standard error of an answer.
    error: f64,
    largest: f64,
    unit: &'static str,
    /// Whether the other column could be what is prescribed.
    swapped: bool,
}

impl Prescribed {
    fn new(
        problem: &DesignProblem,
        sheet: &RealSheet,
        data: &LoadData,
    ) -> Result<Self, CalibrationError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        if mechanics.solver.weight() != [0.0; 2] {
            return Err(CalibrationError::Hanging);
        }
        let curve = ActuationCurve::new(mechanics, sheet.designed());
        let curve = curve.ok_or(CalibrationError::NothingMoves)?;
        if curve.translational != data.translational {
            return Err(CalibrationError::OtherUnits(if curve.translational {
                "forces or translations: write displacement_mm and load_N or mass_g"
            } else {
                "couples or rotations: write displacement_deg and load_Nmm"
            }));
        }
        let full = *curve.points.last().ok_or(CalibrationError::NothingMoves)?;
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
            return Err(CalibrationError::Reading { index, fault });
        }
        // A reading at full load is never quite at it.
        let parts: Vec<f64> = parts.into_iter().map(|part| part.min(1.0)).collect();
        if let Some(index) = parts.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(CalibrationError::Reading {
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
            largest,
            unit: units[answer],
            swapped,
        })
    }

    /// The largest answer must be like that of the drawing's sheet.
    fn check(&self, predicted: &[[f64; 2]]) -> Result<(), CalibrationError> {
        let sizes = self.answers.iter().map(|value| value.abs());
        let index = sizes
            .enumerate()
            .max_by(|one, other| one.1.total_cmp(&other.1));
        let Some((index, _)) = index else {
            return Ok(());
        };
        let (value, predicted) = (self.answers[index], predicted[index][self.answer]);
        let ratio = value / predicted;
        if !(ratio > IMPLAUSIBLE.recip() && ratio < IMPLAUSIBLE) {
            let fault = ReadingFault::Implausible {
                what: WHAT[self.answer],
                unit: self.unit,
                value,
                predicted,
                swapped: self.swapped,
            };
            return Err(CalibrationError::Reading { index, fault });
        }
        Ok(())
    }
}

struct Fit<'a> {
    problem: &'a DesignProblem,
    sheet: &'a RealSheet<'a>,
    thickness: f64,
    /// The parts of the readings and full load.
    plan: ReadingPlan,
    data: &'a Measurements,
    loads: Option<Prescribed>,
    /// The points that are no outliers.
    kept: Vec<MeasuredPoint>,
    /// By which the standard errors of points and readings are multiplied.
    factors: [f64; 2],
}

/// Residuals over their standard errors, of the points and of the readings.
type Residuals = [Vec<f64>; 2];

impl Fit<'_> {
    fn run(
        &mut self,
        quantities: &[Quantity],
        progress: &mut dyn FnMut(),
    ) -> Result<Calibration, CalibrationError> {
        let mut steps = 0;
        let mut fitted = Deviation::default();
        self.keep(&fitted)?;
        for _ in 0..MOST_OUTLIER_ROUNDS {
            fitted = self.minimise(quantities, fitted, &mut steps, progress)?;
            let before = self.kept.clone();
            self.keep(&fitted)?;
            if self.kept == before {
                break;
            }
        }
        let freedom = self.freedom(&self.jacobian(quantities, &fitted)?);
        let chi_squared = chi_squared(&self.residuals(&fitted)?, freedom);
        self.factors = chi_squared.map(|chi_squared| chi_squared.sqrt().max(1.0));
        if self.factors != [1.0; 2] {
            fitted = self.minimise(quantities, fitted, &mut steps, progress)?;
        }
        let found = self.calibration(quantities, &fitted, steps)?;
        if found.estimates.iter().any(|estimate| estimate.determined) {
            Ok(found)
        } else {
            Err(CalibrationError::Undetermined)
        }
    }

    fn calibration(
        &self,
        free: &[Quantity],
        fitted: &Deviation,
        steps: usize,
    ) -> Result<Calibration, CalibrationError> {
        let jacobian = self.jacobian(free, fitted)?;
        let covariance = information(&jacobian).partial_piv_lu().inverse();
        let error = |i: usize| covariance[(i, i)].sqrt();
        let unknowns = free.len();
        let correlations = (0..unknowns)
            .map(|i| {
                (0..unknowns)
                    .map(|j| covariance[(i, j)] / (error(i) * error(j)))
                    .collect()
            })
            .collect();
        let estimates = (free.iter().enumerate())
            .map(|(i, quantity)| Estimate {
                quantity: *quantity,
                deviation: *quantity.of(&mut fitted.clone()),
                standard_error: error(i) * quantity.guess(self.thickness),
                determined: error(i) < DETERMINED,
            })
            .collect();
        let (before, after) = (
            self.residuals(&Deviation::default())?,
            self.residuals(fitted)?,
        );
        let freedom = self.freedom(&jacobian);
        let chi = chi_squared(&after, freedom);
        let fit = |group: usize, unit: f64| GroupFit {
            values: after[group].len(),
            outliers: 0,
            residual: [&before, &after].map(|residuals| unit * rms(&residuals[group])),
            free: freedom[group],
            chi_squared: chi[group],
        };
        Ok(Calibration {
            estimates,
            correlations,
            points: self.data.points.as_ref().map(|data| GroupFit {
                outliers: data.points.len() - self.kept.len(),
                ..fit(0, data.error)
            }),
            loads: (self.loads.as_ref()).map(|loads| fit(1, loads.error / loads.largest)),
            steps,
        })
    }

    /// Looks for outliers among the points.
    fn keep(&mut self, deviation: &Deviation) -> Result<(), CalibrationError> {
        let Some(data) = &self.data.points else {
            return Ok(());
        };
        let (deployment, _) = self.sheet.deployed(deviation)?;
        let path = ShapePath::new(self.problem, &deployment);
        let measured = MeasuredSheet::new(&path, &data.points, data.scale)?;
        self.kept = std::iter::zip(&data.points, &measured.full.points)
            .filter(|(_, fitted)| !fitted.outlier)
            .map(|(point, _)| *point)
            .collect();
        Ok(())
    }

    /// Gauss-Newton with step halving.
    fn minimise(
        &self,
        free: &[Quantity],
        mut at: Deviation,
        steps: &mut usize,
        progress: &mut dyn FnMut(),
    ) -> Result<Deviation, CalibrationError> {
        let square = |residuals: &Residuals, at: &Deviation| -> f64 {
            let measured = residuals.iter().flatten().copied();
            (measured.chain(self.guesses(free, at)))
                .map(|x| x * x)
                .sum()
        };
        let mut residuals = self.weighed(&at)?;
        for _ in 0..MOST_STEPS {
            // After a step, a sheet beside this one that cannot be computed is the fault of the measurements.
            let jacobian = self.jacobian(free, &at).map_err(|error| match error {
                CalibrationError::Design(_) if *steps > 0 => CalibrationError::NotConverged(*steps),
                error => error,
            })?;
            let step = gauss_newton(&jacobian, &residuals, &self.guesses(free, &at));
            *steps += 1;
            progress();
            let now = square(&residuals, &at);
            let mut part = 1.0;
            let (next, found) = loop {
                let next = self.moved(free, &at, |i| part * step[i]);
                match self.weighed(&next) {
                    Ok(found) if square(&found, &next) <= now => break (next, found),
                    _ if part < 1e-3 => break (at.clone(), residuals.clone()),
                    _ => part *= 0.5,
                }
            };
            let moved = step.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let stays = next == at;
            (at, residuals) = (next, found);
            if moved < CONVERGED || (stays && moved < UNDONE) {
                return Ok(at);
            }
            if stays {
                break;
            }
        }
        Err(CalibrationError::NotConverged(*steps))
    }

    /// Degrees of freedom of the points and of the readings: their values less those of the rigid motion and less the part of the
    /// unknowns that they, and not what was known before, determine: the trace of J (J^T J + 1)^-1 J^T over their rows.
    fn freedom(&self, jacobian: &Mat<f64>) -> [f64; 2] {
        let spread = jacobian * information(jacobian).partial_piv_lu().inverse();
        let of_row = |i: usize| -> f64 {
            (0..jacobian.ncols())
                .map(|k| spread[(i, k)] * jacobian[(i, k)])
                .sum()
        };
        let points = 2 * self.kept.len();
        let motion = match &self.data.points {
            Some(data) => data.scale.unknowns(),
            None => 0.0,
        };
        let rows = jacobian.nrows();
        [
            points as f64 - motion - (0..points).map(of_row).sum::<f64>(),
            (rows - points) as f64 - (points..rows).map(of_row).sum::<f64>(),
        ]
    }

    /// d(residuals) / d(unknowns), these in guesses.
    fn jacobian(&self, free: &[Quantity], at: &Deviation) -> Result<Mat<f64>, CalibrationError> {
        let columns = (0..free.len()).map(|k| {
            let side = |sign: f64| {
                let step = |i: usize| if i == k { sign * DIFFERENCE } else { 0.0 };
                self.weighed(&self.moved(free, at, step))
            };
            let (ahead, behind) = (side(1.0)?, side(-1.0)?);
            let pairs = std::iter::zip(ahead.iter().flatten(), behind.iter().flatten());
            Ok(pairs
                .map(|(ahead, behind)| (ahead - behind) / (2.0 * DIFFERENCE))
                .collect())
        });
        let columns: Vec<Vec<f64>> = columns.collect::<Result<_, CalibrationError>>()?;
        let rows = columns.first().map_or(0, Vec::len);
        Ok(Mat::from_fn(rows, free.len(), |i, k| columns[k][i]))
    }

    /// The unknowns in guesses.
    fn guesses(&self, free: &[Quantity], at: &Deviation) -> Vec<f64> {
        let guess = |quantity: &Quantity| quantity.guess(self.thickness);
        (free.iter())
            .map(|quantity| *quantity.of(&mut at.clone()) / guess(quantity))
            .collect()
    }

    /// The deviation with its unknowns moved by a step in guesses.
    fn moved(&self, free: &[Quantity], at: &Deviation, step: impl Fn(usize) -> f64) -> Deviation {
        let mut moved = at.clone();
        for (i, quantity) in free.iter().enumerate() {
            *quantity.of(&mut moved) += step(i) * quantity.guess(self.thickness);
        }
        moved
    }

    /// The residuals over the standard errors and their factors.
    fn weighed(&self, deviation: &Deviation) -> Result<Residuals, CalibrationError> {
        let [points, loads] = self.residuals(deviation)?;
        let over =
            |residuals: Vec<f64>, factor: f64| residuals.iter().map(|r| r / factor).collect();
        Ok([over(points, self.factors[0]), over(loads, self.factors[1])])
    }

    /// The residuals over the stated standard errors.
    fn residuals(&self, deviation: &Deviation) -> Result<Residuals, CalibrationError> {
        let mut residuals = Residuals::default();
        let read = self.sheet.read(&self.plan, deviation)?;
        if let (Some(data), Some(full)) = (&self.data.points, read.steps.last()) {
            let pairs: Vec<Pair> = (self.kept.iter())
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
        if let Some(loads) = &self.loads {
            let found = read.curve.ok_or(CalibrationError::NothingMoves)?;
            residuals[1] = std::iter::zip(&loads.answers, &found.points[1..])
                .map(|(measured, found)| (measured - found[loads.answer]) / loads.error)
                .collect();
        }
        Ok(residuals)
    }
}

/// Reduced chi^2 of the points and of the readings; 1 where it is not known.
fn chi_squared(residuals: &Residuals, freedom: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|group| {
        let square: f64 = residuals[group].iter().map(|r| r * r).sum();
        if freedom[group] > 0.5 {
            square / freedom[group]
        } else {
            1.0
        }
    })
}

/// J^T J + 1, the unknowns in guesses.
fn information(jacobian: &Mat<f64>) -> Mat<f64> {
    let unknowns = jacobian.ncols();
    jacobian.transpose() * jacobian + Mat::<f64>::identity(unknowns, unknowns)
}

/// The step of the unknowns, which are at `at` guesses, that reduces the sum of squares most if the residuals are linear.
fn gauss_newton(jacobian: &Mat<f64>, residuals: &Residuals, at: &[f64]) -> Vec<f64> {
    let all: Vec<f64> = residuals.iter().flatten().copied().collect();
    let downhill = Mat::from_fn(at.len(), 1, |k, _| {
        let along = (0..all.len()).map(|i| jacobian[(i, k)] * all[i]);
        -along.sum::<f64>() - at[k]
    });
    let step = information(jacobian).partial_piv_lu().solve(downhill);
    (0..at.len()).map(|k| step[(k, 0)]).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
