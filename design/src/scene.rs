//! The scene: all input of a design run, read from one TOML file.
//!
//! A scene names its level, and only the hinge law of that level is loaded: `level = "linear"` reads no
//! weights. Paths are relative to the scene file. The admissible values stand with their keys.

mod actuation;
mod boundary_values;
mod checked_scene;
mod checks;
mod cutting;
pub mod design_run;
mod drawn_target;
mod hinge_model;
mod invalid_scene;
mod keys;
mod level;
mod loaded_hinge;
mod other_level;
pub mod placement;
mod posture;
mod problem;
pub mod run_inputs;
mod rung;
mod scene_error;
mod sheet_config;
mod solved_hinges;
mod springback_file;
mod stock;
mod tolerances;
mod weights_files;

pub use crate::objective::target::TargetShape;
pub use crate::objective::terms::ObjectiveConfig;
pub use actuation::{
    At, DriveConfig, EdgeLoadConfig, LoadConfig, NamedPoint, OpeningCoupleConfig, SheetEdge,
    SupportConfig, SupportKind,
};
pub use boundary_values::{Actuation, AppliedLoad, SupportedPanel, panel_name};
pub use checked_scene::Scene;
pub use cutting::CuttingConfig;
pub use drawn_target::{place_drawing, rounded};
pub use hinge_model::{LinearConstants, PinConfig, SurrogateFile};
pub use invalid_scene::{InvalidScene, WeightsMismatch};
pub use keys::{OptimiserConfig, SceneConfig};
pub use level::Level;
pub use loaded_hinge::LoadedHinge;
pub use posture::{FRICTION, Posture, PostureConfig};
pub use rung::{LevelDifference, Rung};
pub use scene_error::SceneError;
pub use sheet_config::{LigamentConfig, SheetConfig, StartConfig};
pub use solved_hinges::{SolvedHinge, SolvedHinges, SolvedHingesError};
pub use springback_file::{SpringbackFileError, SpringbackMismatch};
pub use stock::{Paper, Stock};
pub use tolerances::ToleranceConfig;
pub(crate) use tolerances::standard_deviation;
