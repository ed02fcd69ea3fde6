//! What commands measure of the design of a run, in the report and the page of the run.

use crate::{progress::announce, run_folder};
use analysis::design_checks::DesignChecks;
use anyhow::Result;
use design::pattern::design_vector::DesignVector;
use output::run_results::write_results;
use scene::{Scene, design_run::Designed};
use std::sync::{Arc, atomic::AtomicBool};

/// Adds a check of the design of a scene's run, and writes the results of the run again. Cut files
/// that are there stay, with the errors of the design in them.
pub fn record(
    scene: &Scene,
    design: &DesignVector,
    add: impl FnOnce(&mut DesignChecks),
) -> Result<()> {
    let folder = scene.output();
    let _held = run_folder::hold(&folder)?;
    let mut checks = DesignChecks::read(&folder, design)?;
    add(&mut checks);
    checks.write(&folder, design)?;
    let shown = folder.display();
    let cut = folder.join("cut.dxf").exists();
    match Designed::of_run(scene, Arc::new(AtomicBool::new(false))) {
        Ok(Some(designed)) => {
            // The pictures in pixels show the sheet, which is the same.
            write_results(scene, &designed, cut)?;
            announce(&format!("report and page of {shown} state it"));
        }
        Ok(None) => {}
        Err(error) => announce(&format!("report and page of {shown} do not state it: {error}")),
    }
    Ok(())
}
