//! `kirigami calibrate`: kerf, thickness and stresses of a cut sheet, or of the specimens of a coupon, from measurements on it.

mod coupon;
mod coupon_folder;
mod instructions;
mod known;
mod measured;
mod readings_file;

use crate::commands::inspect::scene_args::{DESIGN_OF_RUN, Inspected};
use crate::commands::points_file::PointArgs;
use crate::ui::progress::Progress;
use crate::ui::run_folder;
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Subcommand, ValueEnum};
use design::analysis::calibrated_scene::write_calibrated;
use design::analysis::calibration::{Quantity, calibrate};
use design::scene::Scene;
use design::scene::run_inputs::{SCENE_FILE, STATE_FILE};
use known::Known;
use measured::Measured;
use output::calibration::CalibrationReport;
use std::path::PathBuf;

/// Find kerf, thickness and stresses of a cut sheet from measurements on it, and write its scene
///
/// Measured points (--points, the table of `kirigami compare`) are those of the sheet at full load. Readings (--readings) are a CSV
/// file with the columns displacement_mm and load_N, or mass_g for weights that pull; displacement_deg and load_Nmm for couples;
/// both count from the sheet before its loads. With distance_mm in place of the displacement, the first row is before the loads. Quantities
/// that the measurements hardly determine are named; they stay near the
/// scene's values. Writes the scene of the calibrated sheet, with its material and weights, for the next design. The folder of a coupon
/// (`kirigami calibrate coupon`) in place of a scene fits all of its specimens. Examples: kirigami calibrate runs/a4-polyester
/// --points points.csv --readings readings.csv --out runs/calibrated;
/// kirigami calibrate runs/coupon --known thickness=2.93
#[derive(Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    mut_arg("design", |arg| arg.help(DESIGN_OF_RUN))
)]
pub struct CalibrateCommand {
    #[command(subcommand)]
    before: Option<Before>,
    #[command(flatten)]
    fit: FitArgs,
}

#[derive(Subcommand)]
enum Before {
    Coupon(coupon::CouponCommand),
}

#[derive(Args)]
struct FitArgs {
    /// There unless there is a subcommand.
    #[command(flatten)]
    designed: Option<Inspected>,
    /// Points measured at full load (CSV)
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    #[command(flatten)]
    read: PointArgs,
    /// Readings of displacement and load on the way (CSV) [default for a coupon: readings.csv in its folder]
    #[arg(long, value_name = "FILE")]
    readings: Option<PathBuf>,
    /// Quantities to find; the others are right
    #[arg(long, value_name = "QUANTITY", value_delimiter = ',', default_values = ["kerf", "thickness", "stress"])]
    fit: Vec<QuantityArg>,
    /// Quantities that were measured by themselves, and are not fitted: kerf and thickness in mm, stress over the material's. Example:
    /// thickness=2.93,kerf=0.25
    #[arg(long, value_name = "QUANTITY=VALUE", value_delimiter = ',')]
    known: Vec<Known>,
    /// Standard error of x and of y of a point (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2, value_parser = above_zero)]
    point_error: f64,
    /// Standard error of a reading, of the load if the motion is prescribed, of the displacement under dead loads (% of the largest)
    #[arg(long, value_name = "PERCENT", default_value_t = READING_ERROR, value_parser = above_zero)]
    reading_error: f64,
    /// Folder for the report and the calibrated scene
    #[arg(long, value_name = "FOLDER", default_value = "runs/calibrate")]
    out: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Usual standard error of a reading (% of the largest).
const READING_ERROR: f64 = 2.0;
/// The report as JSON, in the folder of a calibration.
const REPORT: &str = "calibration.json";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum QuantityArg {
    /// Width that the cutter removes.
    Kerf,
    /// Thickness of the sheet.
    Thickness,
    /// All stresses at equal strain, modulus and yield together.
    Stress,
}

impl From<QuantityArg> for Quantity {
    fn from(arg: QuantityArg) -> Self {
        match arg {
            QuantityArg::Kerf => Self::Kerf,
            QuantityArg::Thickness => Self::Thickness,
            QuantityArg::Stress => Self::Stress,
        }
    }
}

fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| *number > 0.0 && *number < 1e3)
        .ok_or_else(|| "must be a number above 0 and below 1000".into())
}

impl CalibrateCommand {
    pub(crate) fn run(&self) -> Result<()> {
        match (&self.before, &self.fit.designed) {
            (Some(Before::Coupon(coupon)), _) => coupon.run(),
            (None, Some(designed)) => self.fit.run(designed),
            (None, None) => bail!("name a scene, a run or the folder of a coupon"),
        }
    }
}

impl FitArgs {
    fn run(&self, designed: &Inspected) -> Result<()> {
        let measured = Measured::read(self, designed)?;
        let quantities = self.quantities();
        ensure!(
            self.out.join(REPORT).exists()
                || (!self.out.join(SCENE_FILE).exists() && !self.out.join(STATE_FILE).exists()),
            "{} holds a scene or a run that no calibration has written: choose another folder with --out",
            self.out.display()
        );
        let _held = run_folder::hold(&self.out)?;
        let bar = Progress::new(0, "steps");
        let mut steps = 0;
        let mut progress = || {
            steps += 1;
            bar.show(steps, None, "");
        };
        let scene = &measured.scene;
        let known = known::deviation(&self.known, scene);
        let found = measured.with_sheets(|sheets| {
            let found = calibrate(sheets, &quantities, &known, &mut progress);
            found.map_err(|error| measured.located(error))
        });
        bar.finish();
        let found = found?;
        let report =
            CalibrationReport::new(scene, measured.name.clone(), measured.specimens(), found);
        ensure!(
            report.kerf > 0.0,
            "the fit has a kerf of {:.3} mm: no cutter removes less than nothing. Measure the \
             kerf by itself and leave it out of --fit",
            report.kerf
        );
        let json = serde_json::to_string_pretty(&report)?;
        run_folder::write(&self.out, REPORT, &json)?;
        run_folder::write(&self.out, "calibration.txt", &report.to_string())?;
        let deviation = report.calibration.deviation();
        let file = write_calibrated(scene, &deviation, &self.out, &report.comment())
            .context("cannot write the calibrated scene")?;
        if self.json {
            println!("{json}");
        } else {
            print!("{report}\nthe scene of this sheet: {}\n", file.display());
        }
        match Scene::read(&file) {
            Err(error) => eprintln!("before a design the scene needs a change: {error}"),
            Ok(_) if !self.json => println!("next: kirigami design {}", file.display()),
            Ok(_) => {}
        }
        Ok(())
    }

    /// The quantities to fit, each once.
    fn quantities(&self) -> Vec<Quantity> {
        let asked = |quantity: &Quantity| {
            let mut fitted = self.fit.iter().map(|arg| Quantity::from(*arg));
            fitted.any(|own| own == *quantity)
        };
        let known =
            |quantity: &Quantity| self.known.iter().any(|known| known.quantity == *quantity);
        let all = Quantity::ALL.into_iter();
        all.filter(|quantity| asked(quantity) && !known(quantity))
            .collect()
    }
}
