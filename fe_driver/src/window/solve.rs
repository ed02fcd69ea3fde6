//! One window solve: mesh, input deck, CalculiX, samples.
//!
//! A solve is successful if five conditions hold: the exit status is zero, the log contains the end marker, the
//! output contains every converged increment of the .sta file, it ends at lambda = 1, and the internal energy agrees
//! with the work of the reactions.

use crate::window::ccx::{Ccx, CcxRun};
use crate::window::dat::{DatError, Frame, Layout, read_dat};
use crate::window::deck::deck;
use crate::window::deformation_path::DeformationPath;
use crate::window::model::WindowModel;
use crate::window::ray::Ray;
use crate::window::response::samples;
use crate::window::sta::{Attempt, read_sta};
use crate::window::step_control::StepControl;
use hinge::{HingeSample, InvalidMaterial, SheetMaterial};
use mesher::{Gmsh, MeshError, Tier, mesh_window};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::program::{ToolError, remove_stale, tail};

/// All inputs of a window solve except the tool versions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowProblem {
    /// The design and the end of its ray.
    pub ray: Ray,
    /// The sheet material.
    pub material: SheetMaterial,
    /// Mesh of the window.
    pub tier: Tier,
    /// The increments of the solve.
    pub step: StepControl,
}

/// The two programs that a window solve needs.
#[derive(Clone, Debug)]
pub struct Tools {
    /// Generates the mesh.
    pub gmsh: Gmsh,
    /// Solves the window.
    pub ccx: Ccx,
}

impl Tools {
    /// Finds both by their environment variables or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Ok(Self {
            gmsh: Gmsh::find()?,
            ccx: Ccx::find()?,
        })
    }
}

/// The result of a window solve: samples, and whether they reach the end of the ray.
#[derive(Debug)]
pub struct WindowSolution {
    /// One sample per converged increment, in order of lambda; empty if the output is not valid.
    pub samples: Vec<HingeSample>,
    /// Why the samples are not those of a valid complete ray; `None` for a complete ray.
    pub stopped: Option<SolveError>,
    /// User and system time of CalculiX (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Wall time from the mesh to the samples (s).
    pub wall_seconds: f64,
    /// Wall time of CalculiX (s), a part of `wall_seconds`; zero if it was terminated.
    pub solver_seconds: f64,
    /// Maximum resident memory of CalculiX (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Newton iterations, including those of cut-back increments.
    pub iterations: usize,
}

/// Why a window solve has no samples, or only samples of a part of the ray.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum SolveError {
    #[error(transparent)]
    Material(#[from] InvalidMaterial),
    #[error("the end of the ray contains a number that is not finite: {0:?}")]
    Ray(hinge::HingeDeformation),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Solver(#[from] ToolError),
    #[error(
        "the solver exited with {status} before its first increment\nthe end of its log:\n{tail}"
    )]
    NotStarted { status: ExitStatus, tail: String },
    #[error("the solver diverged at lambda = {lambda}\nthe end of its log:\n{tail}")]
    Diverged { lambda: f64, tail: String },
    #[error("the solver reports success, but its output ends at lambda = {lambda}")]
    Truncated { lambda: f64 },
    #[error(
        "the solver's output and its status file disagree on the increment at lambda = {lambda}"
    )]
    Skipped { lambda: f64 },
    #[error(transparent)]
    Output(#[from] DatError),
    #[error(
        "the energy and the work of the whole ray differ by {residual:.2e} of the energy \
         (limit {MAX_ENERGY_RESIDUAL})"
    )]
    EnergyImbalance { residual: f64 },
    #[error("{path}: {source}", path = .path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Maximum |W - work| / W accepted at the end of a complete ray. A partial ray is not checked; its samples contain
/// the residual.
const MAX_ENERGY_RESIDUAL: f64 = 0.01;

/// Name of the deck and its output in the folder of a solve.
const JOB: &str = "window";

/// The lambda that the running solve in `folder` has reached.
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
        limit,
        stop,
    )?;
    let model = WindowModel {
        mesh: &mesh,
        path: &DeformationPath::straight(problem.ray.end),
        material: &problem.material,
        step: &problem.step,
        print_all: false,
    };
    let solution = model.solve(&tools.ccx, folder, limit, stop)?;
    Ok(WindowSolution {
        wall_seconds: start.elapsed().as_secs_f64(),
        ..solution
    })
}

impl WindowModel<'_> {
    /// Solves the window in `folder`, where the input deck, the log and the output remain.
    ///
    /// ccx is terminated after `limit`, and soon after `stop` becomes true. If the path stops early, at the time limit
    /// or by a signal, its converged increments are returned. An error means that ccx was not run, or that it
    /// was stopped on request.
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
            // The increments that converged before the termination are valid.
            Err(
                error @ (ToolError::TimedOut { .. }
                | ToolError::Killed { .. }
                | ToolError::TooMuchOutput { .. }),
            ) => Err(error),
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

    /// The valid samples, and why they are not those of the whole path.
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

    /// The last converged increment of a solve in `folder`; `None` if there is none.
    pub(crate) fn last_frame(&self, folder: &Path) -> Result<Option<Frame>, SolveError> {
        let output = folder.join(JOB).with_extension("dat");
        Ok(read_dat(&read_if_there(&output)?, self.layout())?.pop())
    }

    /// The numbers of rows that one increment of this window prints.
    fn layout(&self) -> Layout {
        Layout {
            nodes: self.mesh.nodes.len(),
            arc_nodes: self.mesh.arc_b.len(),
            displaced_nodes: match self.print_all {
                true => self.mesh.nodes.len(),
                false => self.mesh.bottom.len(),
            },
            elements: self.mesh.elements.len(),
            points: self.mesh.recipe.element().gauss_points(),
        }
    }
}

/// The first increment at which the output and the converged attempts of the .sta file disagree: it is missing
/// in the output, or it was printed although it did not converge.
///
/// A solver that was terminated may not have written all increments to both files: only those in both are
/// compared. Increments missing at the end are detected by the last lambda.
fn skipped(frames: &[Frame], attempts: &[Attempt]) -> Option<f64> {
    let converged = attempts.iter().filter(|attempt| attempt.converged);
    let mut pairs = frames
        .iter()
        .zip(converged)
        .map(|(f, a)| (f.lambda, a.lambda));
    // Numbers in the .sta file have six digits.
    let found = pairs.find(|(printed, expected)| (printed - expected).abs() > 1e-5 * printed);
    found.map(|(printed, expected)| printed.min(expected))
}

/// Maps the error of an operation on `path`, for use in `map_err`.
fn at(path: &Path) -> impl FnOnce(std::io::Error) -> SolveError {
    let path = path.to_owned();
    move |source| SolveError::File { path, source }
}

/// The bytes of a file; empty if ccx did not write it.
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
    fn a_missing_or_surplus_increment_is_found() {
        let frame = |lambda: &f64| {
            let mut frame = Frame::default();
            frame.lambda = *lambda;
            frame
        };
        let status = [(0.0, false), (0.25, true), (0.333333, true), (1.0, true)];
        let attempts = status.map(|(lambda, converged)| Attempt {
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
