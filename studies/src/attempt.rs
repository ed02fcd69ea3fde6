//! One attempt at a window in a folder of its own, whose mesh and output a study reads afterwards.

use crate::stop::refuse_stop_without_store;
use anyhow::Result;
use fe_driver::{CalculiX, Solution, SolveError, Solver, WindowSolve};
use kirigami::ui::interrupt;
use std::path::Path;
use std::time::Duration;

/// The solution, or why there is none; fails if the study is stopped.
pub fn attempt(
    solver: &CalculiX,
    solve: &WindowSolve,
    folder: &Path,
    limit: Duration,
) -> Result<Result<Solution, SolveError>> {
    std::fs::create_dir_all(folder)?;
    let stop = interrupt::stop_flag()?;
    let solution = solver.attempt(solve, folder, limit, stop);
    refuse_stop_without_store(stop)?;
    Ok(solution)
}
