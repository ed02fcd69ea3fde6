//! `kirigami train`: from a hinge database to weights that `design` reads.

use crate::charts::{self, ParityChart};
use crate::picture;
use crate::progress::Progress;
use crate::table::table;
use anyhow::{Context, Result, bail};
use clap::Args;
use comfy_table::Table;
use dataset::Database;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use surrogate::TestErrors;
use train::{Backend, Epoch, Parity, TrainingConfig};

/// Train the surrogate hinge energy on a database
///
/// Writes the weights, their card, the learning curve and a parity plot, and prints the errors on
/// hinge geometries that the training never saw. Example:
/// kirigami train runs/demo/hinges.parquet --config configs/training/demo.toml
#[derive(Args)]
pub struct TrainCommand {
    /// Database, as `kirigami database collect` writes it (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Sizes, loss and optimiser of the training (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/medium.toml"
    )]
    config: PathBuf,
    /// Weights to write; the card, the curve and the plot stand beside them
    #[arg(
        long,
        value_name = "FILE",
        default_value = "runs/weights/surrogate.safetensors"
    )]
    out: PathBuf,
    /// What computes the tensors: flex or ndarray
    #[arg(long, value_name = "NAME", default_value_t = Backend::default())]
    backend: Backend,
    /// Replace existing weights
    #[arg(long)]
    replace: bool,
}

impl TrainCommand {
    /// With the default backend, replacing weights that are there.
    pub fn new(database: PathBuf, config: PathBuf, out: PathBuf) -> Self {
        Self {
            database,
            config,
            out,
            backend: Backend::default(),
            replace: true,
        }
    }

    pub fn run(&self) -> Result<()> {
        let config: TrainingConfig = hinge::config::read(&self.config)?;
        let database = Database::read(&self.database)?;
        if self.out.exists() && !self.replace {
            bail!(
                "{} exists: choose another name or pass --replace",
                self.out.display()
            );
        }
        if let Some(folder) = self.out.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        let bar = Progress::new(config.epochs, "epochs");
        let trained = train::train(&database, &config, self.backend, &mut |epoch: &Epoch| {
            let message = format!(
                "loss {:.2e}, validation {:.2e}",
                epoch.training_loss, epoch.validation_loss
            );
            bar.show(epoch.epoch, None, &message);
        })?;
        bar.finish();
        trained.surrogate.save(&self.out)?;
        self.write_curve(&trained.history)?;
        picture::save(
            &parity_chart(&trained.parity)?,
            &self.beside("parity"),
            2000,
        )?;
        println!("{}", error_table(&trained.test_errors));
        if let Some(last) = trained.history.last() {
            println!(
                "{} epochs on {} in {:.1} s; weights written to {}",
                last.epoch,
                self.backend,
                last.elapsed_s,
                self.out.display()
            );
        }
        Ok(())
    }

    /// `<stem>-<suffix>` beside the weights.
    fn beside(&self, suffix: &str) -> PathBuf {
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy();
        self.out.with_file_name(format!("{stem}-{suffix}"))
    }

    fn write_curve(&self, history: &[Epoch]) -> Result<()> {
        let mut csv = String::from("epoch,training_loss,validation_loss,learning_rate,elapsed_s\n");
        for e in history {
            writeln!(
                csv,
                "{},{:e},{:e},{:e},{:.3}",
                e.epoch, e.training_loss, e.validation_loss, e.learning_rate, e.elapsed_s
            )?;
        }
        let stem = self.beside("learning-curve");
        write(&stem.with_extension("csv"), &csv)?;
        let training: Vec<_> = history.iter().map(|e| e.training_loss).collect();
        let validation: Vec<_> = history.iter().map(|e| e.validation_loss).collect();
        picture::save(
            &charts::learning_curve(&training, &validation)?,
            &stem,
            1200,
        )?;
        Ok(())
    }
}

fn write(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

fn parity_chart(parity: &Parity) -> Result<String> {
    let chart = |title: &str, points| ParityChart {
        title: title.to_owned(),
        points,
    };
    charts::parity(&[
        chart("energy W (N mm)", &parity.energy),
        chart("axial force F_a (N)", &parity.f_a),
        chart("shear force F_s (N)", &parity.f_s),
        chart("moment M (N mm)", &parity.m_theta),
        chart("damage D", &parity.damage),
    ])
}

fn error_table(errors: &TestErrors) -> Table {
    let header = format!("on {} samples of unseen geometries", errors.rows);
    let mut table = table([header.as_str(), "relative RMSE", "median"]);
    for (name, error) in [
        ("energy W", errors.energy),
        ("axial force F_a", errors.f_a),
        ("shear force F_s", errors.f_s),
        ("moment M_theta", errors.m_theta),
        ("damage D", errors.damage),
    ] {
        table.add_row([
            name.to_owned(),
            format!("{:.2} %", 100.0 * error.relative_rmse),
            format!("{:.2} %", 100.0 * error.median),
        ]);
    }
    table
}
