//! `kirigami dataset`: summarise, check, compare hinge databases and write them as CSV.

mod compare;

use anyhow::{Result, ensure};
use app::output_file;
use clap::Args;
use dataset::Database;
use std::path::PathBuf;

/// Summarise, check and compare hinge databases, and write them as CSV
#[derive(Args)]
pub struct DatasetCommand {
    #[command(subcommand)]
    action: Action,
}

subcommands! {
    enum Action {
        Summary(SummaryCommand),
        Check(CheckCommand),
        Export(ExportCommand),
        Compare(compare::CompareCommand),
    }
}

/// Print counts, rejected rows, and of every column its range, unit and meaning
#[derive(Args)]
struct SummaryCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Print the manifest as JSON
    #[arg(long)]
    json: bool,
}

/// Look for what makes a database unfit for training: negative energies, forces that are not the
/// gradient of the energy, damage that decreases, states that occur twice, test geometries that
/// were trained on
#[derive(Args)]
struct CheckCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
}

/// Write the table of a database as CSV
#[derive(Args)]
struct ExportCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    replace: bool,
}

impl DatasetCommand {
    pub(crate) fn run(&self) -> Result<()> {
        self.action.run()
    }
}

impl SummaryCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        if self.json {
            println!("{}", serde_json::to_string_pretty(database.manifest())?);
            return Ok(());
        }
        println!("{database}");
        Ok(())
    }
}

impl CheckCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let findings = database.check();
        for finding in &findings {
            println!("{finding}");
        }
        for row in database.rays_on_other_tiers() {
            println!(
                "note: ray {} was solved on the mesh {}, not on {}",
                row.job, row.solved_tier, row.tier
            );
        }
        ensure!(findings.is_empty(), "{} is not fit for training", self.database.display());
        println!("{}: nothing found", self.database.display());
        Ok(())
    }
}

impl ExportCommand {
    fn run(&self) -> Result<()> {
        if !self.replace {
            output_file::refuse_existing(&self.out)?;
        }
        let csv = Database::read(&self.database)?.to_csv()?;
        output_file::create_folder_of(&self.out)?;
        output_file::write(&self.out, csv)?;
        println!("written to {}", self.out.display());
        Ok(())
    }
}
