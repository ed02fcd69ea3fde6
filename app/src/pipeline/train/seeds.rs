//! Trainings that differ only in their seed, and the choice among them.
//!
//! Every seed has its own files next to the weights `X`: `X-seed-S.safetensors`, and
//! `X-seed-S.state`, from which a stopped training continues. The states remain: from them the
//! command that finds all seeds trained writes the weights, the curves and the comparison.

use crate::{
    failure::Unfinished,
    output_file,
    progress::announce,
    run_folder,
    train::{
        TrainingTask, hold,
        kept_fits::{continued_fit, is_of},
    },
};
use ::train::{Trained, TrainingConfig};
use anyhow::{Context, Result, bail, ensure};
use dataset::Database;
use std::{
    path::{Path, PathBuf},
    sync::atomic::Ordering,
};
use support::Extremes;
use support::table::{Cell, Table};
use surrogate::Surrogate;

/// The trainings of all seeds of one command.
struct Seeds<'a> {
    task: &'a TrainingTask<'a>,
    database: &'a Database,
    /// Initial weights of every training; random ones if `None`.
    base: Option<&'a Surrogate>,
    /// The configuration of every seed.
    configs: Vec<TrainingConfig>,
}

impl TrainingTask<'_> {
    /// Trains the seeds that are not trained yet, and chooses among all.
    pub(super) fn train_seeds(
        &self,
        database: &Database,
        config: &TrainingConfig,
        base: Option<&Surrogate>,
    ) -> Result<()> {
        let seeds = config.seed..config.seed + self.seeds;
        let with = |seed| TrainingConfig { seed, ..config.clone() };
        let configs: Vec<TrainingConfig> = seeds.map(with).collect();
        let seeds = Seeds { task: self, database, base, configs };
        if !self.replace {
            seeds.refuse_other_weights()?;
        }
        seeds.train_each()?;
        seeds.choose()
    }

    /// The path of the weights of one of several seeds.
    pub(super) fn member(&self, seed: u64) -> PathBuf {
        self.with_suffix(&format!("seed-{seed}.safetensors"))
    }
}

impl Seeds<'_> {
    /// Whether a file holds weights of the training with this configuration.
    fn holds(&self, weights: &Path, config: &TrainingConfig) -> bool {
        let loaded = Surrogate::load(weights);
        loaded.is_ok_and(|weights| is_of(weights.card(), self.database.into(), config, self.base))
    }

    /// An error if files of other trainings would be replaced.
    fn refuse_other_weights(&self) -> Result<()> {
        for config in &self.configs {
            let member = self.task.member(config.seed);
            if !self.holds(&member, config) {
                output_file::refuse_existing(&member)?;
            }
        }
        let out = &self.task.out;
        if !self.configs.iter().any(|config| self.holds(out, config)) {
            output_file::refuse_existing(out)?;
        }
        Ok(())
    }

    /// Trains the seeds. One that fails does not end the others.
    fn train_each(&self) -> Result<()> {
        let (mut left, mut failed) = (0, 0);
        for config in &self.configs {
            if self.task.stop.load(Ordering::Relaxed) {
                left += 1;
                continue;
            }
            match self.train_seed(config) {
                Ok(()) => {}
                Err(error) if error.is::<Unfinished>() => left += 1,
                Err(error) => {
                    failed += 1;
                    eprintln!("seed {}: {error:#}", config.seed);
                }
            }
        }
        match left {
            0 => ensure!(failed == 0, "{failed} of {} trainings failed", self.configs.len()),
            _ => bail!(Unfinished { left, what: "trainings" }),
        }
        Ok(())
    }

    /// Trains a seed, unless its training has ended and its state is there.
    fn train_seed(&self, config: &TrainingConfig) -> Result<()> {
        let member = self.task.member(config.seed);
        let _held = hold(&member)?;
        if !(state(&member).exists() && self.holds(&member, config)) {
            announce(&format!("seed {} -> {}", config.seed, member.display()));
            let trained = self.continued(config, self.task.replace)?;
            trained.surrogate.save(&member)?;
        }
        Ok(())
    }

    fn continued(&self, config: &TrainingConfig, discard: bool) -> Result<Trained> {
        let state = state(&self.task.member(config.seed));
        continued_fit(self.database.into(), config, self.base, &state, discard, self.task.stop)
    }

    /// Writes the weights of the best seed with their curves and plots, and the comparison of the
    /// seeds.
    fn choose(&self) -> Result<()> {
        let members = self.configs.iter().map(|config| self.continued(config, false));
        let members: Vec<Trained> = members.collect::<Result<_>>()?;
        let errors = members.iter().map(validation_error).enumerate();
        let best = errors.smallest_by(|(_, error)| *error);
        let (best, _) = best.context("`--seeds` must be at least 1")?;
        let mut table = Table::new(COLUMNS);
        for (place, (config, member)) in self.configs.iter().zip(&members).enumerate() {
            table.row(self.cells(config, member, place == best));
        }
        let name = self.task.with_suffix("seeds");
        let folder = name.parent().unwrap_or(Path::new(""));
        let name = name.file_name().unwrap_or_default().to_string_lossy();
        run_folder::write_table(folder, &name, &table)?;
        println!("{table}\n");
        self.task.write(&members[best])
    }

    /// The cells of one seed in the comparison.
    fn cells(&self, config: &TrainingConfig, member: &Trained, chosen: bool) -> Vec<Cell> {
        let mut cells = vec![
            Cell::text(config.seed),
            Cell::text(if chosen { "yes" } else { "no" }),
            Cell::text(member.history.len()),
        ];
        let validation = validation_errors(member).map(|error| 100.0 * error);
        let errors = validation.into_iter().chain(member.test_errors.percents());
        cells.extend(errors.map(|percent| Cell::fixed(percent, 2)));
        cells.push(Cell::text(self.task.member(config.seed).display()));
        cells
    }
}

/// The path of the state of the training of one seed.
fn state(member: &Path) -> PathBuf {
    member.with_extension("state")
}

const COLUMNS: [&str; 13] = [
    "seed",
    "chosen",
    "epochs",
    "validation W and forces (%)",
    "validation D (%)",
    "validation D_peak (%)",
    "test W (%)",
    "test F_a (%)",
    "test F_s (%)",
    "test M (%)",
    "test D (%)",
    "test D_peak (%)",
    "weights",
];

/// The minimum validation error of each network over the epochs; NaN if it is not known.
fn validation_errors(trained: &Trained) -> [f64; 3] {
    [0, 1, 2].map(|network| {
        let errors = (trained.history.iter()).map(|epoch| epoch.validation_errors[network]);
        errors.fold(f64::NAN, f64::min)
    })
}

/// The error by which the best training is chosen: of W and the forces, which decide how a sheet
/// opens; of D where they are not known.
fn validation_error(trained: &Trained) -> f64 {
    let [w, d, _] = validation_errors(trained);
    if w.is_nan() { d } else { w }
}
