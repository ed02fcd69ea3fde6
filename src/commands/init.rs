//! `kirigami init`: a folder with the files of a new project, scaled to the thickness of its sheet.

mod edited;
mod first_scene;
mod similar_scene;

use crate::commands::init::edited::{heading, scale, set};
use crate::commands::init::first_scene::FirstScene;
use crate::commands::init::similar_scene::{Like, SimilarScene};
use crate::commands::input_file;
use crate::ui::output_file;
use crate::ui::shell_word::shell_word;
use crate::ui::width_by_height::width_by_height;
use anyhow::{Context, Result, ensure};
use clap::Args;
use hinge::SheetMaterial;
use mesher::Tier;
use std::path::{Path, PathBuf};
use support::regular_file;
use surrogate::Surrogate;
use toml_edit::DocumentMut;

/// Create a folder with material, campaign, training and scene for a sheet of your own
///
/// Ligament widths, windows, number of panels, stroke and target are scaled to the thickness and the size of the
/// sheet. The files run as they are: with a material that has weights, `design` at once; with another, after its
/// campaign and training. README.md in the folder lists the commands.
/// Examples: kirigami init my-sheet --thickness 0.1 --size 210x297;
/// kirigami init thin --like configs/scenes/pet-3x3.toml --thickness 0.1;
/// kirigami init longer --like configs/scenes/a4-polyester.toml --size 420x594
#[derive(Args)]
pub struct InitCommand {
    /// Folder to create
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Sheet material (TOML) [default: configs/materials/pet-0.5mm.toml; with --like that of its scene]
    #[arg(long, value_name = "FILE")]
    material: Option<PathBuf>,
    /// Thickness of the sheet (mm) [default: that of the material file; with --like that of its sheet]
    #[arg(long, value_name = "MM")]
    thickness: Option<f64>,
    /// Width and height of the sheet (mm) [default: 210x297 up to a thickness of 0.1 mm, above it in proportion to the
    /// thickness; with --like those of its sheet, in proportion to the thickness]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[f64; 2]>,
    /// Scene whose pattern, panels, supports, loads and target are taken, scaled to thickness and size. With weights the
    /// loads open the new sheet as far as that of the scene
    #[arg(long, value_name = "SCENE")]
    like: Option<PathBuf>,
    /// Weights that the scene uses if they are for this material [default: data/pet-0.5mm/medium.safetensors, if it exists;
    /// with --like those of its scene]
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
}

/// The material of a sheet unless another one is given, and its shipped weights.
const MATERIAL: &str = "configs/materials/pet-0.5mm.toml";
const WEIGHTS: &str = "data/pet-0.5mm/medium.safetensors";
/// The shipped files that are scaled.
const CAMPAIGN: &str = include_str!("../../configs/campaigns/pet-0.5mm.toml");
const TRAINING: &str = include_str!("../../configs/training/medium.toml");
/// Thickness of the shipped campaign's sheet (mm).
const CAMPAIGN_THICKNESS: f64 = 0.5;

impl InitCommand {
    pub(crate) fn run(&self) -> Result<()> {
        ensure!(
            !self.folder.exists(),
            "{} exists already: name a new folder",
            self.folder.display()
        );
        let like = self.like.as_deref().map(Like::read).transpose()?;
        let material = match (&self.material, &like) {
            (Some(material), _) => material.clone(),
            (None, Some(like)) => like.beside(&like.scene.config.material),
            (None, None) => MATERIAL.into(),
        };
        input_file::require(&material, "--material")?;
        let measured = SheetMaterial::load(&material)?;
        let text = material_text(&material)?;
        let alike = like.as_ref().map(|like| like.scene.material.thickness);
        let sheet = SheetMaterial {
            thickness: self.thickness.or(alike).unwrap_or(measured.thickness),
            ..measured.clone()
        };
        sheet.validate()?;
        let weights = self.weights_of(&measured, like.as_ref())?;
        let trained = weights.is_some();
        let weights = weights.unwrap_or_else(|| "weights.safetensors".into());
        let scene = match like {
            Some(like) => {
                let material = trained.then_some(&*material);
                SimilarScene::new(like, &sheet, self.size)?.text(&weights, material)?
            }
            None => FirstScene::new(self.size, sheet.thickness)?.text(&weights)?,
        };
        let name = self
            .folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy();
        let campaign = campaign(&name, measured.thickness, Tier::Default)?;

        output_file::create_folder(&self.folder)?;
        let readme = readme(&self.folder, trained);
        for (file, contents) in [
            ("material.toml", &text),
            ("campaign.toml", &campaign),
            ("training.toml", &TRAINING.to_owned()),
            ("scene.toml", &scene),
            ("README.md", &readme),
        ] {
            output_file::write(&self.folder.join(file), contents)?;
        }
        println!("{readme}");
        Ok(())
    }

