//! What a new sheet can be made of: the materials with weights, and the machines that cut.

use crate::commands::init::WEIGHTS;
use crate::commands::init::first_scene::PANEL;
use anyhow::Result;
use hinge::SheetMaterial;
use output::cut_file::Machines;
use serde::Serialize;
use std::path::{Path, PathBuf};
use surrogate::Surrogate;

const MATERIALS: &str = "configs/materials";

/// The materials and the machines.
#[derive(Serialize)]
pub(super) struct Shop {
    materials: Vec<Offered>,
    /// Names and what they are.
    machines: Vec<[String; 2]>,
}

/// A material with weights.
#[derive(Serialize)]
struct Offered {
    /// Its file.
    file: PathBuf,
    name: String,
    /// In which its hinges were solved (mm).
    thickness: f64,
    /// What its ligaments are, and the errors of its weights, in words.
    says: String,
}

impl Shop {
    /// What the shipped files offer, in the working folder.
    pub fn open() -> Result<Self> {
        let machines = Machines::shipped().machine;
        let mut materials = Vec::new();
        for weights in WEIGHTS
            .iter()
            .map(Path::new)
            .filter(|weights| weights.is_file())
        {
            materials.extend(offered(&Surrogate::load(weights)?)?);
        }
        Ok(Self {
            materials,
            machines: machines
                .into_iter()
                .map(|machine| [machine.name, machine.says])
                .collect(),
        })
    }
}

/// The material of weights, if its file is among the shipped ones.
fn offered(surrogate: &Surrogate) -> Result<Option<Offered>> {
    let card = surrogate.card();
    for entry in std::fs::read_dir(MATERIALS)? {
        let file = entry?.path();
        if file.extension().is_none_or(|kind| kind != "toml") {
            continue;
        }
        let material = SheetMaterial::load(&file)?;
        if card.material_hash != Some(material.law_hash()) {
            continue;
        }
        let (errors, on) = match &card.spot_check {
            Some(check) => (&check.errors, "random"),
            None => (&card.test_errors, "unseen"),
        };
        let [low, high] = card.domain.w_lig;
        return Ok(Some(Offered {
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
