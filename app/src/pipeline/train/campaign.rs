//! The trainings of a campaign: of every network that it names, four seeds, tested on its spot
//! check.

use crate::{
    state_errors::{print_errors, record},
    train::TrainingTask,
};
use ::train::TrainingConfig;
use anyhow::{Context, Result, ensure};
use dataset::Database;
use fe_driver::Campaign;
use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use support::toml_file;
use surrogate::Surrogate;

/// Number of trainings of a network.
const SEEDS: u64 = 4;

/// Trains what a campaign (TOML) names, on the database in its folder; `files` are the names of the
/// database and of the spot check there. `plain`: no setting was given that is for a database.
pub fn train_campaign(
    file: &Path,
    plain: bool,
    replace: bool,
    stop: &AtomicBool,
    files: [&str; 2],
) -> Result<()> {
    let campaign = Campaign::load(file)?;
    ensure!(
        !campaign.training.is_empty(),
        "{} names no training: set training = [\"../training/medium.toml\"] there, or train its database with --config",
        file.display()
    );
    ensure!(
        plain,
        "a campaign says what is trained, with {SEEDS} seeds, into its folder: --config, --out, --from and --seeds \
         are for a database"
    );
    let from = weights_before(&campaign, file)?;
    let folder = Path::new("runs").join(file.file_stem().unwrap_or_default());
    let [database, spot_check] = files.map(|name| folder.join(name));
    for (training, from) in std::iter::zip(&campaign.training, from) {
        let stem = training.file_stem().unwrap_or_default();
        let network = TrainingTask {
            database: database.clone(),
            // The settings of fine-tuning are the default of trainings that begin from weights.
            config: from.is_none().then(|| training.clone()),
            out: folder.join("weights").join(stem).with_added_extension("safetensors"),
            from,
            seeds: SEEDS,
            replace,
            stop,
        };
        network.run()?;
        network.name_ensemble()?;
        if campaign.spot_rays > 0 {
            network.record(&spot_check)?;
        }
    }
    Ok(())
}

impl TrainingTask<'_> {
    /// The best of the seeds, followed by the others.
    fn ensemble(&self) -> impl Iterator<Item = PathBuf> {
        let others = (1..SEEDS).map(|i| self.with_suffix(&format!("{i}.safetensors")));
        std::iter::once(self.out.clone()).chain(others)
    }

    /// Gives the seeds that were not chosen the names of the ensemble.
    fn name_ensemble(&self) -> Result<()> {
        let best = Surrogate::load(&self.out)?;
        let seeds = (0..SEEDS).map(|seed| Surrogate::load(&self.member(seed)));
        let seeds: Vec<Surrogate> = seeds.collect::<Result<_, _>>()?;
        let others = seeds.iter().filter(|seed| seed.hash() != best.hash());
        for (other, file) in std::iter::zip(others, self.ensemble().skip(1)) {
            other.save(&file)?;
        }
        Ok(())
    }

    /// Tests the ensemble on a spot check and records the errors on the cards.
    fn record(&self, spot: &Path) -> Result<()> {
        let spot = Database::read(spot)?;
        for file in self.ensemble() {
            let weights = Surrogate::load(&file)?;
            print_errors(&weights, &spot);
            record(weights, &spot, Surrogate::with_spot_check, &file)?;
        }
        Ok(())
    }
}

/// The weights from which each training of a campaign begins, if there are any; an error for
/// weights that no training begins from.
fn weights_before(campaign: &Campaign, file: &Path) -> Result<Vec<Option<PathBuf>>> {
    let configs = campaign.training.iter();
    let configs: Vec<TrainingConfig> =
        configs.map(|training| toml_file::read(training)).collect::<Result<_, _>>()?;
    let mut before = vec![None; configs.len()];
    for named in &campaign.pretrained {
        let weights = Surrogate::load(named)?;
        let has_sizes = |config: &TrainingConfig| config.clone().with_sizes_of(&weights) == *config;
        let place = configs.iter().position(has_sizes).with_context(|| {
            let (named, file) = (named.display(), file.display());
            format!("{file}: no training has a network of the sizes of {named}")
        })?;
        before[place] = Some(named.clone());
    }
    Ok(before)
}
