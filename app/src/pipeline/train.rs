//! Trains the weights of the hinge energy: on a database, or all that a campaign names.

mod campaign;
mod kept_fits;
mod seeds;

use crate::{charts, input_file, output_file, picture, run_folder};
use ::train::{Epoch, Trained, TrainingConfig};
use anyhow::{Context, Result, bail, ensure};
pub use campaign::train_campaign;
use dataset::{ComparedState, Database, LeftOut};
use kept_fits::continued_fit;
pub use kept_fits::kept_fit;
use std::{
    fmt::Write,
    fs::File,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};
use support::{
    document::Document,
    table::{Cell, Table},
};
use surrogate::{Surrogate, TestErrors};
use verification::spread_table;

/// What is trained on a database, and where the weights go.
pub struct TrainingTask<'a> {
    /// The database (Parquet with its manifest).
    pub database: PathBuf,
    /// The settings of the training; `None` for the shipped ones.
    pub config: Option<PathBuf>,
    /// The weights to write.
    pub out: PathBuf,
    /// Weights to fine-tune.
    pub from: Option<PathBuf>,
    /// Number of trainings, with successive seeds.
    pub seeds: u64,
    /// Whether weights and states of other trainings are replaced.
    pub replace: bool,
    /// Stops the training, which the next call continues.
    pub stop: &'a AtomicBool,
}

/// The data on which test errors are measured.
pub const UNSEEN: &str = "samples of unseen geometries";

impl TrainingTask<'_> {
    /// Trains, writes the weights and prints their errors.
    pub fn run(&self) -> Result<()> {
        input_file::require(self.config(), "--config")?;
        let base = self.from.as_deref().map(Surrogate::load).transpose()?;
        let config: TrainingConfig = support::toml_file::read(self.config())?;
        let config = match &base {
            Some(weights) => config.with_sizes_of(weights),
            None => config,
        };
        let database = self.read_database()?;
        output_file::create_folder_of(&self.out)?;
        self.refuse_card_of_database()?;
        if self.seeds > 1 {
            return self.train_seeds(&database, &config, base.as_ref());
        }
        self.refuse_existing()?;
        let _held = hold(&self.out)?;
        let state = self.state();
        let data = (&database).into();
        let trained = continued_fit(data, &config, base.as_ref(), &state, self.replace, self.stop)?;
        self.write(&trained)?;
        std::fs::remove_file(&state).ok();
        Ok(())
    }

    /// The database, corrected to its finer mesh if it has one.
    fn read_database(&self) -> Result<Database> {
        let database = Database::read(&self.database)?;
        if let Some(leak) = database.leak() {
            bail!("{}: {leak}: collect it again", self.database.display());
        }
        let others = database.rays_on_other_tiers().len();
        if others > 0 {
            println!(
                "{others} of the rays were solved on another mesh than the campaign's, and are used"
            );
        }
        let (database, checked) = database.corrected()?;
        if let Some(checked) = checked {
            println!("{}", correction(&checked));
        }
        Ok(database)
    }

    fn config(&self) -> &Path {
        let default = match self.from {
            Some(_) => "configs/training/fine-tuning.toml",
            None => "configs/training/medium.toml",
        };
        self.config.as_deref().unwrap_or(Path::new(default))
    }

    fn refuse_card_of_database(&self) -> Result<()> {
        // Card and manifest are both `<stem>.json`.
        ensure!(
            located(&card_path(&self.out))? != located(&card_path(&self.database))?,
            "the card of {} would replace the database's manifest: choose another name",
            self.out.display()
        );
        Ok(())
    }

    fn refuse_existing(&self) -> Result<()> {
        for path in [&self.out, &card_path(&self.out)] {
            if !self.replace {
                output_file::refuse_existing(path)?;
            }
        }
        Ok(())
    }

    /// Writes weights, last weights, curves and plots of one training, and prints its errors.
    fn write(&self, trained: &Trained) -> Result<()> {
        trained.surrogate.save(&self.out)?;
        trained.last.save(&self.with_suffix("last.safetensors"))?;
        self.write_curve(&trained.history)?;
        let axes = ["finite elements", "surrogate"];
        let parity = charts::parity(&trained.parity.states, QUANTITIES, axes)?;
        picture::save(&parity, &self.with_suffix("parity"), 1200)?;
        println!("{}\n", error_table(&trained.test_errors, UNSEEN));
        if let Some(last) = trained.history.last() {
            println!(
                "{} epochs in {:.1} s; weights written to {}",
                last.epoch,
                last.elapsed_s,
                self.out.display()
            );
        }
        Ok(())
    }

    /// The path of the file written by [`Training::save`](train::Training::save).
    fn state(&self) -> PathBuf {
        self.out.with_extension("state")
    }

    /// `<stem>-<suffix>` next to the weights.
    fn with_suffix(&self, suffix: &str) -> PathBuf {
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy();
        self.out.with_file_name(format!("{stem}-{suffix}"))
    }

    fn write_curve(&self, history: &[Epoch]) -> Result<()> {
        let mut csv = String::from(
            "epoch,training_loss,validation_loss,validation_error,validation_d_error,\
             validation_d_peak_error,learning_rate,elapsed_s\n",
        );
        for e in history {
            writeln!(
                csv,
                "{},{:e},{:e},{:e},{:e},{:e},{:e},{:.3}",
                e.epoch,
                e.training_loss,
                e.validation_loss,
                e.validation_errors[0],
                e.validation_errors[1],
                e.validation_errors[2],
                e.learning_rate,
                e.elapsed_s
            )?;
        }
        let stem = self.with_suffix("learning-curve");
        output_file::write(&stem.with_extension("csv"), csv)?;
        let losses = |of: fn(&Epoch) -> f64| -> Vec<f64> { history.iter().map(of).collect() };
        let (training, validation) = (losses(|e| e.training_loss), losses(|e| e.validation_loss));
        let chart = charts::learning_curve(&training, &validation)?;
        picture::save(&chart, &stem, 1200)?;
        Ok(())
    }
}

