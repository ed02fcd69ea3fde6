//! Many window solves at once, each made once: what studies and replays are made of.

use crate::database::processors;
use crate::interrupt;
use crate::progress::Progress;
use anyhow::{Context, Result};
use clap::Args;
use fe_driver::{FailureKind, KeptSolution, KeptSolve, KeptSolveError, Tools};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// How window solves are made.
#[derive(Args)]
pub struct SolveArgs {
    /// Solves at a time [default: one for each processor]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// End a solve after this time (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 3600)]
    time_limit_s: u64,
}

/// A solution, or why the path was not followed to its end.
pub type Outcome = Result<KeptSolution, String>;

impl SolveArgs {
    /// The outcomes of `solves`, in their order; solutions are kept in `folder`, and read from it
    /// when they are asked for again.
    pub fn solve(&self, solves: &[&KeptSolve], folder: &Path) -> Result<Vec<Outcome>> {
        let kept = folder.join("solutions");
        std::fs::create_dir_all(&kept)
            .with_context(|| format!("cannot make the folder {}", kept.display()))?;
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
        let tools = Tools::find()?;
        let stop = interrupt::stop_flag()?;
        let limit = Duration::from_secs(self.time_limit_s);
        let workers = self
            .jobs
            .unwrap_or_else(processors)
            .clamp(1, solves.len().max(1));
        let next = AtomicUsize::new(0);
        let (tell, told) = mpsc::channel();
        let bar = Progress::new(solves.len(), "solves");
        std::thread::scope(|scope| {
            for _ in 0..workers {
                let (tell, next, tools) = (tell.clone(), &next, &tools);
                scope.spawn(move || {
                    while let Some((i, solve)) = following(next, solves) {
                        let solution =
                            in_scratch(kept, |work| solve.solution(kept, work, tools, limit, stop));
                        // Nobody listens any more once a solve has failed.
                        let _ = tell.send((i, solution));
                    }
                });
            }
            drop(tell);
            let mut outcomes: Vec<Option<Outcome>> = vec![None; solves.len()];
            for (done, (i, solution)) in told.iter().enumerate() {
                outcomes[i] = Some(outcome(solution).inspect_err(|_| {
                    next.store(solves.len(), Ordering::Relaxed);
                })?);
                bar.show(done + 1, None, "");
            }
            Ok(outcomes.into_iter().flatten().collect())
        })
    }
}

/// What a solve came to; an error if no other solve would fare better.
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

/// The next solve that no worker has taken.
fn following<'a>(next: &AtomicUsize, solves: &[&'a KeptSolve]) -> Option<(usize, &'a KeptSolve)> {
    let i = next.fetch_add(1, Ordering::Relaxed);
    solves.get(i).map(|solve| (i, *solve))
}

/// Does `solve` in a folder of its own beside the solutions, which is removed afterwards.
fn in_scratch(
    kept: &Path,
    solve: impl FnOnce(&Path) -> Result<KeptSolution, KeptSolveError>,
) -> Result<KeptSolution> {
    let work = tempfile::tempdir_in(kept).context("cannot make a folder to work in")?;
    Ok(solve(work.path())?)
}
