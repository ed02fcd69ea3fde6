//! What errors of a cut sheet do to it: to its deployed corners, its load and its largest D_peak.
//!
//! The errors ([`Deviation`]) are independent and normal, and a tolerance is two of their standard deviations.
//! To first order (first-order second-moment method) the variances add up:
//!
//! ```text
//! Var(x) = sum over errors p of (dx/dp sigma_p)^2
//! ```
//!
//! with dx/dp sigma_p from the equilibria of two sheets, one standard deviation to either side. Sheets with all errors at
//! random (Monte Carlo) say how far that holds.
//! (Haldar and Mahadevan, "Probability, Reliability and Statistical Methods in Engineering Design", 2000.)

use crate::analysis::actuation_curve::ActuationCurve;
use crate::equilibrium::nearby_path::KnownPath;
use crate::hinge_law::DamageMeasure;
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem, Mechanics};
use crate::objective::scores::outline_error;
use crate::pattern::design_vector::DesignVector;
use crate::scene::{ErrorDeviations, Scene, ToleranceConfig};
use crate::sheet::deviation::Deviation;
use crate::sheet::kinematics::deployed_corners;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use support::statistics::{normal, rms_and_maximum};

/// Number of hinges above which single ligaments are not studied: two equilibria each.
const MOST_HINGES: usize = 2000;

/// What may be wrong with a cut sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CuttingError {
    /// The width of the ligament of one hinge.
    Ligament(usize),
    /// The width that the cutter removes, everywhere.
    Kerf,
    /// The thickness of the sheet.
    Thickness,
}

/// Why nothing can be said.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum CuttingErrorsError {
    #[error("the scene has no tolerance: give [tolerances] ligament, kerf or thickness (mm)")]
    NoTolerance,
    #[error("hinges that are pins have no ligaments: tolerances need an equilibrium")]
    NoEquilibrium,
    #[error(
        "the effect of the thickness is known for a learned hinge law alone: leave out [tolerances] thickness"
    )]
    NoThickness,
    #[error("the sheet has {0} hinges, more than {MOST_HINGES}")]
    TooManyHinges(usize),
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// The effect of one error of one standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorEffect {
    /// What is wrong.
    pub error: CuttingError,
    /// Its standard deviation (mm).
    pub deviation: f64,
    /// Movement of the panel corners: root mean square and maximum (mm).
    pub corners: [f64; 2],
    /// Change of the load, relative; `None` if nothing moves the sheet.
    pub load: Option<f64>,
    /// Change of the largest D_peak; `None` if it is not known.
    pub d_peak: Option<f64>,
    /// Its part of the sum of the variances of all corners.
    pub share: f64,
}

/// Standard deviations of the deployed sheet to first order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstOrder {
    /// All errors, that with the largest share first.
    pub errors: Vec<ErrorEffect>,
    /// Of the panel corners: root mean square and maximum (mm).
    pub corners: [f64; 2],
    /// Of the load, relative.
    pub load: Option<f64>,
    /// Of the largest D_peak.
    pub d_peak: Option<f64>,
}

/// Sheets with errors at random.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampledSheets {
    /// Number of sheets that were deployed.
    pub deployed: usize,
    /// Number of sheets without an equilibrium at full load.
    pub failed: usize,
    /// Number of deployed sheets of which a hinge leaves the training domain of its law on the way.
    pub outside: usize,
    /// Standard deviation of the panel corners from the designed sheet's: root mean square and maximum (mm).
    pub corners: [f64; 2],
    /// Largest movement of a corner: median and 95 % quantile over the sheets (mm).
    pub largest: [f64; 2],
    /// Change of the load, relative: mean and standard deviation.
    pub load: Option<[f64; 2]>,
    /// Change of the largest D_peak: mean and standard deviation.
    pub d_peak: Option<[f64; 2]>,
    /// L of (16) (mm^2).
    pub loss: Spread,
    /// Root mean square distance of the outline from the target (mm).
    pub outline_error: Spread,
}

/// A quantity of the sheet as drawn and of sheets with errors at random.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Of the sheet as drawn.
    pub drawn: f64,
    /// Mean over the sheets.
    pub mean: f64,
    /// Not exceeded by 95 % of the sheets.
    pub most: f64,
}

/// What is compared of a deployed sheet.
struct Outcome {
    corners: Vec<[f64; 2]>,
    load: Option<f64>,
    d_peak: Option<f64>,
    loss: f64,
    outline_error: f64,
    /// Whether all hinges stay inside the training domain.
    inside: bool,
}

/// A designed sheet and the standard deviations of its errors.
pub struct CuttingErrors<'a> {
    problem: &'a DesignProblem,
    mechanics: &'a Mechanics,
    designed: Deployment,
    /// The path of the designed sheet, from which those of cut ones are corrected.
    known: KnownPath,
    /// Its thickness (mm).
    thickness: f64,
    outcome: Outcome,
    deviations: ErrorDeviations,
}

