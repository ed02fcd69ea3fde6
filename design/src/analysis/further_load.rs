//! The load that a deployed sheet carries in addition to the loads that deployed it; section 3.2, load
//! capacity.
//!
//! The deployment loads are held constant and a further load is applied under displacement control, so that its
//! first maximum is a regular point of the path; under load control the sheet would jump past it.

use crate::analysis::degeneration::Degeneration;
use crate::equilibrium::load_step::{LoadStep, Status};
use crate::equilibrium::supports::Load;
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem};
use std::fmt;

/// Number of steps in which the first limit is located.
const COARSE: usize = 100;
/// Number of steps in which the path up to it is repeated.
const FINE: usize = 400;

/// The response to a further load.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherLoad {
    /// (stroke of the load in mm, its factor) from the deployed sheet to the first limit.
    pub curve: Vec<(f64, f64)>,
    /// Why the curve ends; `None` if no limit was found up to the given stroke.
    pub ended: Option<GivesWay>,
}

/// The kind of limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivesWay {
    /// The load decreases from here on.
    Falls,
    /// A part of the sheet snaps through, even under displacement control.
    Snaps,
    /// Panel edges touch: a void is closed.
    Shut,
    /// No equilibrium was found beyond this point.
    NoEquilibrium,
}

impl FurtherLoad {
    /// The part of a path, with one increment `stroke` per step, up to the limit.
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

    /// The factor at the limit, if there is one.
    pub fn limit(&self) -> Option<f64> {
        self.ended.map(|_| self.carried())
    }
}

impl GivesWay {
    /// The limit between one state and the next, if there is one.
    fn between(before: f64, step: &LoadStep) -> Option<Self> {
        match (step.status, Degeneration::new(step)) {
            (Status::Diverged, _) => Some(Self::NoEquilibrium),
            _ if step.jumps > 0 => Some(Self::Snaps),
            _ if step.load_factor < before => Some(Self::Falls),
            (_, Some(_)) => Some(Self::Shut),
            (_, None) => None,
        }
    }
}

impl fmt::Display for GivesWay {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Falls => "the load decreases from there on",
            Self::Snaps => "a part of the sheet snaps through",
            Self::Shut => "a void is closed",
            Self::NoEquilibrium => "no equilibrium found beyond",
        })
    }
}

impl DesignProblem {
    /// Holds the loads of a deployment constant and applies `further` forces under displacement control, up to the
    /// stroke `stroke` (mm) or the first limit. The curve ends at once if the sheet is not deployed.
    pub fn further_load(
        &self,
        deployment: &Deployment,
        further: &[Load],
        stroke: f64,
    ) -> Result<FurtherLoad, DesignError> {
        let coarse = self.driven_on(deployment, further, stroke, COARSE)?;
        let to_first_failed = (coarse.curve.len() as f64 / COARSE as f64).min(1.0);
        let fine = self.driven_on(deployment, further, stroke * to_first_failed, FINE)?;
        // Shorter steps may pass a limit at which longer ones ended; how far they would go is unknown.
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
        let mechanics = self.model.mechanics().ok_or(DesignError::NoMechanics)?;
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
        let hinged = mechanics.hinged(sheet, &*law, false);
        let path = solver.driven(stroke)?.path_from(hinged, start);
        Ok(FurtherLoad::along(&path, stroke / steps as f64))
    }
}
