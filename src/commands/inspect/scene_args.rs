//! The command line arguments that select a scene and a design, and the printing of their numbers.

use anyhow::{Context, Result};
use clap::Args;
use design::pattern::design_vector::DesignVector;
use design::scene::design_run::{design_of_run, stored_design};
use design::scene::run_inputs::{STATE_FILE, scene_file};
use design::scene::{Scene, SceneConfig};
use serde::Serialize;
use std::fmt::Display;
use std::path::PathBuf;
use support::toml_file;

/// Help of `--design` for commands that use [`Inspected::read_run`].
pub(crate) const DESIGN_OF_RUN: &str = "Design (JSON): the state.json of a run, or a design alone [default: the state.json of the scene's run folder]";

/// Help of `--design` for commands that use [`Inspected::read_judged`].
pub(crate) const DESIGN_TO_JUDGE: &str = "Design (JSON): the state.json of a run, or a design alone; `start` is the start design of the scene [default: the state.json of the scene's run folder, or the start design if the scene has no run]";

/// The value of `--design` that names no file, for commands that use [`Inspected::read_judged`].
const START: &str = "start";

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct Inspected {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material and weights
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Design (JSON): the state.json of a run, or a design alone [default: the start design of the scene, or
    /// the design of the run]
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
}

/// A scene and a design whose numbers are printed.
#[derive(Args)]
pub struct Listed {
    #[command(flatten)]
    inspected: Inspected,
    /// Print every number as JSON
    #[arg(long)]
    json: bool,
}

impl Inspected {
    /// A scene with the weights that it names.
    pub fn new(scene: PathBuf, design: Option<PathBuf>) -> Self {
        Self {
            scene,
            design,
            weights: None,
        }
    }

    pub(crate) fn read(&self) -> Result<(Scene, DesignVector)> {
        let scene = self.scene()?;
        let design = match &self.design {
            Some(path) => stored_design(path, &scene)?,
            None if self.scene.is_dir() => self.design_of_run(&scene)?,
            None => scene.start(),
        };
        Ok((scene, design))
    }

    /// The scene with its designed sheet: without `--design`, the state of its run folder.
    pub(crate) fn read_run(&self) -> Result<(Scene, DesignVector)> {
        let scene = self.scene()?;
        let design = match &self.design {
            Some(path) => stored_design(path, &scene)?,
            None => self.design_of_run(&scene)?,
        };
        Ok((scene, design))
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

    fn design_of_run(&self, scene: &Scene) -> Result<DesignVector> {
        design_of_run(scene, self.weights.is_some())?.with_context(|| {
            format!(
                "the scene {} has no run, there is no state in {}: run `kirigami design` first, or name a design (--design)",
                self.scene.display(),
                scene.output().display()
            )
        })
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

impl Listed {
    pub(crate) fn read(&self) -> Result<(Scene, DesignVector)> {
        self.inspected.read()
    }

    pub(crate) fn print(&self, listing: impl Serialize + Display) -> Result<()> {
        if self.json {
            println!("{}", serde_json::to_string_pretty(&listing)?);
        } else {
            print!("{listing}");
        }
        Ok(())
    }
}
