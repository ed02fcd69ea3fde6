//! One window solve: mesh, deck, CalculiX, samples.
//!
//! A solve is a success by five signs together: the exit status, the end marker in the log, output
//! that leaves out no increment of the solver's own account and ends at lambda = 1, and an energy
//! that agrees with the work done.

use crate::ccx::{Ccx, CcxRun};
use crate::dat::{DatError, Frame, Layout, read_dat};
use crate::deck::{StepControl, deck};
use crate::path::DeformationPath;
use crate::ray::Ray;
use crate::response::samples;
use crate::sta::{Attempt, read_sta};
use hinge::{HingeSample, InvalidMaterial, SheetMaterial};
use mesher::tool::{ToolError, remove_stale, tail};
use mesher::{Gmsh, MeshError, Tier, WindowMesh, mesh_window};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Everything that decides the result of a window solve, but the versions of the tools.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowProblem {
    pub ray: Ray,
    pub material: SheetMaterial,
    pub tier: Tier,
    pub step: StepControl,
}

/// The two programs that a window solve needs.
#[derive(Clone, Debug)]
pub struct Tools {
    pub gmsh: Gmsh,
    pub ccx: Ccx,
}

impl Tools {
    /// Both found by their environment variables or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Ok(Self {
            gmsh: Gmsh::find()?,
            ccx: Ccx::find()?,
        })
    }
}

/// A meshed window with all that its deck says.
#[derive(Clone, Copy, Debug)]
pub struct WindowModel<'a> {
    pub mesh: &'a WindowMesh,
    pub path: &'a DeformationPath,
    pub material: &'a SheetMaterial,
    pub step: &'a StepControl,
}

/// What a window solve gave: samples, and whether they reach the end of the ray.
#[derive(Debug)]
pub struct WindowSolution {
    /// One a converged increment, in order of lambda; none if the output cannot be trusted.
    pub samples: Vec<HingeSample>,
    /// Why the ray ends before lambda = 1; `None` for a whole ray.
    pub stopped: Option<SolveError>,
    /// User and system time of CalculiX (s), where the system tells it.
    pub cpu_seconds: Option<f64>,
    /// From the mesh to the samples (s).
    pub wall_seconds: f64,
    /// Of which CalculiX ran (s); zero if it was ended.
    pub solver_seconds: f64,
    /// Largest resident memory of CalculiX (MiB), where the system tells it.
    pub peak_memory_mib: Option<f64>,
    /// Newton iterations, cut-backs included.
    pub iterations: usize,
}

