//! A folder with the files of a new project, scaled to the thickness of its sheet.

mod cut_from;
pub mod edited;
pub mod first_scene;
mod for_service;
mod silhouette;
mod template;

use crate::{
    WHOLE_BUILD, input_file,
    new_project::{
        cut_from::CutFrom,
        edited::{heading, map, scale, set},
        first_scene::FirstScene,
        for_service::for_service,
        silhouette::fitted_text,
        template::Template,
    },
    output_file,
    own_drawing::OwnDrawing,
    shell_word::shell_word,
};
use analysis::{
    fit::opening::{damage_of_turn, safe_opening},
    material_check::{MaterialCheck, usual_widths},
};
use anyhow::{Result, bail, ensure};
use hinge::{MIN_W_LIG, Regime, SheetMaterial};
use scene::{Posture, Scene, Stock, rounded, run_inputs::SCENE_FILE};
use std::{
    f64::consts::FRAC_PI_2,
    path::{Path, PathBuf},
};
use support::{at, text_file, toml_file, unread};
use surrogate::{Card, Surrogate};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item};

/// What a new project is made from; what is `None` is as usual for the rest.
#[derive(Default)]
pub struct NewProject {
    /// Folder to create.
    pub folder: PathBuf,
    /// Sheet material (TOML).
    pub material: Option<PathBuf>,
    /// Thickness of the sheet (mm).
    pub thickness: Option<f64>,
    /// Width and height of the sheet (mm).
    pub size: Option<[f64; 2]>,
    /// The stock that the sheet is cut from, instead of a size.
    pub stock: Option<Stock>,
    /// Border of the stock that the machine cannot cut (mm).
    pub margin: Option<f64>,
    /// Outline that the sheet opens onto (SVG, DXF, PNG or JPEG).
    pub target: Option<PathBuf>,
    /// Where a picture is traced: the difference from its ground over the largest one.
    pub threshold: Option<f64>,
    /// Side of the panels of a sheet for a drawing (mm).
    pub panel_side: Option<f64>,
    /// Weights for the material.
    pub weights: Option<PathBuf>,
    /// Name of the service that cuts the sheet.
    pub service: Option<String>,
    /// Whether its sheet is fitted to a drawing afterwards: the ligaments of a plate may be wider than
    /// stays flat by itself.
    pub any_width: bool,
    /// Whether a sheet is made that shows too little of its target to be recognised.
    pub anyway: bool,
}

/// The material of a plate and of a film unless another one is given.
const PLATE: &str = "configs/materials/polypropylene-3mm.toml";
const FILM: &str = "configs/materials/pet-0.5mm.toml";
/// The shipped weights; those for the material of a sheet are used.
pub const WEIGHTS: [&str; 6] = [
    "data/polypropylene-3mm/medium.safetensors",
    "data/petg-3mm/medium.safetensors",
    "data/aluminium-2mm/medium.safetensors",
    "data/s235-2mm/medium.safetensors",
    "data/pet-0.5mm/medium.safetensors",
    "data/polypropylene-0.8mm/medium.safetensors",
];

