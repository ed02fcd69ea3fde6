//! `kirigami compare`: points measured on a deployed sheet, compared with its predicted equilibrium
//! path.

use crate::{commands::inspect::scene_args::Inspected, ui::print};
use anyhow::{Context, Result};
use app::{
    measured::{compare, write_template},
    run_folder,
};
use clap::Args;
use std::path::PathBuf;

/// Compare points measured on a deployed sheet with the prediction
///
/// MEASURED is a CSV file with the columns panel, corner, x, y and, unless they are in mm, unit
/// (mm, cm, m, or px of a picture, whose scale is fitted); without a corner the point is the
/// panel's centre. Corners count 0 to 3 counter-clockwise from the lower left one in the flat
/// sheet. Rows may be missing; position and rotation of the measurement are free. Writes report,
/// tables and a picture; see docs/MEASURING.md. Examples: kirigami compare
/// configs/scenes/pet-3x3.toml --template; kirigami compare configs/scenes/pet-3x3.toml points.csv
/// --y-down
#[derive(Args)]
pub struct CompareCommand {
    #[command(flatten)]
    designed: Inspected,
    /// Measured points (CSV)
    #[arg(value_name = "MEASURED", required_unless_present = "template")]
    measured: Option<PathBuf>,
    /// Points of the same sheet before it was deployed (CSV): the floor of the measurement, and, if
    /// both files are in one frame, the slip of the supports
    #[arg(long, value_name = "FILE")]
    closed: Option<PathBuf>,
    /// y counts downwards, as in the pixels of a picture
    #[arg(long)]
    y_down: bool,
    /// Write an empty table of all points and a picture of their numbers, and compare nothing
    #[arg(long, conflicts_with_all = ["measured", "closed"])]
    template: bool,
    /// Folder for the report, the tables and the pictures
    #[arg(long, value_name = "FOLDER", default_value = "runs/compare")]
    out: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

impl CompareCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, _) = self.designed.chosen().read_run()?;
        let _held = run_folder::hold(&self.out)?;
        if self.template {
            let [file, picture] = write_template(&scene, &design, &self.out)?;
            println!(
                "fill x and y in {}, and leave them empty where a point is not measured; numbers in {}",
                file.display(),
                picture.display()
            );
            return Ok(());
        }
        let measured = self.measured.as_ref().context("no measured points")?;
        let files = (measured.as_path(), self.closed.as_deref());
        let report = compare(&scene, &design, files, self.y_down, &self.out)?;
        let text = format!("{}\nwritten to {}", report.document(), self.out.display());
        print(self.json, &report, text)
    }
}
