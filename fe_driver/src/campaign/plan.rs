//! The plan of a run: the jobs that it would solve, and why.

use crate::{
    Campaign, CampaignError, CampaignFolder, Index, Shard, Solve, SolveRecord, SolveState,
    SolveStore, Tally, ToolVersions, WindowSolve, or_damage, short_hash,
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
    folder.belongs_to(&campaign.name)?;
    let (store, solves) = (folder.store(), || campaign.solves(versions));
    let stale = stale(&store, &solves().map(|solve| solve.id()).collect())?;
    let (mut tally, mut reasons) = (Tally::default(), BTreeMap::new());
    let mut to_run: Vec<Tier> = Vec::new();
    for solve in solves() {
        let id = solve.id();
        let state = store.solve(&id).state()?;
        tally.add_state(&id, &state);
        let reason = match state {
            SolveState::Ended(ended) => retry_reason(&ended.1),
            SolveState::Open { started: true } => Some("interrupted".to_owned()),
            SolveState::Open { started: false } => Some(new_reason(&solve, &stale)),
            SolveState::Damaged(reason) => Some(format!("damaged: {reason} (job {id})")),
        };
        if let Some(reason) = reason {
            *reasons.entry(reason).or_default() += 1;
            to_run.push(solve.tier());
        }
    }
    let tiers = || to_run.iter();
    Ok(Plan {
        seconds: tiers().map(|tier| tally.seconds_a_job(*tier)).sum(),
        memory_mb: tiers().map(|tier| tier.usual_memory_mb()).fold(0.0, f64::max),
        disk_mb: JOB_MB * to_run.len() as f64,
        tally,
        reasons,
        stale: stale.count,
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

/// The inputs of the jobs in the folder whose ids are not in `requested`.
fn stale(store: &SolveStore, requested: &HashSet<String>) -> Result<Stale, CampaignError> {
    let mut stale = Stale::default();
    for id in store.ids()?.into_iter().filter(|id| !requested.contains(id)) {
        // A damaged job of another campaign is ignored.
        if let Ok(Some(solve)) = or_damage(store.solve(&id).solve::<WindowSolve>())? {
            stale.count += 1;
            let ray = short_hash(&solve.problem.hinge);
            stale.rays.insert(ray, solve);
        }
    }
    Ok(stale)
}

/// Jobs in the folder that do not belong to the campaign.
#[derive(Default)]
struct Stale {
    count: usize,
    /// One job of each ray, by the hash of the ray.
    rays: HashMap<String, WindowSolve>,
}

/// Why a job with a completed attempt is retried; `None` if it is not.
fn retry_reason(record: &SolveRecord) -> Option<String> {
    let (failure, next) = (record.failure?, record.next?);
    Some(format!("{failure}, next {next}"))
}

/// Why a job is solved for the first time; its ray may have been solved with other settings.
fn new_reason(solve: &WindowSolve, stale: &Stale) -> String {
    match stale.rays.get(&short_hash(&solve.problem.hinge)) {
        Some(old) => format!("stale: {} changed", solve.differences(old).join(", ")),
        None => "new".to_owned(),
    }
}