impl NewProject {
    /// Writes the files of the project, its scene last; returns the text of its README.
    pub fn create(&self) -> Result<String> {
        ensure!(
            !self.folder.exists(),
            "{} exists already: name a new folder",
            self.folder.display()
        );
        let material = self.material_file();
        input_file::require(&material, "--material")?;
        let measured = SheetMaterial::load(&material)?;
        let sheet = SheetMaterial {
            thickness: self.thickness.unwrap_or(measured.thickness),
            ..measured.clone()
        };
        sheet.validate()?;
        let fitting = self.weights_of(&measured)?;
        let named = self.weights.as_ref().and(fitting.first()).map(|weights| weights.regime);
        let cut_from =
            self.stock.map(|stock| CutFrom { stock, margin: self.margin.unwrap_or(0.0) });
        let is_even = (self.target.is_some() || self.any_width) && !fitting.is_empty();
        let first = FirstScene::new(self.size, cut_from, sheet.thickness, named, is_even)?;
        let regime = first.regime;
        let check = MaterialCheck::new(&sheet, usual_widths(sheet.thickness, regime));
        let excluded: Vec<String> = check.errors().map(|it| it.message.clone()).collect();
        ensure!(
            excluded.is_empty(),
            "{}: {}; choose another material (`kirigami material check`)",
            material.display(),
            excluded.join("; ")
        );
        let weights = fitting.iter().find(|weights| weights.regime == regime);
        let trained = weights.is_some();
        let drawing = self.target.as_ref().map(|file| OwnDrawing::read(file, self.threshold));
        let drawing = drawing.transpose()?;
        let scale = sheet.thickness / measured.thickness;
        let mut scene = self.first_scene(first, weights, drawing.as_ref(), scale)?;
        let name = self.folder.file_name().unwrap_or_default().to_string_lossy();
        // The hinges of a plate are solved in its thickness: in the thickness of a film they would
        // be too narrow.
        let solved = match regime {
            Regime::Plate if !trained => sheet.thickness,
            _ => measured.thickness,
        };
        let text = material_text(&material, solved)?;
        let campaign = campaign(&name, solved, regime)?;

        let template = Template::of(regime);
        output_file::create_folder(&self.folder)?;
        let write =
            |file: &str, contents: &str| output_file::write(&self.folder.join(file), contents);
        write("material.toml", &text)?;
        write("campaign.toml", &campaign)?;
        write(TRAINING, template.training)?;
        drawing.map_or(Ok(()), |drawing| drawing.write(&self.folder, ""))?;
        let (mut expected, mut hangs) = (String::new(), true);
        if trained {
            // A refused service or drawing leaves the name of the folder free.
            let discard = |_: &_| drop(std::fs::remove_dir_all(&self.folder));
            (scene, expected, hangs) = self.finished(scene).inspect_err(discard)?;
        }
        let alone = if hangs && regime == Regime::Plate { ALONE } else { "" };
        let why = [template.why, alone].concat();
        let readme = readme(&self.folder, &why, regime, trained, WHOLE_BUILD);
        let text = [readme, expected].join("\n").trim_end().to_owned() + "\n";
        write(README, &text)?;
        // An interrupted command leaves no scene that could be designed.
        write(SCENE_FILE, &scene)?;
        Ok(text)
    }

    /// The text of the first scene, with what weights know of a sheet that is `scale` times as thick
    /// as theirs.
    fn first_scene(
        &self,
        mut first: FirstScene,
        weights: Option<&Weights>,
        drawing: Option<&OwnDrawing>,
        scale: f64,
    ) -> Result<String> {
        first.any_width = self.any_width || self.service.is_some();
        let Some(weights) = weights else {
            return first.text(&self.folder, &self.folder.join("weights.safetensors"), drawing);
        };
        first.opening = weights.opening;
        first.damage = Some(weights.damage);
        weights.known_part(&first.text(&self.folder, &weights.file, drawing)?, scale)
    }

    /// The text of the scene for the service and the drawing, what is expected of its sheet, and
    /// whether it hangs.
    fn finished(&self, mut text: String) -> Result<(String, String, bool)> {
        let file = self.folder.join(SCENE_FILE);
        let read = |text: &str| Scene::new(toml_file::parse(text, &file)?, &file);
        let mut scene = read(&text).map_err(at("no scene of this sheet can be designed"))?;
        let mut expected = String::new();
        if let Some(service) = &self.service {
            let mut config = scene.config.clone();
            for_service(&mut config, service, scene.material.thickness)?;
            text = format!(
                "# A sheet for {service}, written by `kirigami init --for`.\n\n{}",
                config.to_toml()?
            );
            scene = scene.changed(config)?;
        }
        if self.target.is_some() {
            (text, expected) = fitted_text(&scene, &text, self.panel_side, self.anyway)?;
            scene = read(&text)?;
        }
        let hangs = scene.config.posture.is_none_or(|it| it.kind == Posture::Hanging);
        Ok((text, expected, hangs))
    }

    /// The file of the material that is named, or else the usual one.
    fn material_file(&self) -> PathBuf {
        match (&self.material, self.thickness) {
            (Some(material), _) => material.clone(),
            (None, Some(thickness)) if Regime::usual(thickness) == Regime::Film => FILM.into(),
            _ => PLATE.into(),
        }
    }

