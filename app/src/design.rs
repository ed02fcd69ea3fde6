//! A design run: its search and the files of its results.

use crate::{animation, failure::Unfinished, picture, progress::Progress, run_folder};
use anyhow::{Context, Result, bail, ensure};
use design::{
    objective::{scores::shown, term::in_words},
    optimise::outer_loop::{Ended, StepRecord},
};
use output::{
    drawing::deployment_frames,
    report::{Report, Warning},
    run_files::{ANIMATION, RUN_FILES, Writer},
    run_results::{remove_run, write_results},
};
use scene::{
    Level, Scene,
    design_run::{Designed, LEVELS, OnStep},
    run_inputs::{SCENE_FILE, holds_a_run},
};
use std::{fs::File, path::Path};
use support::{Joined, unread};

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 1600;
/// Width (px) and maximum number of the frames of the animation.
const FRAME_WIDTH: u32 = 640;
const MOST_FRAMES: usize = 40;

/// Locks the run folder of a scene until the returned file is dropped; with `restart` without the
/// run in it.
pub fn hold(scene: &Scene, restart: bool) -> Result<File> {
    let folder = scene.output();
    refuse_files_of_others(&folder)?;
    let held = run_folder::hold(&folder)?;
    if restart {
        remove_run(scene)?;
        let levels = folder.join(LEVELS);
        if levels.exists() {
            std::fs::remove_dir_all(&levels)
                .with_context(|| format!("cannot remove {}", levels.display()))?;
        }
    }
    Ok(held)
}

/// An error if a run would replace files of its folder that no run has written.
fn refuse_files_of_others(folder: &Path) -> Result<()> {
    if holds_a_run(folder) {
        return Ok(());
    }
    let names = RUN_FILES.iter().map(|file| file.name).chain([SCENE_FILE]);
    let found: Vec<&str> =
        names.filter(|name| folder.join(name).symlink_metadata().is_ok()).collect();
    ensure!(
        found.is_empty(),
        "the run would replace {} in {}, which no run has written: choose another folder, with --out or the key `output`, or \
         move the files",
        found.join(", "),
        folder.display()
    );
    Ok(())
}

/// Writes the results of a run to the folder of its scene, with pictures and animation; `force` also
/// writes cut files of a design with errors. An error if the run was stopped at a coarser level.
pub fn write_run(scene: &Scene, designed: &Designed, force: bool) -> Result<Report> {
    if designed.scene.output() != scene.output() {
        bail!(unfinished(scene, designed.search.last().step));
    }
    // At a finer level than the scene's if an accuracy was asked for.
    let scene = &designed.scene;
    let animated = || {
        let frames = deployment_frames(scene, designed, MOST_FRAMES);
        animation::save(&frames, &scene.output().join(ANIMATION), FRAME_WIDTH)
    };
    std::thread::scope(|scope| {
        let animated = scope.spawn(animated);
        let report = write_results(scene, designed, force)?;
        rasterise(&scene.output())?;
        animated.join().expect("the frames are drawn")?;
        Ok(report)
    })
}

/// An error if a run is not at its end, or has no cut file.
pub fn ended(scene: &Scene, report: &Report) -> Result<()> {
    match &report.ended {
        Ended::Completed | Ended::Settled => {}
        Ended::Stopped => bail!(unfinished(scene, report.steps)),
        Ended::Stuck { reason } => bail!("the search is stuck: {reason}"),
    }
    let errors = report.errors().map(Warning::to_string).joined("; ");
    ensure!(
        report.cut_file,
        "no cut file: {errors}; --force writes one where the geometry allows it"
    );
    Ok(())
}

/// A run that was stopped after `made` steps at its level.
fn unfinished(scene: &Scene, made: usize) -> Unfinished {
    let left = scene.config.optimiser.steps.saturating_sub(made);
    Unfinished { left, what: "design steps" }
}

/// Writes the PNG of every picture in the run folder that has an SVG.
fn rasterise(folder: &Path) -> Result<()> {
    let pictures = RUN_FILES.iter().filter(|file| matches!(file.writer, Writer::Pictures));
    for file in pictures {
        let vector = folder.join(file.name).with_extension("svg");
        if vector.exists() {
            let svg = std::fs::read_to_string(&vector).map_err(unread(&vector))?;
            picture::save(&svg, &vector.with_extension(""), PICTURE_WIDTH)?;
        }
    }
    Ok(())
}

/// Runs searches at one or several levels, each with a bar of its own.
pub fn with_level_bars<T>(scene: &Scene, searches: impl FnOnce(OnStep) -> T) -> T {
    let total = scene.config.optimiser.steps;
    let mut shown: Option<(Level, Progress)> = None;
    let found = searches(&mut |level, search| {
        let step = search.last();
        let same = shown.take().filter(|(shown, _)| *shown == level);
        let (_, bar) =
            shown.insert(same.unwrap_or_else(|| (level, Progress::new(total, level.name()))));
        bar.show(step.step, None, &progress_line(step, level.is_learned()));
    });
    shown.into_iter().for_each(|(_, bar)| bar.finish());
    found
}

/// A step in one line: the loss and its non-zero terms, outline error, for a learned law the
/// fraction inside its training domain.
fn progress_line(step: &StepRecord, learned: bool) -> String {
    let scores = &step.scores;
    let terms = (scores.terms.iter())
        .filter(|(_, value)| **value != 0.0)
        .map(|(name, value)| format!("{} {}", in_words(name), shown(*value)))
        .joined(", ");
    let inside = || format!(", {:.0} % inside the domain", 100.0 * scores.share_inside);
    let inside = learned.then(inside).unwrap_or_default();
    format!("loss {:.4} ({terms}), outline {:.2} mm{inside}", scores.loss, scores.outline_error)
}
