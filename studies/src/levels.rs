//! `kirigami-studies levels`: cost and error of every choice of a scene, judged by finite elements for all hinges.
//!
//! The design of the scene is deployed with finite elements for its hinges (`kirigami verify --equilibrium`) and with each
//! choice. *Effect* is the movement of the panel corners from the scene as it is, *error* that from the finite elements:
//! a choice whose effect is far below the error costs no accuracy.

mod searches;

use crate::choices::{Choice, Choices, own_weights, step_seconds};
use crate::designed::designed;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::scene::{HingeModel, Scene, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::run_folder;
use mesher::Tier;
use std::path::{Path, PathBuf};
use support::statistics::root_mean_square;
use support::table::{Cell, Table};
use verification::{Balanced, ElementWindows, balanced, movements, size};

/// Measure cost and error of the levels draft, everyday and final, and of every choice, on designed sheets
///
/// The sheet of each scene is designed, and balanced with finite elements for its hinges; each choice is
/// compared with that. Writes levels.md and tradeoff.md. Example:
/// kirigami-studies levels configs/scenes/a4-polyester.toml --networks data/pet-0.5mm/small.safetensors
#[derive(Args)]
pub struct LevelsStudy {
    /// Scenes (TOML) with the learned hinge law
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Further weights of the material; the first are those of the level draft
    #[arg(long, value_name = "WEIGHTS", num_args = 1.., required = true)]
    networks: Vec<PathBuf>,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value = "default")]
    tier: Tier,
    /// Maximum number of times that all hinges of a sheet are solved on the mesh of --tier; before `reference` the sheet is
    /// balanced on `default`
    #[arg(long, value_name = "N", default_value_t = 3)]
    rounds: usize,
    /// Also search at each level from N random starts, and judge all designs by the last of the networks
    #[arg(long, value_name = "N", default_value_t = 0)]
    starts: u64,
    #[command(flatten)]
    solve: SolveArgs,
    /// Folder for the tables, the designs and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-levels")]
    out: PathBuf,
}

/// Kinds of choices: networks and other levels, with which designs are searched, and those that are compared on one design alone.
const NETWORK: &str = "network";
const LEVEL: &str = "level";
const COMPARED: &str = "compared";

/// Load steps and tolerance of the level draft.
const DRAFT: (usize, f64) = (5, 1e-3);

/// A choice on one sheet.
struct Row {
    choice: String,
    /// CPU time of one design step, equilibrium and gradient (s).
    step_s: f64,
    /// Root mean square movement of the panel corners from the scene as it is, and from finite elements of each mesh, the finest
    /// one last (mm).
    effect: f64,
    errors: Vec<f64>,
    /// The last relative to the diagonal of the deployed sheet.
    relative: f64,
    /// Root mean square error of the rotations of the hinges (deg).
    rotation_deg: f64,
}

impl LevelsStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let mut page = String::new();
        for path in &self.scenes {
            page += &self.sheet(path)?;
        }
        run_folder::write(
            &self.out,
            "levels.md",
            &format!("# Draft, everyday, final\n\n{page}"),
        )?;
        run_folder::write(
            &self.out,
            "tradeoff.md",
            &format!("## Levels of a design\n\n{page}"),
        )?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    /// The table of one scene.
    fn sheet(&self, path: &Path) -> Result<String> {
        let base: SceneConfig = support::toml_file::read(path)?;
        ensure!(
            base.hinge == HingeModel::Surrogate,
            "{}: the study needs the learned hinge law: set hinge = \"surrogate\"",
            path.display()
        );
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.join(&*name);
        let scene = |mut config: SceneConfig, run: &str| -> Result<Scene> {
            config.output = std::path::absolute(folder.join(run))?;
            Ok(Scene::new(config, path)?)
        };
        let own = scene(base.clone(), "design")?;
        let design = designed(&own, &mut |_| ())?.design;
        let windows = ElementWindows {
            tier: self.tier,
            service: &self.solve.service(&folder)?,
        };
        let truth = balanced(&own, &design, &windows, self.rounds);
        let (truth, _) = truth.map_err(task_error)?;
        let mut rows = Vec::new();
        let choices = self.choices(&base, path)?;
        for choice in &choices {
            let problem = scene(choice.config.clone(), "design")?.problem()?;
            let row = Row::new(choice.name.clone(), &problem, &design, &truth);
            rows.push(row.with_context(|| format!("{name}, {}", choice.name))?);
        }
        let mut text = section(&own.config.title, &truth, &rows);
        if self.starts > 0 {
            let last = choices.iter().rfind(|choice| choice.kind == NETWORK);
            let judge = last.context("no network judges the designs")?;
            let by_judge = scene(judge.config.clone(), "judge")?.problem()?;
            let levels: Vec<Choice> = (choices.iter())
                .filter(|choice| choice.kind != COMPARED)
                .cloned()
                .collect();
            text += &searches::table(&levels, (&judge.name, &by_judge), self.starts, scene)?;
            text += "\n";
        }
        Ok(text)
    }

    fn choices(&self, base: &SceneConfig, path: &Path) -> Result<Vec<Choice>> {
        let mut choices = Choices::new(base);
        choices.vary(LEVEL, "everyday: the scene as it is", |_| ());
        for (i, weights) in self.networks.iter().enumerate() {
            let mut with_weights = base.clone();
            with_weights.name_weights(weights)?;
            let stem = weights.file_stem().unwrap_or_default().to_string_lossy();
            if i == 0 {
                let (steps, tolerance) = DRAFT;
                let name = format!("draft: {stem}, {steps} load steps, tolerance {tolerance:e}");
                choices.vary(LEVEL, name, |config| {
                    *config = with_weights.clone();
                    (config.load_steps, config.solver.tolerance) = DRAFT;
                });
            }
            choices.vary(NETWORK, format!("weights {stem}"), |config| {
                *config = with_weights
            });
        }
        for tolerance in [1e-6, 1e-3] {
            choices.vary(COMPARED, format!("tolerance {tolerance:e}"), |config| {
                config.solver.tolerance = tolerance;
            });
        }
        for steps in [5, 40] {
            choices.vary(COMPARED, format!("{steps} load steps"), |config| {
                config.load_steps = steps
            });
        }
        let weights = own_weights(base, path)?;
        let springs = "linear springs, secant at 20 deg";
        choices.springs(LEVEL, springs, &weights, 20.0, HingePoint::CutTip);
        choices.vary(COMPARED, "hinges at the corners", |config| {
            config.hinge_point = Some(HingePoint::Corner);
        });
        Ok(choices.list)
    }
}