    /// The weights that are for the material. Weights that are named must be.
    fn weights_of(&self, material: &SheetMaterial) -> Result<Vec<Weights>> {
        let candidates = match &self.weights {
            Some(weights) => {
                input_file::require(weights, "--weights")?;
                vec![weights.clone()]
            }
            None => WEIGHTS.map(PathBuf::from).into_iter().filter(|it| it.is_file()).collect(),
        };
        let mut fitting = Vec::new();
        for file in candidates {
            let card = Card::of(&file)?;
            if card.material_hash == Some(material.law_hash()) {
                let surrogate = Surrogate::load(&file)?;
                let domain = surrogate.domain();
                let regime = material.regime(domain.w_lig[1]);
                let w_lig = 0.5 * domain.w_lig.iter().sum::<f64>();
                let angles = [domain.alpha[0], FRAC_PI_2];
                let opening = safe_opening(&surrogate, w_lig, &angles, first_scene::OPENING);
                fitting.push(Weights {
                    file,
                    regime,
                    opening,
                    damage: damage_of_turn(&surrogate, w_lig, opening),
                    widths: domain.w_lig,
                    holes: surrogate.holes(),
                });
            } else if self.weights.is_some() {
                bail!(
                    "{} are weights for another material than {}: name the material that they were trained on (--material), \
                     or leave out --weights",
                    file.display(),
                    material.name
                );
            }
        }
        Ok(fitting)
    }
}

/// Weights for the material, and the ligaments that they know.
struct Weights {
    file: PathBuf,
    regime: Regime,
    /// The opening at which its ligaments are safe (rad).
    opening: f64,
    /// The damage term of ligaments opened so.
    damage: f64,
    /// Interval of the ligament widths of the training (mm).
    widths: [f64; 2],
    /// Interval of the radius of their holes over the width.
    holes: [f64; 2],
}

impl Weights {
    /// The scene with the holes of the training, and its ligament widths, to a hundredth, in a
    /// sheet that is `scale` times as thick.
    fn known_part(&self, scene: &str, scale: f64) -> Result<String> {
        let mut scene: DocumentMut = scene.parse()?;
        let [least, most] = self.widths.map(|width| scale * width);
        for key in ["start", "range"] {
            let known =
                |width: f64| rounded(width.clamp(f64::max(0.99 * least, MIN_W_LIG), 1.01 * most));
            map(&mut scene["ligament"][key], known);
        }
        // The hole of the narrowest ligament is wider than the slit that it ends.
        let number = |item: &Item| item.as_float().unwrap_or(f64::NAN);
        let slit = number(&scene["process"]["slit_width"]);
        let wider = 0.5 * WIDER * slit / number(&scene["ligament"]["range"][0]);
        let [least, most] = self.holes;
        let hole = &mut scene["process"]["fillet_ratio"];
        let usual = number(hole);
        map(hole, |hole| rounded(hole.max(wider).clamp(least, most)));
        // The law of released hinges is for the usual hole.
        if number(hole) != usual
            && let Some(surrogate) = scene["surrogate"].as_table_mut()
        {
            surrogate.remove("springback");
        }
        Ok(scene.to_string())
    }
}

/// Diameter of the smallest hole over the width of a slit.
const WIDER: f64 = 1.02;
/// Files in a new folder.
const TRAINING: &str = "training.toml";
const README: &str = "README.md";
/// What the README says of a plate that hangs.
const ALONE: &str = " Nothing holds its panels there; the report says whether they stay.";

/// The shipped campaign of a regime, scaled to a sheet of `thickness` (mm); its material is
/// `material.toml` in the same folder.
pub fn campaign(name: &str, thickness: f64, regime: Regime) -> Result<String> {
    let template = Template::of(regime);
    let factor = thickness / template.campaign_thickness;
    let mut campaign: DocumentMut = template.campaign.parse()?;
    set(&mut campaign["name"], name);
    set(&mut campaign["material"], "material.toml");
    heading(
        &mut campaign,
        "# Hinge windows of the material, from which its hinge energy is trained.\n",
    );
    set(&mut campaign["training"], Array::from_iter([TRAINING]));
    campaign.remove("extra_rays");
    for key in ["kerf", "r_win"] {
        scale(&mut campaign["design"][key], factor);
    }
    let boxes = campaign["rays"].as_array_of_tables_mut();
    for rays in boxes.into_iter().flat_map(ArrayOfTables::iter_mut) {
        for key in ["w_lig", "full_range_w_lig"] {
            scale(&mut rays[key], factor);
        }
    }
    Ok(campaign.to_string())
}

