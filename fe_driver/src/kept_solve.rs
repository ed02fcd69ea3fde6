//! Window solves that are made once: studies and replays can be stopped, and go on where they were.

use crate::deck::StepControl;
use crate::failure::FailureKind;
use crate::job::{FileError, read_json, short_hash, write_json};
use crate::path::DeformationPath;
use crate::window_solve::{SolveError, Tools, WindowModel};
use hinge::{HingeDesign, HingeSample, SheetMaterial};
use mesher::{MeshRecipe, mesh_window};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// All that decides a window solve, but the versions of the tools.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeptSolve {
    pub design: HingeDesign,
    pub path: DeformationPath,
    pub material: SheetMaterial,
    pub recipe: MeshRecipe,
    pub step: StepControl,
}

/// What a solve gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptSolution {
    pub elements: usize,
    /// Of the solver (s), where the system tells it.
    pub cpu_seconds: Option<f64>,
    /// Share of the time from the mesh to the samples in which the solver did not run.
    pub overhead: f64,
    /// Largest resident memory of the solver (MiB), where the system tells it.
    pub peak_memory_mib: Option<f64>,
    pub iterations: usize,
    pub samples: Vec<HingeSample>,
    /// Why the path was not followed to its end.
    pub stopped: Option<String>,
}

/// Why there is no solution to keep.
#[derive(Debug, thiserror::Error)]
pub enum KeptSolveError {
    #[error(transparent)]
    Solve(#[from] SolveError),
    #[error(transparent)]
    File(#[from] FileError),
}

impl KeptSolve {
    /// The solution kept in `kept`, or the one that is found now, working in `work`, and kept.
    ///
    /// A path that the solver does not follow to its end is a result; a solver that was ended or
    /// broke down is none. ccx is ended after `limit`, and soon after `stop` becomes true.
    pub fn solution(
        &self,
        kept: &Path,
        work: &Path,
        tools: &Tools,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<KeptSolution, KeptSolveError> {
        let file = self.file(kept);
        if let Some(solution) = read_json(&file)? {
            return Ok(solution);
        }
        let solution = self.solve(work, tools, limit, stop)?;
        write_json(&file, &solution)?;
        Ok(solution)
    }

    /// Its name is the same only for what solves the same.
    fn file(&self, kept: &Path) -> PathBuf {
        kept.join(short_hash(self)).with_extension("json")
    }

    fn solve(
        &self,
        work: &Path,
        tools: &Tools,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<KeptSolution, SolveError> {
        let start = Instant::now();
        let thickness = self.material.thickness;
        let mesh = mesh_window(&self.design, thickness, &self.recipe, work, &tools.gmsh)?;
        let model = WindowModel {
            mesh: &mesh,
            path: &self.path,
            material: &self.material,
            step: &self.step,
        };
        let solution = model.solve(&tools.ccx, work, limit, stop)?;
        let stopped = match solution.stopped {
            None => None,
            Some(reason) => match FailureKind::of(&reason) {
                Some(FailureKind::Diverged | FailureKind::EnergyImbalance) => {
                    Some(reason.to_string())
                }
                _ => return Err(reason),
            },
        };
        Ok(KeptSolution {
            elements: mesh.elements.len(),
            cpu_seconds: solution.cpu_seconds,
            overhead: 1.0 - solution.solver_seconds / start.elapsed().as_secs_f64(),
            peak_memory_mib: solution.peak_memory_mib,
            iterations: solution.iterations,
            samples: solution.samples,
            stopped,
        })
    }
}
