//! The keys of a scene file.

use crate::equilibrium::settings::SolverSettings;
use crate::geometry::chamfer::Precision;
use crate::hinge_law::DamageMeasure;
use crate::objective::loss::OutlinePoints;
use crate::objective::path_functionals::PerFunctional;
use crate::objective::target::TargetShape;
use crate::optimise::search::SearchMethod;
use crate::scene::actuation::{
    DriveConfig, EdgeLoadConfig, LoadConfig, OpeningCoupleConfig, SupportConfig,
};
use crate::scene::cutting::CuttingConfig;
use crate::scene::hinge_model::{
    CondensedConfig, ContactConfig, HingeModel, LinearConstants, PinConfig, SurrogateFile,
};
use crate::scene::sheet_config::{LigamentConfig, SheetConfig, StartConfig};
use crate::sheet::cut_sheet::{Centroid, HingePoint};
use hinge::{HingeConstants, SheetMaterial};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The keys of a scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneConfig {
    /// Title of the pictures.
    pub title: String,
    /// The TOML file of the sheet material, relative to the scene file. For a learned law, the file of the training.
    pub material: PathBuf,
    /// Thickness of the sheet (mm), 0.02 to 10, instead of the material's: the same law in another thickness. Learned
    /// energies are converted exactly, by similarity: ligament widths and r_win scale with the thickness.
    pub thickness: Option<f64>,
    /// The hinge law: `pin`, `linear` or `surrogate`.
    pub hinge: HingeModel,
    /// The attachment points of the panels; by default those that the hinge model was measured with.
    pub hinge_point: Option<HingePoint>,
    /// The reference point of a panel's rotation: the `area` centroid or the mean of the `vertices`.
    #[serde(default)]
    pub centroid: Centroid,
    /// N of the load steps zeta_i = i/N, 1 to 10 000: where the path is read for pictures and path functionals. The solver
    /// chooses its own increments between them.
    #[serde(default = "default_load_steps")]
    pub load_steps: usize,
    /// The run folder, relative to the scene file.
    pub output: PathBuf,
    /// The flat sheet.
    pub sheet: SheetConfig,
    /// The ligament widths.
    pub ligament: LigamentConfig,
    /// The start of the search; by default the uniform sheet.
    #[serde(default)]
    pub start: StartConfig,
    /// The cutting tool and the windows of the hinges.
    pub process: HingeConstants,
    /// How the sheet is cut.
    #[serde(default)]
    pub cutting: CuttingConfig,
    /// Read if `hinge = "pin"`.
    pub pin: Option<PinConfig>,
    /// Constants of (11); read if `hinge = "linear"`.
    pub linear: Option<LinearConstants>,
    /// Constants of (11) from a learned energy, instead of `linear`.
    pub condensed: Option<CondensedConfig>,
    /// Read if `hinge = "surrogate"`.
    pub surrogate: Option<SurrogateFile>,
    /// The supported panels; they must prevent the rigid motions of the sheet. Empty if `hinge = "pin"`.
    #[serde(default)]
    pub supports: Vec<SupportConfig>,
    /// Contact of panel edges; by default with ten times the k_theta of a hinge with the start width, from 0 to
    /// -5.7 deg or, for a learned law, to the end of its domain.
    pub contact: Option<ContactConfig>,
    /// Dead loads on panels.
    #[serde(default)]
    pub loads: Vec<LoadConfig>,
    /// Dead tractions along the edges of the sheet.
    #[serde(default)]
    pub edge_loads: Vec<EdgeLoadConfig>,
    /// Couples on the panels of hinges.
    #[serde(default)]
    pub opening_couples: Vec<OpeningCoupleConfig>,
    /// Displacement control: prescribes the stroke of the loads instead of their magnitude.
    pub drive: Option<DriveConfig>,
    /// The equilibrium solver.
    #[serde(default)]
    pub solver: SolverSettings,
    /// The target outline; its length must be 0.2 to 3 times the perimeter of the flat sheet.
    pub target: TargetShape,
    /// The objective (16) and its weights.
    pub objective: ObjectiveConfig,
    /// The search of the outer loop.
    pub optimiser: OptimiserConfig,
}

