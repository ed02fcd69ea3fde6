//! The scene and the design that finite elements judge.

use anyhow::Result;
use clap::Args;
use design::pattern::design_vector::DesignVector;
use design::scene::design_run::stored_design;
use design::scene::run_inputs::{STATE_FILE, scene_file};
use design::scene::{Scene, SceneConfig};
use std::path::PathBuf;
use support::toml_file;

/// Help of `--design`.
pub(crate) const DESIGN: &str = "Design (JSON): the state.json of a run, or a design alone; `start` is the start design of the scene [default: the state.json of the scene's run folder, or the start design if the scene has no run]";

/// The value of `--design` that names no file.
const START: &str = "start";

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct JudgedDesign {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material and weights
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    #[arg(long, value_name = "FILE", help = DESIGN)]
    pub(crate) design: Option<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
}

impl JudgedDesign {
    /// The scene, the design, and its name for a person.
    pub(crate) fn read(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let path = match &self.design {
            Some(path) => (path.as_os_str() != START).then(|| path.clone()),
            None => Some(scene.output().join(STATE_FILE)).filter(|path| path.exists()),
        };
        let (design, name) = match path {
            Some(path) => (
                stored_design(&path, &scene)?,
                format!("design {}", path.display()),
            ),
            None => (
                scene.start(),
                format!("start design of {}", self.scene.display()),
            ),
        };
        Ok((scene, design, name))
    }

    fn scene(&self) -> Result<Scene> {
        let path = scene_file(&self.scene)?;
        let mut config: SceneConfig = toml_file::read(&path)?;
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        Ok(Scene::new(config, &path)?)
    }
}
