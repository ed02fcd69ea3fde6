//! A search at the level `final`: with finite elements for the hinges.

use crate::{
    progress::{announce, duration},
    solves::{Solves, task_error},
};
use anyhow::{Context, Result, ensure};
use scene::{
    Level, Scene, SceneConfig,
    design_run::{Designed, OnStep},
    run_inputs::{SCENE_FILE, holds_a_run},
};
use verification::{ElementWindows, final_design, most_cpu_seconds, verification_tier};

/// A search that goes on with the hinges solved by finite elements.
pub fn search_by_elements(scene: &Scene, solves: Solves, progress: OnStep) -> Result<Designed> {
    refuse_run_of_another_level(scene)?;
    let weights = scene.weights();
    let tier = verification_tier(None, weights.context(
        "the level `final` corrects a learned energy: give the scene weights (surrogate.weights)",
    )?)?;
    let service = &solves.service(&scene.output())?;
    let (hinges, workers) = (scene.topology.hinge_count(), solves.workers);
    let cpu = most_cpu_seconds(tier, &scene.material, hinges);
    announce(&format!(
        "{hinges} hinges on the mesh `{tier}`: at most about {} of CPU time, {} on {workers} processors; after Ctrl-C the same \
         command goes on",
        duration(cpu),
        duration(cpu / workers as f64)
    ));
    let found = final_design(scene, &ElementWindows { tier, service }, solves.stop, progress);
    found.map_err(task_error)
}

/// An error if the run folder holds a search at another level, which would be found out after all
/// solves.
fn refuse_run_of_another_level(scene: &Scene) -> Result<()> {
    let folder = scene.output();
    if holds_a_run(&folder) {
        let run: SceneConfig = support::toml_file::read(&folder.join(SCENE_FILE))?;
        ensure!(
            run.level == Level::Final,
            "{} holds a run at the level `{}`: choose another folder with --out, or restart it with --restart",
            folder.display(),
            run.level
        );
    }
    Ok(())
}
