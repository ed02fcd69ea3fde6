//! `kirigami-studies surrogate`: the influence of rays, network size, epochs and precision on the error.

use crate::charts::{self, Curve};
use ::train::{Precision, TrainingConfig};
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{Database, Part};
use hinge::{HingeDeformation, HingeDesign};
use kirigami::commands::train::kept_fit;
use kirigami::ui::{picture, run_folder};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use support::table::{Cell, Table};
use surrogate::{Order, Surrogate, TestErrors};

/// Measure the accuracy of the surrogate against its cost: rays, network size, epochs, precision
///
/// Every network is trained on the same geometries, or on a part of them, and tested on the same
/// unseen geometries. Trained networks are stored in the folder, so the study can be stopped and continued.
/// Writes surrogate.csv, surrogate.md, tradeoff.md and surrogate.svg. Example:
/// kirigami-studies surrogate data/hinges.parquet --quick
#[derive(Args)]
pub struct SurrogateStudy {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Train two sizes only, for a tenth of the epochs
    #[arg(long)]
    quick: bool,
    /// Folder of the training configurations small.toml, medium.toml and paper.toml
    #[arg(long, value_name = "FOLDER", default_value = "configs/training")]
    configs: PathBuf,
    /// Folder for the tables, the chart and the fits
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-surrogate")]
    out: PathBuf,
}

/// Names of the shipped configurations, in ascending order of cost.
const SIZES: [&str; 3] = ["small", "medium", "paper"];

/// Numbers of training rays; the number of all available rays is added.
const RAYS: [usize; 5] = [50, 100, 200, 400, 800];

/// One network.
struct Case {
    size: String,
    /// Number of training rays.
    rays: usize,
    config: TrainingConfig,
}

/// A trained network with its errors and cost.
struct Fit {
    case: Case,
    errors: TestErrors,
    training_s: f64,
    /// Time of energy, forces and tangent per hinge, for 275 hinges at once (us).
    kernel_us: f64,
}

impl SurrogateStudy {
    pub fn run(&self) -> Result<()> {
        let database = Database::read(&self.database)?;
        let _held = run_folder::hold(&self.out)?;
        let cases = self.cases(&database)?;
        let count = cases.len();
        let mut fits: Vec<Fit> = Vec::new();
        for (done, case) in cases.into_iter().enumerate() {
            eprintln!("{} of {count}: {}", done + 1, case.name());
            fits.push(case.fit(&self.out.join("fits"), &database)?);
            self.write(&fits)?;
        }
        println!(
            "{} fits; see {}",
            fits.len(),
            self.out.join("surrogate.md").display()
        );
        Ok(())
    }

    /// Every size with every number of rays; with all rays also a quarter of the epochs and the other
    /// precision.
    fn cases(&self, database: &Database) -> Result<Vec<Case>> {
        let all = database.manifest().split.jobs(Part::Training).len();
        let rays: Vec<usize> = RAYS
            .into_iter()
            .filter(|&rays| rays < all)
            .chain([all])
            .collect();
        let sizes = if self.quick { &SIZES[..2] } else { &SIZES[..] };
        let mut cases = Vec::new();
        for size in sizes {
            let path = self.configs.join(format!("{size}.toml"));
            let mut config: TrainingConfig = support::toml_file::read(&path)?;
            if self.quick {
                config.epochs = config.epochs.div_ceil(10);
            }
            let case = |rays: usize, config: &TrainingConfig| Case {
                size: (*size).into(),
                rays,
                config: config.clone(),
            };
            cases.extend(rays.iter().map(|&rays| case(rays, &config)));
            let hasty = TrainingConfig {
                epochs: config.epochs.div_ceil(4),
                ..config.clone()
            };
            cases.push(case(all, &hasty));
            let exact = TrainingConfig {
                precision: Precision::F64,
                ..hasty
            };
            cases.push(case(all, &exact));
        }
        Ok(cases)
    }

    fn write(&self, fits: &[Fit]) -> Result<()> {
        let write = |name: &str, text: &str| run_folder::write(&self.out, name, text);
        write("surrogate.csv", &columns().csv(fits))?;
        write("surrogate.md", &markdown(fits))?;
        write("tradeoff.md", &tradeoff(fits))?;
        let chart = charts::against_rays(&curves(fits))?;
        picture::save(&chart, &self.out.join("surrogate"), 1600)?;
        Ok(())
    }
}

impl Case {
    fn precision(&self) -> &'static str {
        match self.config.precision {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        }
    }

    fn name(&self) -> String {
        let (size, rays, epochs) = (&self.size, self.rays, self.config.epochs);
        format!("{size}-{rays}-rays-{epochs}-epochs-{}", self.precision())
    }

    fn fit(self, folder: &Path, database: &Database) -> Result<Fit> {
        let thinned = database.thinned(self.rays);
        let surrogate = kept_fit(folder, &self.name(), &thinned, &self.config, None)?;
        Ok(Fit {
            errors: surrogate.card().test_errors,
            training_s: surrogate.card().training_s.unwrap_or_default(),
            kernel_us: kernel_us(&surrogate)?,
            case: self,
        })
    }
}

