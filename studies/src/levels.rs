//! `kirigami-studies levels`: cost and error of every choice of a scene, judged by finite elements for all hinges.
//!
//! The design of the scene is deployed with finite elements for its hinges (`kirigami verify --equilibrium`) and with each
//! choice. *Effect* is the movement of the panel corners from the scene as it is, *error* that from the finite elements:
//! a choice whose effect is far below the error costs no accuracy.

use crate::chain::rms;
use crate::condensed::{condense, own_weights};
use crate::designed::designed;
use crate::step_time::step_time;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use design::scene::{HingeModel, Scene, SceneConfig};
use design::sheet::cut_sheet::HingePoint;
use kirigami::replays::balanced_sheet::{Balanced, WindowSolves, balanced, movements, size};
use kirigami::replays::kept_solves::SolveArgs;
use kirigami::ui::run_folder;
use mesher::Tier;
use std::fmt::Write;
use std::path::{Path, PathBuf};

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
    /// Maximum number of times that all hinges of a sheet are solved
    #[arg(long, value_name = "N", default_value_t = 3)]
    rounds: usize,
    #[command(flatten)]
    solve: SolveArgs,
    /// Folder for the tables, the designs and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-levels")]
    out: PathBuf,
}

/// Load steps and tolerance of the level draft.
const DRAFT: (usize, f64) = (5, 1e-3);

/// A choice on one sheet.
struct Row {
    choice: String,
    /// Time of one design step, equilibrium and gradient: the minimum of some repeats (s).
    step_s: f64,
    /// Root mean square movement of the panel corners (mm): from the scene as it is, and from finite elements.
    effect: f64,
    error: f64,
    /// The latter relative to the diagonal of the deployed sheet.
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
        let scene = |mut config: SceneConfig| -> Result<Scene> {
            config.output = std::path::absolute(folder.join("design"))?;
            Ok(Scene::new(config, path)?)
        };
        let own = scene(base.clone())?;
        let design = designed(&own, &mut |_| ())?.design;
        let windows = WindowSolves {
            tier: self.tier,
            args: &self.solve,
            folder: &folder,
        };
        let (truth, _) = balanced(&own, &design, &windows, self.rounds)?;
        let mut rows = Vec::new();
        for (choice, config) in self.choices(&base, path)? {
            let problem = scene(config)?.problem()?;
            let row = Row::new(choice.clone(), &problem, &design, &truth);
            rows.push(row.with_context(|| format!("{name}, {choice}"))?);
        }
        table(&own.config.title, &truth, &rows)
    }

    fn choices(&self, base: &SceneConfig, path: &Path) -> Result<Vec<(String, SceneConfig)>> {
        let mut choices = vec![("everyday: the scene as it is".to_owned(), base.clone())];
        for (i, weights) in self.networks.iter().enumerate() {
            let mut config = base.clone();
            config.name_weights(weights)?;
            let stem = weights.file_stem().unwrap_or_default().to_string_lossy();
            if i == 0 {
                let mut draft = config.clone();
                (draft.load_steps, draft.solver.tolerance) = DRAFT;
                let (steps, tolerance) = DRAFT;
                let choice = format!("draft: {stem}, {steps} load steps, tolerance {tolerance:e}");
                choices.push((choice, draft));
            }
            choices.push((format!("weights {stem}"), config));
        }
        let mut add = |choice: String, change: &dyn Fn(&mut SceneConfig)| {
            let mut config = base.clone();
            change(&mut config);
            choices.push((choice, config));
        };
        for tolerance in [1e-6, 1e-3] {
            let choice = format!("tolerance {tolerance:e}");
            add(choice, &|config| config.solver.tolerance = tolerance);
        }
        for steps in [5, 40] {
            let choice = format!("{steps} load steps");
            add(choice, &|config| config.load_steps = steps);
        }
        let weights = own_weights(base, path)?;
        add("linear springs, secant at 20 deg".into(), &|config| {
            condense(config, &weights, 20.0);
        });
        add("hinges at the corners".into(), &|config| {
            config.hinge_point = Some(HingePoint::Corner);
        });
        Ok(choices)
    }
}

impl Row {
    fn new(
        choice: String,
        problem: &DesignProblem,
        design: &DesignVector,
        truth: &Balanced,
    ) -> Result<Self> {
        let deployed = problem.evaluate(design)?.deployment;
        let step_s = step_time(problem, design)?;
        let (own, by_elements) = (truth.by_law(), truth.by_elements());
        let error = rms(&movements(by_elements, &deployed));
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
            effect: rms(&movements(own, &deployed)),
            error,
            relative: error / size(by_elements),
            rotation_deg: rms(&turned),
        })
    }
}

fn table(title: &str, truth: &Balanced, rows: &[Row]) -> Result<String> {
    let rounds = truth.rounds.len();
    let in_rounds = match rounds {
        1 => "one round".into(),
        rounds => format!("{rounds} rounds"),
    };
    let moved = truth.rounds.last().map_or(0.0, |round| round.movement);
    let warning =
        (truth.ended.warning()).map_or(String::new(), |it| format!(" NOT BALANCED: {it}."));
    let minutes = truth
        .cpu_seconds
        .map_or("?".into(), |seconds| format!("{:.0}", seconds / 60.0));
    let mut text = format!(
        "### {title}\n\n\
         {} hinges by finite elements in {in_rounds}, {minutes} CPU minutes; no corner moved by more than {moved:.2} mm in the \
         last.{warning} Step: equilibrium and gradient. Effect: movement of the panel corners from the scene as it is; error: \
         from finite elements; both root mean squares. `kirigami-studies levels`.\n\n\
         | choice | step, ms | effect, mm | error, mm | of the sheet | error of rotations, deg |\n\
         |---|---|---|---|---|---|\n",
        truth.hinges.len(),
    );
    for row in rows {
        writeln!(
            text,
            "| {} | {:.2} | {:.1e} | {:.3} | {:.3} % | {:.3} |",
            row.choice,
            1e3 * row.step_s,
            row.effect,
            row.error,
            100.0 * row.relative,
            row.rotation_deg
        )?;
    }
    text += "\n";
    Ok(text)
}