/// The weights of (16)-(19), relative to the Chamfer distance divided by the mean panel area: at the
/// weight 1 a functional with the value 1 costs as much as an outline error of one panel size. Every weight is 0 to
/// 1e9.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectiveConfig {
    /// w_cov of the Chamfer distance.
    pub coverage: f64,
    /// Weight of (17); needs `hinge = "surrogate"`.
    #[serde(default)]
    pub damage: f64,
    /// The damage measure of (17): `mean`, D as in the paper, or `peak`, D_peak, at which 1 means tearing.
    #[serde(default)]
    pub damage_measure: DamageMeasure,
    /// Weight of (18).
    #[serde(default)]
    pub compression: f64,
    /// Weight of (19).
    #[serde(default)]
    pub shear: f64,
    /// Temperatures tau of the smooth extrema along the path in (17)-(19), 1e-6 to 10, in the units of D / D_s, eta_a and
    /// eta_s: a tenth of typical values by default. A smaller one is closer to the extremum and less smooth.
    #[serde(default = "default_temperatures")]
    pub temperatures: PerFunctional,
    /// Weight of the panel shape penalty: on panels stretched more than eight to one or with angles below 14 degrees,
    /// which the outline alone does not prevent, and, with learned hinges, on corners of a panel closer than three
    /// radii of their windows. Never relative to a gradient.
    #[serde(default)]
    pub panel_shape: f64,
    /// No panel is thinner anywhere (mm), 0 to a third of the side of a square panel of the mean area: the minimum that
    /// the cutter accepts. Distances of corners from the edges of their panel are kept above it by a barrier, which
    /// begins at twice the value; use it with `method = "lbfgs"`, since Adam can get stuck at it. The panels of the
    /// start must be wider. 0 sets no limit.
    #[serde(default)]
    pub min_panel_width: f64,
    /// Weight of the penalty on states outside the training domain of the hinge law, in squared tenths of its range,
    /// as a mean over hinges and load steps. Needs `hinge = "surrogate"`. Never relative to a gradient.
    #[serde(default)]
    pub domain: f64,
    /// Whether the weights of (17)-(19) are instead relative to the gradient of the Chamfer distance at the
    /// start: at the weight 1 the gradient of a functional has the same norm.
    #[serde(default)]
    pub balance: bool,
    /// Temperature of the minima in the Chamfer distance (mm^2), 0 to 1e9; 0 is the hard minimum of the paper.
    #[serde(default)]
    pub smoothing: f64,
    /// What the distance of the outline is measured to: the `samples` of the target, as in the paper, or the
    /// `curve` through them.
    #[serde(default)]
    pub precision: Precision,
    /// The panel corners on the outline that are compared with the target: `free`, those that belong
    /// to no hinge, or `all`.
    #[serde(default)]
    pub outline: OutlinePoints,
    /// Number of points on the target outline, 1 to 1 000 000.
    pub target_points: usize,
}

/// The search of the outer loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OptimiserConfig {
    /// Number of steps after the start, 1 to 10 000 000.
    pub steps: usize,
    /// Length of the first step in every chart coordinate, 1e-9 to 10; for Adam also of the later steps.
    pub learning_rate: f64,
    /// `adam`, as in the paper, `lbfgs` or `gauss-newton`.
    #[serde(default)]
    pub method: SearchMethod,
    /// Standard deviation of the random start about the uniform sheet, in the chart coordinates, 0 to 10.
    #[serde(default)]
    pub start_noise: f64,
    /// Seed of the random start.
    #[serde(default)]
    pub seed: u64,
}

fn default_temperatures() -> PerFunctional {
    PerFunctional {
        damage: 0.1,
        compression: 0.01,
        shear: 0.01,
    }
}

fn default_load_steps() -> usize {
    10
}

impl SceneConfig {
    /// The scene as a TOML file, without comments.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Thickness of the sheet over that of the material file `material`.
    pub(super) fn scale(&self, material: &SheetMaterial) -> f64 {
        self.thickness
            .map_or(1.0, |thickness| thickness / material.thickness)
    }

    /// Whether there is a load: on panels, on edges or on hinges.
    pub fn has_loads(&self) -> bool {
        !(self.loads.is_empty() && self.edge_loads.is_empty() && self.opening_couples.is_empty())
    }

    /// Multiplies every load: on panels, on edges and on hinges.
    pub fn scale_loads(&mut self, factor: f64) {
        (self.loads.iter_mut()).for_each(|load| load.scale(factor));
        (self.edge_loads.iter_mut()).for_each(|load| load.scale(factor));
        (self.opening_couples.iter_mut()).for_each(|load| load.couple *= factor);
    }
}
