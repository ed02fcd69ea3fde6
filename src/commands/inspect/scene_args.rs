//! The command line arguments that select a scene and a design, and the printing of their numbers.

use anyhow::{Context, Result};
use clap::Args;
use design::pattern::design_vector::DesignVector;
use design::scene::design_run::{design_of_run, stored_design};
use design::scene::run_inputs::scene_file;
use design::scene::{Scene, SceneConfig};
use serde::Serialize;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use support::toml_file;

/// Help of `--design` for commands that use [`Inspected::read_run`].
pub(crate) const DESIGN_OF_RUN: &str = "Design (JSON): the state.json of a run, or a design alone; `start` is the start design of the scene [default: the state.json of the scene's run folder]";

/// The value of `--design` that names no file.
pub(super) const START: &str = "start";

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct Inspected {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material and weights
    #[arg(value_name = "SCENE")]
    pub(super) scene: PathBuf,
    /// Design (JSON): the state.json of a run, or a design alone; `start` is the start design [default: the start design of the scene, or
    /// the design of the run]
    #[arg(long, value_name = "FILE")]
    pub(super) design: Option<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    pub(super) weights: Option<PathBuf>,
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

/// A listing with the design that it is of.
#[derive(Serialize)]
struct Of<T> {
    design: String,
    #[serde(flatten)]
    listing: T,
}

impl Inspected {
    /// Which design [`Inspected::read`] returns.
    fn which(&self) -> String {
        let scene = self.scene.display();
        match &self.design {
            Some(path) if path.as_os_str() == START => format!("the start design of {scene}"),
            Some(path) => format!("the design in {}", path.display()),
            None if self.scene.is_dir() => format!("the best design of the run {scene}"),
            None => format!(
                "the start design of {scene}; for that of its run name the run folder, or --design"
            ),
        }
    }

    /// Which design [`Inspected::read_run`] returns.
    pub(crate) fn which_of_run(&self) -> String {
        match &self.design {
            None => "the best design of the run".to_owned(),
            Some(_) => self.which(),
        }
    }

    pub(crate) fn read(&self) -> Result<(Scene, DesignVector)> {
        let scene = self.scene()?;
        let design = match &self.design {
            Some(path) => named_design(path, &scene)?,
            None if self.scene.is_dir() => self.design_of_run(&scene)?,
            None => scene.start(),
        };
        Ok((scene, design))
    }

    /// The scene with its designed sheet: without `--design`, the state of its run folder.
    pub(crate) fn read_run(&self) -> Result<(Scene, DesignVector)> {
        let scene = self.scene()?;
        let design = match &self.design {
            Some(path) => named_design(path, &scene)?,
            None => self.design_of_run(&scene)?,
        };
        Ok((scene, design))
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

    pub(super) fn scene(&self) -> Result<Scene> {
        let path = scene_file(&self.scene)?;
        let mut config: SceneConfig = toml_file::read(&path)?;
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        Ok(Scene::new(config, &path)?)
    }
}

/// The design of a file, or the start design of the scene.
fn named_design(path: &Path, scene: &Scene) -> Result<DesignVector> {
    if path.as_os_str() == START {
        return Ok(scene.start());
    }
    Ok(stored_design(path, scene)?)
}

impl Listed {
    pub(crate) fn read(&self) -> Result<(Scene, DesignVector)> {
        self.inspected.read()
    }

    pub(crate) fn print(&self, listing: impl Serialize + Display) -> Result<()> {
        let design = self.inspected.which();
        if self.json {
            let of = Of { design, listing };
            println!("{}", serde_json::to_string_pretty(&of)?);
        } else {
            print!("{design}\n\n{listing}");
        }
        Ok(())
    }
}
