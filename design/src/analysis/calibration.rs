//! What cut sheets are, from measurements on them: the width that the cutter removed, the thickness, the stresses of the material. Several
//! sheets of one plate, cut by one machine, have one set of these: their residuals are stacked.
//!
//! The unknowns p of a [`Deviation`] follow from the positions of marked points at full load and from readings of displacement and
//! load on the way, by least squares through the equilibrium (Gauss-Newton with step halving; differences instead of derivatives, two
//! equilibria an unknown and a sheet). Residuals r are divided by the standard errors of the measurements. What was known before, the nominal
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

use crate::analysis::data_error::DataError;
use crate::analysis::sheet_residuals::{CutAndMeasured, Residuals, SheetResiduals};
use crate::sheet::deviation::Deviation;
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use serde::Serialize;
use support::statistics::root_mean_square;

/// Maximum number of Gauss-Newton steps.
const MOST_STEPS: usize = 20;
/// The fit has converged when a step changes no unknown by more than this part of its guess.
const CONVERGED: f64 = 1e-4;
/// Differences for the derivatives, in guesses.
const DIFFERENCE: f64 = 0.02;
/// See [`Estimate::determined`], as a standard error in guesses.
const DETERMINED: f64 = std::f64::consts::FRAC_1_SQRT_2;
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

    /// Its value in a deviation.
    pub fn of(self, deviation: &mut Deviation) -> &mut f64 {
        match self {
            Self::Kerf => &mut deviation.kerf,
            Self::Thickness => &mut deviation.thickness,
            Self::Stress => &mut deviation.stress,
        }
    }
}

/// Why sheets are not calibrated.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum CalibrationError {
    #[error(
        "thickness and stress are calibrated for a learned hinge law alone: use --fit kerf, or set hinge = \"surrogate\""
    )]
    NoLearnedLaw,
    #[error(
        "the measurements say less about every quantity than is known already: measure more points and loads, or with smaller errors"
    )]
    Undetermined,
    #[error(
        "no sheet fits: the search ends after {0} steps without a minimum; check the measurements, and that they are of this design"
    )]
    NotConverged(usize),
    #[error("{error}")]
    Data { sheet: usize, error: DataError },
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

/// Cut sheets as they were measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// All quantities that were asked for.
    pub estimates: Vec<Estimate>,
    /// What was known by itself.
    pub known: Deviation,
    /// Correlations of the estimates.
    pub correlations: Vec<Vec<f64>>,
    /// Fit of the points.
    pub points: Option<GroupFit>,
    /// Fit of the readings.
    pub loads: Option<GroupFit>,
    /// Root mean square of the residuals of every calibrated sheet, over their stated standard errors.
    pub misfits: Vec<f64>,
    /// Number of Gauss-Newton steps.
    pub steps: usize,
}

impl Calibration {
    /// The calibrated sheet.
    pub fn deviation(&self) -> Deviation {
        let mut deviation = self.known.clone();
        for estimate in &self.estimates {
            *estimate.quantity.of(&mut deviation) = estimate.deviation;
        }
        deviation
    }
}

/// The fit of `quantities` to the measurements on one or several sheets that have them in common; the other quantities deviate as
/// `known`. `progress` is called after every step.
///
/// # Panics
/// Without a sheet.
pub fn calibrate(
    sheets: &[CutAndMeasured],
    quantities: &[Quantity],
    known: &Deviation,
    progress: &mut dyn FnMut(),
) -> Result<Calibration, CalibrationError> {
    let needs_law = known.thickness != 0.0
        || known.stress != 0.0
        || (quantities.iter()).any(|quantity| *quantity != Quantity::Kerf);
    if needs_law && !sheets.iter().all(|of| of.sheet.has_similar_laws()) {
        return Err(CalibrationError::NoLearnedLaw);
    }
    let residuals = (sheets.iter().enumerate())
        .map(|(sheet, of)| SheetResiduals::new(*of).map_err(located(sheet)));
    let mut fit = Fit {
        thickness: sheets[0].sheet.thickness(),
        known,
        sheets: residuals.collect::<Result<_, _>>()?,
        factors: [1.0; 2],
    };
    fit.run(quantities, progress)
}

/// The error of the measurements on a sheet.
fn located(sheet: usize) -> impl Fn(DataError) -> CalibrationError {
    move |error| CalibrationError::Data { sheet, error }
}

