//! Windows on random rays, solved by finite elements, as rows of a database.

use crate::rows::rows;
use crate::verification_error::VerificationError;
use dataset::Row;
use fe_driver::{
    Campaign, JobPart, SolveService, Solved, SpotPath, WindowProblem, WindowSolve, finished_windows,
};
use hinge::{HingeSample, SheetMaterial};
use mesher::Tier;
use std::collections::HashMap;
use std::path::Path;
use support::fault::Fault;

/// The states on paths that the solver followed to their end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpotStates {
    /// One row a state; the rows of a window have one job.
    pub rows: Vec<Row>,
    /// The windows of the other paths.
    pub unsolved: Vec<Fault>,
    /// Number of states on the other paths, at which nothing is known.
    pub unknown_states: usize,
    /// Solver CPU time of the paths that it followed to their end (s).
    pub cpu_seconds: f64,
}

/// Solves the windows of the paths.
pub fn spot_check(
    windows: &SolveService,
    paths: &[SpotPath],
    material: &SheetMaterial,
    tier: Tier,
) -> Result<SpotStates, VerificationError> {
    let versions = windows.versions();
    let problem = |path: &SpotPath| WindowProblem::new(path.hinge.clone(), material, tier);
    let solves: Vec<WindowSolve> =
        (paths.iter()).map(|path| WindowSolve::new(problem(path), &versions)).collect();
    let solved = windows.solve(&solves)?;
    let mut check = SpotStates::default();
    for (path, window) in paths.iter().zip(&solved) {
        check.add(path, window);
    }
    Ok(check)
}

impl SpotStates {
    /// The spot check of a campaign, as far as its rays are solved in `folder`; `parts` are the
    /// jobs there.
    pub fn collected(
        campaign: &Campaign,
        parts: &HashMap<String, JobPart>,
        folder: &Path,
    ) -> Result<Self, VerificationError> {
        let windows = finished_windows(folder)?;
        let windows = windows.filter(|window| {
            let is_spot = |window: &Solved| parts.get(&window.id) == Some(&JobPart::SpotCheck);
            window.as_ref().map_or(true, is_spot)
        });
        let windows: Vec<Solved> =
            windows.collect::<Result<_, _>>().map_err(fe_driver::CampaignError::from)?;
        let mut check = Self::default();
        for path in campaign.spot_paths() {
            let of_path = |window: &&Solved| window.solve.problem.hinge == path.hinge;
            match windows.iter().find(of_path) {
                Some(window) => check.add(&path, window),
                None => check.unknown_states += path.fractions.len(),
            }
        }
        Ok(check)
    }

    /// Adds the states on a path.
    fn add(&mut self, path: &SpotPath, window: &Solved) {
        match window.complete() {
            Ok(samples) => {
                let states = path.fractions.iter();
                let states = states.filter_map(|fraction| HingeSample::at(samples, *fraction));
                self.rows.extend(rows(window, states));
                self.cpu_seconds += window.record.cpu_seconds;
            }
            Err(unsolved) => {
                self.unknown_states += path.fractions.len();
                self.unsolved.push(unsolved);
            }
        }
    }
}
