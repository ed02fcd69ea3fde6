//! `kirigami calibrate`: kerf, thickness and stresses of a cut sheet, or of the specimens of a coupon, from measurements on it.

mod coupon;
mod coupon_folder;
mod fit_args;
mod instructions;
mod measured;
mod quantities;
mod readings_file;

use crate::commands::inspect::scene_args::{DESIGN_OF_RUN, Inspected};
use crate::ui::progress::Progress;
use crate::ui::run_folder;
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Subcommand};
use design::analysis::calibrated_scene::write_calibrated;
use design::analysis::calibration::calibrate;
use design::scene::Scene;
use design::scene::run_inputs::{SCENE_FILE, STATE_FILE};
use fit_args::FitArgs;
use measured::Measured;
use output::calibration::CalibrationReport;

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

/// The report as JSON, in the folder of a calibration.
const REPORT: &str = "calibration.json";

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
            !quantities.is_empty(),
            "every quantity of --fit is --known: nothing is left to find"
        );
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
        let known = quantities::deviation(&self.known, scene)?;
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
}
