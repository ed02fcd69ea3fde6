//! What studies have measured, each value with the page that it is from: `calibration.toml`.

use hinge::Regime;
use serde::Deserialize;
use std::sync::LazyLock;

/// A value and where it was measured.
#[derive(Debug, Deserialize)]
pub struct Measured<T> {
    /// The value.
    pub value: T,
    /// The page, or the data.
    pub source: String,
}

/// How the forces depend on the path of a hinge, with separations in ligament widths.
#[derive(Debug, Deserialize)]
pub struct PathDeviation {
    /// Relative change of the forces for each unit of separation.
    pub slope: f64,
    /// The largest change that was found.
    pub most: f64,
    /// Separation up to which the path hardly matters.
    pub safe: f64,
    /// The page.
    pub source: String,
}

/// What is measured in films and plates. The file says what each value means.
#[derive(Debug, Deserialize)]
#[allow(missing_docs, reason = "the file documents them")]
pub struct OfRegime {
    pub imperfection: Measured<Vec<[f64; 2]>>,
    pub path_deviation: PathDeviation,
    pub slit: Measured<[f64; 2]>,
    pub tip_strain: Measured<[f64; 2]>,
    pub slenderness: Measured<[f64; 2]>,
    pub opening: Measured<f64>,
}

/// All measured values.
#[derive(Debug, Deserialize)]
#[allow(missing_docs, reason = "the file documents them")]
pub struct Calibration {
    film: OfRegime,
    plate: OfRegime,
    bent_rays: PathDeviation,
    pub deviation_yield: Measured<f64>,
    pub unloading: Measured<f64>,
    pub safe_margin: Measured<f64>,
    pub falls: Measured<f64>,
    pub table: Measured<[f64; 2]>,
    pub steepest_drop: Measured<f64>,
}

/// The shipped values.
pub static CALIBRATION: LazyLock<Calibration> = LazyLock::new(|| {
    toml::from_str(include_str!("calibration.toml")).expect("the shipped values are readable")
});

impl Calibration {
    /// The values of a regime.
    pub fn of(&self, regime: Regime) -> &OfRegime {
        match regime {
            Regime::Film => &self.film,
            Regime::Plate => &self.plate,
        }
    }

    /// How forces depend on the path in a regime, by a law of straight or of bent rays.
    pub fn path_deviation(&self, regime: Regime, bent_rays: bool) -> &PathDeviation {
        match regime {
            Regime::Plate if bent_rays => &self.bent_rays,
            _ => &self.of(regime).path_deviation,
        }
    }
}
