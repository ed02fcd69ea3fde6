//! The state of a campaign: counts, costs, throughput.

use crate::{
    Campaign, CampaignFolder, FailureKind, Index, Job, JobPart, Solve, SolveListError, SolveRecord,
    SolveState, ToolVersions, WindowSolve, short_hash, unless_damaged,
};
use hinge::SheetMaterial;
use mesher::Tier;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use support::{Extremes, refuse};

/// Numbers of jobs in each state, with their total cost.
#[derive(Debug, Default, Serialize)]
pub struct Tally {
    /// Jobs without a completed attempt.
    pub open: usize,
    /// Open jobs whose files are damaged: the next run solves them again.
    pub damaged: usize,
    /// Failed jobs with a retry left.
    pub retry: usize,
    /// Jobs solved to the end of the ray.
    pub complete: usize,
    /// Closed jobs whose samples end before the end of the ray.
    pub partial: usize,
    /// Closed jobs without samples.
    pub failed: usize,
    /// Samples of complete and partial jobs.
    pub rows: usize,
    /// Kinds of the last failure of partial, failed and retried jobs.
    pub failures: BTreeMap<FailureKind, usize>,
    /// The jobs whose samples were solved on another tier than the tier of the campaign, by their
    /// ids.
    pub other_tiers: BTreeMap<String, Tier>,
    /// Solver CPU time over all attempts (s).
    pub cpu_seconds: f64,
    /// Wall time of one worker over all attempts (s); restored jobs have none.
    pub wall_seconds: f64,
    /// Closed jobs that were solved in this folder, not restored. Only these jobs count in the
    /// throughput.
    pub solved_here: usize,
    /// Closed jobs whose time is known: the wall time of those solved here, the CPU time of
    /// restored ones.
    pub timed: usize,
    /// Seconds and number of the timed jobs of each tier.
    #[serde(skip)]
    timed_by_tier: BTreeMap<Tier, (f64, usize)>,
    #[serde(skip)]
    rows_solved_here: usize,
    #[serde(skip)]
    cpu_seconds_here: f64,
}

impl Tally {
    /// Counts jobs with their records; a job without one is open.
    pub(crate) fn new<'a>(
        jobs: impl IntoIterator<Item = (&'a Job, &'a Option<SolveRecord>)>,
    ) -> Self {
        let mut tally = Self::default();
        for (job, record) in jobs {
            tally.add(&job.id, job.solve.tier(), record.as_ref());
        }
        tally
    }

    /// Counts the job with this id and state.
    pub(crate) fn add_state(&mut self, id: &str, state: &SolveState) {
        self.damaged += usize::from(matches!(state, SolveState::Damaged(_)));
        match state {
            SolveState::Ended(ended) => self.add(id, ended.0.tier(), Some(&ended.1)),
            SolveState::Open { .. } | SolveState::Damaged(_) => self.open += 1,
        }
    }

    fn add(&mut self, id: &str, tier: Tier, record: Option<&SolveRecord>) {
        let Some(record) = record else {
            self.open += 1;
            return;
        };
        if record.rows > 0 && record.tier != tier {
            self.other_tiers.insert(id.to_owned(), record.tier);
        }
        *match (record.is_closed(), record.failure, record.rows) {
            (false, ..) => &mut self.retry,
            (true, None, _) => &mut self.complete,
            (true, Some(_), 0) => &mut self.failed,
            (true, Some(_), _) => &mut self.partial,
        } += 1;
        if record.is_closed() {
            self.rows += record.rows;
        }
        if let Some(kind) = record.failure {
            *self.failures.entry(kind).or_default() += 1;
        }
        self.cpu_seconds += record.cpu_seconds;
        self.wall_seconds += record.wall_seconds;
        let seconds =
            if record.is_solved_here() { record.wall_seconds } else { record.cpu_seconds };
        if seconds > 0.0 {
            let (all, jobs) = self.timed_by_tier.entry(tier).or_default();
            *all += seconds;
            *jobs += usize::from(record.is_closed());
            self.timed += usize::from(record.is_closed());
        }
        if record.is_solved_here() {
            self.cpu_seconds_here += record.cpu_seconds;
            if record.is_closed() {
                self.solved_here += 1;
                self.rows_solved_here += record.rows;
            }
        }
    }

    /// Number of closed jobs.
    pub fn closed(&self) -> usize {
        self.complete + self.partial + self.failed
    }

    /// Number of jobs that a run would work on.
    pub fn to_run(&self) -> usize {
        self.open + self.retry
    }

    /// Time of one worker per job on a tier (s): the mean over the jobs whose time is known,
    /// otherwise the usual time of the material.
    pub(crate) fn seconds_a_job(&self, tier: Tier, material: &SheetMaterial) -> f64 {
        match self.timed_by_tier.get(&tier) {
            Some((seconds, jobs @ 1..)) => seconds / *jobs as f64,
            _ => tier.usual_cpu_seconds(material),
        }
    }

    /// The throughput; `None` before there are samples of jobs solved in this folder.
    fn throughput(&self) -> Option<Throughput> {
        let hours = self.wall_seconds / 3600.0;
        (self.rows_solved_here > 0).then(|| Throughput {
            rays_per_hour: self.solved_here as f64 / hours,
            samples_per_hour: self.rows_solved_here as f64 / hours,
            cpu_seconds_per_sample: self.cpu_seconds_here / self.rows_solved_here as f64,
            overhead: 1.0 - self.cpu_seconds_here / self.wall_seconds,
        })
    }
}

