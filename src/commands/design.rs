//! `kirigami design`: cut pattern and ligament widths for scenes, and the cut files.

#[cfg(feature = "pipeline")]
mod by_elements;
mod many_runs;

use crate::commands::design::many_runs::{Run, compare, refuse_shared_folders};
use crate::fitting::fit_to_target;
use crate::ui::exit::Unfinished;
use crate::ui::progress::{Progress, announce};
use crate::ui::with_unit::Accuracy;
use crate::ui::{animation, interrupt, picture, processors, run_folder, with_unit};
use analysis::refinement::refine;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::objective::scores::shown;
use design::objective::term::in_words;
use design::optimise::outer_loop::{Ended, StepRecord};
use output::drawing::deployment_frames;
use output::report::{Report, Warning};
use output::run_files::{ANIMATION, RUN_FILES, Writer};
use output::run_results::{remove_run, write_results};
use scene::design_run::{BegunRun, Designed, Earlier, LEVELS, OnStep};
use scene::run_inputs::{SCENE_FILE, holds_a_run, scene_file};
use scene::{Level, Scene, SceneConfig};
use std::path::{Path, PathBuf};
use support::worker_pool::{NoThread, Reports, work_through};

/// Design a sheet: cut pattern and ligament widths for a target shape
///
/// Reads a scene and writes cut files (DXF and SVG, 1:1 in mm), pictures, a report and a page that
/// shows the run in a browser (run.html) to the scene's output folder. A stopped run continues when
/// it is started again. Several scenes or seeds are designed side by side on all processors, each
/// in a folder of its own, and compared in a table. Examples: kirigami design
/// configs/scenes/linear-7x7.toml; kirigami design configs/scenes/*7x7.toml --out runs/sheets
#[derive(Args)]
pub struct DesignCommand {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material
    /// and weights
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// The level, instead of the scene's: how much of the hinges is modelled; see `kirigami
    /// levels`. At `final` the hinges are solved by finite elements after the search, and it goes
    /// on with them: hours, which are stated first
    #[arg(long, value_name = "LEVEL", value_parser = with_unit::level_up_to(Level::Final))]
    level: Option<Level>,
    /// How accurately the corners of the panels are to be known: a length such as 0.5mm, or a part
    /// of the longer side of the sheet such as 0.2%. The search begins at `draft`. While the
    /// difference to the next finer level is larger, that level, `standard` and then `fine`,
    /// continues from the converged design. The next finer level evaluates the result
    #[arg(long, value_name = "ACCURACY", value_parser = with_unit::accuracy, conflicts_with_all = ["level", "steps"])]
    within: Option<Accuracy>,
    /// Run folder, instead of the scene's. Of several runs: the folder of the table, designs.md and
    /// designs.csv, and of the runs, each in a folder with the name of its scene [default of the
    /// table: runs/designs]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Design every scene with this many successive seeds, beginning with its own, each in the
    /// folder seed-N of its run folder. The scene needs a random start: optimiser.start_noise
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    seeds: u64,
    /// Number of search steps, instead of the scene's
    #[arg(long, value_name = "N")]
    steps: Option<usize>,
    /// First fit outline, cuts and pulls of the sheet, a rectangle that stands for its stock, and
    /// the place of the target to each other, as `init --target` does. What the scene states of
    /// these, of posture, weights of the objective and optimiser is replaced; the run's scene.toml
    /// has what was chosen
    #[arg(long)]
    fit: bool,
    /// Begin at the start design even if the run folder contains a run of this scene
    #[arg(long)]
    restart: bool,
    /// Write the cut files even if the report has errors
    #[arg(long)]
    force: bool,
    /// Print the report as JSON; of a single run
    #[arg(long)]
    json: bool,
}

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 1600;
/// Width (px) and maximum number of the frames of the animation.
const FRAME_WIDTH: u32 = 640;
const MOST_FRAMES: usize = 40;

