//! What a run leaves in its folder beside its state: report, cut lines, pictures.

use crate::drawing;
use crate::fabrication::{CutLines, FabricationError, write_dxf, write_svg};
use crate::gradient::Deployment;
use crate::inverse_design::Designed;
use crate::report::Report;
use crate::scene::Scene;
use hinge::files;
use std::path::PathBuf;

/// A result that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    #[error(transparent)]
    Fabrication(#[from] FabricationError),
    #[error("cannot write {path}: {source}", path = .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Writes `report.json`, `report.txt`, `deployed-start.svg` and `deployed.svg`, and of a design that
/// can be cut `cut.dxf`, `cut.svg` and `flat.svg`.
///
/// Of one that cannot, the report says why, and cut files of an earlier design are removed.
pub fn write_results(scene: &Scene, designed: &Designed) -> Result<Report, ResultsError> {
    let folder = scene.output();
    let write = |name: &str, contents: &[u8]| {
        let path = folder.join(name);
        files::write(&path, contents).map_err(|source| ResultsError::Write { path, source })
    };
    let best = &designed.best.deployment;
    let cuts = CutLines::new(&best.pattern, &best.sheet, &scene.material);
    // First of all, so that whoever finds a cut file finds what to mind about it.
    let report = Report::new(scene, designed, &cuts);
    let json = serde_json::to_vec_pretty(&report).map_err(|error| ResultsError::Write {
        path: folder.join("report.json"),
        source: error.into(),
    })?;
    write("report.json", &json)?;
    write("report.txt", report.to_string().as_bytes())?;
    match &cuts {
        Ok(cuts) => {
            write_dxf(&folder.join("cut.dxf"), cuts)?;
            write_svg(&folder.join("cut.svg"), cuts)?;
            let flat = drawing::flat(&scene.config.title, &best.sheet, cuts);
            write("flat.svg", flat.as_bytes())?;
        }
        Err(_) => {
            for name in ["cut.dxf", "cut.svg", "flat.svg"] {
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
    let configuration = &deployment.final_step().configuration;
    drawing::deployed(scene, &deployment.sheet, configuration)
}
