//! The design of a sheet that finite elements judge.

use crate::commands::inspect::scene_args::Inspected;
use anyhow::Result;
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
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
        let named = match self.named(&scene)? {
            Some(named) => Some(named),
            None => self.run(&scene)?,
        };
        let (design, name) = named.unwrap_or_else(|| self.start(&scene));
        Ok((scene, design, name))
    }
}
