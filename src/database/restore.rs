//! `kirigami database restore`

use super::CampaignArgs;
use super::rows::jobs_of;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::Database;
use std::path::PathBuf;

/// Write the folders of jobs back from a database that was collected from them
///
/// A run then solves only what the database does not hold. Jobs that were solved with other settings or
/// versions of gmsh and ccx are none of the campaign's and are left out.
#[derive(Args)]
pub struct RestoreCommand {
    #[command(flatten)]
    campaign: CampaignArgs,
    /// The database: a Parquet file, with its manifest beside it
    #[arg(long, value_name = "FILE")]
    from: PathBuf,
}

impl RestoreCommand {
    pub fn run(&self) -> Result<()> {
        let database = Database::read(&self.from)?;
        let campaign = self.campaign.load()?;
        // The jobs of a corrected database are the campaign's, but its rows are not what they solved.
        ensure!(
            database.manifest().tier == campaign.tier.to_string(),
            "{} holds rows of the tier `{}`, the campaign solves `{}`",
            self.from.display(),
            database.manifest().tier,
            campaign.tier
        );
        let jobs = jobs_of(database.rows())?;
        let folder = self.campaign.folder();
        let restored = fe_driver::restore(&campaign, &folder, &jobs)?;
        println!(
            "{} rays restored to {}; {} were there",
            restored.written,
            folder.display(),
            restored.there
        );
        if restored.strangers > 0 {
            println!("{} rays are none of this campaign's", restored.strangers);
        }
        Ok(())
    }
}
