//! CalculiX as a window solver: mesh, input deck, process, samples.
//!
//! An attempt is successful if five conditions hold: the exit status is zero, the log contains the end marker, the
//! output contains every converged increment of the .sta file, it ends at lambda = 1, and the internal energy agrees
//! with the work of the reactions.

use crate::calculix::ccx::{Ccx, CcxRun};
use crate::calculix::dat::{Frame, Layout, read_dat};
use crate::calculix::deck::deck;
use crate::calculix::model::WindowModel;
use crate::calculix::response::samples;
use crate::calculix::sta::{Increment, read_sta};
use crate::solve::tool_versions::ToolVersions;
use crate::solve::window_solve::WindowSolve;
use crate::solve::window_solver::{MAX_ENERGY_RESIDUAL, SolveError, WindowSolution, WindowSolver};
use hinge::HingeSample;
use mesher::{Gmsh, WindowMesh, WindowShape};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::file_error::FileError;
use support::program::{ToolError, remove_stale, tail};
use support::vtk::UnstructuredGrid;

/// gmsh and CalculiX, which solve windows.
#[derive(Clone, Debug)]
pub struct CalculiX {
    /// Generates the mesh.
    pub gmsh: Gmsh,
    /// Solves the window.
    pub ccx: Ccx,
    /// Whether the displacements of all nodes are printed, for [`fields`](Self::fields); if not, those of the lower
    /// face, which are a small part of the output.
    pub print_all: bool,
}

/// Name of the deck and its output in the folder of an attempt.
const JOB: &str = "window";

/// The lambda that the running attempt in `folder` has reached.
pub fn reached(folder: &Path) -> f64 {
    let status = std::fs::read(folder.join(JOB).with_extension("sta")).unwrap_or_default();
    let increments = read_sta(&status);
    increments.last().map_or(0.0, |increment| increment.lambda)
}

impl CalculiX {
    /// Finds both programs by their environment variables or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Ok(Self {
            gmsh: Gmsh::find()?,
            ccx: Ccx::find()?,
            print_all: false,
        })
    }

    /// The undeformed window with the fields of the last converged increment of an attempt in `folder`, which must have
    /// printed the displacements of all nodes; `None` if no increment converged.
    pub fn fields(
        &self,
        solve: &WindowSolve,
        folder: &Path,
    ) -> Result<Option<UnstructuredGrid>, SolveError> {
        let mesh = shape(solve).read(folder)?;
        let model = self.model(solve, &mesh);
        let output = folder.join(JOB).with_extension("dat");
        let last = read_dat(&read_if_there(&output)?, model.layout())?.pop();
        Ok(last.map(|frame| model.grid(&frame)))
    }

    fn model<'a>(&self, solve: &'a WindowSolve, mesh: &'a WindowMesh) -> WindowModel<'a> {
        let problem = &solve.problem;
        WindowModel {
            mesh,
            path: &problem.hinge.path,
            material: &problem.material,
            step: &problem.step,
            print_all: self.print_all,
        }
    }
}

fn shape(solve: &WindowSolve) -> WindowShape<'_> {
    WindowShape {
        design: &solve.problem.hinge.design,
        thickness: solve.problem.material.thickness,
        recipe: &solve.mesh,
    }
}

