//! The finished jobs of a campaign, from which the database is collected.

use crate::campaign::definition::CampaignError;
use crate::campaign::job::{JobSpec, JobState};
use crate::campaign::ledger::CampaignFolder;
use crate::record_file::short_hash;
use crate::window::failure::FailureKind;
use crate::window::versions::ToolVersions;
use hinge::{HingeDesign, HingeSample};
use mesher::Tier;
use std::path::Path;

/// A job whose samples belong in the database.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedJob {
    /// Id of the job.
    pub id: String,
    /// The hinge design.
    pub design: HingeDesign,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of the material; empty if unknown.
    pub material_hash: String,
    /// Hash of the settings that all jobs of a campaign share, except the material: mesh, step control,
    /// programs; empty if unknown.
    pub settings_hash: String,
    /// Requested tier.
    pub tier: Tier,
    /// Tier on which the samples were solved: a finer one if the requested tier failed.
    pub solved_tier: Tier,
    /// Versions of the programs that solved the samples.
    pub tools: ToolVersions,
    /// One sample per converged increment.
    pub samples: Vec<HingeSample>,
    /// Solver CPU time over all attempts (s).
    pub cpu_seconds: f64,
    /// Why the samples end before the end of the ray; `None` for a complete ray.
    pub failure: Option<FailureKind>,
}

/// The jobs of the campaign in `folder` that are closed and have samples, in the order of their ids, as in a
/// database.
///
/// Stale jobs are omitted. Neither gmsh nor ccx needs to be installed.
pub fn finished_jobs(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<FinishedJob, CampaignError>>, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let mut jobs = folder.index()?.jobs;
    jobs.sort_unstable();
    Ok(jobs
        .into_iter()
        .filter_map(move |id| finished(&folder, id).transpose()))
}

fn finished(folder: &CampaignFolder, id: String) -> Result<Option<FinishedJob>, CampaignError> {
    let job = folder.job(&id);
    let JobState::Ended(ended) = job.state()? else {
        return Ok(None);
    };
    let (spec, record) = *ended;
    if !record.is_closed() || record.rows == 0 {
        return Ok(None);
    }
    Ok(Some(FinishedJob {
        id,
        design: spec.problem.ray.design,
        material_hash: spec.problem.material.law_hash(),
        settings_hash: settings_hash(&spec),
        material: spec.problem.material.name,
        tier: spec.problem.tier,
        solved_tier: record.tier,
        tools: spec.tools,
        samples: job.samples(&record)?,
        cpu_seconds: record.cpu_seconds,
        failure: record.failure,
    }))
}

fn settings_hash(spec: &JobSpec) -> String {
    let problem = &spec.problem;
    short_hash(&(
        problem.tier,
        &spec.mesh,
        &problem.step,
        &spec.tools,
        spec.recipe_version,
    ))
}
