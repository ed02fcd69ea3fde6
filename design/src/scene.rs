//! The scene: everything a design run is told, read from one TOML file.
//!
//! A scene names the cheapest model that answers it, and only that is loaded: `hinge = "linear"`
//! reads no weights. Paths are relative to the scene file. What a value may be is in `checks.rs`.

mod checks;
mod hinge_model;
mod problem;

pub use hinge_model::{HingeModel, LinearConstants, PinConfig, SurrogateFile};

use crate::grid::Grid;
use crate::objective::OutlinePoints;
use crate::sheet::{Centroid, CutProcess, HingePoint, SheetOptions};
use crate::target::{Target, TargetError, TargetShape};
use hinge::SheetMaterial;
use hinge::config::ConfigError;
use hinge_model::LoadedHinge;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use surrogate::{Surrogate, WeightsError};

/// The keys of a scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneConfig {
    /// What the pictures are titled.
    pub title: String,
    /// The TOML file of the sheet material.
    pub material: PathBuf,
    pub hinge: HingeModel,
    /// Where panels attach; by default what the hinge model was measured with.
    pub hinge_point: Option<HingePoint>,
    #[serde(default)]
    pub centroid: Centroid,
    /// N of the load path zeta_i = i/N.
    #[serde(default = "default_load_steps")]
    pub load_steps: usize,
    /// The run folder.
    pub output: PathBuf,
    pub sheet: SheetSize,
    pub ligament: LigamentConfig,
    pub process: CutProcess,
    /// Read if `hinge = "pin"`.
    pub pin: Option<PinConfig>,
    /// Constants of (11); read if `hinge = "linear"`.
    pub linear: Option<LinearConstants>,
    /// Read if `hinge = "surrogate"`.
    pub surrogate: Option<SurrogateFile>,
    #[serde(default)]
    pub supports: Vec<SupportConfig>,
    #[serde(default)]
    pub loads: Vec<LoadConfig>,
    pub target: TargetShape,
    pub objective: ObjectiveConfig,
    pub optimiser: OptimiserConfig,
}

/// The flat sheet: a rectangle from the origin, `panels` = [columns M, rows N].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetSize {
    /// [along x, along y] (mm)
    pub size: [f64; 2],
    pub panels: [usize; 2],
}

/// The ligament widths: where they start, and the chart's interval in which they are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LigamentConfig {
    /// Width that every hinge starts at (mm).
    pub start: f64,
    /// [w_minus, w_plus] of the chart (mm).
    pub range: [f64; 2],
}

/// A held panel, named by [column, row].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupportConfig {
    pub panel: [usize; 2],
    pub kind: SupportKind,
}

/// Which motions of a panel's centroid a support prevents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SupportKind {
    /// Both translations and the rotation.
    Clamp,
    /// Both translations.
    Pin,
    /// Rolls along x: the translation along y.
    RollerX,
    /// Rolls along y: the translation along x.
    RollerY,
}

/// A dead load at the centroid of a panel, named by [column, row].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadConfig {
    pub panel: [usize; 2],
    /// N
    #[serde(default)]
    pub force: [f64; 2],
    /// N mm, counter-clockwise.
    #[serde(default)]
    pub couple: f64,
}

/// The weights of (16)-(19), relative to the Chamfer distance over the mean panel area: at the weight
/// 1 a functional of 1 costs as much as an outline that lies a panel's size off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectiveConfig {
    /// w_cov of the Chamfer distance.
    pub coverage: f64,
    /// Of (17); needs `hinge = "surrogate"`.
    #[serde(default)]
    pub damage: f64,
    /// Of (18).
    #[serde(default)]
    pub compression: f64,
    /// Of (19).
    #[serde(default)]
    pub shear: f64,
    /// Which panel corners on the outline are compared with the target: `free`, those that belong
    /// to no hinge, or `all`.
    #[serde(default)]
    pub outline: OutlinePoints,
    /// Points on the target outline.
    pub target_points: usize,
}