/// The throughput of one worker over all attempts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Throughput {
    /// Closed jobs per hour.
    pub rays_per_hour: f64,
    /// Samples of closed jobs per hour.
    pub samples_per_hour: f64,
    /// Solver CPU time over all attempts, per sample (s).
    pub cpu_seconds_per_sample: f64,
    /// Fraction of the wall time in which the solver did not compute: gmsh, reading and writing,
    /// waiting for a processor.
    pub overhead: f64,
}

/// The state of a campaign.
#[derive(Debug, Serialize)]
pub struct CampaignStatus {
    /// Name of the campaign.
    pub name: String,
    /// Numbers of jobs by their state.
    pub tally: Tally,
    /// The throughput; `None` before a job solved in this folder has samples.
    pub throughput: Option<Throughput>,
}

/// What each job in a folder is for, by its id; an error if `campaign` was last run there with
/// settings other than its current ones.
///
/// Tool versions are taken from the folder: neither gmsh nor ccx needs to be installed.
pub fn known_parts(
    campaign: &Campaign,
    folder: &Path,
) -> Result<HashMap<String, JobPart>, SolveListError> {
    let folder = CampaignFolder(folder.to_owned());
    folder.known(&campaign.name)?;
    let ids = folder.index()?.jobs;
    let store = folder.store();
    let mut known = ids.iter().map(|id| store.solve(id).solve::<WindowSolve>());
    let Some(known) = known.find_map(Result::transpose).transpose()? else {
        return Ok(HashMap::new());
    };
    let jobs = campaign.jobs(&known.tools);
    if jobs.iter().map(|(_, solve)| solve.id()).eq(ids.iter().cloned()) {
        let parts = jobs.into_iter().map(|(part, _)| part);
        return Ok(ids.into_iter().zip(parts).collect());
    }
    let same_tier = jobs.iter().find(|(_, solve)| solve.tier() == known.tier());
    let changes = same_tier.or(jobs.first());
    let changes = changes.map_or(Vec::new(), |(_, solve)| solve.differences(&known));
    let changes = match changes.as_slice() {
        [] => "its rays".to_owned(),
        changes => changes.join(", "),
    };
    refuse!(
        "the campaign has changed since it was run in {} ({changes}): run it again first",
        folder.0.display()
    )
}

/// The state of the campaign in `folder`, as it was last run.
pub fn status(folder: &Path) -> Result<CampaignStatus, SolveListError> {
    let folder = CampaignFolder(folder.to_owned());
    let Index { name, jobs, .. } = folder.index()?;
    let (store, mut tally) = (folder.store(), Tally::default());
    for id in jobs {
        tally.add_state(&id, &store.solve(&id).state()?);
    }
    Ok(CampaignStatus { name, throughput: tally.throughput(), tally })
}

// The plan of a run: the jobs that it would solve, and why.

