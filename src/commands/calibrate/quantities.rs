//! The quantities of a cut sheet: those that are fitted, and those that were measured by themselves.

use anyhow::ensure;
use design::analysis::calibration::Quantity;
use design::scene::Scene;
use design::sheet::deviation::Deviation;
use std::str::FromStr;

/// A quantity by its name.
pub(super) fn quantity(name: &str) -> Result<Quantity, String> {
    let mut all = Quantity::ALL.into_iter();
    all.find(|quantity| quantity.name() == name)
        .ok_or_else(|| "the quantities are kerf, thickness and stress".into())
}

/// A quantity and its value: mm, or relative to the material's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub quantity: Quantity,
    value: f64,
}

impl FromStr for Known {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text
            .split_once('=')
            .ok_or("must be QUANTITY=VALUE, for example thickness=2.93")?;
        let quantity = quantity(name)?;
        let value: Option<f64> = value.parse().ok();
        let value = value.filter(|value| *value > 0.0 && value.is_finite());
        Ok(Self {
            quantity,
            value: value.ok_or_else(|| format!("{name} must be a number above 0"))?,
        })
    }
}

/// A known value is within this factor of that of the scene: a unit or a decimal point is wrong in others.
const FACTOR: f64 = 4.0;

/// The sheet of a scene with known quantities; an error if one is named twice or out of proportion to the scene.
pub(super) fn deviation(known: &[Known], scene: &Scene) -> anyhow::Result<Deviation> {
    let mut deviation = Deviation::default();
    for (i, Known { quantity, value }) in known.iter().enumerate() {
        let name = quantity.name();
        ensure!(
            known[..i].iter().all(|other| other.quantity != *quantity),
            "--known names {name} twice: give one value"
        );
        let nominal = match quantity {
            Quantity::Kerf => scene.config.process.kerf,
            Quantity::Thickness => scene.material.thickness,
            Quantity::Stress => 1.0,
        };
        ensure!(
            nominal == 0.0 || (nominal / FACTOR..=FACTOR * nominal).contains(value),
            "--known {name}={value}, but the scene has {nominal}: check the unit and the decimal point, or change the scene"
        );
        *quantity.of(&mut deviation) = value - nominal;
    }
    Ok(deviation)
}
