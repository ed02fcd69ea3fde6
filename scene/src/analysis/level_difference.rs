//! By how much a sheet at one level differs from the same sheet at a finer one: the estimate of the
//! error of the coarser level.

use crate::analysis::actuation_curve::ActuationCurve;
use crate::{Level, LevelDifference, Rung, Scene, SceneError};
use design::geometry::plane::{complex, point};
use design::geometry::polygon::distance;
use design::geometry::similarity::{Scale, Similarity};
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::{Deployment, DesignError, DesignProblem};
use design::optimise::outer_loop::StepRecord;
use design::pattern::design_vector::DesignVector;
use design::sheet::kinematics::deployed_corners;
use support::statistics::rms_and_maximum;

/// A sheet at a level.
pub struct AtLevel {
    /// The level.
    pub level: Level,
    /// Its design problem.
    pub problem: DesignProblem,
    /// The design, deployed.
    pub deployment: Deployment,
}

/// Why a sheet has no state at a level.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum LevelError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("at the level `{level}` {source}")]
    Design { level: Level, source: DesignError },
}

impl AtLevel {
    /// Deploys a design of a scene at the level of the scene.
    pub fn new(scene: &Scene, design: &DesignVector) -> Result<Self, LevelError> {
        let level = scene.config.level;
        let problem = scene.problem()?;
        let deployed = || -> Result<Deployment, DesignError> {
            let deployment = problem.deploy(design)?;
            deployment.at_target_state()?;
            Ok(deployment)
        };
        let deployment = deployed().map_err(|source| LevelError::Design { level, source })?;
        Ok(Self { level, problem, deployment })
    }

    /// What is kept of a search that ended at this design, compared with a finer level and with the
    /// difference `asked` for (mm).
    pub fn rung(&self, history: &[StepRecord], finer: &Self, asked: f64) -> Rung {
        Rung {
            level: self.level,
            start: history[0].scores.clone(),
            steps: history.len() - 1,
            finer: finer.level,
            difference: self.difference(finer),
            asked,
        }
    }

    /// The difference to a finer level.
    pub fn difference(&self, finer: &Self) -> LevelDifference {
        let [own, other] = [self, finer].map(Self::corners);
        let moved = match self.level {
            Level::Pin => {
                let pairs: Vec<_> = std::iter::zip(own.iter().copied(), other.iter().copied())
                    .map(|(own, other)| [own, other].map(complex))
                    .collect();
                match Similarity::least_squares(&pairs, Scale::Given) {
                    Some(motion) => pairs.iter().map(|[p, _]| point(motion.of(*p))).collect(),
                    None => own,
                }
            }
            _ => own,
        };
        let distances = std::iter::zip(moved, other).map(|(own, other)| distance(own, other));
        let relative = |[own, other]: [f64; 2]| (own - other).abs() / other.abs();
        let both = |of: fn(&Self) -> Option<f64>| Some([of(self)?, of(finer)?]);
        LevelDifference {
            corners: rms_and_maximum(distances),
            load: both(Self::load).map(relative),
            damage: both(Self::damage_peak).map(|[own, other]| (own - other).abs()),
        }
    }

    /// Panel corners in the state that is compared with the target (mm).
    fn corners(&self) -> Vec<[f64; 2]> {
        let configuration = &self.deployment.compared().configuration;
        let corners = deployed_corners(&self.deployment.sheet, configuration);
        corners.into_iter().flatten().collect()
    }

    /// The load at the end of the path, where the motion is prescribed.
    pub fn load(&self) -> Option<f64> {
        let mechanics = self.problem.model.mechanics()?;
        let curve = ActuationCurve::new(mechanics, &self.deployment)?;
        let end = curve.points.last().map(|point| point[1]);
        end.filter(|_| curve.is_prescribed(mechanics))
    }

    /// The largest D_peak of a hinge along the path, if it is known of every hinge.
    pub fn damage_peak(&self) -> Option<f64> {
        let hinges = 0..self.deployment.sheet.hinges.len();
        let mut peaks = hinges.map(|hinge| self.deployment.damage_max(DamageMeasure::Peak, hinge));
        peaks.try_fold(0.0, |largest: f64, peak| Some(largest.max(peak?)))
    }
}
