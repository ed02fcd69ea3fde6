//! `kirigami dataset`: summarise, check, compare hinge databases and exchange them as CSV.

mod compare;

pub(crate) use compare::correction;

use crate::ui::output_file;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{ColumnMap, Database, SplitPlan, rows_from_csv};
use std::path::PathBuf;

/// Summarise, check and compare hinge databases, and exchange them as CSV
#[derive(Args)]
pub struct DatasetCommand {
    #[command(subcommand)]
    action: Action,
}

subcommands! {
    enum Action {
        Summary(SummaryCommand),
        Check(CheckCommand),
        Import(ImportCommand),
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

/// Make a database from a CSV file, written by `dataset export` or by any solver
#[derive(Args)]
struct ImportCommand {
    /// Table (CSV), one hinge state per row
    #[arg(value_name = "CSV")]
    table: PathBuf,
    /// Column names, unit factors and constants of the table (TOML); see configs/import
    #[arg(long, value_name = "FILE")]
    columns: Option<PathBuf>,
    #[command(flatten)]
    out: OutArgs,
}

/// Write the table of a database as CSV
#[derive(Args)]
struct ExportCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    #[command(flatten)]
    out: OutArgs,
}

/// The file to write.
#[derive(Args)]
struct OutArgs {
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

impl ImportCommand {
    fn run(&self) -> Result<()> {
        let map: ColumnMap = match &self.columns {
            Some(path) => support::toml_file::read(path)?,
            None => ColumnMap::default(),
        };
        let rows = rows_from_csv(&self.table, &map)?;
        self.out.write(&Database::collect(rows, &SplitPlan::default())?)
    }
}

impl ExportCommand {
    fn run(&self) -> Result<()> {
        let OutArgs { out, replace } = &self.out;
        if !replace {
            output_file::refuse_existing(out)?;
        }
        let csv = Database::read(&self.database)?.to_csv()?;
        output_file::create_folder_of(out)?;
        output_file::write(out, csv)?;
        println!("written to {}", out.display());
        Ok(())
    }
}

impl OutArgs {
    fn write(&self, database: &Database) -> Result<()> {
        output_file::create_folder_of(&self.out)?;
        database.write(&self.out, self.replace)?;
        println!("{database}\nwritten to {}", self.out.display());
        Ok(())
    }
}
