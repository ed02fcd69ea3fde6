//! The command line arguments that select a scene and a design.

use app::chosen::Chosen;
use clap::Args;
use std::path::PathBuf;

/// A scene and a design of its sheet.
#[derive(Args)]
pub struct Inspected {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material
    /// and weights
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Design (JSON): the state.json of a run, or a design alone; `start` is the start design of
    /// the scene [default: the design of the scene's run]
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
}

impl Inspected {
    pub(crate) fn chosen(&self) -> Chosen<'_> {
        Chosen { scene: &self.scene, design: self.design.as_deref() }
    }
}