/// The work that a run would do.
#[derive(Debug, Serialize)]
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
) -> Result<Plan, SolveListError> {
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
        seconds: tiers().map(|tier| tally.seconds_a_job(*tier, &campaign.material)).sum(),
        memory_mb: tiers().map(|tier| tier.usual_memory_mb()).largest(),
        disk_mb: JOB_MB * to_run.len() as f64,
        tally,
        reasons,
        stale,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shard;
    use crate::campaign::definition::tests::of_two_boxes;
    use crate::campaign::run::{RunOptions, run};
    use crate::solve::solve_folder::SolveFolder;
    use crate::solve::solver::Solver;
    use crate::solve::tests::{healthy, solve_on};
    use std::sync::atomic::AtomicBool;
    use std::time::Duration;

    fn solved(cpu_seconds: f64, wall_seconds: f64) -> Option<SolveRecord> {
        Some(SolveRecord {
            rows: 20,
            cpu_seconds,
            wall_seconds,
            tier: Tier::Default,
            ..SolveRecord::default()
        })
    }

    fn tally(records: &[Option<SolveRecord>]) -> Tally {
        let job = job();
        Tally::new(records.iter().map(|record| (&job, record)))
    }

    fn job() -> Job {
        let solve = solve_on(Tier::Default);
        Job { id: solve.id(), solve, folder: SolveFolder("none".into()) }
    }

    /// Restored jobs have no wall time, but their CPU time is the CPU time for this material.
    #[test]
    fn the_time_of_a_job_is_also_that_of_restored_ones() {
        let material = solve_on(Tier::Default).problem.material;
        let seconds = |tally: &Tally| tally.seconds_a_job(Tier::Default, &material);
        assert_eq!(seconds(&tally(&[None])), Tier::Default.usual_cpu_seconds(&material));
        let metal = SheetMaterial { density_kg_m3: 7850.0, ..material.clone() };
        let usual = |material| Tier::Plate.usual_cpu_seconds(material);
        assert_eq!(usual(&metal), 3.2 * usual(&material));
        let restored = tally(&[solved(60.0, 0.0), solved(80.0, 0.0), None]);
        assert_eq!((restored.timed, seconds(&restored)), (2, 70.0));
        let fine = restored.seconds_a_job(Tier::Fine, &material);
        assert_eq!(fine, Tier::Fine.usual_cpu_seconds(&material));
        assert_eq!((restored.solved_here, restored.throughput()), (0, None));
        let mixed = tally(&[solved(60.0, 0.0), solved(75.0, 80.0), None]);
        assert_eq!((mixed.timed, seconds(&mixed)), (2, 70.0));
    }

    #[test]
    fn a_job_on_another_mesh_is_named() {
        let mut finer = solved(60.0, 60.0);
        assert!(tally(std::slice::from_ref(&finer)).other_tiers.is_empty());
        finer.as_mut().unwrap().tier = Tier::Fine;
        assert_eq!(tally(&[finer]).other_tiers[&job().id], Tier::Fine);
    }
    #[test]
    fn every_job_in_the_folder_of_a_campaign_has_a_part() {
        let folder = tempfile::tempdir().unwrap();
        let (campaign, solver) = (of_two_boxes(), healthy());
        let known = |campaign: &Campaign| known_parts(campaign, folder.path());
        let error = known(&campaign).unwrap_err();
        assert!(error.to_string().contains("contains no campaign"), "{error}");
        // Jobs without a file are unknown.
        let stop = AtomicBool::new(false);
        let solved = |time_limit| {
            let options = RunOptions { shard: Shard::WHOLE, workers: 1, time_limit, retry: false };
            let ended = run(&campaign, folder.path(), &solver, &options, &stop, &mut |_| {});
            ended.unwrap().tally.complete
        };
        assert_eq!(solved(Some(Duration::ZERO)), 0);
        assert_eq!(known(&campaign).unwrap(), HashMap::new());
        assert_eq!(solved(None), campaign.size());

        let parts = known(&campaign).unwrap();
        let jobs = campaign.jobs(&solver.versions());
        let expected = jobs.into_iter().map(|(part, solve)| (solve.id(), part));
        assert_eq!(parts, expected.collect());

        type Change = fn(&mut Campaign);
        let changes: [(Change, &str); 5] = [
            (|campaign| campaign.boxes[0].count += 1, "its rays"),
            (|campaign| campaign.boxes[1].finer = 0, "its rays"),
            (|campaign| campaign.spot_rays += 1, "its rays"),
            (|campaign| campaign.tier = Tier::Default, "mesh tier"),
            (|campaign| campaign.material.young += 1.0, "material"),
        ];
        for (change, expected) in changes {
            let mut changed = campaign.clone();
            change(&mut changed);
            let error = known(&changed).unwrap_err();
            assert!(error.to_string().contains(&format!(" ({expected})")), "{error}");
        }
    }
}
