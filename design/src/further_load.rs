//! What a deployed sheet carries beside the loads that deployed it; section 3.2, load capacity.
//!
//! Those loads are held and a further one is driven along its way, so that its greatest value is a point
//! of the path like any other: dead loads would throw the sheet past it.

use crate::actuation::Load;
use crate::degeneration::Degeneration;
use crate::equilibrium::{LoadStep, Status};
use crate::gradient::{Deployment, DesignError, DesignProblem, Model};
use std::fmt;

/// Steps in which the first maximum is looked for, and in which the way to it is gone again.
const STEPS: [usize; 2] = [100, 400];

/// A further load along its way.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherLoad {
    /// (way of the load in mm, its factor) from the deployed sheet to where it gives way.
    pub curve: Vec<(f64, f64)>,
    /// Why the factor at the end of the curve is the greatest; none if the sheet still resists there.
    pub ended: Option<GivesWay>,
}

/// How a further load comes to its greatest value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivesWay {
    /// It falls from here on.
    Falls,
    /// A part of the sheet snaps through, however the load is led.
    Snaps,
    /// Panel edges touch: a void is shut.
    Shut,
    /// No equilibrium was found further on.
    NoEquilibrium,
}

impl FurtherLoad {
    /// The part of a path, one stroke a step, before the sheet gives way.
    fn along(path: &[LoadStep], stroke: f64) -> Self {
        let mut curve = vec![(0.0, 0.0)];
        let mut ended = None;
        for step in path {
            let (way, factor) = curve[curve.len() - 1];
            ended = GivesWay::between(factor, step);
            if ended.is_some() {
                break;
            }
            curve.push((way + stroke, step.load_factor));
        }
        Self { curve, ended }
    }

    /// The factor at the end of the curve.
    pub fn carried(&self) -> f64 {
        self.curve.last().map_or(0.0, |(_, factor)| *factor)
    }
}

impl GivesWay {
    /// What happens on the step from one state to the next.
    fn between(before: f64, step: &LoadStep) -> Option<Self> {
        match (step.status, Degeneration::of(step)) {
            (Status::Diverged, _) => Some(Self::NoEquilibrium),
            (Status::LimitPoint, _) => Some(Self::Snaps),
            _ if step.load_factor < before => Some(Self::Falls),
            (_, Some(_)) => Some(Self::Shut),
            (_, None) => None,
        }
    }
}

impl fmt::Display for GivesWay {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Falls => "the load falls from there on",
            Self::Snaps => "a part snaps through",
            Self::Shut => "a void is shut",
            Self::NoEquilibrium => "no equilibrium beyond",
        })
    }
}

impl DesignProblem {
    /// Holds the loads of a deployment and leads `further` ones along their way, at most as far as
    /// `stroke` (mm), until the sheet gives way.
    pub fn further_load(
        &self,
        deployment: &Deployment,
        further: &[Load],
        stroke: f64,
    ) -> Result<FurtherLoad, DesignError> {
        let [coarse, fine] = STEPS;
        let found = self.driven_on(deployment, further, stroke, coarse)?;
        let to_first_failed = found.curve.len() as f64 / coarse as f64;
        self.driven_on(deployment, further, stroke * to_first_failed.min(1.0), fine)
    }

    fn driven_on(
        &self,
        deployment: &Deployment,
        further: &[Load],
        stroke: f64,
        steps: usize,
    ) -> Result<FurtherLoad, DesignError> {
        let Model::Equilibrium(mechanics) = &self.model else {
            return Err(DesignError::NoMechanics);
        };
        let sheet = &deployment.sheet;
        let start = deployment.at_full_load()?.configuration.clone();
        let solver = mechanics.solver.followed_by(further, steps)?;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law);
        let path = solver.driven(stroke)?.path_from(hinged, start);
        Ok(FurtherLoad::along(&path, stroke / steps as f64))
    }
}
