//! Solves some finished jobs of a campaign again. A difference shows that a solver or a machine is
//! not deterministic, or that hosts of a cluster differ although their versions agree.

use crate::campaign::campaign_folder::CampaignFolder;
use crate::campaign::definition::{Campaign, CampaignError};
use crate::campaign::status::known_parts;
use crate::solve::attempts::SolveListError;
use crate::solve::solved::Solved;
use crate::solve::solver::Solver;
use hinge::HingeSample;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use support::file_error::FileError;
use support::scratch::Scratch;

/// A job that was solved again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SolvedAgain {
    /// Id of the job.
    pub job: String,
    /// What differs between the samples; `None` if they agree to the last bit.
    pub difference: Option<Difference>,
}

/// How the samples of two solves of one job differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Numbers of samples before and now.
    pub samples: [usize; 2],
    /// Maximum difference of W between samples of the same place, over the maximum W of the job.
    pub w: f64,
}

impl Difference {
    /// The difference between the samples of two solves; `None` if there is none.
    fn between(before: &[HingeSample], now: &[HingeSample]) -> Option<Self> {
        let pairs = || before.iter().zip(now);
        let scale = before.iter().map(|sample| sample.w.abs()).fold(0.0, f64::max);
        let w = pairs().map(|(a, b)| (a.w - b.w).abs()).fold(0.0, f64::max);
        (before != now).then(|| Self { samples: [before.len(), now.len()], w: w / scale })
    }
}

/// Whether the samples come from a complete first attempt. A restored job may have been solved by a
/// later attempt.
fn is_of_first_attempt(window: &Solved) -> bool {
    let record = &window.record;
    record.failure.is_none()
        && record.attempts == 1
        && record.is_solved_here()
        && record.tier == window.solve.problem.tier
}

/// Solves every `every`-th job of `folder` again, among those that were complete here at the first
/// attempt, and compares the samples. Nothing in the folder is changed. `progress` receives the
/// numbers of jobs done and of all.
///
/// Returns early, with the jobs done so far, when `stop` becomes true.
pub fn solve_again(
    campaign: &Campaign,
    folder: &Path,
    solver: &dyn Solver,
    every: usize,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Vec<SolvedAgain>, CampaignError> {
    known_parts(campaign, folder)?;
    let campaign_folder = CampaignFolder(folder.to_owned());
    let store = campaign_folder.store();
    let mut complete = Vec::new();
    for id in campaign_folder.index()?.jobs {
        if let Some(window) = store.solve(&id).result()?
            && is_of_first_attempt(&window)
        {
            complete.push(window);
        }
    }
    let chosen: Vec<_> = complete.into_iter().step_by(every.max(1)).collect();
    let mut solved = Vec::new();
    for window in &chosen {
        progress(solved.len(), chosen.len());
        if window.solve.tools != solver.versions() {
            let (folder, changes) = (folder.to_owned(), "tool versions".to_owned());
            return Err(CampaignError::Changed { folder, changes });
        }
        let scratch = Scratch::new().map_err(FileError::at(&std::env::temp_dir()))?;
        let work = scratch.path().join(&window.id);
        std::fs::create_dir(&work).map_err(FileError::at(&work))?;
        let again = solver.attempt(&window.solve, &work, campaign.time_limit, stop);
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let again = again.map_err(|source| SolveListError::Halted {
            job: window.id.clone(),
            source: Box::new(source),
        })?;
        solved.push(SolvedAgain {
            job: window.id.clone(),
            difference: Difference::between(&window.samples, &again.samples),
        });
    }
    Ok(solved)
}
