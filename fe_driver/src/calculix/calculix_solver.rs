//! CalculiX as a solver of windows: mesh, input deck, process, samples.
//!
//! An attempt is successful if its run is ([`DeckRun`]) and the internal energy agrees with the
//! work of the reactions.

use crate::{
    Cause, Ccx, DeckRun, FailureKind, Layout, OutputFrame, Solution, SolveError, Solver,
    ToolVersions, WindowModel, WindowSolve, deck, read_dat, read_if_there, samples, time_reached,
};
use mesher::{Gmsh, WindowMesh, WindowShape};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use support::program::ToolError;
use support::vtk::UnstructuredGrid;

/// gmsh and CalculiX, which solve windows and sheets.
#[derive(Debug)]
pub struct CalculiX {
    /// Generates the mesh.
    pub gmsh: Gmsh,
    /// Solves the mesh.
    pub ccx: Ccx,
    /// Whether the displacements of all nodes of a window are printed, for
    /// [`fields`](Self::fields); if not, only the displacements of the lower face are printed,
    /// which are a small part of the output.
    pub print_all: bool,
}

/// Name of the deck and its output in the folder of an attempt.
const JOB: &str = "window";

/// Maximum |W - work| / W accepted at the end of a complete path. A partial path is not checked;
/// its samples contain the residual.
const MAX_ENERGY_RESIDUAL: f64 = 0.01;

/// The lambda that the running attempt in `folder` has reached.
pub fn reached(folder: &Path) -> f64 {
    time_reached(folder, JOB)
}

impl CalculiX {
    /// Finds both programs by their environment variables or on PATH.
    pub fn find() -> Result<Self, ToolError> {
        Ok(Self { gmsh: Gmsh::find()?, ccx: Ccx::find()?, print_all: false })
    }

    /// The undeformed window with the fields of the last converged increment of an attempt in
    /// `folder`, which must have printed the displacements of all nodes; `None` if no increment
    /// converged.
    pub fn fields(
        &self,
        solve: &WindowSolve,
        folder: &Path,
    ) -> Result<Option<UnstructuredGrid>, SolveError> {
        let mesh = shape(solve).read(folder)?;
        let model = self.model(solve, &mesh);
        let last = model.frames(folder)?.pop();
        Ok(last.map(|frame| model.grid(&frame)))
    }

    /// The versions of the programs.
    pub fn versions(&self) -> ToolVersions {
        ToolVersions { gmsh: self.gmsh.0.version.clone(), ccx: self.ccx.0.version.clone() }
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

impl Solver for CalculiX {
    fn versions(&self) -> ToolVersions {
        CalculiX::versions(self)
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let start = Instant::now();
        let mesh = shape(solve).mesh(work, &self.gmsh, limit, stop)?;
        let model = self.model(solve, &mesh);
        let invalid = Cause::Problem(FailureKind::InvalidInput);
        model.material.validate().map_err(|error| invalid.error(error))?;
        let end = model.path.at(1.0);
        if !end.to_array().iter().all(|x| x.is_finite()) {
            let what = "the end of the ray contains a number that is not finite";
            return Err(invalid.error(format!("{what}: {end:?}")));
        }
        let run = DeckRun::new(&self.ccx, &deck(&model), work, JOB, limit, stop)?;
        let mut solution = run.solution(&model.layout(), |frames| samples(&model, frames));
        let residual = solution.samples.last().map_or(0.0, |last| last.energy_residual);
        if solution.stopped.is_none() && residual > MAX_ENERGY_RESIDUAL {
            solution.samples.clear();
            let imbalance = Cause::Problem(FailureKind::EnergyImbalance).error(format!(
                "the energy and the work of the whole ray differ by {residual:.2e} of the energy (limit \
                 {MAX_ENERGY_RESIDUAL})"
            ));
            solution.stopped = Some(imbalance);
        }
        solution.wall_seconds = start.elapsed().as_secs_f64();
        solution.elements = mesh.elements.len();
        Ok(solution)
    }
}

impl WindowModel<'_> {
    /// The printed increments of an attempt in `folder`.
    fn frames(&self, folder: &Path) -> Result<Vec<OutputFrame>, SolveError> {
        let output = read_if_there(&folder.join(JOB).with_extension("dat"))?;
        read_dat(&output, self.layout()).map_err(|error| Cause::Machine.error(error))
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