impl<'a> CuttingErrors<'a> {
    /// A design of a scene and its problem, with these tolerances.
    pub fn new(
        scene: &'a Scene,
        problem: &'a DesignProblem,
        design: &DesignVector,
        tolerances: ToleranceConfig,
    ) -> Result<Self, CuttingErrorsError> {
        let deviations = tolerances.deviations();
        if deviations == ErrorDeviations::default() {
            return Err(CuttingErrorsError::NoTolerance);
        }
        let mechanics = problem.model.mechanics();
        let mechanics = mechanics.ok_or(CuttingErrorsError::NoEquilibrium)?;
        let designed = problem.deploy(design)?;
        designed.at_full_load()?;
        if deviations.thickness > 0.0 && mechanics.law.scales() != [true; 2] {
            return Err(CuttingErrorsError::NoThickness);
        }
        let hinges = designed.sheet.hinges.len();
        if hinges > MOST_HINGES {
            return Err(CuttingErrorsError::TooManyHinges(hinges));
        }
        Ok(Self {
            outcome: Outcome::new(problem, mechanics, &designed)?,
            problem,
            mechanics,
            known: designed.known_path(),
            designed,
            thickness: scene.material.thickness,
            deviations,
        })
    }

    /// The designed sheet without errors.
    pub fn designed(&self) -> &Deployment {
        &self.designed
    }

    /// All errors that have a tolerance.
    pub fn errors(&self) -> Vec<CuttingError> {
        let ligaments = (0..self.designed().sheet.hinges.len()).map(CuttingError::Ligament);
        let common = [CuttingError::Kerf, CuttingError::Thickness];
        let all = ligaments.chain(common);
        all.filter(|error| self.deviation(*error) > 0.0).collect()
    }

    /// The first-order estimate; `deployed` is called after every error.
    pub fn first_order(&self, deployed: &mut dyn FnMut()) -> Result<FirstOrder, DesignError> {
        let mut effects = Vec::new();
        let mut variances = vec![0.0; self.outcome.corners.len()];
        for error in self.errors() {
            let effect = self.effect(error)?;
            for (sum, [x, y]) in variances.iter_mut().zip(&effect.corners) {
                *sum += x * x + y * y;
            }
            effects.push((error, effect));
            deployed();
        }
        let all: f64 = variances.iter().sum();
        let of_outcome = |of: fn(&Outcome) -> Option<f64>| {
            let squares = effects.iter().map(|(_, effect)| Some(of(effect)?.powi(2)));
            squares.sum::<Option<f64>>().map(f64::sqrt)
        };
        let (load, d_peak) = (of_outcome(|of| of.load), of_outcome(|of| of.d_peak));
        let mut errors: Vec<ErrorEffect> = (effects.into_iter())
            .map(|(error, effect)| {
                let lengths = || effect.corners.iter().map(|[x, y]| x.hypot(*y));
                ErrorEffect {
                    error,
                    deviation: self.deviation(error),
                    corners: rms_and_maximum(lengths()),
                    load: effect.load,
                    d_peak: effect.d_peak,
                    // Without any effect there is nothing to share.
                    share: lengths().map(|length| length * length).sum::<f64>()
                        / all.max(f64::MIN_POSITIVE),
                }
            })
            .collect();
        errors.sort_by(|a, b| b.share.total_cmp(&a.share));
        Ok(FirstOrder {
            errors,
            corners: rms_and_maximum(variances.into_iter().map(f64::sqrt)),
            load,
            d_peak,
        })
    }

