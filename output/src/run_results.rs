//! The results of a run, written to its folder besides its state, and deleted before a new search.

use crate::{
    cut_file::{CutLines, SheetDrawing},
    report::Report,
    run_files::{RUN_FILES, Results, Writer},
};
use analysis::design_checks::DesignChecks;
use scene::{
    Scene,
    design_run::{Designed, START},
};
use std::{io, path::Path};
use support::{Fault, FileError, at, fault, whole_file};

/// Writes the results of [`RUN_FILES`]: the picture of the flat sheet for a design with cut lines,
/// the cut files for a design without errors, or if `force`.
///
/// If no cut file is written, the report states why, and the cut files of an earlier design are
/// removed.
pub fn write_results(scene: &Scene, designed: &Designed, force: bool) -> Result<Report, Fault> {
    let best = &designed.best.deployment;
    let cuts = CutLines::of(scene, best);
    let checks = DesignChecks::read(&scene.output(), &designed.search.best).map_err(unwritten)?;
    let report = Report::new(scene, designed, &cuts, checks, force);
    let drawn = cuts.as_ref().ok().filter(|_| report.cut_file);
    let results = Results {
        scene,
        designed,
        cuts: &cuts,
        report: &report,
        sheet: drawn.map(|cuts| SheetDrawing::new(cuts, &best.sheet, &scene.material)),
    };
    for file in &RUN_FILES {
        let Writer::Results(contents) = file.writer else {
            continue;
        };
        let path = scene.output().join(file.name);
        let written = contents(&results).and_then(|contents| match contents {
            Some(bytes) => whole_file::write(&path, &bytes),
            None => remove_with_pixels(&path),
        });
        written.map_err(FileError::at(&path)).map_err(unwritten)?;
    }
    Ok(report)
}

fn unwritten(error: FileError) -> Fault {
    fault!("cannot write {error}")
}

/// Removes the files of an earlier run of the scene, so that the next one begins at the start
/// design. The copies of its inputs stay. An error, and nothing is removed, if the start has no
/// objective value.
pub fn remove_run(scene: &Scene) -> Result<(), Fault> {
    let start = scene.problem()?.evaluate(&scene.start());
    start.map_err(at(START))?;
    for file in &RUN_FILES {
        let path = scene.output().join(file.name);
        remove(&path).map_err(at(format!("cannot use {}", path.display())))?;
    }
    Ok(())
}

/// Removes a result of an earlier design and, of a picture, its pixels.
fn remove_with_pixels(path: &Path) -> io::Result<()> {
    remove(path)?;
    let pixels = path.with_extension("png");
    let name = pixels.file_name().and_then(|name| name.to_str());
    if RUN_FILES.iter().any(|file| Some(file.name) == name) { remove(&pixels) } else { Ok(()) }
}

fn remove(path: &Path) -> io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
