//! The quantities of a cut sheet: those that are fitted, and those that were measured by themselves.

use clap::ValueEnum;
use design::analysis::calibration::Quantity;
use design::scene::Scene;
use design::sheet::deviation::Deviation;
use std::str::FromStr;

/// What is fitted.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum QuantityArg {
    /// Width that the cutter removes.
    Kerf,
    /// Thickness of the sheet.
    Thickness,
    /// All stresses at equal strain, modulus and yield together.
    Stress,
}

impl From<QuantityArg> for Quantity {
    fn from(arg: QuantityArg) -> Self {
        match arg {
            QuantityArg::Kerf => Self::Kerf,
            QuantityArg::Thickness => Self::Thickness,
            QuantityArg::Stress => Self::Stress,
        }
    }
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
        let quantity = QuantityArg::from_str(name, false)
            .map_err(|_| "the quantities are kerf, thickness and stress")?;
        let value: Option<f64> = value.parse().ok();
        let value = value.filter(|value| *value > 0.0 && value.is_finite());
        Ok(Self {
            quantity: quantity.into(),
            value: value.ok_or_else(|| format!("{name} must be a number above 0"))?,
        })
    }
}

/// The sheet of a scene with known quantities.
pub(super) fn deviation(known: &[Known], scene: &Scene) -> Deviation {
    let mut deviation = Deviation::default();
    for Known { quantity, value } in known {
        match quantity {
            Quantity::Kerf => deviation.kerf = value - scene.config.process.kerf,
            Quantity::Thickness => deviation.thickness = value - scene.material.thickness,
            Quantity::Stress => deviation.stress = value - 1.0,
        }
    }
    deviation
}
