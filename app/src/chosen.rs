//! The scene and the design that a command is about.

use anyhow::{Context, Result};
use design::pattern::design_vector::DesignVector;
use scene::{
    Scene,
    design_run::{design_of_run, stored_design},
    run_inputs::{STATE_FILE, scene_file},
};
use std::path::Path;

/// The name of the start design.
const START: &str = "start";

/// A scene, or the folder of a run, and a design of its sheet.
#[derive(Clone, Copy)]
pub struct Chosen<'a> {
    /// A scene file or the folder of a run.
    pub scene: &'a Path,
    /// A file with a design, or `start`; `None` for the design of the scene's run.
    pub design: Option<&'a Path>,
}

/// A design and its name for a person.
type NamedDesign = (DesignVector, String);

impl Chosen<'_> {
    /// The scene, a design of its sheet and the name of the design: without `--design` the design
    /// of the scene's run, or the start design if the scene has no run.
    pub fn read(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let (design, name) = match self.stored(&scene)? {
            Some(stored) => stored,
            None => self.start(&scene),
        };
        Ok((scene, design, name))
    }

    /// The same with a designed sheet: without `--design` it is an error if the scene has no run.
    pub fn read_run(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let (design, name) = self.stored(&scene)?.with_context(|| {
            format!(
                "the scene {} has no run, there is no state in {}: run `kirigami design` first, or name a design (--design)",
                self.scene.display(),
                scene.output().display()
            )
        })?;
        Ok((scene, design, name))
    }

    /// The design that `--design` names, or the design of the scene's run; `None` if the scene has
    /// no run.
    fn stored(&self, scene: &Scene) -> Result<Option<NamedDesign>> {
        Ok(match self.design {
            None => {
                let path = scene.output().join(STATE_FILE);
                design_of_run(scene)?.map(|design| (design, design_in(&path)))
            }
            Some(path) if path.as_os_str() == START => Some(self.start(scene)),
            Some(path) => Some((stored_design(path, scene)?, design_in(path))),
        })
    }

    /// The start design of the scene.
    fn start(&self, scene: &Scene) -> NamedDesign {
        let name = format!("start design of {}", self.scene.display());
        (scene.start(), name)
    }

    /// Whether the design that [`read`](Self::read) finds is the design of the scene's run.
    pub fn is_run(&self, scene: &Scene) -> bool {
        self.design.is_none() && scene.output().join(STATE_FILE).exists()
    }

    fn scene(&self) -> Result<Scene> {
        Ok(Scene::read(&scene_file(self.scene)?)?)
    }
}

fn design_in(path: &Path) -> String {
    format!("design {}", path.display())
}
