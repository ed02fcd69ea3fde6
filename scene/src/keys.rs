//! The keys of a scene file.

use crate::{
    actuation::{
        Attached, DriveConfig, EdgeLoadConfig, LoadConfig, OpeningCoupleConfig, SupportConfig, name,
    },
    cells::CellsConfig,
    cutting::CuttingConfig,
    hinge_model::{LinearConstants, PinConfig, SurrogateFile},
    level::Level,
    posture::PostureConfig,
    sheet_config::{LigamentConfig, SheetConfig, StartConfig},
    target::TargetShape,
    tolerances::ToleranceConfig,
};
use design::{
    equilibrium::settings::SolverSettings,
    objective::terms::ObjectiveConfig,
    optimise::search::SearchMethod,
    sheet::{cutting_process::CuttingProcess, topology::Topology},
};
use hinge::SheetMaterial;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::{
    path::{Component, Path, PathBuf},
    sync::Arc,
};
use support::Fault;

/// The keys of a scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneConfig {
    /// Title of the pictures.
    pub title: String,
    /// The TOML file of the sheet material, relative to the scene file. For a learned law, the file
    /// of the training.
    pub material: PathBuf,
    /// Thickness of the sheet (mm), instead of the material's: the same law in another thickness.
    /// Learned energies are converted exactly, by similarity: ligament widths and r_win scale with
    /// the thickness.
    #[schemars(range(min = 0.02, max = 10.0))]
    pub thickness: Option<f64>,
    /// How much of the hinges is modelled: `pin`, `linear`, `draft`, `standard` or `fine`.
    pub level: Level,
    /// N of the load steps zeta_i = i/N, where the path is read for pictures and path functionals.
    /// The solver chooses its own increments between them.
    #[schemars(range(min = 1, max = 10_000))]
    #[serde(default = "default_load_steps")]
    pub load_steps: usize,
    /// The run folder, relative to the scene file.
    pub output: PathBuf,
    /// The flat sheet.
    pub sheet: SheetConfig,
    /// The cells that are panels, and the shapes of those that are trimmed, as `init --target`
    /// writes them; by default every cell is a panel.
    pub cells: Option<CellsConfig>,
    /// The ligament widths.
    pub ligament: LigamentConfig,
    /// The start of the search; by default the uniform sheet.
    #[serde(default)]
    pub start: StartConfig,
    /// What is cut at a hinge, and its window.
    pub process: CuttingProcess,
    /// How the sheet is cut.
    #[serde(default)]
    pub cutting: CuttingConfig,
    /// Tolerances of the cut sheet.
    #[serde(default)]
    pub tolerances: ToleranceConfig,
    /// Read at the level `pin`.
    pub pin: Option<PinConfig>,
    /// Constants of (11); read at the level `linear`.
    pub linear: Option<LinearConstants>,
    /// Networks of the learned energy; read at the levels `draft`, `standard` and `fine`.
    pub surrogate: Option<SurrogateFile>,
    /// What keeps the panels in their plane; required with a learned energy.
    pub posture: Option<PostureConfig>,
    /// The supported panels; they must prevent the rigid motions of the sheet, except that a
    /// `hanging` sheet may swing about a single pin. Empty at the level `pin`.
    #[serde(default)]
    pub supports: Vec<SupportConfig>,
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
    /// Settings of the equilibrium solver: of code, not keys.
    #[serde(skip)]
    pub solver: SolverSettings,
    /// The target outline; it, or a box around it, must be 0.2 to 3 times as long as the outline of
    /// the flat sheet.
    pub target: TargetShape,
    /// The objective (16) and its weights.
    #[serde(default)]
    pub objective: ObjectiveConfig,
    /// The search of the outer loop.
    pub optimiser: OptimiserConfig,
}

/// The search of the outer loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OptimiserConfig {
    /// Number of steps after the start; 0 leaves the start as it is.
    #[schemars(range(min = 0, max = 10_000_000))]
    pub steps: usize,
    /// Length of the first step in every chart coordinate; for Adam also of the later steps.
    #[schemars(range(min = 1e-9, max = 10.0))]
    pub learning_rate: f64,
    /// `adam`, as in the paper, or `lbfgs`.
    #[serde(default)]
    pub method: SearchMethod,
    /// Standard deviation of the random start about the uniform sheet, in the chart coordinates.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 10.0))]
    pub start_noise: f64,
    /// Seed of the random start.
    #[serde(default)]
    pub seed: u64,
}

/// The folder of a scene file.
pub(super) fn folder(scene: &Path) -> &Path {
    scene.parent().unwrap_or(Path::new(""))
}

/// A path written relative to the scene file, without `.` inside, and without `..` after a folder
/// that is not a link.
pub(super) fn resolved(scene: &Path, path: &Path) -> PathBuf {
    let mut short = PathBuf::new();
    for part in folder(scene).join(path).components() {
        let named = short.file_name().is_some() && !short.is_symlink();
        if part == Component::ParentDir && named {
            short.pop();
        } else {
            short.push(part);
        }
    }
    short
}

fn default_load_steps() -> usize {
    10
}

impl SceneConfig {
    /// The panels and hinges of the sheet.
    pub(super) fn topology(&self) -> Result<Arc<Topology>, Fault> {
        let grid = self.sheet.grid();
        self.cells.as_ref().map_or(Ok(grid.into()), |cells| Ok(Arc::new(cells.topology(grid)?)))
    }

    /// The points at which supports and loads of single panels act, in that order.
    pub(super) fn attached(&self) -> impl Iterator<Item = Attached> {
        let supports = self.supports.iter().enumerate().map(|(i, of)| Attached {
            key: format!("supports[{i}]"),
            kind: name(of.kind),
            panel: of.panel,
            at: of.at,
            hole: of.hole,
            clip: of.clip,
        });
        let loads = self.loads.iter().enumerate().map(|(i, of)| Attached {
            key: format!("loads[{i}]"),
            kind: "load".to_owned(),
            panel: of.panel,
            at: of.at,
            hole: of.hole,
            clip: of.clip,
        });
        supports.chain(loads)
    }

    /// The scene as a TOML file, without comments.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Thickness of the sheet over the thickness of the material file `material`.
    pub(super) fn scale(&self, material: &SheetMaterial) -> f64 {
        self.thickness.map_or(1.0, |thickness| thickness / material.thickness)
    }

    /// Removes supports, loads and drive.
    pub fn clear_actuation(&mut self) {
        self.supports.clear();
        self.loads.clear();
        self.edge_loads.clear();
        self.opening_couples.clear();
        self.drive = None;
    }

    /// Whether there is a load: on panels, on edges or on hinges.
    pub fn has_loads(&self) -> bool {
        !(self.loads.is_empty() && self.edge_loads.is_empty() && self.opening_couples.is_empty())
    }
}
