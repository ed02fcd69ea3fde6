//! The command line arguments that select a scene and a design, and the printing of their numbers.

use anyhow::{Context, Result};
use clap::Args;
use design::pattern::design_vector::DesignVector;
use design::scene::design_run::{design_of_run, stored_design};
use design::scene::run_inputs::{STATE_FILE, scene_file};
use design::scene::{Scene, SceneConfig};
use serde::Serialize;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use support::toml_file;

/// Help of `--design` for commands that use [`Inspected::read_run`].
pub(crate) const DESIGN_OF_RUN: &str = "Design (JSON): the state.json of a run, or a design alone; `start` is the start design of the scene [default: the state.json of the scene's run folder]";

/// The value of `--design` that names no file.
const START: &str = "start";

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct Inspected {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material and weights
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// Design (JSON): the state.json of a run, or a design alone; `start` is the start design [default: the start design of the scene, or
    /// the design of the run]
    #[arg(long, value_name = "FILE")]
    pub(crate) design: Option<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
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

/// A design and its name for a person.
type Named = (DesignVector, String);

impl Inspected {
    /// The scene, a design of its sheet and the name of the design: without `--design` that of the run folder that stands for the
    /// scene, or else the start design.
    pub(crate) fn read(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let (design, name) = match self.named(&scene)? {
            Some(named) => named,
            None if self.scene.is_dir() => self.needed_run(&scene)?,
            None => {
                let (design, name) = self.start(&scene);
                let hint = "for that of its run name the run folder, or --design";
                (design, format!("{name}; {hint}"))
            }
        };
        Ok((scene, design, name))
    }

    /// The same with the designed sheet: without `--design`, the state of its run folder.
    pub(crate) fn read_run(&self) -> Result<(Scene, DesignVector, String)> {
        let scene = self.scene()?;
        let named = self.named(&scene)?;
        let (design, name) = named.map_or_else(|| self.needed_run(&scene), Ok)?;
        Ok((scene, design, name))
    }

    /// The design that `--design` names.
    pub(super) fn named(&self, scene: &Scene) -> Result<Option<Named>> {
        Ok(match &self.design {
            None => None,
            Some(path) if path.as_os_str() == START => Some(self.start(scene)),
            Some(path) => Some((stored_design(path, scene)?, design_in(path))),
        })
    }

    /// The start design of the scene.
    pub(super) fn start(&self, scene: &Scene) -> Named {
        let name = format!("start design of {}", self.scene.display());
        (scene.start(), name)
    }

    /// The design of the scene's run; `None` if it has no run.
    pub(super) fn run(&self, scene: &Scene) -> Result<Option<Named>> {
        let design = design_of_run(scene, self.weights.is_some())?;
        Ok(design.map(|design| (design, design_in(&scene.output().join(STATE_FILE)))))
    }

    fn needed_run(&self, scene: &Scene) -> Result<Named> {
        self.run(scene)?.with_context(|| {
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

fn design_in(path: &Path) -> String {
    format!("design {}", path.display())
}

impl Listed {
    pub(crate) fn read(&self) -> Result<(Scene, DesignVector, String)> {
        self.inspected.read()
    }

    /// Prints the numbers of the design with this name.
    pub(crate) fn print(&self, design: String, listing: impl Serialize + Display) -> Result<()> {
        if self.json {
            let of = Of { design, listing };
            println!("{}", serde_json::to_string_pretty(&of)?);
        } else {
            print!("{design}\n\n{listing}");
        }
        Ok(())
    }
}