/// Locks the files of weights against a second training until the returned file is dropped.
fn hold(out: &Path) -> Result<File> {
    run_folder::lock(&out.with_extension("lock"), || {
        let out = out.display();
        format!("another training writes {out}: wait for it, or choose another name with --out")
    })
}

/// The path of the card of weights, or of the manifest of a database.
fn card_path(file: &Path) -> PathBuf {
    file.with_extension("json")
}

/// The path of a file in an existing folder, without links and `.` in the path of the folder.
fn located(file: &Path) -> Result<PathBuf> {
    let file = std::path::absolute(file)?;
    let folder = file.parent().unwrap_or(Path::new("/"));
    let folder = (folder.canonicalize())
        .with_context(|| format!("cannot read the folder {}", folder.display()))?;
    Ok(folder.join(file.file_name().unwrap_or_default()))
}

/// The errors of each quantity on `what`.
pub fn error_table(errors: &TestErrors, what: &str) -> Table {
    let header = format!("on {} {what}", errors.rows);
    let mut table = Table::new([header.as_str(), "relative RMSE", "median"]);
    for (name, error) in QUANTITIES.into_iter().zip(errors.by_quantity()) {
        table.row([
            Cell::text(name),
            Cell::percent(error.relative_rmse, 2),
            Cell::percent(error.median, 2),
        ]);
    }
    table
}

/// The quantities of [`TestErrors::by_quantity`].
const QUANTITIES: [&str; 6] = [
    "energy W (N mm)",
    "axial force F_a (N)",
    "shear force F_s (N)",
    "moment M_theta (N mm)",
    "damage D",
    "damage D_peak",
];

/// What a correction would leave, when each ray is corrected by the others.
pub fn correction(checked: &LeftOut) -> Document {
    let note = match &checked.uncorrected()[..] {
        [] => String::new(),
        left => format!(
            " Not corrected, because that does not reduce the differences: {}.",
            left.join(", ")
        ),
    };
    let states: Vec<&[ComparedState]> = checked.states.iter().map(Vec::as_slice).collect();
    let mut page = Document::default();
    page.text(format!(
        "Remaining differences when each of the {} rays is corrected by the others.{note}",
        checked.states.len()
    ));
    page.table(spread_table(&states, "ray"));
    page
}
