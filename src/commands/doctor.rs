//! `kirigami doctor`: the build, and whether what it needs is found.

use anyhow::{Result, ensure};
use app::{WHOLE_BUILD, new_project::WEIGHTS};
use clap::Args;
#[cfg(feature = "pipeline")]
use fe_driver::CCX;
#[cfg(feature = "pipeline")]
use mesher::GMSH;
use std::{
    env::consts::{ARCH, OS},
    path::Path,
};
#[cfg(feature = "pipeline")]
use support::program::Tool;
use surrogate::Surrogate;

/// Print version and build, and check that what they need is found
///
/// Reads the shipped weights below the folder it is run in. The whole build also needs gmsh and
/// CalculiX, for the commands that solve windows; what is missing is named with how to install it.
#[derive(Args)]
pub struct DoctorCommand {}

impl DoctorCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let build = if WHOLE_BUILD { "the whole build" } else { "the build for design alone" };
        println!("kirigami {}, {build}, on {ARCH} {OS}", env!("CARGO_PKG_VERSION"));
        let shipped = WEIGHTS.iter().map(Path::new).filter(|weights| weights.is_file());
        let weights = shipped.map(|weights| match Surrogate::load(weights) {
            Ok(_) => (true, format!("weights {}", weights.display())),
            Err(error) => (false, format!("weights {error}")),
        });
        let weights: Vec<(bool, String)> = weights.collect();
        if weights.is_empty() {
            println!("weights none below this folder: run it in the folder of kirigami");
        }
        let found = [weights, solvers()].concat();
        found.iter().for_each(|(_, line)| println!("{line}"));
        let unusable = found.iter().filter(|(usable, _)| !usable).count();
        ensure!(unusable == 0, "{unusable} of what this build needs cannot be used");
        Ok(())
    }
}

/// The programs that solve windows: whether each can be used, and what is printed of it.
fn solvers() -> Vec<(bool, String)> {
    #[cfg(not(feature = "pipeline"))]
    return Vec::new();
    #[cfg(feature = "pipeline")]
    [&GMSH, &CCX]
        .map(|kind| match Tool::find(kind) {
            Ok(Tool { version, program, .. }) => {
                (true, format!("{:7} {version:8} {}", kind.name, program.display()))
            }
            Err(error) => (false, format!("{:7} {error}", kind.name)),
        })
        .into()
}