/// What the sheet is, and the commands of the project in their order.
fn readme(folder: &Path, why: &str, regime: Regime, trained: bool, whole_build: bool) -> String {
    let path = |name: &str| shell_word(&folder.join(name));
    let (campaign, scene, material) =
        (path("campaign.toml"), path(SCENE_FILE), path("material.toml"));
    let (jobs, database) = (path("campaign"), path("hinges.parquet"));
    let (weights, training) = (path("weights.safetensors"), path(TRAINING));
    let (learned, learned_weights) = (path("learned"), path("learned/weights.safetensors"));
    let check = match regime {
        Regime::Film => "--equilibrium   # the deployed sheet by finite elements of its ligaments",
        Regime::Plate => "--sheet   # the whole sheet by finite elements: whether it stays flat",
    };
    let design = format!("kirigami design {scene}\n");
    let verify = format!("kirigami verify {scene} {check}\n");
    let learn = format!("kirigami material learn {material} --out {learned}\n");
    let with = format!("kirigami design {scene} --weights {learned_weights} --restart\n");
    let campaign = format!(
        "kirigami campaign plan {campaign} --folder {jobs}      # number of rays and time\n\
         kirigami campaign run {campaign} --folder {jobs}\n\
         kirigami campaign collect {campaign} --folder {jobs} --out {database}\n\
         kirigami train {database} --config {training} --out {weights}\n"
    );
    let install = "cargo install --path . --locked\n".to_owned();
    let parts = match (trained, whole_build) {
        (true, true) => vec![
            ("The material has weights. Design the sheet, and check it:", design + &verify),
            (
                "After a change to the material, fine-tune weights on about an hour of its solves:",
                learn + &with,
            ),
            ("Or train weights from nothing, in many hours:", campaign),
        ],
        (false, true) => vec![
            (
                "The material has no weights yet. Fine-tune weights on about an hour of its solves, and design the sheet:",
                learn + &with,
            ),
            (
                "Or train weights from nothing, in many hours; the scene names these:",
                campaign + &design + &verify,
            ),
        ],
        (true, false) => vec![
            ("The material has weights. Design the sheet:", design),
            (
                "The whole program also checks it by finite elements, and makes weights for other materials. In the folder of kirigami:",
                install,
            ),
        ],
        (false, false) => vec![(
            "The material has no weights yet. The whole program makes them. In the folder of kirigami:",
            install,
        )],
    };
    let mut text = format!("# A sheet of your own\n\n{why}\n");
    for (title, commands) in parts {
        text += &format!("\n{title}\n\n```sh\n{commands}```\n");
    }
    text
}

/// Text of a material file in another thickness (mm).
pub fn material_text(path: &Path, thickness: f64) -> Result<String> {
    let text = text_file::read(path).map_err(unread(path))?;
    let mut material: DocumentMut = text.parse()?;
    set(&mut material["thickness"], thickness);
    Ok(material.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_of_a_folder_with_a_space_can_be_copied() {
        let text = readme(Path::new("my sheet"), "", Regime::Film, true, true);
        assert!(text.contains("kirigami design 'my sheet/scene.toml'\n"), "{text}");
    }

    #[test]
    fn a_readme_names_the_commands_of_its_build_alone() {
        for trained in [false, true] {
            let text = readme(Path::new("sheet"), "", Regime::Plate, trained, false);
            let commands = text.lines().filter(|line| line.starts_with("kirigami "));
            let commands: Vec<&str> = commands.collect();
            let design = ["kirigami design sheet/scene.toml"];
            assert_eq!(commands, if trained { &design[..] } else { &[] }, "{text}");
        }
    }

    #[test]
    fn a_copied_material_keeps_its_comments() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.toml");
        let text = "name = \"film\"\nthickness = 0.5 # measured\n";
        std::fs::write(&path, text).unwrap();
        assert_eq!(material_text(&path, 3.0).unwrap(), text.replace("0.5", "3.0"));
    }

    #[test]
    fn a_campaign_is_scaled_and_keeps_its_comments() {
        let text = campaign("thin", 0.1, Regime::Film).unwrap();
        for line in [
            "name = \"thin\"",
            "tier = \"default\"",
            "r_win = 20.0        # mm; radius of the window",
            "w_lig = [1.0, 5.0]        # mm",
            "full_range_w_lig = 1.6     # mm, 16 thicknesses",
            "training = [\"training.toml\"] # what",
            "median_deg = 25.0",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        // The widths in every box.
        let boxes = text.matches("[[rays]]").count();
        for scaled in ["\nw_lig = [1.0, 5.0]", "\nfull_range_w_lig = 1.6"] {
            assert_eq!(text.matches(scaled).count(), boxes, "{text}");
        }
        assert!(
            text.starts_with("# Hinge windows of the material")
                && !text.contains("Hinge database")
                && !text.contains("extra_rays"),
            "{text}"
        );
    }
}
