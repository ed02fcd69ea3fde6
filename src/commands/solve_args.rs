//! Options of window solves, and the service that they describe.

use crate::ui::{count::jobs, interrupt, processors};
use anyhow::Result;
use app::{failure::Unfinished, progress::Progress};
use clap::Args;
use fe_driver::{Solve, SolveListError, SolveService, SolveStore, Solver};
use std::{cell::RefCell, num::NonZeroUsize, path::Path, time::Duration};
use verification::VerificationError;

/// The solver of windows and sheets of every command.
pub use fe_driver::CalculiX as FeSolver;

/// Time limit of a window solve, unless a campaign states another.
pub const LIMIT: Duration = Duration::from_secs(3600);

/// Options of window solves.
#[derive(Args, Clone, Copy, Default)]
pub struct SolveArgs {
    /// Number of solves in parallel [default: one per processor]
    #[arg(long, value_name = "N", value_parser = jobs::<NonZeroUsize>)]
    jobs: Option<NonZeroUsize>,
}

impl SolveArgs {
    /// Number of solves in parallel.
    pub fn workers(&self) -> usize {
        self.jobs.map_or_else(processors, NonZeroUsize::get)
    }

    /// Solves windows with CalculiX, shows their progress, and keeps them in the folder `solves` of
    /// `folder`.
    pub fn service(&self, folder: &Path) -> Result<SolveService<'static>> {
        let bar = RefCell::new(None);
        let progress = move |done: usize, all: usize| {
            let mut bar = bar.borrow_mut();
            if done < all {
                let bar = bar.get_or_insert_with(|| Progress::new(all, "solves"));
                bar.show(done, None, "");
            } else if let Some(bar) = bar.take() {
                bar.finish();
            }
        };
        self.service_of(FeSolver::find()?, folder, progress)
    }

    /// Solves problems of one kind, and keeps them in the folder `solves` of `folder`.
    pub fn service_of<S: Solve>(
        &self,
        solver: impl Solver<S> + 'static,
        folder: &Path,
        progress: impl Fn(usize, usize) + 'static,
    ) -> Result<SolveService<'static, S>> {
        Ok(SolveService {
            solver: Box::new(solver),
            store: SolveStore(folder.join("solves")),
            workers: self.workers(),
            limit: LIMIT,
            stop: interrupt::stop_flag()?,
            progress: Box::new(progress),
        })
    }
}

/// The error of a task for the command line: a task that was stopped is unfinished.
pub fn task_error(error: VerificationError) -> anyhow::Error {
    match error {
        VerificationError::Solve(SolveListError::Stopped { left }) => {
            Unfinished { left, what: "solves" }.into()
        }
        error => error.into(),
    }
}
