//! `kirigami campaign restore`

use super::campaign_args::CampaignArgs;
use anyhow::Result;
use clap::Args;
use dataset::Database;
use std::path::PathBuf;

/// Restore the job folders of a campaign from the database that was collected from them
///
/// A later run then solves only the rays that the database lacks. Jobs solved with other settings
/// or other versions of gmsh and ccx do not belong to the campaign and are skipped. Rays of the
/// spot check are solved again, since its file has four states of each.
#[derive(Args)]
pub(crate) struct RestoreCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// Database (Parquet with its manifest)
    #[arg(long, value_name = "FILE")]
    from: PathBuf,
}

impl RestoreCommand {
    pub(super) fn run(&self) -> Result<()> {
        let database = Database::read(&self.from)?;
        let campaign = self.campaign.load()?;
        let folder = self.campaign.folder();
        let restored = fe_driver::restore(&campaign, &folder, database.rays())?;
        println!(
            "{} rays restored to {}; {} existed already",
            restored.written,
            folder.display(),
            restored.there
        );
        if restored.foreign > 0 {
            println!("{} rays do not belong to this campaign", restored.foreign);
        }
        Ok(())
    }
}
