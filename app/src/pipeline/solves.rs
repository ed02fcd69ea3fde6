//! Solves of a shell: their service, their progress, and the end of a task that was stopped.

use crate::{failure::Unfinished, progress::Progress};
use anyhow::Result;
use fe_driver::{
    CalculiX, CampaignProgress, Solve, SolveListError, SolveService, SolveStore, Solver,
};
use hinge::HingeSample;
use std::{cell::RefCell, path::Path, sync::atomic::AtomicBool, time::Duration};
use support::table::{Cell, Table};
use verification::VerificationError;

/// Time limit of a window solve, unless a campaign states another.
pub const LIMIT: Duration = Duration::from_secs(3600);

/// What solves.
#[derive(Clone, Copy)]
pub struct Solves<'a> {
    /// Number of solves in parallel.
    pub workers: usize,
    /// Stops them.
    pub stop: &'a AtomicBool,
}

impl<'a> Solves<'a> {
    /// Solves windows with CalculiX, shows their progress, and keeps them in the folder `solves` of
    /// `folder`.
    pub fn service(self, folder: &Path) -> Result<SolveService<'a>> {
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
        Ok(self.service_of(CalculiX::find()?, folder, progress))
    }

    /// Solves problems of one kind, and keeps them in the folder `solves` of `folder`.
    pub(crate) fn service_of<S: Solve>(
        self,
        solver: impl Solver<S> + 'a,
        folder: &Path,
        progress: impl Fn(usize, usize) + 'a,
    ) -> SolveService<'a, S> {
        SolveService {
            solver: Box::new(solver),
            store: SolveStore(folder.join("solves")),
            workers: self.workers,
            limit: LIMIT,
            stop: self.stop,
            progress: Box::new(progress),
        }
    }
}

/// The progress of the rays of a campaign.
pub struct RayProgress(pub Progress);

impl RayProgress {
    /// The progress of a campaign of some rays.
    pub fn new(rays: usize) -> Self {
        Self(Progress::new(rays, "rays"))
    }

    /// Shows how far the campaign has come.
    pub fn show(&self, now: &CampaignProgress) {
        let tally = &now.tally;
        let message = format!("{} samples, {} failed", tally.rows, tally.failed);
        self.0.set_total(tally.closed() + tally.to_run());
        self.0.show(tally.closed(), now.seconds_left, &message);
    }
}

/// The error of a task for a shell: a task that was stopped is unfinished.
pub fn task_error(error: VerificationError) -> anyhow::Error {
    match error {
        VerificationError::Solve(SolveListError::Stopped { left }) => {
            Unfinished { left, what: "solves" }.into()
        }
        error => error.into(),
    }
}

/// The rows of a ray, thinned to about twenty.
pub fn ray_table(samples: &[HingeSample]) -> Table {
    let mut table = Table::new([
        "lambda",
        "theta\ndeg",
        "a\nmm",
        "s\nmm",
        "W\nN mm",
        "F_a\nN",
        "F_s\nN",
        "M_theta\nN mm",
        "D",
        "D_peak",
        "u_z\nmm",
        "energy\nresidual",
    ]);
    let stride = samples.len().div_ceil(20).max(1);
    for (i, x) in samples.iter().enumerate() {
        if (samples.len() - 1 - i).is_multiple_of(stride) {
            table.row([
                Cell::fixed(x.lambda, 3),
                Cell::fixed(x.theta.to_degrees(), 2),
                Cell::fixed(x.a, 3),
                Cell::fixed(x.s, 3),
                Cell::fixed(x.w, 3),
                Cell::fixed(x.f_a, 3),
                Cell::fixed(x.f_s, 3),
                Cell::fixed(x.m_theta, 3),
                Cell::fixed(x.d, 5),
                Cell::fixed(x.d_peak, 3),
                Cell::fixed(x.uz_max, 2),
                Cell::text(format!("{:.1e}", x.energy_residual)),
            ]);
        }
    }
    table
}
