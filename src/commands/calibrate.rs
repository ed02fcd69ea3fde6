//! `kirigami calibrate`: kerf, thickness and stresses of a cut sheet, from measurements on it.

mod readings_file;

use crate::commands::inspect::scene_args::{DESIGN_OF_RUN, Inspected};
use crate::commands::points_file::PointArgs;
use crate::ui::progress::Progress;
use crate::ui::run_folder;
use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use design::analysis::calibrated_scene::write_calibrated;
use design::analysis::calibration::{
    CalibrationError, LoadData, Measurements, PointData, Quantity, calibrate,
};
use design::analysis::real_sheet::RealSheet;
use design::scene::Scene;
use design::scene::run_inputs::{SCENE_FILE, STATE_FILE};
use output::calibration::CalibrationReport;
use readings_file::ReadingsFile;
use std::path::PathBuf;

/// Find kerf, thickness and stresses of a cut sheet from measurements on it, and write its scene
///
/// Measured points (--points, the table of `kirigami compare`) are those of the sheet at full load. Readings (--readings) are a CSV
/// file with the columns displacement_mm and load_N, or mass_g for weights that pull; displacement_deg and load_Nmm for couples;
/// both count from the sheet before its loads. Quantities that the measurements hardly determine are named; they stay near the
/// scene's values. Writes the scene of the calibrated sheet, with its material and weights, for the next design. Example: kirigami calibrate runs/a4-polyester
/// --points points.csv --readings readings.csv --out runs/calibrated
#[derive(Args)]
#[command(mut_arg("design", |arg| arg.help(DESIGN_OF_RUN)))]
pub struct CalibrateCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Points measured at full load (CSV)
    #[arg(long, value_name = "FILE", required_unless_present = "readings")]
    points: Option<PathBuf>,
    #[command(flatten)]
    read: PointArgs,
    /// Readings of displacement and load on the way (CSV)
    #[arg(long, value_name = "FILE")]
    readings: Option<PathBuf>,
    /// Quantities to find; the others are right
    #[arg(long, value_name = "QUANTITY", value_delimiter = ',', default_values = ["kerf", "thickness", "stress"])]
    fit: Vec<QuantityArg>,
    /// Standard error of x and of y of a point (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2, value_parser = above_zero)]
    point_error: f64,
    /// Standard error of a reading, of the load if the motion is prescribed, of the displacement under dead loads (% of the largest)
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0, value_parser = above_zero)]
    reading_error: f64,
    /// Folder for the report and the calibrated scene
    #[arg(long, value_name = "FOLDER", default_value = "runs/calibrate")]
    out: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// The report as JSON, in the folder of a calibration.
const REPORT: &str = "calibration.json";

#[derive(Clone, Copy, ValueEnum)]
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
        let (scene, design, name) = self.designed.read_run()?;
        let problem = scene.problem()?;
        let points = self.points.as_ref().map(|file| self.read.read(file));
        let points = points.transpose()?;
        let readings = self.readings.as_ref().map(|file| ReadingsFile::read(file));
        let readings = readings.transpose()?;
        let data = Measurements {
            points: points.as_ref().map(|(file, scale)| PointData {
                points: file.points.clone(),
                scale: *scale,
                error: self.point_error,
            }),
            loads: readings.as_ref().map(|file| LoadData {
                readings: file.readings.clone(),
                translational: file.translational,
                error: 0.01 * self.reading_error,
            }),
        };
        let mut quantities: Vec<Quantity> = Vec::new();
        for quantity in self.fit.iter().map(|arg| Quantity::from(*arg)) {
            if !quantities.contains(&quantity) {
                quantities.push(quantity);
            }
        }
        ensure!(
            self.out.join(REPORT).exists()
                || (!self.out.join(SCENE_FILE).exists() && !self.out.join(STATE_FILE).exists()),
            "{} holds a scene or a run that no calibration has written: choose another folder with --out",
            self.out.display()
        );
        let _held = run_folder::hold(&self.out)?;
        let sheet = RealSheet::new(&scene, &problem, &design)?;
        let bar = Progress::new(0, "steps");
        let mut steps = 0;
        let mut progress = || {
            steps += 1;
            bar.show(steps, None, "");
        };
        let found = calibrate(&problem, &sheet, &data, &quantities, &mut progress);
        bar.finish();
        let found = found.map_err(|error| match (error, &points, &readings) {
            (CalibrationError::Points(error), Some((file, _)), _) => file.located(error),
            (CalibrationError::Reading { index, fault }, _, Some(file)) => {
                file.located(index, &fault)
            }
            (error @ CalibrationError::OtherUnits(_), _, Some(file)) => file.of_file(&error),
            (error, ..) => error.into(),
        })?;
        let report = CalibrationReport::new(&scene, name, found);
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
        let file = write_calibrated(&scene, &deviation, &self.out, &report.comment())
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
