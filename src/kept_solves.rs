//! Many window solves at once, each made once: what studies and replays are made of.

use crate::database::{Unfinished, processors};
use crate::interrupt;
use crate::progress::Progress;
use anyhow::{Context, Result, bail};
use clap::Args;
use fe_driver::{FailureKind, KeptSolution, KeptSolve, KeptSolveError, Tools};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
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
        remove_scratch(kept)?;
        let tools = Tools::find()?;
        let stop = interrupt::stop_flag()?;
        let limit = Duration::from_secs(self.time_limit_s);
        let workers = self
            .jobs
            .unwrap_or_else(processors)
            .clamp(1, solves.len().max(1));
        let (next, halt) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (tell, told) = mpsc::channel();
        let bar = Progress::new(solves.len(), "solves");
        let mut outcomes: Vec<Option<Outcome>> = vec![None; solves.len()];
        let ended = std::thread::scope(|scope| {
            for _ in 0..workers {
                let (tell, next, halt, tools) = (tell.clone(), &next, &halt, &tools);
                scope.spawn(move || {
                    while let Some((i, solve)) = following(next, halt, solves) {
                        let solution =
                            in_scratch(kept, |work| solve.solution(kept, work, tools, limit, halt));
                        // Nobody listens any more once a solve has failed.
                        let _ = tell.send((i, solution));
                    }
                });
            }
            drop(tell);
            let mut done = 0;
            loop {
                match told.recv_timeout(Duration::from_millis(100)) {
                    Ok((i, solution)) => match outcome(solution) {
                        Ok(outcome) => {
                            outcomes[i] = Some(outcome);
                            done += 1;
                            bar.show(done, None, "");
                        }
                        Err(error) => {
                            halt.store(true, Ordering::Relaxed);
                            return Err(error);
                        }
                    },
                    Err(RecvTimeoutError::Timeout) => {
                        halt.fetch_or(stop.load(Ordering::Relaxed), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
            }
        });
        bar.finish();
        let left = outcomes.iter().filter(|outcome| outcome.is_none()).count();
        if stop.load(Ordering::Relaxed) && left > 0 {
            let what = "solves";
            bail!(Unfinished { left, what });
        }
        ended?;
        Ok(outcomes.into_iter().flatten().collect())
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
fn following<'a>(
    next: &AtomicUsize,
    halt: &AtomicBool,
    solves: &[&'a KeptSolve],
) -> Option<(usize, &'a KeptSolve)> {
    if halt.load(Ordering::Relaxed) {
        return None;
    }
    let i = next.fetch_add(1, Ordering::Relaxed);
    solves.get(i).map(|solve| (i, *solve))
}

/// How the folders begin in which solves are made.
const SCRATCH: &str = "solving-";

/// Removes the folders of solves that were killed.
fn remove_scratch(kept: &Path) -> Result<()> {
    for entry in std::fs::read_dir(kept)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(SCRATCH) {
            std::fs::remove_dir_all(entry.path())?;
        }
    }
    Ok(())
}

/// Does `solve` in a folder of its own beside the solutions, which is removed afterwards.
fn in_scratch(
    kept: &Path,
    solve: impl FnOnce(&Path) -> Result<KeptSolution, KeptSolveError>,
) -> Result<KeptSolution> {
    let work = tempfile::Builder::new().prefix(SCRATCH).tempdir_in(kept);
    let work = work.context("cannot make a folder to work in")?;
    Ok(solve(work.path())?)
}