    /// `count` sheets with all errors at random; `deployed` is called after each.
    pub fn sampled(
        &self,
        count: usize,
        seed: u64,
        deployed: &mut dyn FnMut(),
    ) -> Result<SampledSheets, DesignError> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut found = Vec::new();
        let mut failed = 0;
        for _ in 0..count {
            let errors = self.drawn(&mut random);
            match self.outcome_of(&errors) {
                Ok(outcome) => found.push(outcome.minus(&self.outcome)),
                Err(
                    DesignError::NoEquilibrium { .. }
                    | DesignError::NotLetGo
                    | DesignError::Sheet(_)
                    | DesignError::ImpossibleSheet,
                ) => failed += 1,
                Err(error) => return Err(error),
            }
            deployed();
        }
        let corners = self.outcome.corners.len();
        let over =
            |of: &dyn Fn(&Outcome) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
        let deviation =
            |corner: usize| over(&|of| of.corners[corner].iter().map(|x| x * x).sum()).sqrt();
        let largest = found.iter().map(|of| {
            of.corners
                .iter()
                .fold(0.0, |most: f64, [x, y]| most.max(x.hypot(*y)))
        });
        let largest = ascending(largest);
        let spread = |of: fn(&Outcome) -> f64| {
            let (drawn, changes) = (of(&self.outcome), ascending(found.iter().map(of)));
            Spread {
                drawn,
                mean: drawn + changes.iter().sum::<f64>() / changes.len() as f64,
                most: drawn + quantile(&changes, 0.95),
            }
        };
        let moments = |of: fn(&Outcome) -> Option<f64>| {
            let values: Option<Vec<f64>> = found.iter().map(of).collect();
            let values = values.filter(|values| !values.is_empty())?;
            let [mean, variance] = surrogate::mean_and_variance(values);
            Some([mean, variance.sqrt()])
        };
        Ok(SampledSheets {
            deployed: found.len(),
            failed,
            outside: found.iter().filter(|of| !of.inside).count(),
            corners: rms_and_maximum((0..corners).map(deviation)),
            largest: [0.5, 0.95].map(|share| quantile(&largest, share)),
            load: moments(|of| of.load),
            d_peak: moments(|of| of.d_peak),
            loss: spread(|of| of.loss),
            outline_error: spread(|of| of.outline_error),
        })
    }

    fn deviation(&self, error: CuttingError) -> f64 {
        match error {
            CuttingError::Ligament(_) => self.deviations.ligament,
            CuttingError::Kerf => self.deviations.kerf,
            CuttingError::Thickness => self.deviations.thickness,
        }
    }

    /// Half the difference between the sheets with one standard deviation of an error to either side.
    fn effect(&self, error: CuttingError) -> Result<Outcome, DesignError> {
        let outcome = |sign: f64| {
            let size = sign * self.deviation(error);
            let mut errors = self.none();
            match error {
                CuttingError::Ligament(hinge) => errors.widths[hinge] = size,
                CuttingError::Kerf => errors.kerf = size,
                CuttingError::Thickness => errors.thickness = size,
            }
            self.outcome_of(&errors)
        };
        let (ahead, behind) = (outcome(1.0)?, outcome(-1.0)?);
        let load = self.outcome.load;
        let half = |ahead: Option<f64>, behind: Option<f64>| Some(0.5 * (ahead? - behind?));
        Ok(Outcome {
            corners: std::iter::zip(&ahead.corners, &behind.corners)
                .map(|(ahead, behind)| [0, 1].map(|i| 0.5 * (ahead[i] - behind[i])))
                .collect(),
            load: half(ahead.load, behind.load)
                .zip(load)
                .map(|(change, load)| change / load.abs()),
            d_peak: half(ahead.d_peak, behind.d_peak),
            loss: 0.5 * (ahead.loss - behind.loss),
            outline_error: 0.5 * (ahead.outline_error - behind.outline_error),
            inside: ahead.inside && behind.inside,
        })
    }

    fn none(&self) -> Deviation {
        Deviation {
            widths: vec![0.0; self.designed().sheet.hinges.len()],
            ..Deviation::default()
        }
    }

    /// Independent normal errors.
    fn drawn(&self, random: &mut ChaCha8Rng) -> Deviation {
        let ErrorDeviations {
            ligament,
            kerf,
            thickness,
        } = self.deviations;
        let mut normal = || normal([random.random(), random.random()]);
        let mut errors = self.none();
        errors
            .widths
            .iter_mut()
            .for_each(|width| *width = ligament * normal());
        errors.kerf = kerf * normal();
        errors.thickness = thickness * normal();
        errors
    }

    fn outcome_of(&self, errors: &Deviation) -> Result<Outcome, DesignError> {
        let mechanics = self.mechanics.as_cut(errors, self.thickness)?;
        let deployment = mechanics.deploy_cut(&self.designed, errors, &self.known)?;
        Outcome::new(self.problem, &mechanics, &deployment)
    }
}

fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// A quantile of values in ascending order; NaN of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let last = values.len().saturating_sub(1) as f64;
    let value = values.get((share * last).round() as usize);
    value.copied().unwrap_or(f64::NAN)
}

impl Outcome {
    fn new(
        problem: &DesignProblem,
        mechanics: &Mechanics,
        deployment: &Deployment,
    ) -> Result<Self, DesignError> {
        let compared = deployment.compared();
        let hinges = 0..deployment.sheet.hinges.len();
        let peaks: Option<Vec<f64>> = hinges
            .map(|hinge| deployment.damage_max(DamageMeasure::Peak, hinge))
            .collect();
        let load = ActuationCurve::new(mechanics, deployment)
            .and_then(|curve| curve.points.last().map(|[_, load]| *load));
        Ok(Self {
            corners: deployed_corners(&deployment.sheet, &compared.configuration).concat(),
            load,
            d_peak: peaks.map(|peaks| peaks.into_iter().fold(0.0, f64::max)),
            loss: problem.loss_of(deployment)?,
            outline_error: outline_error(&problem.objective, deployment),
            inside: deployment.share_inside() == 1.0,
        })
    }

    /// The change from the designed sheet, that of the load relative.
    fn minus(&self, designed: &Self) -> Self {
        Self {
            corners: std::iter::zip(&self.corners, &designed.corners)
                .map(|(to, from)| [0, 1].map(|i| to[i] - from[i]))
                .collect(),
            load: self
                .load
                .zip(designed.load)
                .map(|(to, from)| to / from - 1.0),
            d_peak: self.d_peak.zip(designed.d_peak).map(|(to, from)| to - from),
            loss: self.loss - designed.loss,
            outline_error: self.outline_error - designed.outline_error,
            inside: self.inside,
        }
    }
}