impl DesignCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let out = self.out.as_deref().map(std::path::absolute).transpose()?;
        match &self.scenes[..] {
            [file] if self.seeds == 1 => {
                let scene = self.scene(file, |config| {
                    config.output = out.unwrap_or_else(|| config.output.clone());
                })?;
                let report = with_level_bars(&scene, |progress| self.design(&scene, progress))?;
                if self.json {
                    println!("{}", serde_json::to_string_pretty(&report)?);
                } else {
                    let folder = scene.output().canonicalize()?;
                    println!("{}\nwritten to {}", report.document(), folder.display());
                }
                check(&scene, &report)
            }
            _ => {
                ensure!(!self.json, "--json prints the report of one run: name one scene");
                self.run_many(self.runs(out.as_deref())?)
            }
        }
    }

    /// All runs; with `out` in folders there.
    fn runs(&self, out: Option<&Path>) -> Result<Vec<Run>> {
        let mut runs = Vec::new();
        for file in &self.scenes {
            for seed in 0..self.seeds {
                let scene = self.scene(file, |config| {
                    if let Some(out) = out {
                        let name = if file.is_dir() { file.file_name() } else { file.file_stem() };
                        config.output = out.join(name.unwrap_or_default());
                    }
                    config.optimiser.seed += seed;
                    if self.seeds > 1 {
                        let name = format!("seed-{}", config.optimiser.seed);
                        config.output = config.output.join(name);
                    }
                })?;
                ensure!(
                    self.seeds == 1 || scene.config.optimiser.start_noise > 0.0,
                    "{}: all seeds give the same run without a random start: set optimiser.start_noise",
                    file.display()
                );
                let (file, failure) = (file.clone(), None);
                runs.push(Run { file, scene, failure });
            }
        }
        refuse_shared_folders(&runs)?;
        Ok(runs)
    }

    /// Designs the runs, as many at a time as there are processors, and compares them.
    fn run_many(&self, mut runs: Vec<Run>) -> Result<()> {
        let stop = interrupt::stop_flag()?;
        let folder = self.out.clone().unwrap_or("runs/designs".into());
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))?;
        // The windows of a single sheet occupy all processors.
        let workers = match self.level {
            Some(Level::Final) => 1,
            _ => processors(),
        };
        let scenes: Vec<Scene> = runs.iter().map(|run| run.scene.clone()).collect();
        let bar = Progress::new(runs.len(), "designs");
        let (mut left, mut failed, mut done) = (runs.len(), 0, 0);
        let work = |i: usize, reports: &Reports<(usize, Result<()>)>| {
            let designed = self.design(&scenes[i], &mut |_, _| {});
            let ended = designed.and_then(|report| check(&scenes[i], &report));
            reports.send((i, ended));
        };
        work_through(runs.len(), workers, stop, &work, &mut |(i, ended)| {
            done += 1;
            bar.show(done, None, &runs[i].file.display().to_string());
            match ended {
                Ok(()) => left -= 1,
                Err(error) if error.is::<Unfinished>() => {}
                Err(error) => {
                    left -= 1;
                    failed += 1;
                    runs[i].failure = Some(format!("{error:#}"));
                }
            }
            Ok::<_, NoThread>(())
        })?;
        bar.finish();
        let listed = compare(&runs, &folder)?;
        println!("{listed}\nwritten to {}", folder.display());
        let failure = |run: &Run| {
            let why = run.failure.as_ref()?;
            Some(format!("\n{}: {why}", run.scene.output().display()))
        };
        let failures: String = runs.iter().filter_map(failure).collect();
        match left {
            0 => ensure!(failed == 0, "{failed} of {} runs failed{failures}", runs.len()),
            _ => bail!(Unfinished { left, what: "runs" }),
        }
        Ok(())
    }

    /// One run: its search and its results.
    fn design(&self, scene: &Scene, progress: OnStep) -> Result<Report> {
        refuse_files_of_others(&scene.output())?;
        let _held = run_folder::hold(&scene.output())?;
        if self.restart {
            remove_run(scene)?;
            let levels = scene.output().join(LEVELS);
            if levels.exists() {
                std::fs::remove_dir_all(&levels)
                    .with_context(|| format!("cannot remove {}", levels.display()))?;
            }
        }
        match self.within {
            None if self.by_elements(scene.config.level) => {
                self.search_by_elements(scene, progress)
            }
            None => self.search(scene, progress),
            Some(accuracy) => self.refine(scene, accuracy, progress),
        }
    }

    /// Whether the hinges of a scene at a level are still to be solved.
    fn by_elements(&self, of_scene: Level) -> bool {
        self.level == Some(Level::Final) && of_scene != Level::Final
    }

    #[cfg(not(feature = "pipeline"))]
    fn search_by_elements(&self, _: &Scene, _: OnStep) -> Result<Report> {
        bail!(
            "the level `final` needs finite elements: install the whole program, as the README says"
        )
    }

    /// A search at the level of the scene.
    fn search(&self, scene: &Scene, progress: OnStep) -> Result<Report> {
        let (run, stop) = (BegunRun::new(scene.clone(), None)?, interrupt::stop_flag()?);
        let designed = run.search(&Earlier::default(), None, stop, progress)?;
        write_run(scene, &designed, self.force)
    }

    /// Searches from the cheapest level to one that is accurate enough.
    fn refine(&self, scene: &Scene, accuracy: Accuracy, progress: OnStep) -> Result<Report> {
        let tolerance = match accuracy {
            Accuracy::Length(mm) => mm,
            Accuracy::Part(part) => part * scene.config.sheet.outline().size(),
        };
        self.write_refined(refine(scene, tolerance, interrupt::stop_flag()?, progress)?)
    }

    /// Writes the results of a design that was found on several levels.
    fn write_refined(&self, designed: Designed) -> Result<Report> {
        let scene = &designed.scene;
        if designed.ended == Ended::Stopped {
            let made = designed.search.last().step;
            bail!(Unfinished { left: scene.config.optimiser.steps - made, what: "design steps" });
        }
        write_run(scene, &designed, self.force)
    }

    /// A scene with the changes of the command line and the changes of `change`.
    fn scene(&self, file: &Path, change: impl FnOnce(&mut SceneConfig)) -> Result<Scene> {
        let path = scene_file(file)?;
        let mut config: SceneConfig = support::toml_file::read(&path)?;
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        change(&mut config);
        if let Some(steps) = self.steps {
            config.optimiser.steps = steps;
        }
        let mut scene = Scene::new(config, &path)?;
        if let Some(level) = self.level.filter(|_| !self.by_elements(scene.config.level)) {
            scene = scene.at_level(level)?;
        }
        if self.fit {
            let (fit, expected) = fit_to_target(&scene)?;
            announce(&expected);
            config = fit.config;
            config.optimiser.steps = self.steps.unwrap_or(config.optimiser.steps);
            scene = scene.changed(config)?;
        }
        Ok(scene)
    }
}