struct Fit<'a> {
    sheets: Vec<SheetResiduals<'a>>,
    /// What the sheets are besides what is fitted.
    known: &'a Deviation,
    /// Nominal thickness (mm).
    thickness: f64,
    /// By which the standard errors of points and readings are multiplied.
    factors: [f64; 2],
}

impl Fit<'_> {
    fn run(
        &mut self,
        quantities: &[Quantity],
        progress: &mut dyn FnMut(),
    ) -> Result<Calibration, CalibrationError> {
        let mut steps = 0;
        let mut fitted = self.known.clone();
        for _ in 0..MOST_OUTLIER_ROUNDS {
            fitted = self.minimise(quantities, fitted, &mut steps, progress)?;
            if !self.keep(&fitted)? {
                break;
            }
        }
        let freedom = self.freedom(&fitted, &self.jacobian(quantities, &fitted)?)?;
        let chi_squared = chi_squared(&stacked(&self.residuals(&fitted)?), freedom);
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
        let by_sheet = self.residuals(fitted)?;
        let before = stacked(&self.residuals(&Deviation::default())?);
        let after = stacked(&by_sheet);
        let freedom = self.freedom(fitted, &jacobian)?;
        let chi = chi_squared(&after, freedom);
        let fit = |group: usize| {
            let stated = self.sheets.iter().find_map(|of| of.stated_errors()[group]);
            stated.map(|unit| GroupFit {
                values: after[group].len(),
                outliers: match group {
                    0 => self.sheets.iter().map(SheetResiduals::outliers).sum(),
                    _ => 0,
                },
                residual: [&before, &after]
                    .map(|residuals| unit * root_mean_square(residuals[group].iter().copied())),
                free: freedom[group],
                chi_squared: chi[group],
            })
        };
        Ok(Calibration {
            estimates,
            known: self.known.clone(),
            correlations,
            points: fit(0),
            loads: fit(1),
            misfits: by_sheet
                .iter()
                .map(|of| root_mean_square(of.concat()))
                .collect(),
            steps,
        })
    }

    /// Looks for outliers among the points of all sheets; whether there are others than before.
    fn keep(&mut self, deviation: &Deviation) -> Result<bool, CalibrationError> {
        let mut changed = false;
        for (sheet, of) in self.sheets.iter_mut().enumerate() {
            changed |= of.keep(deviation).map_err(located(sheet))?;
        }
        Ok(changed)
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
                CalibrationError::Data {
                    error: DataError::Design(_),
                    ..
                } if *steps > 0 => CalibrationError::NotConverged(*steps),
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

    /// Degrees of freedom of the points and of the readings: their values less those of the rigid motions and of the zeros of the scales
    /// and less the part of the unknowns that they, and not what was known before, determine: the trace of J (J^T J + 1)^-1 J^T over
    /// their rows.
    fn freedom(&self, at: &Deviation, jacobian: &Mat<f64>) -> Result<[f64; 2], CalibrationError> {
        let spread = jacobian * information(jacobian).partial_piv_lu().inverse();
        let of_row = |i: usize| -> f64 {
            (0..jacobian.ncols())
                .map(|k| spread[(i, k)] * jacobian[(i, k)])
                .sum()
        };
        let [points, readings] = stacked(&self.residuals(at)?).map(|group| group.len());
        let rows = [0..points, points..points + readings];
        Ok([0, 1].map(|group| {
            let own = self.sheets.iter().map(|of| of.own_unknowns()[group]);
            let rows = rows[group].clone();
            rows.len() as f64 - own.sum::<f64>() - rows.map(of_row).sum::<f64>()
        }))
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

    /// The residuals of all sheets over the standard errors and their factors.
    fn weighed(&self, deviation: &Deviation) -> Result<Residuals, CalibrationError> {
        let mut residuals = stacked(&self.residuals(deviation)?);
        for (group, factor) in std::iter::zip(&mut residuals, self.factors) {
            group.iter_mut().for_each(|residual| *residual /= factor);
        }
        Ok(residuals)
    }

    /// The residuals of every sheet over the stated standard errors.
    fn residuals(&self, deviation: &Deviation) -> Result<Vec<Residuals>, CalibrationError> {
        let sheets = self.sheets.iter().enumerate();
        sheets
            .map(|(sheet, of)| of.at(deviation).map_err(located(sheet)))
            .collect()
    }
}

/// The points of all sheets, and the readings of all sheets.
fn stacked(by_sheet: &[Residuals]) -> Residuals {
    [0, 1].map(|group| by_sheet.iter().flat_map(|of| &of[group]).copied().collect())
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
