//! `kirigami dataset`: summarise, join, split, correct, compare hinge databases and exchange them as CSV.

mod compare;

use crate::ui::output_file;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{ColumnMap, Database, Mixing, SplitPlan, rows_from_csv};
use std::path::PathBuf;

/// Summarise, join, split, correct and compare hinge databases, and exchange them as CSV
#[derive(Args)]
pub struct DatasetCommand {
    #[command(subcommand)]
    action: Action,
}

subcommands! {
    enum Action {
        Summary(SummaryCommand),
        Check(CheckCommand),
        Merge(MergeCommand),
        Split(SplitCommand),
        Import(ImportCommand),
        Export(ExportCommand),
        Compare(compare::CompareCommand),
        Correct(CorrectCommand),
    }
}

/// Print counts, rejected rows and the range of every column
#[derive(Args)]
struct SummaryCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Print the manifest as JSON
    #[arg(long)]
    json: bool,
}

/// Look for what makes a database unfit for training: negative energies, forces that are not the gradient of the
/// energy, damage that decreases, states that occur twice, test geometries that were trained on
#[derive(Args)]
struct CheckCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
}

/// Join the databases of several campaigns; a job found in several of them is kept once
#[derive(Args)]
struct MergeCommand {
    /// Databases (Parquet with their manifests)
    #[arg(value_name = "DATABASE", required = true)]
    databases: Vec<PathBuf>,
    /// Allow different materials and mesh tiers, which no surrogate can tell apart
    #[arg(long)]
    mixed: bool,
    #[command(flatten)]
    out: OutArgs,
}

/// Split the geometries again into training, validation and test
///
/// Example: kirigami dataset split runs/reference.parquet --like runs/corrected.parquet --out runs/reference-split.parquet
#[derive(Args)]
struct SplitCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Give each geometry the part that it has in this database; geometries that it lacks are for training. Weights trained
    /// on this database can then be fine-tuned without having seen the test geometries
    #[arg(long, value_name = "DATABASE", conflicts_with_all = ["seed", "validation", "test"])]
    like: Option<PathBuf>,
    /// Seed of the split
    #[arg(long, value_name = "N", default_value_t = SplitPlan::default().seed)]
    seed: u64,
    /// Fraction of the geometries for validation, which selects the checkpoint
    #[arg(long, value_name = "FRACTION", default_value_t = SplitPlan::default().validation)]
    validation: f64,
    /// Fraction of the geometries for the test errors
    #[arg(long, value_name = "FRACTION", default_value_t = SplitPlan::default().test)]
    test: f64,
    #[command(flatten)]
    out: OutArgs,
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

/// Correct a database to a finer mesh, by those of its rays that were also solved on that mesh
///
/// The energy is multiplied by a fitted ratio of the two meshes, a polynomial in geometry and deformation;
/// the forces remain its gradient. D and D_peak have their own factors. Quantities whose differences this does not
/// reduce on rays that were left out remain as they are. The split and the columns that are
/// not used for training are unchanged. Prints the remaining differences when each ray is corrected
/// by the others. Example: kirigami dataset correct data/pet-0.5mm/hinges.parquet
/// data/pet-0.5mm/reference.parquet --out runs/corrected.parquet
#[derive(Args)]
struct CorrectCommand {
    /// Database to correct (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Database with some of its rays on a finer mesh (Parquet with its manifest)
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
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
        ensure!(
            findings.is_empty(),
            "{} is not fit for training",
            self.database.display()
        );
        println!("{}: nothing found", self.database.display());
        Ok(())
    }
}

impl MergeCommand {
    fn run(&self) -> Result<()> {
        let databases: Result<Vec<_>, _> = self
            .databases
            .iter()
            .map(|path| Database::read(path))
            .collect();
        let mixing = if self.mixed {
            Mixing::Allowed
        } else {
            Mixing::Refused
        };
        self.out.write(&Database::merge(
            &databases?,
            &SplitPlan::default(),
            mixing,
        )?)
    }
}

impl SplitCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let split = match &self.like {
            Some(other) => database.split_like(&Database::read(other)?)?,
            None => database.split(&SplitPlan {
                seed: self.seed,
                validation: self.validation,
                test: self.test,
            })?,
        };
        self.out.write(&split)
    }
}

impl ImportCommand {
    fn run(&self) -> Result<()> {
        let map: ColumnMap = match &self.columns {
            Some(path) => support::toml_file::read(path)?,
            None => ColumnMap::default(),
        };
        let rows = rows_from_csv(&self.table, &map)?;
        self.out
            .write(&Database::collect(rows, &SplitPlan::default())?)
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

impl CorrectCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let reference = Database::read(&self.reference)?;
        let (corrected, judged) = database.corrected(&reference)?;
        self.out.write(&corrected)?;
        println!("{}", compare::correction(&judged)?);
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
