//! The scene: everything a design run is told, read from one TOML file.
//!
//! A scene names the cheapest model that answers it, and only that is loaded: `hinge = "linear"`
//! reads no weights. Paths are relative to the scene file. What a value may be is in `checks.rs`.

mod actuation;
mod checks;
mod hinge_model;
mod problem;
mod sheet_config;

pub use actuation::{
    DriveConfig, EdgeLoadConfig, LoadConfig, OpeningCoupleConfig, SheetEdge, SupportConfig,
    SupportKind,
};
pub use hinge_model::{
    CondensedConfig, ContactConfig, HingeModel, LinearConstants, PinConfig, SurrogateFile,
};
pub use sheet_config::{LigamentConfig, SheetConfig, StartConfig};

use crate::chamfer::Precision;
use crate::equilibrium::{Method, SolverSettings};
use crate::gradient::DesignError;
use crate::hinge_law::DamageMeasure;
use crate::objective::OutlinePoints;
use crate::search::SearchMethod;
use crate::sheet::{Centroid, HingePoint, SheetOptions};
use crate::target::{Target, TargetError, TargetShape};
use hinge::config::ConfigError;
use hinge::{HingeConstants, MaterialError, SheetMaterial};
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
    pub sheet: SheetConfig,
    pub ligament: LigamentConfig,
    /// Where the search starts; by default the uniform sheet.
    #[serde(default)]
    pub start: StartConfig,
    pub process: HingeConstants,
    /// Read if `hinge = "pin"`.
    pub pin: Option<PinConfig>,
    /// Constants of (11); read if `hinge = "linear"`.
    pub linear: Option<LinearConstants>,
    /// Constants of (11) from a learned energy, in place of `linear`.
    pub condensed: Option<CondensedConfig>,
    /// Read if `hinge = "surrogate"`.
    pub surrogate: Option<SurrogateFile>,
    #[serde(default)]
    pub supports: Vec<SupportConfig>,
    /// Contact of panel edges; by default that of the hinge law.
    pub contact: Option<ContactConfig>,
    #[serde(default)]
    pub loads: Vec<LoadConfig>,
    #[serde(default)]
    pub edge_loads: Vec<EdgeLoadConfig>,
    #[serde(default)]
    pub opening_couples: Vec<OpeningCoupleConfig>,
    /// Follows the path by the way of the loads instead of their size.
    pub drive: Option<DriveConfig>,
    #[serde(default)]
    pub solver: SolverConfig,
    pub target: TargetShape,
    pub objective: ObjectiveConfig,
    pub optimiser: OptimiserConfig,
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
    /// Which damage (17) is of: `mean`, D as the paper, or `peak`, D_peak that tears at 1.
    #[serde(default)]
    pub damage_measure: DamageMeasure,
    /// Of (18).
    #[serde(default)]
    pub compression: f64,
    /// Of (19).
    #[serde(default)]
    pub shear: f64,
    /// Of panels stretched more than eight to one or sharper than 14 degrees, which the outline alone
    /// does not mind, and, with learned hinges, of corners of a panel closer than three radii of their
    /// windows; never relative to a gradient.
    #[serde(default)]
    pub panel_shape: f64,
    /// Of states outside the domain that the hinge law was learned in, in squared tenths of its range, as a
    /// mean over hinges and load steps; needs `hinge = "surrogate"`; never relative to a gradient.
    #[serde(default)]
    pub domain: f64,
    /// Whether the weights of (17)-(19) are relative to the gradient of the Chamfer distance at the
    /// start instead: at the weight 1 a functional pulls as hard as the shape.
    #[serde(default)]
    pub balance: bool,
    /// Temperature of the minima in the Chamfer distance (mm^2); 0 is the hard minimum of the paper.
    #[serde(default)]
    pub smoothing: f64,
    /// What the outline's distance is measured to: the `samples` of the target, as the paper, or the
    /// `curve` through them.
    #[serde(default)]
    pub precision: Precision,
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
    /// Length of the first step, in every chart coordinate; of Adam that of the later ones too.
    pub learning_rate: f64,
    /// `adam`, as the paper, or `lbfgs`.
    #[serde(default)]
    pub method: SearchMethod,
    /// Standard deviation of the random start about the uniform sheet, in the chart coordinates.
    #[serde(default)]
    pub start_noise: f64,
    /// Of the random start.
    #[serde(default)]
    pub seed: u64,
}

/// How the equilibria are sought.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SolverConfig {
    /// Residual of a converged state, relative to the greatest force.
    pub tolerance: f64,
    /// `"newton"`, or `{ lbfgs = { max_iterations = 20000 } }` as the paper.
    pub method: Method,
}

impl Default for SolverConfig {
    fn default() -> Self {
        let SolverSettings {
            tolerance, method, ..
        } = SolverSettings::default();
        Self { tolerance, method }
    }
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
    #[error(transparent)]
    Material(#[from] MaterialError),
    #[error("{path}: {reason}", path = .path.display())]
    Value { path: PathBuf, reason: String },
    #[error("{path}: {source}", path = .path.display())]
    Target { path: PathBuf, source: TargetError },
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error("{path}: objective.balance needs the gradients at the start: {source}", path = .path.display())]
    Balance { path: PathBuf, source: DesignError },
}

impl SceneConfig {
    /// Names other weights, relative to the working folder.
    pub fn name_weights(&mut self, weights: &Path) -> std::io::Result<()> {
        let weights = std::path::absolute(weights)?;
        self.surrogate = Some(SurrogateFile {
            weights,
            ensemble: Vec::new(),
        });
        Ok(())
    }

    /// Grows or shrinks the loads on panels, forces and couples alike.
    pub fn scale_loads(&mut self, factor: f64) {
        (self.loads.iter_mut()).for_each(|load| load.scale(factor));
    }
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
        let material = SheetMaterial::load(&material_path)?;
        let points = config.objective.target_points;
        let target = Target::sample(&config.target, folder(path), points).map_err(|source| {
            SceneError::Target {
                path: path.to_owned(),
                source,
            }
        })?;
        checks::target(&target, &config.sheet.outline()).map_err(refuse)?;
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
            LoadedHinge::Surrogate { surrogate, .. } => Some(surrogate),
            _ => None,
        }
    }

    /// The learned hinge law and the further networks of its training; none if the scene names none.
    pub fn networks(&self) -> Vec<&Surrogate> {
        match &self.hinge {
            LoadedHinge::Surrogate {
                surrogate,
                ensemble,
                ..
            } => std::iter::once(&**surrogate).chain(ensemble).collect(),
            _ => Vec::new(),
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

fn folder(scene: &Path) -> &Path {
    scene.parent().unwrap_or(Path::new(""))
}

/// A path that the scene file writes relative to itself.
fn beside(scene: &Path, path: &Path) -> PathBuf {
    folder(scene).join(path)
}
