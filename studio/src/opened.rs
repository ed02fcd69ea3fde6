//! The sheet that is open: its scene, what was before it, and its runs.

use crate::project::Project;
use analysis::fit::scene::{FittedScene, cropped, fitted};
use anyhow::Result;
use app::{cut::Verdict, fitting::expected, own_drawing::OwnDrawing};
use design::{equilibrium::warm_start::WarmStart, optimise::outer_loop::Ended};
use scene::{Scene, SceneConfig, target::TargetShape};
use serde_json::{Value, json};
use std::{collections::BTreeMap, path::PathBuf};

/// An opened sheet.
pub(crate) struct Opened {
    pub project: Project,
    /// The scene that is shown; its start is the sheet.
    pub scene: Scene,
    /// The keys on disk, those before and after them.
    pub on_disk: SceneConfig,
    pub before: Vec<SceneConfig>,
    pub after: Vec<SceneConfig>,
    /// The page that made the last change, and the number of its changes; `None` if no page did, as
    /// after an undo.
    pub by: Option<(String, u64)>,
    /// The keys before the sheet was fitted to a drawing: their sheet is the space for another fit.
    pub space: Option<SceneConfig>,
    /// The last equilibrium, from which a draft starts.
    pub known: Option<WarmStart>,
    /// The runs, each in a folder of its own.
    pub runs: Vec<OpenedRun>,
}

/// A run whose best design is shown while the scene has the keys `adopted`.
pub(crate) struct OpenedRun {
    pub scene: Scene,
    pub adopted: SceneConfig,
    pub ended: Ended,
    /// What services say of the files of a machine, by its name.
    pub verdicts: BTreeMap<String, Vec<Verdict>>,
}

impl Opened {
    /// The last equilibrium, if a scene's may be near it: of the same sheet with the same
    /// supports.
    pub(crate) fn known_near(&self, scene: &Scene) -> Option<&WarmStart> {
        let held = |scene: &Scene| (scene.config.sheet, scene.config.supports.clone());
        self.known.as_ref().filter(|_| held(scene) == held(&self.scene))
    }

    /// The scene with a run folder of its own.
    pub(crate) fn scene_of_run(&self) -> Result<Scene> {
        let config = SceneConfig { output: self.project.next_run(), ..self.scene.config.clone() };
        Ok(self.scene.changed(config)?)
    }

    /// The run whose best design is shown.
    pub(crate) fn run(&self) -> Option<&OpenedRun> {
        let mut runs = self.runs.iter();
        runs.find(|run| run.adopted == self.scene.config)
    }

    pub(crate) fn run_mut(&mut self) -> Option<&mut OpenedRun> {
        let mut runs = self.runs.iter_mut();
        runs.find(|run| run.adopted == self.scene.config)
    }
}

impl OpenedRun {
    pub(crate) fn new(scene: Scene, adopted: SceneConfig, ended: Ended) -> Self {
        Self { scene, adopted, ended, verdicts: BTreeMap::new() }
    }
}

/// A sheet in a space that is fitted to a drawing, which the scene names; its panels have a side
/// (mm), or else the smallest one. Also what is said of it.
pub(crate) fn fitted_to(
    scene: &Scene,
    space: Option<&SceneConfig>,
    drawing: &OwnDrawing,
    file: PathBuf,
    side: Option<f64>,
) -> Result<(Scene, Value)> {
    let target = &scene.target;
    let (centre, height) = drawing.placed(target.mean(), target.area())?;
    let target = TargetShape::Svg { file, centre, height: Some(height), rotation_deg: 0.0 };
    let drawn = SceneConfig { target, ..scene.config.clone() };
    let drawn = scene.changed(in_space(drawn, space))?;
    let (scene, mut says) = told(&drawn, fitted(&drawn, side)?)?;
    says["threshold"] = json!(drawing.threshold());
    Ok((scene, says))
}

/// A scene with the sheet that was fitted to it, and what is said of it.
pub(crate) fn told(scene: &Scene, fit: FittedScene) -> Result<(Scene, Value)> {
    let says = expected(&fit, scene.material.thickness);
    let scene = scene.changed(fit.config)?;
    let says = json!({
        "target": scene.config.target,
        "says": says,
        "panels": fit.panels,
        "side": fit.side,
        "smallest": fit.smallest,
    });
    Ok((scene, says))
}

/// The keys before the sheet was fitted to a drawing, from a space, if one is known.
fn in_space(config: SceneConfig, space: Option<&SceneConfig>) -> SceneConfig {
    let Some(space) = space.cloned() else { return config };
    SceneConfig {
        sheet: space.sheet,
        cells: space.cells,
        start: space.start,
        posture: space.posture,
        supports: space.supports,
        loads: space.loads,
        drive: space.drive,
        ..config
    }
}

impl Opened {
    /// What panels with another side (mm) show of its target.
    pub(crate) fn cropped(&self, side: f64) -> Result<Value> {
        let uncut = in_space(self.scene.config.clone(), self.space.as_ref());
        let (panels, seen) = cropped(&self.scene.changed(uncut)?, side)?;
        Ok(json!({ "panels": panels, "seen": seen }))
    }
}