impl WindowSolver for CalculiX {
    fn versions(&self) -> ToolVersions {
        ToolVersions {
            gmsh: self.gmsh.0.version.clone(),
            ccx: self.ccx.0.version.clone(),
        }
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowSolution, SolveError> {
        let start = Instant::now();
        let mesh = shape(solve).mesh(work, &self.gmsh, limit, stop)?;
        let solution = (self.model(solve, &mesh)).solve(&self.ccx, work, limit, stop)?;
        Ok(WindowSolution {
            wall_seconds: start.elapsed().as_secs_f64(),
            elements: mesh.elements.len(),
            ..solution
        })
    }
}

impl WindowModel<'_> {
    /// Solves the window in `folder`; see [`WindowSolver::attempt`].
    fn solve(
        &self,
        ccx: &Ccx,
        folder: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<WindowSolution, SolveError> {
        self.material.validate()?;
        let end = self.path.at(1.0);
        if !end.to_array().iter().all(|x| x.is_finite()) {
            return Err(SolveError::Ray(end));
        }
        let [input, output, status, log] =
            ["inp", "dat", "sta", "log"].map(|kind| folder.join(JOB).with_extension(kind));
        std::fs::write(&input, deck(self)).map_err(FileError::at(&input))?;
        for stale in [&output, &status] {
            remove_stale(stale).map_err(FileError::at(stale))?;
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
        let increments = read_sta(&read_if_there(&status)?);
        let (cpu_seconds, solver_seconds, peak_memory_mib) = match &run {
            Ok(CcxRun { run, .. }) => (run.cpu_seconds, run.wall_seconds, run.peak_memory_mib),
            Err(error) => (error.cpu_seconds(), 0.0, None),
        };
        let (samples, stopped) = self.outcome(run, &increments, &output, &log)?;
        Ok(WindowSolution {
            samples,
            stopped,
            cpu_seconds,
            solver_seconds,
            peak_memory_mib,
            iterations: increments
                .iter()
                .map(|increment| increment.iterations)
                .sum(),
            ..WindowSolution::default()
        })
    }

    /// The valid samples, and why they are not those of the whole path.
    fn outcome(
        &self,
        run: Result<CcxRun, ToolError>,
        increments: &[Increment],
        output: &Path,
        log: &Path,
    ) -> Result<(Vec<HingeSample>, Option<SolveError>), SolveError> {
        let frames = match read_dat(&read_if_there(output)?, self.layout()) {
            Ok(frames) => frames,
            Err(error) => return Ok((Vec::new(), Some(error.into()))),
        };
        let finished = run.as_ref().is_ok_and(|run| run.finished);
        if let Some(lambda) = skipped(&frames, increments) {
            return Ok((Vec::new(), Some(SolveError::Skipped { lambda })));
        }
        let samples = samples(self, &frames);
        let last = samples.last().copied().unwrap_or_default();
        let (lambda, residual) = (last.lambda, last.energy_residual);
        let stopped = match run {
            Err(error) => Some(error.into()),
            Ok(CcxRun { run, .. }) if !finished && increments.is_empty() => {
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

    /// The numbers of rows that one increment of this window prints.
    fn layout(&self) -> Layout {
        Layout {
            nodes: self.mesh.nodes.len(),
            arc_nodes: self.mesh.arc_b.len(),
            displaced_nodes: if self.print_all {
                self.mesh.nodes.len()
            } else {
                self.mesh.bottom.len()
            },
            elements: self.mesh.elements.len(),
            points: self.mesh.recipe.element().gauss_points(),
        }
    }
}

/// The first increment at which the output and the converged increments of the .sta file disagree: it is missing
/// in the output, or it was printed although it did not converge.
///
/// A solver that was terminated may not have written all increments to both files: only those in both are
/// compared. Increments missing at the end are detected by the last lambda.
fn skipped(frames: &[Frame], increments: &[Increment]) -> Option<f64> {
    let converged = increments.iter().filter(|increment| increment.converged);
    let mut pairs = frames
        .iter()
        .zip(converged)
        .map(|(f, a)| (f.lambda, a.lambda));
    // Numbers in the .sta file have six digits.
    let found = pairs.find(|(printed, expected)| (printed - expected).abs() > 1e-5 * printed);
    found.map(|(printed, expected)| printed.min(expected))
}

/// The bytes of a file; empty if ccx did not write it.
fn read_if_there(path: &Path) -> Result<Vec<u8>, FileError> {
    match std::fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        read => read.map_err(FileError::at(path)),
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
        let increments = status.map(|(lambda, converged)| Increment {
            lambda,
            iterations: 3,
            converged,
        });
        let skipped = |printed: &[f64]| {
            let frames: Vec<_> = printed.iter().map(frame).collect();
            skipped(&frames, &increments)
        };
        assert_eq!(skipped(&[0.25, 1.0 / 3.0, 1.0]), None);
        assert_eq!(skipped(&[0.25, 1.0 / 3.0]), None);
        assert_eq!(skipped(&[0.25, 1.0]), Some(0.333333));
        assert_eq!(skipped(&[0.25, 0.3, 1.0 / 3.0, 1.0]), Some(0.3));
    }
}