/// Why a window solve gave no samples, or not all.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    #[error(transparent)]
    Material(#[from] InvalidMaterial),
    #[error("the ray's end has a number that is not finite: {0:?}")]
    Ray(hinge::HingeDeformation),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Solver(#[from] ToolError),
    #[error("the solver ended with {status} before its first increment\nits log ends:\n{tail}")]
    NotStarted { status: ExitStatus, tail: String },
    #[error("the solver diverged at lambda = {lambda}\nits log ends:\n{tail}")]
    Diverged { lambda: f64, tail: String },
    #[error("the solver claims to have finished, but its output ends at lambda = {lambda}")]
    Truncated { lambda: f64 },
    #[error("the solver's output lacks the increment at lambda = {lambda}")]
    Skipped { lambda: f64 },
    #[error(transparent)]
    Output(#[from] DatError),
    #[error(
        "energy and work of the whole ray disagree by {residual:.2e} of the energy \
         (limit {MAX_ENERGY_RESIDUAL})"
    )]
    EnergyImbalance { residual: f64 },
    #[error("{path}: {source}", path = .path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Largest |W - work| / W accepted at the end of a whole ray; a partial ray's rows carry theirs.
const MAX_ENERGY_RESIDUAL: f64 = 0.01;

/// Name of the deck and its output in the folder of a solve.
const JOB: &str = "window";

/// How far along its path (lambda) the solve in `folder` has come, while it runs.
pub fn reached(folder: &Path) -> f64 {
    let status = std::fs::read(folder.join(JOB).with_extension("sta")).unwrap_or_default();
    let attempts = read_sta(&status);
    attempts.last().map_or(0.0, |attempt| attempt.lambda)
}

/// Meshes the window of `problem` and solves it in `folder`; see [`WindowModel::solve`].
pub fn solve_window(
    problem: &WindowProblem,
    tools: &Tools,
    folder: &Path,
    limit: Duration,
    stop: &AtomicBool,
) -> Result<WindowSolution, SolveError> {
    let start = Instant::now();
    let (design, thickness) = (&problem.ray.design, problem.material.thickness);
    let mesh = mesh_window(
        design,
        thickness,
        &problem.tier.recipe(),
        folder,
        &tools.gmsh,
    )?;
    let model = WindowModel {
        mesh: &mesh,
        path: &DeformationPath::straight(problem.ray.end),
        material: &problem.material,
        step: &problem.step,
    };
    let solution = model.solve(&tools.ccx, folder, limit, stop)?;
    Ok(WindowSolution {
        wall_seconds: start.elapsed().as_secs_f64(),
        ..solution
    })
}

impl WindowModel<'_> {
    /// Solves the window in `folder`, which keeps the deck, the log and the output.
    ///
    /// ccx is ended after `limit`, and soon after `stop` becomes true. A path that stops early
    /// keeps its converged increments. An error means that ccx did not run, or not to an end of
    /// its own.
    pub fn solve(
        &self,
        ccx: &Ccx,
        folder: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowSolution, SolveError> {
        let start = Instant::now();
        self.material.validate()?;
        let end = self.path.at(1.0);
        if !end.to_array().iter().all(|x| x.is_finite()) {
            return Err(SolveError::Ray(end));
        }
        let [input, output, status, log] =
            ["inp", "dat", "sta", "log"].map(|kind| folder.join(JOB).with_extension(kind));
        std::fs::write(&input, deck(self)).map_err(at(&input))?;
        for stale in [&output, &status] {
            remove_stale(stale).map_err(at(stale))?;
        }

        let run = match ccx.run(folder, JOB, limit, stop) {
            // What had converged when it was ended is as good as ever.
            Err(error @ (ToolError::TimedOut { .. } | ToolError::Killed { .. })) => Err(error),
            other => Ok(other?),
        };
        let attempts = read_sta(&read_if_there(&status)?);
        let (cpu_seconds, solver_seconds, peak_memory_mib) = match &run {
            Ok(CcxRun { run, .. }) => (run.cpu_seconds, run.wall_seconds, run.peak_memory_mib),
            Err(error) => (error.cpu_seconds(), 0.0, None),
        };
        let (samples, stopped) = self.outcome(run, &attempts, &output, &log)?;
        Ok(WindowSolution {
            samples,
            stopped,
            cpu_seconds,
            wall_seconds: start.elapsed().as_secs_f64(),
            solver_seconds,
            peak_memory_mib,
            iterations: attempts.iter().map(|attempt| attempt.iterations).sum(),
        })
    }

    /// The samples that can be trusted, and why they are not those of the whole path.
    fn outcome(
        &self,
        run: Result<CcxRun, ToolError>,
        attempts: &[Attempt],
        output: &Path,
        log: &Path,
    ) -> Result<(Vec<HingeSample>, Option<SolveError>), SolveError> {
        let frames = match read_dat(&read_if_there(output)?, self.layout()) {
            Ok(frames) => frames,
            Err(error) => return Ok((Vec::new(), Some(error.into()))),
        };
        let finished = run.as_ref().is_ok_and(|run| run.finished);
        if let Some(lambda) = skipped(&frames, attempts) {
            return Ok((Vec::new(), Some(SolveError::Skipped { lambda })));
        }
        let samples = samples(self, &frames);
        let last = samples.last().copied().unwrap_or_default();
        let (lambda, residual) = (last.lambda, last.energy_residual);
        let stopped = match run {
            Err(error) => Some(error.into()),
            Ok(CcxRun { run, .. }) if !finished && attempts.is_empty() => {
                Some(SolveError::NotStarted {
                    status: run.status,
                    tail: tail(log),
                })
            }
            Ok(_) if !finished => Some(SolveError::Diverged {
                lambda,
                tail: tail(log),
            }),
            Ok(_) if lambda < 1.0 => Some(SolveError::Truncated { lambda }),
            Ok(_) if residual > MAX_ENERGY_RESIDUAL => {
                return Ok((Vec::new(), Some(SolveError::EnergyImbalance { residual })));
            }
            Ok(_) => None,
        };
        Ok((samples, stopped))
    }

    /// What one increment of this window prints.
    fn layout(&self) -> Layout {
        Layout {
            arc_nodes: self.mesh.arc_b.len(),
            bottom_nodes: self.mesh.bottom.len(),
            elements: self.mesh.elements.len(),
            points: self.mesh.recipe.element().gauss_points(),
        }
    }
}

/// The first increment that the output lacks, or holds although it did not converge, by the
/// solver's own account.
///
/// A solver that was ended has not written all that it had in either file: only what both tell of
/// is compared. What is missing at the end is seen by lambda.
fn skipped(frames: &[Frame], attempts: &[Attempt]) -> Option<f64> {
    let told = attempts.iter().filter(|attempt| attempt.converged);
    let mut pairs = frames.iter().zip(told).map(|(f, a)| (f.lambda, a.lambda));
    // The account has six digits.
    let found = pairs.find(|(printed, told)| (printed - told).abs() > 1e-5 * printed);
    found.map(|(printed, told)| printed.min(told))
}

/// For `map_err` on what was done to `path`.
fn at(path: &Path) -> impl FnOnce(std::io::Error) -> SolveError {
    let path = path.to_owned();
    move |source| SolveError::File { path, source }
}

/// The bytes of a file; none if ccx never came to write it.
fn read_if_there(path: &Path) -> Result<Vec<u8>, SolveError> {
    match std::fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        read => read.map_err(at(path)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_increment_that_is_missing_or_too_many_is_found() {
        let frame = |lambda: &f64| {
            let mut frame = Frame::default();
            frame.lambda = *lambda;
            frame
        };
        let told = [(0.0, false), (0.25, true), (0.333333, true), (1.0, true)];
        let attempts = told.map(|(lambda, converged)| Attempt {
            lambda,
            iterations: 3,
            converged,
        });
        let skipped = |printed: &[f64]| {
            let frames: Vec<_> = printed.iter().map(frame).collect();
            skipped(&frames, &attempts)
        };
        assert_eq!(skipped(&[0.25, 1.0 / 3.0, 1.0]), None);
        assert_eq!(skipped(&[0.25, 1.0 / 3.0]), None);
        assert_eq!(skipped(&[0.25, 1.0]), Some(0.333333));
        assert_eq!(skipped(&[0.25, 0.3, 1.0 / 3.0, 1.0]), Some(0.3));
    }
}
