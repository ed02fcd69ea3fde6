//! CalculiX as a solver of sheets: mesh, input deck, process, states.

use crate::{
    AttemptKind, CalculiX, Cause, DeckRun, FailureKind, SECONDS, SheetLayout, SheetModel,
    SheetNodes, SheetProblem, SheetSolve, SheetStates, Solution, Solve, SolveError, SolveFolder,
    Solver, ToolVersions, states, time_reached,
};
use mesher::{Panels, Tier};
use std::fmt::Display;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Name of the deck and its output in the folder of an attempt.
const JOB: &str = "sheet";

/// The lambda that the solve of a sheet in `folder` has reached; 1 when no attempt is left.
pub fn sheet_reached(folder: &SolveFolder) -> f64 {
    let record = folder.record().ok().flatten();
    let time = time_reached(&folder.work_here(), JOB);
    match record.map(|record| record.next) {
        Some(None) => 1.0,
        Some(Some(AttemptKind::Dynamic)) => time / SECONDS,
        _ => time,
    }
}

impl Solve for SheetSolve {
    type Samples = SheetStates;

    fn tier(&self) -> Tier {
        self.problem.tier
    }

    fn description(&self) -> String {
        let SheetProblem { shape, tier, .. } = &self.problem;
        format!(
            "sheet of {} panels and {} hinges, tier {tier}",
            shape.panels.len(),
            shape.windows.len()
        )
    }

    /// A sheet that snaps has no static path beyond: inertia carries it on.
    fn next_attempt(
        &self,
        attempt: AttemptKind,
        failure: FailureKind,
        _lambda: f64,
    ) -> Option<AttemptKind> {
        match (failure, attempt) {
            // Rigid panels have no mass.
            (FailureKind::Diverged, AttemptKind::Requested) => {
                let has_mass = self.problem.shape.model == Panels::Meshed;
                (has_mass && !self.problem.dynamic).then_some(AttemptKind::Dynamic)
            }
            _ => None,
        }
    }

    fn attempted(&self, attempt: AttemptKind) -> Self {
        let mut solve = self.clone();
        if attempt == AttemptKind::Dynamic {
            solve.problem.dynamic = true;
            solve.problem.step = SheetProblem::dynamic_step();
        }
        solve
    }
}

impl Solver<SheetSolve> for CalculiX {
    fn versions(&self) -> ToolVersions {
        CalculiX::versions(self)
    }

    fn attempt(
        &self,
        solve: &SheetSolve,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution<SheetStates>, SolveError> {
        let start = Instant::now();
        let problem = &solve.problem;
        let invalid = |error: &dyn Display| Cause::Problem(FailureKind::InvalidInput).error(error);
        problem.material.validate().map_err(|error| invalid(&error))?;
        problem.validate().map_err(|error| invalid(&error))?;
        let mesh = problem.shape.mesh(work, &self.gmsh, limit, stop)?;
        let nodes = SheetNodes::new(problem, &mesh).map_err(|error| invalid(&error))?;
        let model = SheetModel { problem, mesh: &mesh, nodes: &nodes };
        let run = DeckRun::new(&self.ccx, &model.deck(), work, JOB, limit, stop)?;
        let layout = SheetLayout::new(&model);
        let mut solution = run.solution(&layout, |frames| states(&model, frames));
        solution.elements = mesh.elements.len();
        solution.wall_seconds = start.elapsed().as_secs_f64();
        Ok(solution)
    }
}
