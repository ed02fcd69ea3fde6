//! `kirigami design`: cut pattern and ligament widths for a scene, and the cut files.

use crate::ui::exit::Unfinished;
use crate::ui::progress::Progress;
use crate::ui::{animation, interrupt, picture, run_folder};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::objective::scores::shown;
use design::optimise::outer_loop::{Ended, StepRecord};
use design::output::drawing::deployment_frames;
use design::output::report::Warning;
use design::output::run_results::write_results;
use design::scene::design_run::{forget, inverse_design};
use design::scene::{Scene, SceneConfig};
use std::path::{Path, PathBuf};

/// Design a sheet: cut pattern and ligament widths for a target shape
///
/// Reads a scene and writes cut files (DXF and SVG, 1:1 in mm), pictures, a report and a page
/// that shows the run in a browser (run.html) to the scene's output folder. A stopped run continues when it is started again. Example:
/// kirigami design configs/scenes/linear-7x7.toml
#[derive(Args)]
pub struct DesignCommand {
    /// Scene (TOML); see configs/scenes
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Run folder, instead of the scene's
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Number of search steps, instead of the scene's
    #[arg(long, value_name = "N")]
    steps: Option<usize>,
    /// Begin at the start design even if the run folder contains a run of this scene
    #[arg(long)]
    restart: bool,
    /// Write the cut files even if the report has errors
    #[arg(long)]
    force: bool,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 1600;
/// Width (px) and maximum number of the frames of the animation.
const FRAME_WIDTH: u32 = 640;
const MOST_FRAMES: usize = 40;

impl DesignCommand {
    /// A run of the scene without changes, from its start design.
    pub fn afresh(scene: PathBuf) -> Self {
        Self {
            scene,
            weights: None,
            out: None,
            steps: None,
            restart: true,
            force: false,
            json: false,
        }
    }

    pub(crate) fn run(&self) -> Result<()> {
        let scene = self.scene()?;
        let _held = run_folder::hold(&scene.output())?;
        if self.restart {
            forget(&scene)?;
        }
        let stop = interrupt::stop_flag()?;
        let bar = Progress::new(scene.config.optimiser.steps, "design steps");
        let designed = inverse_design(&scene, stop, &mut |step: &StepRecord| {
            bar.show(step.step, None, &progress_line(step));
        })?;
        bar.finish();
        let report = write_results(&scene, &designed, self.force)?;
        rasterise(&scene.output())?;
        let frames = deployment_frames(&scene, &designed, MOST_FRAMES);
        animation::save(&frames, &scene.output().join("deployment.png"), FRAME_WIDTH)?;
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            let folder = scene.output().canonicalize()?;
            println!("{report}\nwritten to {}", folder.display());
        }
        match designed.ended {
            Ended::Completed | Ended::Settled => {}
            Ended::Stopped => bail!(Unfinished::new(
                scene.config.optimiser.steps - report.steps,
                "design steps"
            )),
            Ended::Stuck { reason } => bail!("the search is stuck: {reason}"),
        }
        ensure!(
            report.cut_file,
            "no cut file: {}; --force writes one where the geometry allows it",
            report
                .errors()
                .map(Warning::to_string)
                .collect::<Vec<_>>()
                .join("; ")
        );
        Ok(())
    }
}

impl DesignCommand {
    /// The scene with the changes of the command line.
    fn scene(&self) -> Result<Scene> {
        let mut config: SceneConfig = support::toml_file::read(&self.scene)?;
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        if let Some(out) = &self.out {
            config.output = std::path::absolute(out)?;
        }
        if let Some(steps) = self.steps {
            config.optimiser.steps = steps;
        }
        Ok(Scene::new(config, &self.scene)?)
    }
}

/// A step in one line: the loss and its non-zero terms, outline error, fraction inside the training domain.
fn progress_line(step: &StepRecord) -> String {
    let scores = &step.scores;
    let terms: Vec<String> = (scores.terms().iter())
        .filter(|(_, value)| *value != 0.0)
        .map(|(name, value)| format!("{name} {}", shown(*value)))
        .collect();
    format!(
        "loss {:.4} ({}), outline {:.2} mm, {:.0} % inside the domain",
        scores.loss,
        terms.join(", "),
        scores.outline_error,
        100.0 * scores.share_inside
    )
}

/// Writes a PNG of every picture in the run folder.
fn rasterise(folder: &Path) -> Result<()> {
    for name in ["flat", "deployed-start", "deployed"] {
        let stem = folder.join(name);
        let vector = stem.with_extension("svg");
        if vector.exists() {
            let svg = std::fs::read_to_string(&vector)
                .with_context(|| format!("cannot read {}", vector.display()))?;
            picture::save(&svg, &stem, PICTURE_WIDTH)?;
        }
    }
    Ok(())
}