impl Row {
    fn new(
        choice: String,
        problem: &DesignProblem,
        design: &DesignVector,
        truth: &Balanced,
    ) -> Result<Self> {
        let step_s = step_seconds(problem, design)?;
        let deployed = problem.deploy(design)?;
        let (own, by_elements) = (truth.by_law(), truth.by_elements());
        let errors: Vec<f64> = (truth.by_mesh())
            .map(|(_, by_mesh)| root_mean_square(movements(by_mesh, &deployed)))
            .collect();
        let rotations = |of: &Deployment| -> Vec<f64> {
            let states = of.final_step().deformations.iter();
            states.map(|state| state.theta.to_degrees()).collect()
        };
        let turned: Vec<f64> = std::iter::zip(rotations(&deployed), rotations(by_elements))
            .map(|(by_choice, by_elements)| by_choice - by_elements)
            .collect();
        Ok(Self {
            choice,
            step_s,
            effect: root_mean_square(movements(own, &deployed)),
            relative: errors.last().unwrap_or(&f64::NAN) / size(by_elements),
            errors,
            rotation_deg: root_mean_square(turned),
        })
    }
}

/// The table of a sheet under its title.
fn section(title: &str, truth: &Balanced, rows: &[Row]) -> String {
    let in_rounds = match truth.rounds.len() {
        1 => "one round".into(),
        rounds => format!("{rounds} rounds"),
    };
    let moved = truth.rounds.last().map_or(0.0, |round| round.movement);
    let warning = truth.ended.warning();
    let mut warning = warning.map_or(String::new(), |why| format!(" NOT BALANCED: {why}."));
    for hinge in truth.unsolved() {
        warning += &format!(" NOT SOLVED: {hinge}.");
    }
    let minutes = truth.cpu_seconds / 60.0;
    let mut table = Table::new()
        .column("choice", |row: &Row| Cell::text(&row.choice))
        .column("step, ms", |row| Cell::fixed(1e3 * row.step_s, 2))
        .column("effect, mm", |row| Cell::scientific(row.effect, 1));
    let meshes: Vec<_> = truth.by_mesh().collect();
    for (i, (tier, _)) in meshes.iter().enumerate() {
        let heading = format!("error by `{tier}`, mm");
        table = table.column(heading, move |row| Cell::fixed(row.errors[i], 3));
    }
    let mut judge = String::new();
    if let Some([(draft, by_draft), (finest, by_finest)]) = truth.mesh_error() {
        let error = root_mean_square(movements(by_draft, by_finest));
        judge = format!(" Error of `{draft}` itself, by `{finest}`: {error:.3} mm.");
    }
    let table = table
        .column("of the sheet", |row| Cell::percent(row.relative, 3))
        .column("error of rotations, deg", |row| {
            Cell::fixed(row.rotation_deg, 3)
        });
    format!(
        "### {title}\n\n\
         {} hinges by finite elements in {in_rounds}, {minutes:.0} CPU minutes; no corner moved by more than {moved:.2} mm in the \
         last.{judge}{warning} Step: CPU time of equilibrium and gradient. Effect: movement of the panel corners from the scene as \
         it is; error: from finite elements; both root mean squares. `kirigami-studies levels`.\n\n{}\n",
        truth.hinges.len(),
        table.markdown(rows)
    )
}
