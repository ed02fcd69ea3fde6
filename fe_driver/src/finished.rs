//! The samples of a campaign, for the database.

use crate::campaign::CampaignError;
use crate::failure::FailureKind;
use crate::job::{JobSpec, ToolVersions, short_hash};
use crate::ledger::CampaignFolder;
use hinge::{HingeDesign, HingeSample};
use mesher::Tier;
use std::path::Path;

/// A job whose samples belong in the database.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedJob {
    pub id: String,
    pub design: HingeDesign,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of it; empty if not known.
    pub material_hash: String,
    /// Hash of everything that jobs of one campaign share but the material: mesh, step control,
    /// programs; empty if not known.
    pub settings_hash: String,
    /// Tier that was asked.
    pub tier: Tier,
    /// Tier that the samples were solved with: a finer one if the asked one failed.
    pub solved_tier: Tier,
    pub tools: ToolVersions,
    /// One a converged increment.
    pub samples: Vec<HingeSample>,
    /// Of the solver, over all attempts (s).
    pub cpu_seconds: f64,
    /// Why the samples end before the ray does; `None` for a whole ray.
    pub failure: Option<FailureKind>,
}

/// The jobs of the campaign in `folder` that are closed and have samples, in the campaign's order.
///
/// Stale jobs are left out. Neither gmsh nor ccx need be installed.
pub fn finished_jobs(
    folder: &Path,
) -> Result<impl Iterator<Item = Result<FinishedJob, CampaignError>>, CampaignError> {
    let folder = CampaignFolder(folder.to_owned());
    let jobs = folder.index()?.jobs;
    Ok(jobs
        .into_iter()
        .filter_map(move |id| finished(&folder, id).transpose()))
}

fn finished(folder: &CampaignFolder, id: String) -> Result<Option<FinishedJob>, CampaignError> {
    let job = folder.job(&id);
    let (Some(spec), Some(record)) = (job.spec()?, job.record()?) else {
        return Ok(None);
    };
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
