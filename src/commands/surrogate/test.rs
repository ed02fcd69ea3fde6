//! `kirigami surrogate test`

use crate::commands::surrogate::errors::StateErrors;
use anyhow::{Result, ensure};
use clap::Args;
use dataset::Database;
use std::path::{Path, PathBuf};
use surrogate::Surrogate;
use train::{ErrorInterval, spot_check};

/// Print the errors of weights on a database, such as a spot check or rays of a finer mesh
///
/// Only states inside the training domain are evaluated, except for the 95 % intervals of the
/// errors over other rays. Rays that the weights were trained on count too, if the database has
/// any. Example: kirigami surrogate test data/pet-0.5mm/medium.safetensors
/// data/pet-0.5mm/spot-check.parquet
#[derive(Args)]
pub struct TestCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Write the errors to the card of the weights as their spot check, from which the error budget
    /// of a design takes the errors of the hinge law. The states must be in no training
    #[arg(long)]
    record: bool,
}

impl TestCommand {
    pub fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let database = Database::read(&self.database)?;
        let (card, manifest) = (surrogate.card(), database.manifest());
        if let Some(material) = &card.material_hash {
            ensure!(
                (manifest.material_hashes.iter()).all(|other| other == material),
                "{} were trained on {}, but {} is of another material law, {}",
                self.weights.display(),
                card.material,
                self.database.display(),
                manifest.material
            );
        }
        print_errors(&surrogate, &database);
        if self.record {
            record(surrogate, &database, &self.weights)?;
        }
        Ok(())
    }
}

/// Prints the errors of weights at the states of a database.
pub(crate) fn print_errors(surrogate: &Surrogate, database: &Database) {
    let manifest = database.manifest();
    println!(
        "weights of tier {}, tested on tier {}, {} rays",
        surrogate.card().tier,
        manifest.tier,
        manifest.rays
    );
    print!("{}", StateErrors::new(surrogate, database.rows()).document());
    match ErrorInterval::of(surrogate, database.rows()) {
        Some([w, forces]) => println!("all states: W {w}; forces {forces}"),
        None => println!("all states: too few for an interval"),
    }
}

/// Writes the errors to the card of weights.
pub(crate) fn record(surrogate: Surrogate, spot: &Database, weights: &Path) -> Result<()> {
    let check = spot_check(&surrogate, spot.rows(), &spot.manifest().tier.to_string());
    surrogate.with_spot_check(check).save(weights)?;
    println!("recorded on the card of {}", weights.display());
    Ok(())
}