/// Time per hinge: the minimum over many evaluations of 275 hinges.
fn kernel_us(surrogate: &Surrogate) -> Result<f64> {
    const HINGES: usize = 275;
    let constants = surrogate.card().hinge;
    let fraction = |step: f64, k: usize| (step * k as f64).fract();
    let designs: Vec<HingeDesign> = (0..HINGES)
        .map(|k| {
            constants.hinge(
                5.0 + 20.0 * fraction(0.618, k),
                0.8 + 1.5 * fraction(0.414, k),
            )
        })
        .collect();
    let states: Vec<HingeDeformation> = (0..HINGES)
        .map(|k| {
            HingeDeformation::from([-fraction(0.732, k), fraction(0.236, k), fraction(0.89, k)])
        })
        .collect();
    let prepared = surrogate.prepare(&designs);
    let mut fastest = Duration::MAX;
    for _ in 0..100 {
        let began = Instant::now();
        let energies = surrogate.evaluate(&prepared, &states, Order::Tangent);
        fastest = fastest.min(began.elapsed());
        ensure!(
            energies.len() == HINGES,
            "the kernel returned {} energies for {HINGES} hinges",
            energies.len()
        );
    }
    Ok(1e6 * fastest.as_secs_f64() / HINGES as f64)
}

/// What both tables begin with.
fn cases<'a>() -> Table<'a, Fit> {
    Table::new()
        .column("size", |fit: &Fit| Cell::text(&fit.case.size))
        .column("precision", |fit| Cell::text(fit.case.precision()))
        .column("rays", |fit| Cell::text(fit.case.rays))
        .column("epochs", |fit| Cell::text(fit.case.config.epochs))
}

/// An error (%), which is NaN if not known.
fn error(percent: f64, decimals: usize) -> Cell {
    if percent.is_nan() {
        Cell::known(None, "- %")
    } else {
        Cell::percent(0.01 * percent, decimals)
    }
}

fn columns<'a>() -> Table<'a, Fit> {
    let mut table = cases()
        .column("W", |fit| error(fit.errors.percents()[0], 2))
        .column("median", |fit| Cell::percent(fit.errors.energy.median, 2));
    for (k, name) in ["F_a", "F_s", "M", "D", "D_peak"].into_iter().enumerate() {
        table = table.column(name, move |fit| error(fit.errors.percents()[k + 1], 1));
    }
    let seconds = |value: f64| Cell::number(value, format!("{value:.0} s"));
    let microseconds = |value: f64| Cell::number(value, format!("{value:.1} us"));
    table
        .column("training", move |fit| seconds(fit.training_s))
        .column("kernel", move |fit| microseconds(fit.kernel_us))
}

fn markdown(fits: &[Fit]) -> String {
    let mut text = format!(
        "# Accuracy of the surrogate against its cost\n\n\
         Relative root mean square errors on geometries that no network was trained on, the same for every \
         row; the kernel time is that of energy, forces and tangent.\n\n{}\
         \nThe error of the energy decreases with the number n of rays as n^-p:\n\n",
        columns().markdown(fits)
    );
    for curve in curves(fits) {
        if let [(first, error), .., (last, smallest)] = curve.energy[..] {
            let p = (error / smallest).ln() / (last / first).ln();
            let doubled = 100.0 * (1.0 - 2.0_f64.powf(-p));
            text += &format!(
                "* {}: p = {p:.2}; twice the rays would reduce the error by {doubled:.0} %\n",
                curve.title
            );
        }
    }
    text + "\n![errors against rays](surrogate.png)\n"
}

/// One row per network: its cost, its errors and its use.
fn tradeoff(fits: &[Fit]) -> String {
    let table = Table::new()
        .column("network", |fit: &Fit| {
            Cell::text(format!("{} {}", fit.case.size, fit.case.precision()))
        })
        .column("rays", |fit| Cell::text(fit.case.rays))
        .column("epochs", |fit| Cell::text(fit.case.config.epochs))
        .column("training", |fit| {
            Cell::text(format!("{:.0} s", fit.training_s))
        })
        .column("kernel, us per hinge", |fit| Cell::fixed(fit.kernel_us, 1))
        .column("W", |fit| error(fit.errors.percents()[0], 2))
        .column("forces", |fit| error(fit.errors.forces_percent(), 1))
        .column("damage", |fit| error(fit.errors.percents()[4], 1))
        .column("good for", |fit| {
            Cell::text(match fit.case.size.as_str() {
                "small" => "first designs, many seeds",
                "medium" => "everyday design",
                _ => "the last design before cutting",
            })
        });
    format!("## Surrogate\n\n{}", table.markdown(fits))
}

/// Errors against rays for each size at its own number of epochs.
fn curves(fits: &[Fit]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    let longest = |size: &str| {
        let epochs = fits.iter().filter(|fit| fit.case.size == size);
        epochs.map(|fit| fit.case.config.epochs).max()
    };
    for Fit { case, errors, .. } in fits {
        if longest(&case.size) != Some(case.config.epochs) {
            continue;
        }
        if curves.last().is_none_or(|curve| curve.title != case.size) {
            curves.push(Curve {
                title: case.size.clone(),
                ..Curve::default()
            });
        }
        if let Some(curve) = curves.last_mut() {
            let rays = case.rays as f64;
            curve.energy.push((rays, errors.percents()[0]));
            curve.forces.push((rays, errors.forces_percent()));
        }
    }
    curves
}
