//! A cache of window solves: a study or a verification that was stopped continues with the solves it has finished.

use crate::record_file::{FileError, read_json, short_hash, write_json};
use crate::window::deformation_path::DeformationPath;
use crate::window::failure::FailureKind;
use crate::window::model::WindowModel;
use crate::window::solve::{SolveError, Tools};
use crate::window::step_control::StepControl;
use crate::window::versions::{RECIPE_VERSION, ToolVersions};
use hinge::{HingeDesign, HingeSample, SheetMaterial};
use mesher::{MeshRecipe, mesh_window};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// All inputs of a window solve except the tool versions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeptSolve {
    /// The hinge design.
    pub design: HingeDesign,
    /// The path along which the window is driven.
    pub path: DeformationPath,
    /// The sheet material.
    pub material: SheetMaterial,
    /// The recipe of the mesh.
    pub recipe: MeshRecipe,
    /// The increments of the solve.
    pub step: StepControl,
}

/// The result of a solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptSolution {
    /// Number of elements of the mesh.
    pub elements: usize,
    /// Solver CPU time (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Fraction of the wall time, from mesh to samples, in which the solver did not run.
    pub overhead: f64,
    /// Maximum resident memory of the solver (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Newton iterations, including those of cut-back increments.
    pub iterations: usize,
    /// One sample per converged increment, in order of lambda.
    pub samples: Vec<HingeSample>,
    /// Why the solver did not follow the path to its end; `None` if it did.
    pub stopped: Option<String>,
}

/// Why a solve has no solution to cache.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum KeptSolveError {
    #[error(transparent)]
    Solve(#[from] SolveError),
    #[error(transparent)]
    File(#[from] FileError),
}

impl KeptSolve {
    /// The second attempt at a path that was not followed to its end: with shorter increments, if this solve has the usual
    /// ones. See [`RetryStep`](crate::RetryStep).
    pub fn second_attempt(&self) -> Option<Self> {
        (self.step == StepControl::default()).then(|| Self {
            step: StepControl::patient(),
            ..self.clone()
        })
    }

    /// The id: 16 hexadecimal digits, the same for the same inputs.
    pub fn id(&self) -> String {
        short_hash(self)
    }

    /// Reads the solution from the cache folder `kept`, or computes it in `work` and writes it to the cache.
    ///
    /// A path that the solver does not follow to its end is a result and is cached. A solver that was terminated or
    /// crashed is an error. ccx is terminated after `limit`, and soon after `stop` becomes true.
    pub fn solution(
        &self,
        kept: &Path,
        work: &Path,
        tools: &Tools,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<KeptSolution, KeptSolveError> {
        let file = self.file(kept, &ToolVersions::of(tools));
        if let Some(solution) = read_json(&file)? {
            return Ok(solution);
        }
        let solution = self.solve(work, tools, limit, stop)?;
        write_json(&file, &solution)?;
        Ok(solution)
    }

    /// The file of the solution. Its name is a hash of all inputs of the result: the solve, the tool versions and the
    /// recipe version of this crate.
    fn file(&self, kept: &Path, tools: &ToolVersions) -> PathBuf {
        let name = short_hash(&(self, tools, RECIPE_VERSION));
        kept.join(name).with_extension("json")
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
        let (design, recipe) = (&self.design, &self.recipe);
        let mesh = mesh_window(design, thickness, recipe, work, &tools.gmsh, limit, stop)?;
        let model = WindowModel {
            mesh: &mesh,
            path: &self.path,
            material: &self.material,
            step: &self.step,
            print_all: false,
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

impl KeptSolution {
    /// Fraction of the path that was followed.
    fn lambda(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.lambda)
    }

    /// The one of two attempts that followed the path further, with the cost of both.
    #[must_use]
    pub fn or(self, second: Self) -> Self {
        let cpu_seconds = [self.cpu_seconds, second.cpu_seconds].into_iter().flatten();
        let cpu_seconds = cpu_seconds.reduce(|first, second| first + second);
        let iterations = self.iterations + second.iterations;
        let is_further = second.stopped.is_none() || second.lambda() > self.lambda();
        Self {
            cpu_seconds,
            iterations,
            ..if is_further { second } else { self }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeDeformation;
    use mesher::Tier;

    #[test]
    fn of_two_attempts_the_one_that_reached_further_is_kept_with_the_cost_of_both() {
        let reached = |lambda: f64, stopped: Option<&str>| KeptSolution {
            elements: 100,
            cpu_seconds: Some(2.0),
            overhead: 0.0,
            peak_memory_mib: None,
            iterations: 10,
            samples: vec![HingeSample {
                lambda,
                ..HingeSample::default()
            }],
            stopped: stopped.map(str::to_owned),
        };
        let first = reached(0.6, Some("diverged"));
        for (second, lambda, stopped) in [
            (reached(1.0, None), 1.0, false),
            (reached(0.7, Some("diverged")), 0.7, true),
            (reached(0.5, Some("diverged")), 0.6, true),
        ] {
            let kept = first.clone().or(second);
            assert_eq!((kept.lambda(), kept.stopped.is_some()), (lambda, stopped));
            assert_eq!((kept.cpu_seconds, kept.iterations), (Some(4.0), 20));
        }
    }

    #[test]
    fn the_cache_file_depends_on_the_tool_versions() {
        let material = "name = \"film\"\nthickness = 0.5\nyoung = 3000.0\npoisson = 0.4\n\
            density_kg_m3 = 1390.0\nfracture_strain = 1.784\nplastic = [[44.0, 0.0]]\n";
        let solve = KeptSolve {
            design: HingeDesign {
                w_lig: 10.0,
                alpha: 1.5,
                fillet_ratio: 0.16,
                kerf: 0.2,
                r_win: 100.0,
            },
            path: DeformationPath::straight(HingeDeformation::default()),
            material: support::toml_file::parse(material, Path::new("film.toml")).unwrap(),
            recipe: Tier::Tiny.recipe(),
            step: StepControl::default(),
        };
        let file = |gmsh: &str, ccx: &str| {
            let (gmsh, ccx) = (gmsh.to_owned(), ccx.to_owned());
            solve.file(Path::new("kept"), &ToolVersions { gmsh, ccx })
        };
        let known = file("4.8.4", "2.20");
        assert_eq!(known, file("4.8.4", "2.20"));
        assert_ne!(known, file("4.8.5", "2.20"));
        assert_ne!(known, file("4.8.4", "2.21"));
    }
}
