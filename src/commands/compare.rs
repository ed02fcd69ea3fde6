//! `kirigami compare`: points measured on a deployed sheet, compared with its predicted equilibrium
//! path.

use crate::commands::inspect::scene_args::Inspected;
use analysis::{measured_points::Mark, measured_sheet::MeasuredSheet, shape_path::ShapePath};
use anyhow::{Context, Result, ensure};
use app::{picture, points_file::PointsFile, run_folder};
use clap::Args;
use design::sheet::cut_sheet::Sheet;
use output::{drawing, measurement::MeasurementReport};
use scene::Scene;
use std::{
    collections::BTreeSet,
    fmt::Write,
    path::{Path, PathBuf},
};

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

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 2000;

impl CompareCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let (scene, design, _) = self.designed.chosen().read_run()?;
        let problem = scene.problem()?;
        let _held = run_folder::hold(&self.out)?;
        if self.template {
            let (_, sheet) = problem.cut(&design)?;
            return self.write_template(&scene, &sheet);
        }
        let deployment = problem.deploy(&design)?;
        let path = ShapePath::new(&problem, &deployment);
        if path.end() == 0.0 {
            deployment.at_full_load()?;
        }
        let measured = self.measured.as_ref().context("no measured points")?;
        let measured = self.fit(measured, &path)?;
        let closed = match &self.closed {
            Some(file) => Some(self.fit(file, &ShapePath::flat(path.sheet))?.best),
            None => None,
        };
        let topology = &path.sheet.topology;
        let supports = scene.config.supports.iter();
        let supported: BTreeSet<usize> =
            supports.map(|support| topology.number(support.panel)).collect();
        let supported: Vec<usize> = supported.into_iter().collect();
        let title = &scene.config.title;
        let closed = closed.as_ref();
        let report = MeasurementReport::new(title, path.sheet, &measured, closed, &supported);
        let json = serde_json::to_string_pretty(&report)?;
        let write = |name, text: &str| run_folder::write(&self.out, name, text);
        write("comparison.json", &json)?;
        let document = report.document();
        write("comparison.txt", &document.to_string())?;
        write("residuals.csv", &report.residuals_csv())?;
        write("openings.csv", &report.openings_csv())?;
        let svg = drawing::measured(path.sheet, &measured.best, &report);
        picture::save(&svg, &self.out.join("comparison"), PICTURE_WIDTH)?;
        let text = format!("{document}\nwritten to {}", self.out.display());
        println!("{}", if self.json { json } else { text });
        Ok(())
    }

    fn fit(&self, file: &Path, path: &ShapePath) -> Result<MeasuredSheet> {
        let points = PointsFile::read(file, path.sheet.panels.len(), self.y_down)?;
        MeasuredSheet::new(path, &points.points, points.scale())
            .with_context(|| file.display().to_string())
    }

    /// Writes `template.csv`, to be filled, and `numbering.svg`.
    fn write_template(&self, scene: &Scene, sheet: &Sheet) -> Result<()> {
        let mut text = "panel,corner,x,y,flat_x_mm,flat_y_mm\n".to_owned();
        for mark in Mark::all(sheet) {
            let corner = mark.corner.map(|corner| corner.to_string());
            let [x, y] = mark.flat(sheet);
            let (panel, corner) = (mark.panel, corner.unwrap_or_default());
            writeln!(text, "{panel},{corner},,,{x:.2},{y:.2}")?;
        }
        let file = self.out.join("template.csv");
        ensure!(
            !file.exists(),
            "{} exists and may contain a measurement: choose another folder with --out",
            file.display()
        );
        run_folder::write(&self.out, "template.csv", &text)?;
        let svg = drawing::numbering(&scene.config.title, sheet);
        let [_, picture] = picture::save(&svg, &self.out.join("numbering"), PICTURE_WIDTH)?;
        println!(
            "fill x and y in {}, and leave them empty where a point is not measured; numbers in {}",
            file.display(),
            picture.display()
        );
        Ok(())
    }
}
