//! `kirigami train`: trains the weights of the hinge energy on a hinge database.

use crate::{
    commands::pipeline::campaign::{DATABASE, SPOT_CHECK},
    ui::interrupt,
};
use anyhow::Result;
use app::train::{TrainingTask, train_campaign};
use clap::Args;
use std::path::{Path, PathBuf};

/// Train the surrogate hinge energy on a database
///
/// Writes the weights (of the best epoch and of the last), their card, the learning curve and a
/// parity plot, and prints the errors on hinge geometries that were not used for training. After a
/// stop the same command continues. Examples: kirigami train runs/demo/hinges.parquet --config
/// configs/training/small.toml; kirigami train configs/campaigns/polypropylene-3mm.toml
///
/// Of a campaign, whose database is collected, it makes every training that the campaign names,
/// each with four seeds: the best one is runs/CAMPAIGN/weights/NAME.safetensors, the others NAME-1
/// to NAME-3, its ensemble. It tests them on the spot check of the campaign, and records the errors
/// on their cards.
#[derive(Args, Clone)]
pub(crate) struct TrainCommand {
    /// Database as written by `kirigami campaign collect` (Parquet with its manifest), or a
    /// campaign (TOML)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Network sizes, loss and optimiser of the training (TOML) [default:
    /// configs/training/medium.toml, with --from configs/training/fine-tuning.toml]
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Weights to write; the card, the curve and the plots are written next to them
    #[arg(
        long,
        value_name = "FILE",
        default_value = WEIGHTS
    )]
    out: PathBuf,
    /// Fine-tune these weights of another material, thickness or mesh; the network sizes are taken
    /// from the weights. docs/MATERIALS.md lists the errors over the number of rays
    #[arg(long, value_name = "WEIGHTS")]
    from: Option<PathBuf>,
    /// Number of trainings, with successive seeds. The one with the smallest validation error of W
    /// and the forces is kept as the weights. Seeds that are trained already are not trained again
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=64))]
    seeds: u64,
    /// Replace existing weights; with several seeds, the weights of another training. Also discard
    /// the state of another training that was stopped
    #[arg(long)]
    replace: bool,
}

/// The weights to write by default.
const WEIGHTS: &str = "runs/weights/surrogate.safetensors";

impl TrainCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let stop = interrupt::stop_flag()?;
        if self.database.extension().is_some_and(|extension| extension == "toml") {
            let plain = self.config.is_none()
                && self.from.is_none()
                && self.seeds == 1
                && self.out == Path::new(WEIGHTS);
            return train_campaign(
                &self.database,
                plain,
                self.replace,
                stop,
                [DATABASE, SPOT_CHECK],
            );
        }
        let Self { database, config, out, from, seeds, replace } = self.clone();
        TrainingTask { database, config, out, from, seeds, replace, stop }.run()
    }
}
