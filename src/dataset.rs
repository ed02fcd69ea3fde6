//! `kirigami dataset`: look at hinge databases, join them, split them, exchange them as CSV.

mod compare;

use anyhow::{Context, Result, ensure};
use clap::{Args, Subcommand};
use dataset::{ColumnMap, Database, Details, Gates, Mixing, SplitPlan, compare, rows_from_csv};
use std::path::{Path, PathBuf};

/// Look at hinge databases, join them, split them, exchange them as CSV
#[derive(Args)]
pub struct DatasetCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Summary(SummaryCommand),
    Merge(MergeCommand),
    Split(SplitCommand),
    Import(ImportCommand),
    Export(ExportCommand),
    Compare(compare::CompareCommand),
    Correct(CorrectCommand),
}

/// Print counts, ranges, histograms, rejected rows, energy residuals and coverage
#[derive(Args)]
struct SummaryCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
}

/// Join the databases of several campaigns; a job that stands in more than one counts once
#[derive(Args)]
struct MergeCommand {
    /// Databases (Parquet with their manifests)
    #[arg(value_name = "DATABASE", required = true)]
    databases: Vec<PathBuf>,
    /// Let materials and mesh tiers be mixed, which no surrogate can tell apart
    #[arg(long)]
    mixed: bool,
    #[command(flatten)]
    out: OutArgs,
}

/// Deal the geometries anew to training, validation and test
#[derive(Args)]
struct SplitCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    #[command(flatten)]
    out: OutArgs,
}

/// Make a database of a CSV file, of `dataset export` or of any solver
#[derive(Args)]
struct ImportCommand {
    /// Table, one state of one hinge a row
    #[arg(value_name = "CSV")]
    table: PathBuf,
    /// Names, factors and constants of foreign columns (TOML); see configs/import
    #[arg(long, value_name = "FILE")]
    columns: Option<PathBuf>,
    /// Greatest accepted energy residual of a row, where the table has one
    #[arg(long, value_name = "SHARE", default_value_t = Gates::default().energy_residual_max)]
    energy_residual_max: f64,
    #[command(flatten)]
    out: OutArgs,
}

/// Write the table of a database as CSV
#[derive(Args)]
struct ExportCommand {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// The CSV file
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Correct every row to a finer mesh, by the rays that were solved on it too
///
/// The energy is multiplied by what the finer mesh makes of it, a polynomial in geometry and
/// deformation; the forces stay its gradient, and D and D_peak have factors of their own. The split
/// stays, and so do the columns that no surrogate is trained on. Prints what is left of the
/// differences where each ray is corrected by the others. Example: kirigami dataset correct
/// data/pet-0.5mm/hinges.parquet data/pet-0.5mm/reference.parquet --out runs/corrected.parquet
#[derive(Args)]
struct CorrectCommand {
    /// Database to correct (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Some of its rays on a finer mesh
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
    /// The Parquet file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    replace: bool,
}

/// The database to write, and how its geometries are dealt out.
#[derive(Args)]
struct OutArgs {
    /// The Parquet file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    replace: bool,
    /// Seed of the split
    #[arg(long, value_name = "N", default_value_t = SplitPlan::default().seed)]
    seed: u64,
    /// Share of the geometries that chooses the checkpoint
    #[arg(long, value_name = "SHARE", default_value_t = SplitPlan::default().validation)]
    validation: f64,
    /// Share of the geometries that errors are measured on
    #[arg(long, value_name = "SHARE", default_value_t = SplitPlan::default().test)]
    test: f64,
}

impl DatasetCommand {
    pub fn run(&self) -> Result<()> {
        match &self.action {
            Action::Summary(command) => command.run(),
            Action::Merge(command) => command.run(),
            Action::Split(command) => command.run(),
            Action::Import(command) => command.run(),
            Action::Export(command) => command.run(),
            Action::Compare(command) => command.run(),
            Action::Correct(command) => command.run(),
        }
    }
}

impl SummaryCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        println!("{database}\n{}", Details(&database));
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
        let mixing = match self.mixed {
            true => Mixing::Allowed,
            false => Mixing::Refused,
        };
        self.out
            .write(&Database::merge(&databases?, &self.out.plan(), mixing)?)
    }
}

impl SplitCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        self.out.write(&database.split(&self.out.plan())?)
    }
}

impl ImportCommand {
    fn run(&self) -> Result<()> {
        let map: ColumnMap = match &self.columns {
            Some(path) => hinge::config::read(path)?,
            None => ColumnMap::default(),
        };
        let gates = Gates {
            energy_residual_max: self.energy_residual_max,
        };
        let rows = rows_from_csv(&self.table, &map)?;
        self.out
            .write(&Database::collect(rows, &gates, &self.out.plan())?)
    }
}

impl ExportCommand {
    fn run(&self) -> Result<()> {
        ensure!(
            !self.out.exists(),
            "{} exists; choose another name",
            self.out.display()
        );
        let csv = Database::read(&self.database)?.to_csv()?;
        make_folder(&self.out)?;
        hinge::files::write(&self.out, &csv)
            .with_context(|| format!("cannot write {}", self.out.display()))?;
        println!("written to {}", self.out.display());
        Ok(())
    }
}

impl CorrectCommand {
    fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let reference = Database::read(&self.reference)?;
        let corrected = database.corrected(&reference)?;
        write(&corrected, &self.out, self.replace)?;
        println!("{}", compare::correction(&compare(&database, &reference))?);
        Ok(())
    }
}

impl OutArgs {
    fn plan(&self) -> SplitPlan {
        SplitPlan {
            seed: self.seed,
            validation: self.validation,
            test: self.test,
        }
    }

    fn write(&self, database: &Database) -> Result<()> {
        write(database, &self.out, self.replace)
    }
}

fn write(database: &Database, out: &Path, replace: bool) -> Result<()> {
    make_folder(out)?;
    database.write(out, replace)?;
    println!("{database}\nwritten to {}", out.display());
    Ok(())
}

fn make_folder(file: &Path) -> Result<()> {
    let Some(folder) = file.parent() else {
        return Ok(());
    };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))
}
