//! `kirigami material check`: what a material means for windows and sheets.

use crate::ui::print;
use analysis::material_check::{MaterialCheck, usual_widths};
use anyhow::{Result, bail, ensure};
use clap::Args;
use hinge::{Regime, SheetMaterial};
use scene::{SceneConfig, run_inputs::scene_file};
use std::path::PathBuf;
use support::toml_file;

/// Check a material before windows are solved with it
///
/// Prints the law as the window solver reads it, thickness against ligament width, buckling against
/// yield, and the openings at which ligaments tear. Exits with 1 if a verdict is an error. Example:
/// kirigami material check configs/materials/pet-0.5mm.toml configs/scenes/pet-7x7.toml
#[derive(Args)]
pub(crate) struct CheckCommand {
    /// Material (TOML); see configs/materials
    #[arg(value_name = "MATERIAL")]
    material: PathBuf,
    /// Scene (TOML), or the folder of a run, whose ligament widths are intended; its own material is
    /// not read
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

impl CheckCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let measured = SheetMaterial::load(&self.material)?;
        let scene: Option<SceneConfig> = match &self.scene {
            Some(scene) => Some(toml_file::read(&scene_file(scene)?)?),
            None => None,
        };
        let thickness = scene.as_ref().and_then(|scene| scene.thickness);
        let material =
            SheetMaterial { thickness: thickness.unwrap_or(measured.thickness), ..measured };
        let usual = usual_widths(material.thickness, Regime::usual(material.thickness));
        let w_lig = scene.map_or(usual, |scene| scene.ligament.range);
        if let Some(scene) = &self.scene {
            let [min, max] = w_lig;
            ensure!(
                0.0 < min && min < max && max.is_finite(),
                "{}: ligament.range = [{min}, {max}] mm violates 0 < minimum < maximum",
                scene.display()
            );
        }
        let check = MaterialCheck::new(&material, w_lig);
        print(self.json, &check, check.document(&material))?;
        match check.errors().count() {
            0 => Ok(()),
            1 => bail!("the material has 1 error for this use"),
            count => bail!("the material has {count} errors for this use"),
        }
    }
}
