//! What a new sheet can be made of: the materials with weights, and the machines that cut.

use crate::key_meanings::meanings;
use anyhow::Result;
use app::new_project::{WEIGHTS, first_scene::PANEL};
use hinge::SheetMaterial;
use output::cut_file::Machines;
use scene::Level;
use serde::Serialize;
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use support::text_file;
use surrogate::Card;

const MATERIALS: &str = "configs/materials";

/// Finished sheets that a page offers to open, what they are, and what they become. Their pictures
/// are next to them.
const EXAMPLES: [[&str; 3]; 3] = [
    [
        "configs/examples/heart.toml",
        "Heart",
        "an A4 plate of polypropylene for a laser service becomes a heart, to 5 mm; two boards hold it flat",
    ],
    [
        "configs/examples/service-plate.toml",
        "Service plate",
        "an A4 plate of polypropylene for a laser service hangs, and a pull opens its twelve panels",
    ],
    [
        "configs/examples/disc.toml",
        "Disc",
        "49 panels of polyester film, a square of 4.2 m, become a disc",
    ],
];

/// What a page offers.
#[derive(Serialize)]
pub(crate) struct Catalogue {
    materials: Vec<OfferedMaterial>,
    /// Names and what they are.
    machines: Vec<[String; 2]>,
    /// Names of services that cut, and the machines whose files they take.
    services: Vec<[String; 2]>,
    /// Finished sheets, with pictures of the flat and the opened sheet (SVG).
    examples: Vec<Value>,
    /// Names and what they are; those that a search of the studio can have.
    levels: Vec<[&'static str; 2]>,
    keys: BTreeMap<String, String>,
    /// Least side of a panel over the radius of a window.
    panel: f64,
}

/// A material with weights.
#[derive(Serialize)]
struct OfferedMaterial {
    /// Its file.
    file: PathBuf,
    name: String,
    /// In which its hinges were solved (mm).
    thickness: f64,
    /// What its ligaments are, and the errors of its weights, in words.
    says: String,
}

impl Catalogue {
    /// What the shipped files offer, in the working folder.
    pub(crate) fn open() -> Result<Self> {
        let Machines { machine, service } = Machines::shipped();
        let mut materials = Vec::new();
        for weights in WEIGHTS.iter().map(Path::new).filter(|weights| weights.is_file()) {
            materials.extend(offered(&Card::of(weights)?)?);
        }
        Ok(Self {
            materials,
            machines: (machine.into_iter())
                .map(|machine| [machine.name, machine.says])
                .collect(),
            services: (service.into_iter())
                .map(|service| [service.name, service.machine])
                .collect(),
            examples: (EXAMPLES.into_iter())
                .filter(|[scene, ..]| is_example(Path::new(scene)))
                .map(|[scene, title, becomes]| {
                    let picture = text_file::read(&Path::new(scene).with_extension("svg")).ok();
                    json!({ "scene": scene, "title": title, "becomes": becomes, "picture": picture })
                })
                .collect(),
            levels: (Level::ALL.into_iter())
                .filter(|level| *level != Level::Final)
                .map(|level| [level.name(), level.hinges()])
                .collect(),
            keys: meanings(),
            panel: PANEL,
        })
    }
}

/// Whether a file is one of the examples, and is there.
pub(crate) fn is_example(file: &Path) -> bool {
    EXAMPLES.iter().any(|[name, ..]| file == Path::new(name)) && file.is_file()
}

/// The material of weights, if its file is among the shipped ones.
fn offered(card: &Card) -> Result<Option<OfferedMaterial>> {
    for entry in std::fs::read_dir(MATERIALS)? {
        let file = entry?.path();
        if file.extension().is_none_or(|kind| kind != "toml") {
            continue;
        }
        let material = SheetMaterial::load(&file)?;
        if card.material_hash != Some(material.law_hash()) {
            continue;
        }
        let checked = card.check().map(|(check, states)| (&check.errors, states));
        let (errors, on) = checked.unwrap_or((&card.test_errors, "unseen"));
        let [low, high] = card.domain.w_lig;
        return Ok(Some(OfferedMaterial {
            says: format!(
                "{}: at {} mm ligaments of {low:.2} to {high:.2} mm, panels of {:.0} mm at least; W within {:.1} %, F_a {:.1} %, M {:.1} % (root mean squares at {} {on} states)",
                material.regime(high),
                material.thickness,
                PANEL * card.hinge.r_win,
                100.0 * errors.energy.relative_rmse,
                100.0 * errors.f_a.relative_rmse,
                100.0 * errors.m_theta.relative_rmse,
                errors.rows,
            ),
            name: material.name,
            thickness: material.thickness,
            file,
        }));
    }
    Ok(None)
}
