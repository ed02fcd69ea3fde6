//! `kirigami campaign plan`

use super::campaign_args::{CampaignArgs, print_tally};
use crate::ui::processors;
use anyhow::Result;
use app::progress::duration;
use clap::Args;
use fe_driver::CalculiX;
use support::table::Table;

/// Print what a run would solve, why, and the estimated time
#[derive(Args)]
pub(crate) struct PlanCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl PlanCommand {
    pub(super) fn run(&self) -> Result<()> {
        let folder = self.campaign.folder();
        let versions = CalculiX::find()?.versions();
        let plan = fe_driver::plan(&self.campaign.load()?, &folder, &versions)?;
        if self.json {
            println!("{}", serde_json::to_string_pretty(&plan)?);
            return Ok(());
        }
        print_tally(&plan.tally);
        if !plan.reasons.is_empty() {
            let mut reasons = Table::new(["to be solved because", "rays"]);
            for (reason, count) in &plan.reasons {
                reasons.row([reason.clone(), count.to_string()]);
            }
            println!("{reasons}");
        }
        if plan.stale > 0 {
            println!(
                "{} jobs in {} no longer belong to the campaign; they are kept",
                plan.stale,
                folder.display()
            );
        }
        let workers = processors() as f64;
        println!(
            "a run would solve {} rays in about {} of CPU time, {} on {workers} processors ({}), with {:.0} MB of memory a \
             processor and {:.0} MB on disk",
            plan.tally.to_run(),
            duration(plan.seconds),
            duration(plan.seconds / workers),
            match plan.tally.timed {
                0 => "the usual time of its meshes for polymers or metals".into(),
                timed => format!("from the time of the {timed} rays solved"),
            },
            plan.memory_mb,
            plan.disk_mb
        );
        Ok(())
    }
}
