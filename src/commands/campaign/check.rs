//! `kirigami campaign check`

use crate::commands::campaign::campaign_args::CampaignArgs;
use crate::commands::solve_args::FeSolver;
use crate::ui::count::count;
use crate::ui::interrupt;
use crate::ui::progress::Progress;
use anyhow::{Result, ensure};
use clap::Args;
use fe_driver::solve_again;
use std::num::NonZeroUsize;
use std::sync::atomic::Ordering;
use support::table::Table;

/// Solve some of the finished rays again and compare their samples to the last bit
///
/// A difference shows that the solver or a machine is not deterministic, or that the nodes of a
/// cluster differ although their versions of gmsh and ccx agree. Nothing in the folder is changed.
/// Exit code 1 if any ray differs. Example: kirigami campaign check configs/campaigns/demo.toml
/// --every 10
#[derive(Args)]
pub struct CheckCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Solve every N-th ray
    #[arg(long, value_name = "N", default_value = "50", value_parser = count::<NonZeroUsize>)]
    every: NonZeroUsize,
}

impl CheckCommand {
    pub fn run(&self) -> Result<()> {
        let (campaign, folder) = (self.campaign.load()?, self.campaign.folder());
        let (solver, stop) = (FeSolver::find()?, interrupt::stop_flag()?);
        let bar = Progress::new(0, "rays");
        let mut show = |done, all| {
            bar.set_total(all);
            bar.show(done, None, "");
        };
        let every = self.every.get();
        let solved = solve_again(&campaign, &folder, &solver, every, stop, &mut show)?;
        bar.finish();
        let mut rows = Table::new(["ray", "samples before", "now", "difference in W"]);
        let differing = solved.iter().filter_map(|ray| Some((&ray.job, ray.difference?)));
        let count = differing.clone().count();
        for (job, difference) in differing {
            let [before, now] = difference.samples.map(|n| n.to_string());
            rows.row([job.clone(), before, now, format!("{:.1e}", difference.w)]);
        }
        let (all, versions) = (solved.len(), solver.versions());
        ensure!(
            all > 0 || stop.load(Ordering::Relaxed),
            "no ray of {} was solved there to its end at the first attempt; restored rays may stem from a retry",
            folder.display()
        );
        println!("{all} rays solved again with {versions}; {count} differ");
        if count > 0 {
            println!("{rows}");
        }
        ensure!(
            count == 0,
            "{count} of {all} rays differ from their first solve: the solver or one of the two hosts is not \
             deterministic"
        );
        Ok(())
    }
}
