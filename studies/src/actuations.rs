//! `kirigami-studies actuations`: one sheet, one target, five actuations; section 3.2.

mod actuations_page;

use crate::designed::designed;
use crate::drawing::{ActuationRow, actuations};
use anyhow::{Context, Result};
use clap::Args;
use design::analysis::force_transmission::ForceTransmission;
use design::analysis::tension_routes::{TensionRoute, tension_routes};
use design::analysis::threshold::least_passing;
use design::analysis::void_families::{VoidFamilies, disjoint_voids};
use design::objective::loss::Objective;
use design::objective::outline_error::outline_error;
use design::scene::design_run::Designed;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::{picture, run_folder};
use std::path::{Path, PathBuf};

/// Design one sheet for one rectangle under five actuations, and compare the forces
///
/// Designs the scenes actuation-1 to actuation-5 and compares the patterns and the forces within them.
/// Writes actuations.csv, actuations.md and a picture. A stopped run continues when it is started again.
/// Example: kirigami-studies actuations
#[derive(Args)]
pub struct ActuationStudy {
    /// Folder of the scenes
    #[arg(long, value_name = "FOLDER", default_value = "configs/scenes")]
    scenes: PathBuf,
    /// Replace the load of each scene by the minimum load with which a design reaches the target
    #[arg(long)]
    tune: bool,
    /// Folder for the tables, the picture and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-actuations")]
    out: PathBuf,
}

const LABELS: [&str; 5] = ["I", "II", "III", "IV", "V"];
/// A design reaches its target if its outline error (root mean square), relative to the target's width, is at
/// most this: the value of the paper's designs.
const REACHED: f64 = 0.012;
/// Relative accuracy of the minimum load.
const RESOLUTION: f64 = 0.04;
/// Expected number of designs of one tuning, for the estimate of the time left.
const TRIALS: usize = 6;
/// Number of void families.
const FAMILIES: usize = 3;

/// One actuation with its design.
struct Case {
    label: &'static str,
    scene: Scene,
    designed: Designed,
    objective: Objective,
    transmission: ForceTransmission,
    routes: Vec<TensionRoute>,
    /// Vertices and sides of the voids of disjoint unit cells.
    voids: Vec<([usize; 2], [f64; 2])>,
}

impl ActuationStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let paths = (1..).map(|i| self.scenes.join(format!("actuation-{i}.toml")));
        let named: Vec<_> = std::iter::zip(LABELS, paths)
            .map(|(label, path)| Ok((label, support::toml_file::read::<SceneConfig>(&path)?, path)))
            .collect::<Result<_>>()?;
        let trials = if self.tune { TRIALS } else { 1 };
        let steps: usize = named
            .iter()
            .map(|(_, config, _)| config.optimiser.steps)
            .sum();
        let mut search = Search {
            out: std::path::absolute(&self.out)?,
            bar: Progress::new(trials * steps, "design steps"),
            done: 0,
        };
        let mut cases = Vec::new();
        for (i, (label, config, path)) in named.into_iter().enumerate() {
            let factor = if self.tune {
                search.least_load(label, &config, &path)?
            } else {
                1.0
            };
            let (scene, designed) = search.design(label, &config, factor, &path)?;
            cases.push(Case::new(label, scene, designed)?);
            search.done = (i + 1) * trials * steps / LABELS.len();
        }
        search.bar.finish();

        let voids = || cases.iter().flat_map(|case| &case.voids);
        let sides: Vec<[f64; 2]> = voids().map(|(_, sides)| *sides).collect();
        let families = VoidFamilies::of(&sides, FAMILIES);
        let mut family = voids()
            .zip(&families.family)
            .map(|((cell, _), f)| (*cell, *f));
        let cells: Vec<Vec<_>> = cases
            .iter()
            .map(|case| family.by_ref().take(case.voids.len()).collect())
            .collect();
        let rows: Vec<ActuationRow> = std::iter::zip(&cases, &cells)
            .map(|(case, families)| case.row(families))
            .collect();
        picture::save(&actuations(&rows), &self.out.join("actuations"), 2400)?;
        run_folder::write(&self.out, "actuations.csv", &actuations_page::csv(&cases)?)?;
        let page = actuations_page::page(&cases, &families, &self.scenes)?;
        run_folder::write(&self.out, "actuations.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// Designs scenes in separate run folders.
struct Search {
    out: PathBuf,
    bar: Progress,
    /// Design steps made so far.
    done: usize,
}

impl Search {
    /// The minimum factor on the loads of a scene for which its design reaches the target.
    fn least_load(&mut self, label: &str, config: &SceneConfig, path: &Path) -> Result<f64> {
        let factor = least_passing(1.0, RESOLUTION, |factor| {
            let (scene, designed) = self.design(label, config, factor, path)?;
            Ok::<_, anyhow::Error>(boundary_error(&scene, &designed) <= REACHED)
        })?;
        factor.with_context(|| {
            format!("case {label}: no load factor found for which the design reaches its target")
        })
    }

    /// The design under `factor` times the scene's loads.
    fn design(
        &mut self,
        label: &str,
        config: &SceneConfig,
        factor: f64,
        path: &Path,
    ) -> Result<(Scene, Designed)> {
        let mut config = config.clone();
        config.scale_loads(factor);
        config.output = self.out.join(format!("runs/{label}-{factor:.4}"));
        let scene = Scene::new(config, path)?;
        let designed = designed(&scene, &mut |step| {
            self.done += 1;
            let message = format!(
                "case {label}, load x {factor:.3}: outline {:.1} mm",
                step.scores.outline_error
            );
            self.bar.show(self.done, None, &message);
        })?;
        Ok((scene, designed))
    }
}

/// Root mean square distance of the outline of the best design from the target, relative to the target's width.
fn boundary_error(scene: &Scene, designed: &Designed) -> f64 {
    outline_error(&designed.problem.objective, &designed.best.deployment) / scene.target.width()
}

impl Case {
    fn new(label: &'static str, scene: Scene, designed: Designed) -> Result<Self> {
        let problem = scene.problem()?;
        let deployment = &designed.best.deployment;
        let transmission = ForceTransmission::new(&problem, deployment)?;
        Ok(Self {
            label,
            routes: tension_routes(&transmission),
            voids: disjoint_voids(&deployment.pattern),
            objective: problem.objective,
            transmission,
            scene,
            designed,
        })
    }

    fn row<'a>(&'a self, families: &'a [([usize; 2], usize)]) -> ActuationRow<'a> {
        ActuationRow {
            label: self.label,
            scene: &self.scene,
            start: &self.designed.start.deployment.sheet,
            deployment: &self.designed.best.deployment,
            transmission: &self.transmission,
            routes: &self.routes,
            families,
        }
    }
}
