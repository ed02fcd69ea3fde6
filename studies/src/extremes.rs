//! `kirigami-studies extremes`: what the solver and the learned law do at the limits of their inputs.
//!
//! Every row has a promise, which the study checks, and an outcome. The study fails if a promise is not kept.

mod law_extremes;
mod sheet_extremes;

use anyhow::{Result, ensure};
use clap::Args;
use design::objective::design_problem::Model;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use std::path::{Path, PathBuf};

/// Deploy sheets and evaluate the learned law at the limits of loads, ligaments, cut angles, thickness and size
///
/// Checks what is promised of each row: a stated equilibrium or a refusal with its reason, finite numbers, no damage where it is
/// not known, forces that are the derivative of the energy. Writes extremes.md.
/// Example: kirigami-studies extremes
#[derive(Args)]
pub struct ExtremesStudy {
    /// Scene (TOML) with a learned hinge law
    #[arg(value_name = "SCENE", default_value = "configs/scenes/pet-3x3.toml")]
    scene: PathBuf,
    /// Scene (TOML) with a linear hinge law
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/scenes/linear-7x7.toml"
    )]
    linear: PathBuf,
    /// Columns and rows of the large learned sheet
    #[arg(long, value_name = "N", default_value_t = 71)]
    panels: usize,
    /// Folder for the table
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-extremes")]
    out: PathBuf,
}

/// A table of the page.
struct Checked {
    text: String,
    /// Number of rows whose promise is not kept.
    broken: usize,
}

impl ExtremesStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let scene = Scene::read(&self.scene)?;
        let Model::Equilibrium(mechanics) = scene.problem()?.model else {
            anyhow::bail!("{}: the hinge law has no energy", self.scene.display());
        };
        let law = law_extremes::table(&*mechanics.law, &scene.config.process)?;
        let scenes = [
            (&scene.config, &*self.scene),
            (&read(&self.linear)?, &self.linear),
        ];
        let extremes = sheet_extremes::all(scenes, self.panels)?;
        let bar = Progress::new(extremes.len(), "sheets");
        let sheets = sheet_extremes::table(&extremes, |done, name| bar.show(done, None, name))?;
        bar.finish();
        let page = format!("# At the extremes\n\n{}\n{}", law.text, sheets.text);
        run_folder::write(&self.out, "extremes.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        let broken = law.broken + sheets.broken;
        ensure!(broken == 0, "{broken} promises are not kept");
        Ok(())
    }
}

fn read(scene: &Path) -> Result<SceneConfig> {
    Ok(support::toml_file::read(scene)?)
}

fn kept(promise: bool) -> &'static str {
    if promise { "kept" } else { "NOT KEPT" }
}
