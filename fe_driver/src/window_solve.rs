//! One window solve: mesh, deck, CalculiX, samples.
//!
//! A solve is a success by four signs together: the exit status, the end marker in the log,
//! output that is complete up to lambda = 1, and an energy that agrees with the work done.

use crate::ccx::Ccx;
use crate::dat::{DatError, Frame, Layout, read_dat};
use crate::deck::{StepControl, deck};
use crate::path::DeformationPath;
use crate::ray::Ray;
use crate::response::samples;
use hinge::{HingeSample, InvalidMaterial, SheetMaterial};
use mesher::tool::{ToolError, remove_stale, tail};
use mesher::{Gmsh, MeshError, Tier, WindowMesh, mesh_window};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
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
    /// One a converged increment, in order of lambda.
    pub samples: Vec<HingeSample>,
    /// Why the ray ends before lambda = 1; `None` for a whole ray.
    pub stopped: Option<SolveError>,
    /// User and system time of CalculiX (s), where the system tells it.
    pub cpu_seconds: Option<f64>,
    /// From the mesh to the samples (s).
    pub wall_seconds: f64,
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
    #[error("the solver diverged at lambda = {lambda}; its log ends:\n{tail}")]
    Diverged { lambda: f64, tail: String },
    #[error("the solver claims to have finished, but its output ends at lambda = {lambda}")]
    Truncated { lambda: f64 },
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
    /// keeps its converged increments: an error means that there are none.
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
        let input = folder.join(JOB).with_extension("inp");
        std::fs::write(&input, deck(self)).map_err(at(&input))?;
        let output = folder.join(JOB).with_extension("dat");
        remove_stale(&output).map_err(at(&output))?;

        let run = match ccx.run(folder, JOB, limit, stop) {
            // What had converged when it was ended is as good as ever.
            Err(error @ (ToolError::TimedOut { .. } | ToolError::Killed { .. })) => Err(error),
            other => Ok(other?),
        };
        let samples = samples(self, &read_frames(&output, self.mesh)?);
        let last = samples.last().copied().unwrap_or_default();
        let (cpu_seconds, iterations) = match &run {
            Ok(run) => (run.run.cpu_seconds, run.iterations),
            Err(error) => (error.cpu_seconds(), 0),
        };
        let stopped = match run {
            Err(error) => Some(error.into()),
            Ok(run) if !run.finished => Some(SolveError::Diverged {
                lambda: last.lambda,
                tail: tail(&folder.join(JOB).with_extension("log")),
            }),
            Ok(_) if last.lambda < 1.0 => Some(SolveError::Truncated {
                lambda: last.lambda,
            }),
            Ok(_) => None,
        };
        let residual = last.energy_residual;
        match stopped {
            Some(error) if samples.is_empty() => Err(error),
            None if residual > MAX_ENERGY_RESIDUAL => Err(SolveError::EnergyImbalance { residual }),
            stopped => Ok(WindowSolution {
                samples,
                stopped,
                cpu_seconds,
                wall_seconds: start.elapsed().as_secs_f64(),
                iterations,
            }),
        }
    }
}

/// For `map_err` on what was done to `path`.
fn at(path: &Path) -> impl FnOnce(std::io::Error) -> SolveError {
    let path = path.to_owned();
    move |source| SolveError::File { path, source }
}

/// What ccx printed; no frames if it never came to print.
fn read_frames(output: &Path, mesh: &WindowMesh) -> Result<Vec<Frame>, SolveError> {
    let bytes = match std::fs::read(output) {
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read.map_err(at(output))?,
    };
    let layout = Layout {
        arc_nodes: mesh.arc_b.len(),
        bottom_nodes: mesh.bottom.len(),
        elements: mesh.elements.len(),
        points: mesh.recipe.element().gauss_points(),
    };
    Ok(read_dat(&bytes, layout)?)
}
