//! `kirigami-studies actuations`: one sheet, one target, five actuations; section 3.2.

mod actuations_page;
mod drive_readings;

use crate::designed::designed;
use crate::drawing::{ActuationRow, actuations};
use crate::shape_alone::shape_alone;
use anyhow::Result;
use clap::Args;
use design::analysis::force_transmission::ForceTransmission;
use design::analysis::tension_lines::{TensionLine, tension_lines};
use design::analysis::void_families::{VoidFamilies, disjoint_voids};
use design::objective::loss::Objective;
use design::objective::scores::outline_error;
use design::scene::design_run::Designed;
use design::scene::{Scene, SceneConfig};
use drive_readings::READINGS;
use kirigami::ui::progress::Progress;
use kirigami::ui::{picture, run_folder};
use std::path::{Path, PathBuf};

/// Design one sheet for one rectangle under five actuations, and compare the forces
///
/// The loads of the scenes actuation-1 to actuation-5 are scaled to the minimum with which the uniform sheet matches the
/// target, in several readings of the paper. The scenes are designed at these loads, with and without the objectives on
/// the hinge deformation, and the patterns and the forces within them are compared. Writes actuations.csv, actuations.md and a picture. A stopped run continues when it is started again.
/// Example: kirigami-studies actuations
#[derive(Args)]
pub struct ActuationStudy {
    /// Folder of the scenes
    #[arg(long, value_name = "FOLDER", default_value = "configs/scenes")]
    scenes: PathBuf,
    /// Folder for the tables, the picture and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-actuations")]
    out: PathBuf,
}

const LABELS: [&str; 5] = ["I", "II", "III", "IV", "V"];
/// Number of void families.
const FAMILIES: usize = 3;

/// One actuation with its design.
struct Case {
    label: &'static str,
    /// Drive in each reading (N).
    drives: Vec<f64>,
    scene: Scene,
    designed: Designed,
    /// Outline error of the design for the shape alone, relative to the target's width.
    shape_alone: f64,
    objective: Objective,
    transmission: ForceTransmission,
    lines: Vec<TensionLine>,
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
        let steps: usize = named
            .iter()
            .map(|(_, config, _)| config.optimiser.steps)
            .sum();
        let mut search = Search {
            out: std::path::absolute(&self.out)?,
            bar: Progress::new(2 * steps, "design steps"),
            done: 0,
        };
        let mut cases = Vec::new();
        for (i, (label, mut config, path)) in named.into_iter().enumerate() {
            let factors = READINGS
                .iter()
                .map(|reading| reading.least_factor(&config, &path))
                .collect::<Result<Vec<f64>>>()?;
            let drives = factors
                .iter()
                .map(|factor| factor * drive(&config))
                .collect();
            config.scale_loads(factors[0]);
            let (scene, designed) = search.design(label, &config, &path)?;
            let config = shape_alone(&config);
            let (alone, of_shape) = search.design(&format!("{label}-shape"), &config, &path)?;
            let of_shape = boundary_error(&alone, &of_shape);
            cases.push(Case::new(label, drives, scene, designed, of_shape)?);
            search.done = 2 * (i + 1) * steps / LABELS.len();
        }
        search.bar.finish();

        let voids = || cases.iter().flat_map(|case| &case.voids);
        let sides: Vec<[f64; 2]> = voids().map(|(_, sides)| *sides).collect();
        let families = VoidFamilies::new(&sides, FAMILIES);
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
        run_folder::write(&self.out, "actuations.csv", &actuations_page::csv(&cases))?;
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
    /// The design of a scene.
    fn design(
        &mut self,
        label: &str,
        config: &SceneConfig,
        path: &Path,
    ) -> Result<(Scene, Designed)> {
        let mut config = config.clone();
        config.output = self.out.join("runs").join(label);
        let scene = Scene::new(config, path)?;
        let designed = designed(&scene, &mut |step| {
            self.done += 1;
            let message = format!("case {label}: outline {:.1} mm", step.scores.outline_error);
            self.bar.show(self.done, None, &message);
        })?;
        Ok((scene, designed))
    }
}

/// Root mean square distance of the outline of the best design from the target, relative to the target's width.
fn boundary_error(scene: &Scene, designed: &Designed) -> f64 {
    outline_error(&designed.problem.objective, &designed.best.deployment) / scene.target.width()
}

/// The sum of the axial forces of a scene, or of all forces if there are no axial ones (N).
fn drive(config: &SceneConfig) -> f64 {
    let axial: f64 = config.loads.iter().map(|load| load.force[0].abs()).sum();
    let all = config
        .loads
        .iter()
        .map(|load| load.force[0].hypot(load.force[1]));
    if axial > 0.0 { axial } else { all.sum() }
}

impl Case {
    fn new(
        label: &'static str,
        drives: Vec<f64>,
        scene: Scene,
        designed: Designed,
        shape_alone: f64,
    ) -> Result<Self> {
        let problem = scene.problem()?;
        let deployment = &designed.best.deployment;
        let transmission = ForceTransmission::new(&problem, deployment)?;
        Ok(Self {
            label,
            drives,
            shape_alone,
            lines: tension_lines(&transmission),
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
            lines: &self.lines,
            families,
        }
    }
}
