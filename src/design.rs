//! `kirigami design`: cut pattern and ligament widths for a scene, and the files to cut it by.

use crate::{interrupt, picture, progress};
use anyhow::{Context, Result, bail};
use clap::Args;
use design::inverse_design::{Ended, StepRecord, inverse_design};
use design::results::write_results;
use design::scene::Scene;
use std::path::{Path, PathBuf};

/// Design a sheet: where to cut, and how wide to leave every ligament
///
/// Reads a scene and writes cut files (DXF and SVG, 1:1 in mm), pictures and a report to the
/// scene's output folder. A run that was stopped goes on from where it was. Example:
/// kirigami design configs/scenes/linear-7x7.toml
#[derive(Args)]
pub struct DesignCommand {
    /// Scene (TOML); see configs/scenes
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Width of the pictures (px).
const PICTURE_WIDTH: u32 = 1600;

impl DesignCommand {
    pub fn new(scene: PathBuf) -> Self {
        Self { scene, json: false }
    }

    pub fn run(&self) -> Result<()> {
        let scene = Scene::read(&self.scene)?;
        let stop = interrupt::stop_flag()?;
        let bar = progress::bar(scene.config.optimiser.steps, "design steps");
        let designed = inverse_design(&scene, stop, &mut |step: &StepRecord| {
            let message = format!(
                "loss {:.4}, outline {:.2} mm, {:.0} % inside the domain",
                step.loss,
                step.outline_error,
                100.0 * step.share_inside
            );
            progress::show(&bar, step.step, None, &message);
        })?;
        bar.finish_and_clear();
        let report = write_results(&scene, &designed)?;
        rasterise(&scene.output())?;
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!("{report}\nwritten to {}", scene.output().display());
        }
        match designed.ended {
            Ended::Completed => Ok(()),
            Ended::Stopped => bail!("stopped; run again to go on"),
            Ended::Stuck { reason } => bail!("the search is stuck: {reason}"),
        }
    }
}

/// Gives every picture of the run folder its PNG.
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
