//! Points measured on a deployed sheet, compared with its predicted equilibrium path.

mod points_file;

use crate::{picture, run_folder};
use analysis::{measured_points::Mark, measured_sheet::MeasuredSheet, shape_path::ShapePath};
use anyhow::{Context, Result, ensure};
use design::pattern::design_vector::DesignVector;
use output::{drawing, measurement::MeasurementReport};
use points_file::PointsFile;
use scene::Scene;
use std::{
    collections::BTreeSet,
    fmt::Write,
    path::{Path, PathBuf},
};

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 2000;

/// Compares the points in files, of the deployed sheet and of the same sheet before that, with the
/// prediction; y may count downwards in them. Writes report, tables and a picture to the folder
/// `out`.
pub fn compare(
    scene: &Scene,
    design: &DesignVector,
    (measured, closed): (&Path, Option<&Path>),
    y_down: bool,
    out: &Path,
) -> Result<MeasurementReport> {
    let problem = scene.problem()?;
    let deployment = problem.deploy(design)?;
    let path = ShapePath::new(&problem, &deployment);
    if path.end() == 0.0 {
        deployment.at_full_load()?;
    }
    let sheet = path.sheet;
    let fit = |file: &Path, path: &ShapePath| {
        let points = PointsFile::read(file, sheet.panels.len(), y_down)?;
        MeasuredSheet::new(path, &points.points, points.scale())
            .with_context(|| file.display().to_string())
    };
    let measured = fit(measured, &path)?;
    let closed = match closed {
        Some(file) => Some(fit(file, &ShapePath::flat(sheet))?.best),
        None => None,
    };
    let supports = scene.config.supports.iter();
    let supported: BTreeSet<usize> =
        supports.map(|support| sheet.topology.number(support.panel)).collect();
    let supported: Vec<usize> = supported.into_iter().collect();
    let title = &scene.config.title;
    let report = MeasurementReport::new(title, sheet, &measured, closed.as_ref(), &supported);
    let write = |name, text: &str| run_folder::write(out, name, text);
    write("comparison.json", &serde_json::to_string_pretty(&report)?)?;
    write("comparison.txt", &report.document().to_string())?;
    write("residuals.csv", &report.residuals_csv())?;
    write("openings.csv", &report.openings_csv())?;
    let svg = drawing::measured(sheet, &measured.best, &report);
    picture::save(&svg, &out.join("comparison"), PICTURE_WIDTH)?;
    Ok(report)
}

/// Writes `template.csv`, to be filled, and the picture `numbering`; returns both.
pub fn write_template(scene: &Scene, design: &DesignVector, out: &Path) -> Result<[PathBuf; 2]> {
    let (_, sheet) = scene.problem()?.cut(design)?;
    let mut text = "panel,corner,x,y,flat_x_mm,flat_y_mm\n".to_owned();
    for mark in Mark::all(&sheet) {
        let corner = mark.corner.map(|corner| corner.to_string());
        let [x, y] = mark.flat(&sheet);
        let (panel, corner) = (mark.panel, corner.unwrap_or_default());
        writeln!(text, "{panel},{corner},,,{x:.2},{y:.2}")?;
    }
    let file = out.join("template.csv");
    ensure!(
        !file.exists(),
        "{} exists and may contain a measurement: choose another folder with --out",
        file.display()
    );
    run_folder::write(out, "template.csv", &text)?;
    let svg = drawing::numbering(&scene.config.title, &sheet);
    let [_, picture] = picture::save(&svg, &out.join("numbering"), PICTURE_WIDTH)?;
    Ok([file, picture])
}
