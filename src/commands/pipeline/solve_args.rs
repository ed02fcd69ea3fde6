//! Options of window solves.

use crate::ui::{count::jobs, interrupt, processors};
use anyhow::Result;
use app::solves::Solves;
use clap::Args;
use std::num::NonZeroUsize;

/// Options of window solves.
#[derive(Args, Clone, Copy, Default)]
pub(crate) struct SolveArgs {
    /// Number of solves in parallel [default: one per processor]
    #[arg(long, value_name = "N", value_parser = jobs::<NonZeroUsize>)]
    jobs: Option<NonZeroUsize>,
}

impl SolveArgs {
    /// Solves that Ctrl-C stops.
    pub(crate) fn solves(&self) -> Result<Solves<'static>> {
        let workers = self.jobs.map_or_else(processors, NonZeroUsize::get);
        Ok(Solves { workers, stop: interrupt::stop_flag()? })
    }
}
