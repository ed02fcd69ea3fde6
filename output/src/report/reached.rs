//! The end of an equilibrium path.

use crate::report::numbers::rounded;
use analysis::{
    actuation_curve::{ActuationCurve, LimitPoint, LoadPeak, Mover},
    unit::Unit,
};
use design::objective::design_problem::{Deployment, DesignProblem};
use scene::{Scene, panel_name};

/// Load and stroke at the end of a path.
#[derive(Clone, Debug)]
pub struct Reached {
    /// What moves the sheet, and what its displacement means.
    pub stroke_of: String,
    /// Displacement, in the first of `units`.
    pub displacement: f64,
    /// Load, in the second of `units`.
    pub load: f64,
    /// Units of displacement and load.
    pub units: [Unit; 2],
    /// The maximum of the load along the path; `None` under dead loads, whose maximum is the load
    /// at the end.
    pub peak: Option<LoadPeak>,
    /// The maxima and minima of the load on the way; empty under dead loads, or if the sheet jumps.
    pub(super) limit_points: Vec<LimitPoint>,
    /// Increment of the load for an increment of the displacement; `None` if supports move the
    /// sheet, or if the tangent is singular.
    pub(super) stiffness: Option<f64>,
}

impl Reached {
    /// `None` without equilibrium, or if nothing moves the sheet.
    pub(super) fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
    ) -> Option<Self> {
        let mechanics = problem.model.mechanics()?;
        let curve = ActuationCurve::new(mechanics, deployment)?;
        let [displacement, load] = *curve.points.last()?;
        let stiffness = deployment.final_step().stiffness(&mechanics.solver);
        let resolved = (curve.is_prescribed(mechanics))
            .then(|| ActuationCurve::resolved(mechanics, deployment))
            .flatten();
        Some(Self {
            stroke_of: stroke_of(scene, &curve),
            displacement,
            load,
            units: curve.units(),
            peak: resolved.as_ref().map(ActuationCurve::peak),
            // The curve beyond a jump is another branch.
            limit_points: resolved
                .filter(|_| deployment.path.iter().all(|step| step.jumps == 0))
                .map_or_else(Vec::new, |curve| curve.limit_points()),
            stiffness: stiffness.filter(|_| curve.mover == Mover::Loads),
        })
    }

    /// The load, if it is a force (N).
    pub(super) fn force(&self) -> Option<f64> {
        (self.units[1] == Unit::Newton).then_some(self.load)
    }

    /// The parts of the stroke in which the load rises, so a dead load holds the sheet there.
    pub(super) fn stable_parts(&self) -> String {
        let [length, force] = self.units;
        let mut parts = Vec::new();
        let mut from = Some("0".to_owned());
        for point in &self.limit_points {
            let [at, load] = [point.displacement, point.load].map(|value| rounded(value, 4));
            match from.take() {
                Some(from) if point.is_maximum => {
                    parts.push(format!("{from} to {at} {length} (up to {load} {force})"));
                }
                _ => from = Some(at),
            }
        }
        if let Some(from) = from {
            parts.push(format!("{from} to {} {length}", rounded(self.displacement, 4)));
        }
        format!("a dead load holds the sheet at strokes of {}", parts.join(", "))
    }
}

/// What moves the sheet, and what its displacement means.
fn stroke_of(scene: &Scene, curve: &ActuationCurve) -> String {
    let [way, load] =
        if curve.translational { ["displacement", "force"] } else { ["rotation", "couple"] };
    let position = match (scene.actuation().loads.as_slice(), &*scene.config.loads) {
        ([only], [load]) => only.place.zip(Some(load.at)),
        _ => None,
    };
    let mut stroke = match position {
        _ if curve.mover == Mover::Supports => format!("{way} of the moved supports"),
        Some((panel, at)) => {
            format!("{way} of {at}{} along its {load}", panel_name(&scene.topology, panel))
        }
        None => format!("mean {way} along the loads, weighted by their {load}s"),
    };
    if scene.weight_by_area() != [0.0; 2] {
        stroke += ", from the flat sheet before its weight came on";
    }
    stroke
}
