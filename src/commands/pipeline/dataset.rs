//! `kirigami dataset`: summarise, check, compare hinge databases and write them as CSV.

mod compare;

use crate::ui;
use anyhow::{Result, ensure};
use app::output_file;
use clap::Subcommand;
use dataset::Database;
use std::path::PathBuf;

/// Summarise, check and compare hinge databases, and write them as CSV
#[derive(Subcommand)]
pub(crate) enum DatasetCommand {
    /// Print counts, rejected rows, and of every column its range, unit and meaning
    Summary {
        /// Database (Parquet with its manifest)
        #[arg(value_name = "DATABASE")]
        database: PathBuf,
        /// Print the manifest as JSON
        #[arg(long)]
        json: bool,
    },
    /// Look for what makes a database unfit for training: negative energies, forces that are not the
    /// gradient of the energy, damage that decreases, states that occur twice, test geometries that
    /// were trained on
    Check {
        /// Database (Parquet with its manifest)
        #[arg(value_name = "DATABASE")]
        database: PathBuf,
    },
    /// Write the table of a database as CSV
    Export {
        /// Database (Parquet with its manifest)
        #[arg(value_name = "DATABASE")]
        database: PathBuf,
        /// File to write
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Replace an existing file
        #[arg(long)]
        replace: bool,
    },
    Compare(compare::CompareRaysCommand),
}

impl DatasetCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match self {
            Self::Summary { database, json } => {
                let database = Database::read(database)?;
                ui::print(*json, database.manifest(), &database)?;
            }
            Self::Check { database: file } => {
                let database = Database::read(file)?;
                let findings = database.check();
                for finding in &findings {
                    println!("{finding}");
                }
                for ray in database.rays_on_other_tiers() {
                    println!(
                        "note: ray {} was solved on the mesh {}, not on {}",
                        ray.job, ray.solved_tier, ray.tier
                    );
                }
                ensure!(findings.is_empty(), "{} is not fit for training", file.display());
                println!("{}: nothing found", file.display());
            }
            Self::Export { database, out, replace } => {
                if !replace {
                    output_file::refuse_existing(out)?;
                }
                let csv = Database::read(database)?.to_csv()?;
                output_file::create_folder_of(out)?;
                output_file::write(out, csv)?;
                println!("written to {}", out.display());
            }
            Self::Compare(command) => command.run()?,
        }
        Ok(())
    }
}