    /// The path of the weights, if they are for the material. Weights that are named must exist.
    fn weights_of(&self, material: &SheetMaterial, like: Option<&Like>) -> Result<Option<PathBuf>> {
        let candidates = match &self.weights {
            Some(weights) => {
                input_file::require(weights, "--weights")?;
                vec![weights.clone()]
            }
            None => {
                let shipped = Some(PathBuf::from(WEIGHTS)).filter(|weights| weights.is_file());
                like.and_then(Like::weights)
                    .into_iter()
                    .chain(shipped)
                    .collect()
            }
        };
        for weights in candidates {
            let trained = Surrogate::load(&weights)?.card().material_hash.clone();
            if trained == Some(material.law_hash()) {
                return Ok(Some(std::path::absolute(weights)?));
            }
        }
        Ok(None)
    }
}

/// The shipped campaign, scaled to a sheet of `thickness` (mm); its material is `material.toml` in the same folder.
pub(crate) fn campaign(name: &str, thickness: f64, tier: Tier) -> Result<String> {
    let factor = thickness / CAMPAIGN_THICKNESS;
    let mut campaign: DocumentMut = CAMPAIGN.parse()?;
    set(&mut campaign["tier"], tier.to_string());
    set(&mut campaign["name"], name);
    set(&mut campaign["material"], "material.toml");
    heading(
        &mut campaign,
        "# Hinge windows of the material, from which its hinge energy is trained.\n",
    );
    for (section, key) in [
        ("design", "kerf"),
        ("design", "r_win"),
        ("rays", "full_range_w_lig"),
    ] {
        scale(&mut campaign[section][key], factor);
    }
    scale(&mut campaign["rays"]["w_lig"], factor);
    Ok(campaign.to_string())
}

/// The commands of the project, in their order.
fn readme(folder: &Path, trained: bool) -> String {
    let path = |name: &str| shell_word(&folder.join(name));
    let (campaign, scene) = (path("campaign.toml"), path("scene.toml"));
    let (jobs, database) = (path("campaign"), path("hinges.parquet"));
    let (weights, training) = (path("weights.safetensors"), path("training.toml"));
    let learn = format!(
        "kirigami campaign plan {campaign} --folder {jobs}      # number of rays and time\n\
         kirigami campaign run {campaign} --folder {jobs}\n\
         kirigami campaign collect {campaign} --folder {jobs} --out {database}\n\
         kirigami train {database} --config {training} --out {weights}\n"
    );
    let design = format!("kirigami design {scene}\n");
    let (first, then) = if trained {
        (
            "The material has weights. Design the sheet:",
            format!("{design}```\n\nTrain weights of your own:\n\n```sh\n{learn}"),
        )
    } else {
        (
            "The material has no weights yet. Solve its hinges, train them, and design the sheet:",
            format!("{learn}{design}"),
        )
    };
    format!("# A sheet of your own\n\n{first}\n\n```sh\n{then}```\n")
}

/// The text of a material file for another folder: the path of its measured curve becomes absolute.
pub(crate) fn material_text(path: &Path) -> Result<String> {
    let text = regular_file::read_to_string(path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let mut material: DocumentMut = text.parse()?;
    let curve = material.get("tensile_csv").and_then(|curve| curve.as_str());
    if let Some(curve) = curve.map(|curve| path.with_file_name(curve)) {
        let curve = std::path::absolute(curve)?;
        set(&mut material["tensile_csv"], &*curve.to_string_lossy());
    }
    Ok(material.to_string())
}

fn size(text: &str) -> Result<[f64; 2], String> {
    let size = width_by_height(text).filter(|size| size.iter().all(|side| side.is_finite()));
    size.ok_or_else(|| "expected two lengths in mm, for example 210x297".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_of_a_folder_with_a_space_can_be_copied() {
        let text = readme(Path::new("my sheet"), true);
        assert!(
            text.contains("kirigami design 'my sheet/scene.toml'\n"),
            "{text}"
        );
    }

    #[test]
    fn a_copied_material_names_the_curve_of_the_original() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.toml");
        std::fs::write(
            &path,
            "name = \"film\"\ntensile_csv = \"curve.csv\" # measured\n",
        )
        .unwrap();
        let curve = folder.path().join("curve.csv");
        let expected = format!("name = \"film\"\ntensile_csv = {curve:?} # measured\n");
        assert_eq!(material_text(&path).unwrap(), expected);
    }

    #[test]
    fn a_campaign_is_scaled_and_keeps_its_comments() {
        let text = campaign("thin", 0.1, Tier::Small).unwrap();
        for line in [
            "name = \"thin\"",
            "tier = \"small\"",
            "r_win = 20.0        # mm; radius of the window",
            "w_lig = [1.0, 5.0]       # mm",
            "full_range_w_lig = 1.6    # mm, 16 thicknesses",
            "median_deg = 25.0",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        assert!(
            text.starts_with("# Hinge windows of the material") && !text.contains("hours"),
            "{text}"
        );
    }
}
