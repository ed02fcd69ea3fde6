//! The hinges of a deployed sheet, solved by finite elements along their paths in it.

use crate::verification_error::VerificationError;
use crate::visited::hinge_path;
use dataset::Fidelity;
use design::objective::design_problem::Deployment;
use fe_driver::{SolveService, WindowProblem, WindowSolve};
use hinge::{HingeSample, SheetMaterial};
use mesher::Tier;
use serde::Serialize;
use support::{Fault, fault};
use surrogate::Surrogate;

/// A hinge of a sheet that finite elements did not follow along its path.
#[derive(Clone, Debug, Serialize, thiserror::Error)]
#[error("hinge {hinge}: {reason}")]
pub struct UnsolvedHinge {
    /// Number of the hinge.
    pub hinge: usize,
    /// Its window, why it was not solved, and the folder of its last attempt.
    pub reason: String,
}

/// Finite elements for the hinges of sheets.
#[derive(Clone, Copy)]
pub struct ElementWindows<'a> {
    /// Tier of the meshes.
    pub tier: Tier,
    /// Solves the windows.
    pub service: &'a SolveService<'a>,
}

/// Hinges of a sheet, solved along their paths.
#[derive(Default)]
pub(crate) struct SolvedPaths {
    /// The last state of every hinge by finite elements; `None` if it was not solved.
    pub ends: Vec<Option<HingeSample>>,
    /// The hinges that were not.
    pub unsolved: Vec<UnsolvedHinge>,
    /// CPU time of the windows (s).
    pub cpu_seconds: f64,
}

impl ElementWindows<'_> {
    /// Solves all hinges of a deployment along their paths; an error if none is solved.
    pub(crate) fn solve(
        &self,
        deployment: &Deployment,
        material: &SheetMaterial,
    ) -> Result<SolvedPaths, VerificationError> {
        let versions = self.service.versions();
        let designs = deployment.sheet.designs().into_iter().enumerate();
        let solves = designs.map(|(hinge, design)| {
            let hinge = hinge_path(deployment, hinge, design)?;
            let problem = WindowProblem::new(hinge, material, self.tier);
            Ok(WindowSolve::new(problem, &versions))
        });
        let solves: Vec<WindowSolve> = solves.collect::<Result<_, Fault>>()?;
        let mut solved = SolvedPaths::default();
        for (hinge, window) in self.service.solve(&solves)?.into_iter().enumerate() {
            solved.cpu_seconds += window.record.cpu_seconds;
            let complete = window.complete();
            solved.ends.push(complete.as_ref().ok().and_then(|samples| samples.last().copied()));
            if let Err(failed) = complete {
                solved.unsolved.push(UnsolvedHinge { hinge, reason: failed.to_string() });
            }
        }
        match &solved.unsolved[..] {
            [first, ..] if solved.unsolved.len() == solves.len() => {
                Err(VerificationError::NoHinge(first.to_string()))
            }
            _ => Ok(solved),
        }
    }
}

/// The mesh tier to test weights on: `requested`, or the tier of the database they were trained on,
/// or the finer tier that the database was corrected to.
pub fn verification_tier(requested: Option<Tier>, surrogate: &Surrogate) -> Result<Tier, Fault> {
    let trained_on = &surrogate.card().tier;
    let own = || trained_on.parse().map(Fidelity::mesh).ok();
    requested.or_else(own).ok_or_else(|| {
        fault!(
            "the weights were trained on the tier `{trained_on}`, which is no mesh tier: pass the \
             tier to compare with as --tier"
        )
    })
}
