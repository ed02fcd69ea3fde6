//! The scene: all input of a design run, read from one TOML file.
//!
//! A scene names its level, and only the hinge law of that level is loaded: `level = "linear"`
//! reads no weights. Paths are relative to the scene file. The admissible values stand with their
//! keys. [`Scene::read`] reads a scene and [`Scene::problem`] makes it a design problem;
//! [`design_run`] searches and keeps its run folder; the outlines of drawings are in [`drawing`].
//!
//! ```
//! use scene::Scene;
//! use std::path::Path;
//!
//! # let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
//! let scene = Scene::read(&scenes.join("pin-7x7.toml"))?;
//! let (problem, start) = (scene.problem()?, scene.start());
//! assert!(problem.loss(&start)?.is_finite());
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod actuation;
mod boundary_values;
mod cells;
mod checked_scene;
mod checks;
mod coarse_search;
mod cutting;
pub mod design_run;
pub mod drawing;
mod drawn_target;

mod hinge_model;
mod keys;
mod level;
mod loaded_hinge;
mod other_level;
pub mod placement;
mod posture;
mod problem;
mod rounding;
pub mod run_inputs;
mod sheet_config;
mod solved_hinges;
mod springback_file;
mod stock;
pub mod target;
mod tolerances;
mod weights_files;

pub use actuation::{
    At, DriveConfig, EdgeLoadConfig, LoadConfig, NamedPoint, OpeningCoupleConfig, SheetEdge,
    SupportConfig, SupportKind,
};
pub use boundary_values::{Actuation, AppliedLoad, SupportedPanel, panel_name};
pub use cells::{CellsConfig, TrimmedPanel};
pub use checked_scene::{FILLS_HOLES, Scene};
pub use checks::ON_EDGE;
pub use coarse_search::{CoarseSearch, LevelDifference};
pub use cutting::CuttingConfig;
pub use design::objective::terms::ObjectiveConfig;
pub use hinge_model::{LinearConstants, PinConfig, SurrogateFile};
pub use keys::{OptimiserConfig, SceneConfig};
pub use level::Level;
pub use loaded_hinge::LoadedHinge;
pub use posture::{FRICTION, Posture, PostureConfig};
pub use rounding::{rounded, short};
pub use sheet_config::{LigamentConfig, SheetConfig, StartConfig};
pub use solved_hinges::{SolvedHinge, SolvedHinges};
pub use stock::{Paper, Stock};
pub use target::TargetShape;
pub use tolerances::ToleranceConfig;
