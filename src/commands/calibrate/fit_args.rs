//! The arguments of a calibration.

use crate::commands::calibrate::quantities::{Known, quantity};
use crate::commands::inspect::scene_args::Inspected;
use crate::commands::points_file::PointArgs;
use clap::Args;
use design::analysis::calibration::Quantity;
use std::path::PathBuf;

/// Usual standard error of a reading (% of the largest).
pub(super) const READING_ERROR: f64 = 2.0;

/// What was measured, and what is fitted to it.
#[derive(Args)]
pub(super) struct FitArgs {
    /// There unless there is a subcommand.
    #[command(flatten)]
    pub designed: Option<Inspected>,
    /// Points measured at full load (CSV)
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    #[command(flatten)]
    pub read: PointArgs,
    /// Readings of displacement and load on the way (CSV) [default for a coupon: readings.csv in its folder]
    #[arg(long, value_name = "FILE")]
    pub readings: Option<PathBuf>,
    /// Quantities to find: kerf, thickness, and stress, all stresses at equal strain, modulus and yield together; the others are right
    #[arg(long, value_name = "QUANTITY", value_delimiter = ',', value_parser = quantity, default_values = ["kerf", "thickness", "stress"])]
    fit: Vec<Quantity>,
    /// Quantities that were measured by themselves, and are not fitted: kerf and thickness in mm, stress over the material's. Example:
    /// thickness=2.93,kerf=0.25
    #[arg(long, value_name = "QUANTITY=VALUE", value_delimiter = ',')]
    pub known: Vec<Known>,
    /// Standard error of x and of y of a point (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2, value_parser = above_zero)]
    pub point_error: f64,
    /// Standard error of a reading, of the load if the motion is prescribed, of the displacement under dead loads (% of the largest)
    #[arg(long, value_name = "PERCENT", default_value_t = READING_ERROR, value_parser = above_zero)]
    pub reading_error: f64,
    /// Folder for the report and the calibrated scene
    #[arg(long, value_name = "FOLDER", default_value = "runs/calibrate")]
    pub out: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
}

fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| *number > 0.0 && *number < 1e3)
        .ok_or_else(|| "must be a number above 0 and below 1000".into())
}

impl FitArgs {
    /// The quantities to fit, each once.
    pub fn quantities(&self) -> Vec<Quantity> {
        let asked = |quantity: &Quantity| self.fit.contains(quantity);
        let known =
            |quantity: &Quantity| self.known.iter().any(|known| known.quantity == *quantity);
        let all = Quantity::ALL.into_iter();
        all.filter(|quantity| asked(quantity) && !known(quantity))
            .collect()
    }
}
