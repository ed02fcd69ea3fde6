//! The design of a sheet that finite elements judge.

use crate::commands::inspect::scene_args::{Inspected, START};
use anyhow::Result;
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use design::scene::design_run::{design_of_run, stored_design};
use design::scene::run_inputs::STATE_FILE;
use std::path::PathBuf;

/// Help of `--design`.
pub(crate) const DESIGN_TO_JUDGE: &str = "Design (JSON): the state.json of a run, or a design alone; `start` is the start design of the scene [default: the state.json of the scene's run folder, or the start design if the scene has no run]";

impl Inspected {
    /// A scene with the weights that it names.
    pub(crate) fn new(scene: PathBuf, design: Option<PathBuf>) -> Self {
        Self {
            scene,
            design,
            weights: None,
        }
    }

    /// The scene, the design that finite elements judge, and its name for a person. Without `--design` it is that of the
    /// scene's run, or the start design if there is no run.
    pub(crate) fn read_judged(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let stored = match &self.design {
            Some(path) if path.as_os_str() == START => None,
            Some(path) => Some((stored_design(path, &scene)?, path.clone())),
            None => design_of_run(&scene, self.weights.is_some())?
                .map(|design| (design, scene.output().join(STATE_FILE))),
        };
        let (design, name) = match stored {
            Some((design, path)) => (design, format!("design {}", path.display())),
            None => {
                let scene_file = self.scene.display();
                (scene.start(), format!("start design of {scene_file}"))
            }
        };
        Ok((scene, design, name))
    }
}
