//! Solves some finished jobs of a campaign again. A difference shows that a solver or a machine is not deterministic, or
//! that hosts of a cluster differ although their versions agree.

use crate::campaign::definition::{Campaign, CampaignError};
use crate::campaign::job::{JobRecord, JobSpec, JobState};
use crate::campaign::ledger::{CampaignFolder, refuse_changed};
use crate::record_file::FileError;
use crate::window::solve::{Tools, solve_window};
use crate::window::versions::ToolVersions;
use hinge::HingeSample;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
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
        let scale = before
            .iter()
            .map(|sample| sample.w.abs())
            .fold(0.0, f64::max);
        let w = pairs().map(|(a, b)| (a.w - b.w).abs()).fold(0.0, f64::max);
        (before != now).then(|| Self {
            samples: [before.len(), now.len()],
            w: w / scale,
        })
    }
}

/// Whether the samples are those of a complete first attempt, which is made as the job asks. A restored job may have been
/// solved by a retry.
fn is_of_first_attempt(spec: &JobSpec, record: &JobRecord) -> bool {
    record.failure.is_none()
        && record.attempts == 1
        && record.is_solved_here()
        && record.tier == spec.problem.tier
}

/// Solves every `every`-th job of `folder` again, among those that were complete here at the first attempt, and compares the
/// samples. Nothing in the folder is changed. `progress` receives the numbers of jobs done and of all.
///
/// Returns early, with the jobs done so far, when `stop` becomes true.
pub fn solve_again(
    campaign: &Campaign,
    folder: &Path,
    tools: &Tools,
    every: usize,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Vec<SolvedAgain>, CampaignError> {
    refuse_changed(campaign, folder)?;
    let versions = ToolVersions::of(tools);
    let folder = CampaignFolder(folder.to_owned());
    let mut complete = Vec::new();
    for id in folder.index()?.jobs {
        let job = folder.job(&id);
        if let JobState::Ended(ended) = job.state()?
            && is_of_first_attempt(&ended.0, &ended.1)
        {
            complete.push((id, job, ended));
        }
    }
    let chosen: Vec<_> = complete.into_iter().step_by(every.max(1)).collect();
    let mut solved = Vec::new();
    for (job, home, ended) in &chosen {
        progress(solved.len(), chosen.len());
        let (spec, record) = &**ended;
        if spec.tools != versions {
            let changes = "tool versions".to_owned();
            let folder = folder.0;
            return Err(CampaignError::Changed { folder, changes });
        }
        let scratch = Scratch::new().map_err(FileError::at(&std::env::temp_dir()))?;
        let work = scratch.path().join(job);
        std::fs::create_dir(&work).map_err(FileError::at(&work))?;
        let again = solve_window(&spec.problem, tools, &work, campaign.time_limit, stop);
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let again = again.map_err(|source| CampaignError::Halted {
            job: job.clone(),
            source: Box::new(source),
        })?;
        solved.push(SolvedAgain {
            job: job.clone(),
            difference: Difference::between(&home.samples(record)?, &again.samples),
        });
    }
    Ok(solved)
}
