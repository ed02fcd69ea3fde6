//! What the commands that inspect a scene share: its design, and how their numbers are printed.

use anyhow::Result;
use clap::Args;
use design::design_vector::DesignVector;
use design::inverse_design::stored_design;
use design::scene::Scene;
use serde::Serialize;
use std::fmt::Display;
use std::path::PathBuf;

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct Inspected {
    /// Scene (TOML); see configs/scenes
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Design (JSON): the state.json of a run, or a design alone; by default the scene's start
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
}

/// A design whose numbers are listed.
#[derive(Args)]
pub struct Listed {
    #[command(flatten)]
    inspected: Inspected,
    /// Print every number as JSON
    #[arg(long)]
    json: bool,
}

impl Inspected {
    pub fn new(scene: PathBuf, design: Option<PathBuf>) -> Self {
        Self { scene, design }
    }

    pub fn read(&self) -> Result<(Scene, DesignVector)> {
        let scene = Scene::read(&self.scene)?;
        let design = match &self.design {
            Some(path) => stored_design(path, &scene)?,
            None => scene.start(),
        };
        Ok((scene, design))
    }
}

impl Listed {
    pub fn read(&self) -> Result<(Scene, DesignVector)> {
        self.inspected.read()
    }

    pub fn print(&self, listing: impl Serialize + Display) -> Result<()> {
        if self.json {
            println!("{}", serde_json::to_string_pretty(&listing)?);
        } else {
            print!("{listing}");
        }
        Ok(())
    }
}
