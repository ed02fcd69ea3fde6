//! `kirigami surrogate test`

use anyhow::{Result, ensure};
use app::state_errors::{print_errors, record};
use clap::{Args, ValueEnum};
use dataset::Database;
use std::path::PathBuf;
use surrogate::Surrogate;

/// Print the errors of weights on a database, such as a spot check or rays of a finer mesh
///
/// Only states inside the training domain are evaluated, except for the 95 % intervals of the
/// errors over other rays. Rays that the weights were trained on count too, if the database has
/// any. Example: kirigami surrogate test data/pet-0.5mm/medium.safetensors
/// data/pet-0.5mm/spot-check.parquet
#[derive(Args)]
pub(crate) struct TestCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Write the errors to the card of the weights, from which the report of a design takes the
    /// errors of the hinge law: at random states, or at visited ones, which it prefers. The states
    /// must be in no training
    #[arg(long, value_name = "STATES")]
    record: Option<States>,
}

#[derive(Clone, Copy, ValueEnum)]
enum States {
    Random,
    Visited,
}

impl TestCommand {
    pub(super) fn run(&self) -> Result<()> {
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
        if let Some(states) = self.record {
            let recorded = match states {
                States::Random => Surrogate::with_spot_check,
                States::Visited => Surrogate::with_visited,
            };
            record(surrogate, &database, recorded, &self.weights)?;
        }
        Ok(())
    }
}
