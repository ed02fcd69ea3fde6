//! Difference of a sheet at one level to the same sheet at a finer one: the estimate of the error of
//! the coarser level.

use crate::actuation_curve::ActuationCurve;
use design::geometry::plane::{complex, point};
use design::geometry::polygon::distance;
use design::geometry::similarity::{Scale, Similarity};
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::optimise::outer_loop::SearchState;
use design::pattern::design_vector::DesignVector;
use design::sheet::kinematics::deployed_corners;
use scene::{CoarseSearch, Level, LevelDifference, Scene};
use support::{Fault, fault};
use support::{Point, statistics::rms_and_maximum};

/// What is compared of a sheet at a level.
#[derive(Clone)]
pub struct AtLevel {
    level: Level,
    /// Panel corners in the state that is compared with the target (mm).
    corners: Vec<Point>,
    /// The load at the end of the path, where the motion is prescribed.
    pub load: Option<f64>,
    /// The largest D_peak of a hinge along the path, if every hinge has one.
    pub damage_peak: Option<f64>,
}

/// Deploys a design of a scene at the level of the scene.
pub fn deployed(
    scene: &Scene,
    design: &DesignVector,
) -> Result<(DesignProblem, Deployment), Fault> {
    let problem = scene.problem()?;
    let deployment = problem.deploy(design).and_then(|deployment| {
        deployment.at_full_load()?;
        Ok(deployment)
    });
    let level = scene.config.level;
    let named = |error| fault!("at the level `{level}` {error}");
    Ok((problem, deployment.map_err(named)?))
}

impl AtLevel {
    /// A deployed sheet of a design problem at a level.
    pub fn new(level: Level, problem: &DesignProblem, deployment: &Deployment) -> Self {
        let configuration = &deployment.final_step().configuration;
        let corners = deployed_corners(&deployment.sheet, configuration);
        let hinges = 0..deployment.sheet.hinges.len();
        let mut peaks = hinges.map(|hinge| deployment.damage_max(DamageMeasure::Peak, hinge));
        Self {
            level,
            corners: corners.into_iter().flatten().collect(),
            load: load(problem, deployment),
            damage_peak: peaks.try_fold(0.0, |largest: f64, peak| Some(largest.max(peak?))),
        }
    }

    /// What is kept of a search that ended at this design, compared with a finer level; tolerance
    /// and error by the mesh of the windows in mm.
    pub fn coarse_search(
        &self,
        search: &SearchState,
        finer: &Self,
        tolerance: Option<f64>,
        mesh: f64,
    ) -> CoarseSearch {
        CoarseSearch {
            level: self.level,
            history: search.history.clone(),
            finer: finer.level,
            difference: self.difference(finer),
            tolerance,
            mesh,
        }
    }

    /// The difference to a finer level.
    pub fn difference(&self, finer: &Self) -> LevelDifference {
        let [own, other] = [&self.corners, &finer.corners];
        let moved = match self.level {
            Level::Pin => {
                let pairs: Vec<_> = std::iter::zip(own, other)
                    .map(|(own, other)| [*own, *other].map(complex))
                    .collect();
                match Similarity::least_squares(&pairs, Scale::Given) {
                    Some(motion) => pairs.iter().map(|[p, _]| point(motion.of(*p))).collect(),
                    None => own.clone(),
                }
            }
            _ => own.clone(),
        };
        let distances = std::iter::zip(moved, other).map(|(own, other)| distance(own, *other));
        let relative = |[own, other]: [f64; 2]| (own - other).abs() / other.abs();
        let both = |of: fn(&Self) -> Option<f64>| Some([of(self)?, of(finer)?]);
        LevelDifference {
            corners: rms_and_maximum(distances),
            load: both(|at| at.load).map(relative),
            damage: both(|at| at.damage_peak).map(|[own, other]| (own - other).abs()),
        }
    }
}

/// The load at the end of the path, where the motion is prescribed.
fn load(problem: &DesignProblem, deployment: &Deployment) -> Option<f64> {
    let mechanics = problem.model.mechanics()?;
    let curve = ActuationCurve::new(mechanics, deployment)?;
    let end = curve.points.last().map(|point| point[1]);
    end.filter(|_| curve.is_prescribed(mechanics))
}
