//! `kirigami dataset compare`: differences of a mesh from a finer one on the same rays.

use anyhow::{Context, Result};
use app::{compared_meshes::compared_meshes, output_file, run_folder};
use clap::Args;
use dataset::Database;
use std::path::PathBuf;

/// Compare the rays of a database with the same rays on its finer mesh, or in another database
///
/// Prints the differences, also those that a training leaves, which corrects the rays to the finer
/// mesh, and writes them to compare.md. Example: kirigami dataset
/// compare data/polypropylene-3mm/hinges.parquet
#[derive(Args)]
pub(crate) struct CompareRaysCommand {
    /// Database to evaluate (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Reference database (Parquet with its manifest) [default: the finer mesh of DATABASE]
    #[arg(value_name = "REFERENCE")]
    reference: Option<PathBuf>,
    /// Folder of compare.md
    #[arg(long, value_name = "FOLDER", default_value = "runs/compare")]
    out: PathBuf,
}

impl CompareRaysCommand {
    pub(super) fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let reference = (self.reference.as_ref()).map(|file| Database::read(file));
        let page = compared_meshes(&database, reference.transpose()?.as_ref())
            .with_context(|| self.database.display().to_string())?;
        output_file::create_folder(&self.out)?;
        run_folder::write(&self.out, "compare.md", &page.markdown())?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}
