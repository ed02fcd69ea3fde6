//! What a deployed sheet carries beside the loads that deployed it; section 3.2, load capacity.
//!
//! Those loads are held and a further one is driven along its way, so that the first maximum is a point
//! of the path like any other: dead loads would throw the sheet past it.

use crate::actuation::Load;
use crate::degeneration::Degeneration;
use crate::equilibrium::{LoadStep, Status};
use crate::gradient::{Deployment, DesignError, DesignProblem, Model};
use std::fmt;

/// Steps in which the sheet is first seen to give way.
const COARSE: usize = 100;
/// Steps in which the way there is gone again.
const FINE: usize = 400;

/// A further load along its way.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherLoad {
    /// (way of the load in mm, its factor) from the deployed sheet to where it first gives way.
    pub curve: Vec<(f64, f64)>,
    /// Why the curve ends; none if the sheet still resists where it was led to.
    pub ended: Option<GivesWay>,
}

/// How a sheet gives way to a further load.
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

    /// The factor at which the sheet gives way, if it does.
    pub fn limit(&self) -> Option<f64> {
        self.ended.map(|_| self.carried())
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
    /// Holds the loads of a deployment and leads `further` forces along their way, at most as far as
    /// `stroke` (mm), until the sheet first gives way; at once if it was not deployed.
    pub fn further_load(
        &self,
        deployment: &Deployment,
        further: &[Load],
        stroke: f64,
    ) -> Result<FurtherLoad, DesignError> {
        let coarse = self.driven_on(deployment, further, stroke, COARSE)?;
        let to_first_failed = (coarse.curve.len() as f64 / COARSE as f64).min(1.0);
        let fine = self.driven_on(deployment, further, stroke * to_first_failed, FINE)?;
        // Shorter steps may pass where longer ones gave up; how far they would go is not known then.
        let passed = coarse.ended.is_some() && fine.ended.is_none();
        Ok(if passed { coarse } else { fine })
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
        let (sheet, opened) = (&deployment.sheet, deployment.final_step());
        if opened.status == Status::Diverged {
            return Ok(FurtherLoad {
                curve: vec![(0.0, 0.0)],
                ended: Some(GivesWay::NoEquilibrium),
            });
        }
        let start = opened.configuration.clone();
        let solver = mechanics.solver.followed_by(opened, further, steps)?;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law);
        let path = solver.driven(stroke)?.path_from(hinged, start);
        Ok(FurtherLoad::along(&path, stroke / steps as f64))
    }
}