/// Runs searches at one or several levels, each with a bar of its own.
fn with_level_bars<T>(scene: &Scene, searches: impl FnOnce(OnStep) -> T) -> T {
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

/// Writes the results of a run to its folder, with pictures and animation.
pub(crate) fn write_run(scene: &Scene, designed: &Designed, force: bool) -> Result<Report> {
    let report = write_results(scene, designed, force)?;
    rasterise(&scene.output())?;
    let frames = deployment_frames(scene, designed, MOST_FRAMES);
    animation::save(&frames, &scene.output().join(ANIMATION), FRAME_WIDTH)?;
    Ok(report)
}

/// An error if a run is not at its end, or has no cut file.
fn check(scene: &Scene, report: &Report) -> Result<()> {
    match &report.ended {
        Ended::Completed | Ended::Settled => {}
        Ended::Stopped => bail!(Unfinished {
            left: scene.config.optimiser.steps - report.steps,
            what: "design steps"
        }),
        Ended::Stuck { reason } => bail!("the search is stuck: {reason}"),
    }
    let errors: Vec<String> = report.errors().map(Warning::to_string).collect();
    ensure!(
        report.cut_file,
        "no cut file: {}; --force writes one where the geometry allows it",
        errors.join("; ")
    );
    Ok(())
}

/// A step in one line: the loss and its non-zero terms, outline error, for a learned law the
/// fraction inside its training domain.
fn progress_line(step: &StepRecord, learned: bool) -> String {
    let scores = &step.scores;
    let terms: Vec<String> = (scores.terms.iter())
        .filter(|(_, value)| **value != 0.0)
        .map(|(name, value)| format!("{} {}", in_words(name), shown(*value)))
        .collect();
    let inside = if learned {
        format!(", {:.0} % inside the domain", 100.0 * scores.share_inside)
    } else {
        String::new()
    };
    format!(
        "loss {:.4} ({}), outline {:.2} mm{inside}",
        scores.loss,
        terms.join(", "),
        scores.outline_error,
    )
}

/// Writes the PNG of every picture in the run folder that has an SVG.
fn rasterise(folder: &Path) -> Result<()> {
    let pictures = RUN_FILES.iter().filter(|file| matches!(file.writer, Writer::Pictures));
    for file in pictures {
        let vector = folder.join(file.name).with_extension("svg");
        if vector.exists() {
            let svg = std::fs::read_to_string(&vector)
                .with_context(|| format!("cannot read {}", vector.display()))?;
            picture::save(&svg, &vector.with_extension(""), PICTURE_WIDTH)?;
        }
    }
    Ok(())
}
