//! The plan of a run: the jobs that it would solve, and why.

use crate::{
    Campaign, CampaignError, CampaignFolder, Index, Shard, Solve, SolveState, Tally, ToolVersions,
    WindowSolve, short_hash, unless_damaged,
};
use mesher::Tier;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// The work that a run would do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Numbers of jobs by their state.
    pub tally: Tally,
    /// Numbers of jobs that a run would work on, by reason.
    pub reasons: BTreeMap<String, usize>,
    /// Jobs in the folder that no longer belong to the campaign; they are kept.
    pub stale: usize,
    /// Estimated time of one worker (s), from the jobs of each mesh whose time is known
    /// ([`Tally::timed`]); if there is none, the time of as many jobs of the polyester film.
    pub seconds: f64,
    /// Memory of one worker (MB) for the largest mesh.
    pub memory_mb: f64,
    /// Disk space of the jobs to run (MB).
    pub disk_mb: f64,
}

/// Disk space of a solved job (MB): three files and their folders.
const JOB_MB: f64 = 0.05;

/// Returns what [`crate::run`] would do in `folder`, without changing anything.
pub fn plan(
    campaign: &Campaign,
    folder: &Path,
    versions: &ToolVersions,
) -> Result<Plan, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    folder.known(&campaign.name)?;
    let (store, solves) = (folder.store(), campaign.solves(versions).collect::<Vec<_>>());
    let ids: Vec<String> = solves.iter().map(WindowSolve::id).collect();
    let requested: HashSet<&String> = ids.iter().collect();
    // Jobs in the folder that do not belong to the campaign, one of each ray by its hash.
    let (mut stale, mut old_rays) = (0, HashMap::new());
    for id in store.ids()?.iter().filter(|id| !requested.contains(id)) {
        // A damaged job of another campaign is ignored.
        if let Some(Some(solve)) = unless_damaged(store.solve(id).solve::<WindowSolve>())? {
            stale += 1;
            old_rays.insert(short_hash(&solve.problem.hinge), solve);
        }
    }
    let (mut tally, mut reasons) = (Tally::default(), BTreeMap::new());
    let mut to_run: Vec<Tier> = Vec::new();
    for (id, solve) in std::iter::zip(&ids, &solves) {
        let state = store.solve(id).state()?;
        tally.add_state(id, &state);
        let reason = match state {
            SolveState::Ended(ended) => match (ended.1.failure, ended.1.next) {
                (Some(failure), Some(next)) => format!("{failure}, next {next}"),
                _ => continue,
            },
            SolveState::Open { started: true } => "interrupted".to_owned(),
            SolveState::Open { started: false } => {
                match old_rays.get(&short_hash(&solve.problem.hinge)) {
                    Some(old) => format!("stale: {} changed", solve.differences(old).join(", ")),
                    None => "new".to_owned(),
                }
            }
            SolveState::Damaged(reason) => format!("damaged: {reason} (job {id})"),
        };
        *reasons.entry(reason).or_default() += 1;
        to_run.push(solve.tier());
    }
    let tiers = || to_run.iter();
    Ok(Plan {
        seconds: tiers().map(|tier| tally.seconds_a_job(*tier)).sum(),
        memory_mb: tiers().map(|tier| tier.usual_memory_mb()).fold(0.0, f64::max),
        disk_mb: JOB_MB * to_run.len() as f64,
        tally,
        reasons,
        stale,
    })
}

/// Enters the jobs of the campaign in `folder` before any of them is solved, so that every shard
/// finds the same jobs and the same versions of gmsh and ccx.
pub fn prepare(
    campaign: &Campaign,
    folder: &Path,
    versions: &ToolVersions,
) -> Result<(), CampaignError> {
    let index = Index::new(&campaign.name, &campaign.solves(versions).collect::<Vec<_>>());
    CampaignFolder(folder.to_owned()).enter(Shard::WHOLE, &index)?;
    Ok(())
}
