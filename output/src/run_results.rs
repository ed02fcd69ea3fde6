//! The results of a run, written to its folder besides its state: report, cut files, pictures.

use crate::cut_file::{
    CutLines, SheetDrawing, cut_list, cut_summary, deployed_panels, dxf, mark_errors, svg,
};
use crate::drawing;
use crate::report::{Report, Warning};
use crate::report_pdf::report_pdf;
use crate::run_page::run_page;
use design::objective::design_problem::Deployment;
use design::scene::Scene;
use design::scene::design_run::{CUT_FILES, Designed};
use design::scene::placement::placed;
use design::sheet::kinematics::deployed_corners;
use std::path::PathBuf;
use support::whole_file;

/// A result that could not be written.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum ResultsError {
    #[error("cannot write {path}: {source}", path = .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Writes `report.json`, `report.txt`, `report.pdf`, `run.html`, `deployed-start.svg` and `deployed.svg`; for a design with
/// cut lines also `flat.svg`; for a design without errors, or if `force`, also the [`CUT_FILES`].
///
/// If no cut file is written, the report states why, and the cut files of an earlier design are removed.
pub fn write_results(
    scene: &Scene,
    designed: &Designed,
    force: bool,
) -> Result<Report, ResultsError> {
    let folder = scene.output();
    let write = |name: &str, contents: &[u8]| {
        let path = folder.join(name);
        whole_file::write(&path, contents).map_err(|source| ResultsError::Write { path, source })
    };
    let best = &designed.best.deployment;
    let cuts = CutLines::new(&best.pattern, &best.sheet, scene.config.cutting);
    // Written first, so that there is never a cut file without its report.
    let report = Report::new(scene, designed, &cuts, force);
    let not_json = |name: &str| {
        let path = folder.join(name);
        |error: serde_json::Error| ResultsError::Write {
            path,
            source: error.into(),
        }
    };
    let json = serde_json::to_vec_pretty(&report).map_err(not_json("report.json"))?;
    write("report.json", &json)?;
    write("report.txt", report.to_string().as_bytes())?;
    let page = run_page(scene, designed, &report).map_err(not_json("run.html"))?;
    write("run.html", page.as_bytes())?;
    let paper = report_pdf(scene, designed, &report, cuts.as_ref().ok());
    write("report.pdf", &paper)?;
    match &cuts {
        Ok(cuts) if report.cut_file => {
            let drawing = SheetDrawing::new(cuts, &best.sheet, &scene.material);
            let mut annotated = drawing.annotated();
            let errors: Vec<String> = report.errors().map(Warning::to_string).collect();
            mark_errors(&mut annotated, &errors);
            write("cut.dxf", dxf(&annotated).as_bytes())?;
            write("cut.svg", svg(&annotated).as_bytes())?;
            write("cut-list.csv", cut_list(&best.sheet, cuts).as_bytes())?;
            write(
                "cut-summary.csv",
                cut_summary(cuts, &drawing.totals).as_bytes(),
            )?;
            let configuration = placed(scene, &best.sheet, &best.final_step().configuration);
            let deployed = deployed_panels(&deployed_corners(&best.sheet, &configuration));
            write("deployed.dxf", dxf(&deployed).as_bytes())?;
        }
        _ => {
            for name in CUT_FILES {
                remove(folder.join(name))?;
            }
        }
    }
    match &cuts {
        Ok(cuts) => {
            let flat = drawing::flat(&scene.config.title, &best.sheet, cuts);
            write("flat.svg", flat.as_bytes())?;
        }
        Err(_) => {
            for name in ["flat.svg", "flat.png"] {
                remove(folder.join(name))?;
            }
        }
    }
    write(
        "deployed-start.svg",
        picture(scene, &designed.start.deployment).as_bytes(),
    )?;
    write("deployed.svg", picture(scene, best).as_bytes())?;
    Ok(report)
}

/// Removes a file of an earlier run, if there is one.
fn remove(path: PathBuf) -> Result<(), ResultsError> {
    match std::fs::remove_file(&path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(ResultsError::Write { path, source })
        }
        _ => Ok(()),
    }
}

fn picture(scene: &Scene, deployment: &Deployment) -> String {
    drawing::deployed(scene, &deployment.sheet, deployment.final_step())
}