/// How the outer loop searches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OptimiserConfig {
    pub steps: usize,
    /// Of Adam, in the chart coordinates.
    pub learning_rate: f64,
    /// Standard deviation of the random start about the uniform sheet, in the chart coordinates.
    #[serde(default)]
    pub start_noise: f64,
    /// Of the random start.
    #[serde(default)]
    pub seed: u64,
}

fn default_load_steps() -> usize {
    10
}

/// A scene whose values were checked, with its material and its sampled target.
#[derive(Clone, Debug)]
pub struct Scene {
    pub config: SceneConfig,
    pub material: SheetMaterial,
    pub target: Target,
    hinge: LoadedHinge,
    path: PathBuf,
}

/// Why a scene was refused; every message names the file and the key.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("{path}: {reason}", path = .path.display())]
    Value { path: PathBuf, reason: String },
    #[error("{path}: {source}", path = .path.display())]
    Target { path: PathBuf, source: TargetError },
    #[error(transparent)]
    Weights(#[from] WeightsError),
}

impl Scene {
    /// Reads a scene with all that it names, and refuses what cannot be.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::new(hinge::config::read(path)?, path)
    }

    /// Reads the material, the target and the weights of a scene whose paths are relative to the
    /// file at `path`, and refuses what cannot be.
    pub fn new(config: SceneConfig, path: &Path) -> Result<Self, SceneError> {
        let refuse = |reason| SceneError::Value {
            path: path.to_owned(),
            reason,
        };
        checks::config(&config).map_err(refuse)?;
        let material_path = beside(path, &config.material);
        let material: SheetMaterial = hinge::config::read(&material_path)?;
        material.validate().map_err(|invalid| SceneError::Value {
            path: material_path,
            reason: invalid.to_string(),
        })?;
        let points = config.objective.target_points;
        let target = Target::sample(&config.target, folder(path), points).map_err(|source| {
            SceneError::Target {
                path: path.to_owned(),
                source,
            }
        })?;
        checks::target(&target, config.sheet.size).map_err(refuse)?;
        let hinge = LoadedHinge::load(&config, &material, path)?;
        Ok(Self {
            config,
            material,
            target,
            hinge,
            path: path.to_owned(),
        })
    }

    /// The learned hinge law, if the scene names it.
    pub fn surrogate(&self) -> Option<&Surrogate> {
        match &self.hinge {
            LoadedHinge::Surrogate(surrogate) => Some(surrogate),
            _ => None,
        }
    }

    /// What turns a pattern into this scene's sheet.
    pub fn sheet_options(&self) -> SheetOptions {
        let measured_at = match self.config.hinge {
            HingeModel::Pin | HingeModel::Linear => HingePoint::Corner,
            HingeModel::Surrogate => HingePoint::CutTip,
        };
        SheetOptions {
            hinge_point: self.config.hinge_point.unwrap_or(measured_at),
            centroid: self.config.centroid,
            process: self.config.process,
        }
    }

    /// The run folder.
    pub fn output(&self) -> PathBuf {
        beside(&self.path, &self.config.output)
    }
}

impl SupportKind {
    /// Whether (u_x, u_y, phi) are held.
    pub fn holds(self) -> [bool; 3] {
        match self {
            Self::Clamp => [true, true, true],
            Self::Pin => [true, true, false],
            Self::RollerX => [false, true, false],
            Self::RollerY => [true, false, false],
        }
    }
}

impl SheetSize {
    pub fn grid(&self) -> Grid {
        let [m, n] = self.panels;
        Grid { m, n }
    }
}

fn folder(scene: &Path) -> &Path {
    scene.parent().unwrap_or(Path::new(""))
}

/// A path that the scene file writes relative to itself.
fn beside(scene: &Path, path: &Path) -> PathBuf {
    folder(scene).join(path)
}
