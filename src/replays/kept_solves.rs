//! Window solves in parallel, stored so that each is made once; used by studies and replays.

use crate::ui::exit::Unfinished;
use crate::ui::interrupt;
use crate::ui::processors;
use crate::ui::progress::Progress;
use anyhow::{Context, Result, bail};
use clap::Args;
use fe_driver::{FailureKind, KeptSolution, KeptSolve, KeptSolveError, Tools};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;
use support::worker_pool::{Reports, work_through};

/// Options of window solves.
#[derive(Args)]
pub struct SolveArgs {
    /// Number of solves in parallel [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Time limit of each solve (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 3600)]
    time_limit_s: u64,
}

/// A solution, or the reason why the path was not followed to its end.
pub type Outcome = Result<KeptSolution, String>;

impl SolveArgs {
    /// With one processor for each of `jobs` solves, each limited to `time_limit`.
    pub fn new(jobs: Option<NonZeroUsize>, time_limit: Duration) -> Self {
        Self {
            jobs,
            time_limit_s: time_limit.as_secs(),
        }
    }

    /// Number of solves in parallel.
    pub fn workers(&self) -> usize {
        self.jobs.map_or_else(processors, NonZeroUsize::get)
    }

    /// The outcomes of `solves`, in the same order. Solutions are stored in `folder` and read from there
    /// when the same solve is needed again. A path that is not followed to its end is tried again with shorter increments.
    pub fn solve(&self, solves: &[&KeptSolve], folder: &Path) -> Result<Vec<Outcome>> {
        let kept = folder.join("solutions");
        std::fs::create_dir_all(&kept)
            .with_context(|| format!("cannot create the folder {}", kept.display()))?;
        let mut different: Vec<&KeptSolve> = Vec::new();
        for solve in solves {
            if !different.contains(solve) {
                different.push(solve);
            }
        }
        let outcomes = self.solve_different(&different, &kept)?;
        let outcome = |solve| {
            let index = different.iter().position(|known| *known == solve);
            outcomes[index.expect("every solve is among the different ones")].clone()
        };
        Ok(solves.iter().copied().map(outcome).collect())
    }

    fn solve_different(&self, solves: &[&KeptSolve], kept: &Path) -> Result<Vec<Outcome>> {
        remove_scratch(kept)?;
        let tools = Tools::find()?;
        let stop = interrupt::stop_flag()?;
        let limit = Duration::from_secs(self.time_limit_s);
        let workers = self.workers();
        let bar = Progress::new(solves.len(), "solves");
        let mut outcomes: Vec<Option<Outcome>> = vec![None; solves.len()];
        let mut done = 0;
        let work = |i: usize, reports: &Reports<_>| {
            let halt = reports.halt();
            let attempt = |solve: &KeptSolve| {
                in_scratch(kept, |work| solve.solution(kept, work, &tools, limit, halt))
            };
            let first = attempt(solves[i]);
            let solution = first.and_then(|first| match solves[i].second_attempt() {
                Some(second) if first.stopped.is_some() => Ok(first.or(attempt(&second)?)),
                _ => Ok(first),
            });
            reports.send((i, solution));
        };
        let ended = work_through(solves.len(), workers, stop, &work, &mut |(i, solution)| {
            outcomes[i] = Some(outcome(solution)?);
            done += 1;
            bar.show(done, None, "");
            Ok::<_, anyhow::Error>(())
        });
        bar.finish();
        let left = outcomes.iter().filter(|outcome| outcome.is_none()).count();
        if stop.load(Ordering::Relaxed) && left > 0 {
            let what = "solves";
            bail!(Unfinished::new(left, what));
        }
        ended?;
        Ok(outcomes.into_iter().flatten().collect())
    }
}

/// The outcome of a solve; an error if other solves would fail for the same reason.
fn outcome(solution: Result<KeptSolution>) -> Result<Outcome> {
    let error = match solution {
        Ok(KeptSolution {
            stopped: Some(reason),
            ..
        }) => return Ok(Err(reason)),
        Ok(solution) => return Ok(Ok(solution)),
        Err(error) => error,
    };
    match error.downcast_ref() {
        Some(KeptSolveError::Solve(reason)) if FailureKind::of(reason).is_some() => {
            Ok(Err(reason.to_string()))
        }
        _ => Err(error),
    }
}

/// Prefix of the names of scratch folders.
const SCRATCH: &str = "solving-";

/// Removes the scratch folders of solves that were killed.
fn remove_scratch(kept: &Path) -> Result<()> {
    for entry in std::fs::read_dir(kept)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(SCRATCH) {
            std::fs::remove_dir_all(entry.path())?;
        }
    }
    Ok(())
}

/// Runs `solve` in a scratch folder next to the stored solutions, which is removed afterwards.
fn in_scratch(
    kept: &Path,
    solve: impl FnOnce(&Path) -> Result<KeptSolution, KeptSolveError>,
) -> Result<KeptSolution> {
    let work = tempfile::Builder::new().prefix(SCRATCH).tempdir_in(kept);
    let work = work.context("cannot create a scratch folder")?;
    Ok(solve(work.path())?)
}
