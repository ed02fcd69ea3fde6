//! Recreates job folders from collected samples, so that collected jobs are not solved again.

use crate::{
    Campaign, CampaignError, CampaignFolder, Event, FailureKind, Index, Shard, SolveRecord,
    ToolVersions, WindowSolve, now,
};
use hinge::HingeSample;
use mesher::Tier;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use support::refuse;

/// What a database contains of a solve.
#[derive(Clone, Debug, PartialEq)]
pub struct CollectedWindow {
    /// Id of the solve.
    pub id: String,
    /// Versions of the programs that solved it.
    pub tools: ToolVersions,
    /// Tier on which the samples were solved.
    pub solved_tier: Tier,
    /// One sample per converged increment.
    pub samples: Vec<HingeSample>,
    /// Solver CPU time over all attempts (s).
    pub cpu_seconds: f64,
    /// Why the samples end before the end of the path; `None` for a complete path.
    pub failure: Option<FailureKind>,
}

/// Numbers of jobs that were restored, already present, and foreign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Restored {
    /// Jobs that were restored.
    pub written: usize,
    /// Jobs that are already closed in the folder; they are not changed.
    pub there: usize,
    /// Jobs that do not belong to the campaign.
    pub foreign: usize,
}

/// Recreates the folders of jobs that `campaign` finished in another place or earlier.
///
/// The id of a job is a hash of all inputs of its result. Jobs of another campaign are omitted; it
/// is an error if all jobs are of another campaign.
pub fn restore(
    campaign: &Campaign,
    folder: &Path,
    collected: &[CollectedWindow],
) -> Result<Restored, CampaignError> {
    let mut restored = Restored::default();
    let Some(first) = collected.first() else {
        return Ok(restored);
    };
    // Jobs of another campaign may have been solved with other versions of gmsh and ccx.
    let mut tools: Vec<&ToolVersions> = Vec::new();
    for window in collected {
        if !tools.contains(&&window.tools) {
            tools.push(&window.tools);
        }
    }
    let solves_with = |tools| {
        let solves: Vec<WindowSolve> = campaign.solves(tools).collect();
        let index = Index::new(&campaign.name, &solves);
        let ids: HashSet<&String> = index.jobs.iter().collect();
        let known = collected.iter().any(|window| ids.contains(&window.id));
        known.then_some((index, solves))
    };
    let Some((index, solves)) = tools.into_iter().find_map(solves_with) else {
        refuse!(
            "none of the jobs belongs to the campaign (the first is {}): they were solved with other settings, with another \
     version of gmsh or ccx, or for another campaign",
            first.id
        );
    };
    let solves: HashMap<_, _> = index.jobs.iter().zip(solves).collect();
    let folder = CampaignFolder(folder.to_owned());
    let (store, mut history) = (folder.store(), folder.enter(Shard::WHOLE, &index)?);
    for window in collected {
        let Some(solve) = solves.get(&window.id) else {
            restored.foreign += 1;
            continue;
        };
        let home = store.solve(&window.id);
        if home.ended::<WindowSolve>()?.is_some_and(|record| record.is_closed()) {
            restored.there += 1;
            continue;
        }
        home.write_solve(solve)?;
        let rows_hash = home.write_samples(&window.samples)?;
        home.write_record(&record(window, rows_hash))?;
        history.note(&window.id, &Event::Restored)?;
        restored.written += 1;
    }
    Ok(restored)
}

/// The record of a solve that was made elsewhere. The database does not contain its wall time.
fn record(window: &CollectedWindow, rows_hash: String) -> SolveRecord {
    SolveRecord {
        failure: window.failure,
        message: (window.failure).map(|_| "restored from a database".to_owned()),
        attempts: 1,
        tier: window.solved_tier,
        rows: window.samples.len(),
        rows_hash,
        lambda: window.samples.last().map_or(0.0, |last| last.lambda),
        cpu_seconds: window.cpu_seconds,
        ended: now(),
        ..SolveRecord::default()
    }
}
