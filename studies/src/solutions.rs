//! `kirigami-studies solutions`: how many designs reach one shape; section 3.1.

mod opening_profile;
mod plane_contours;
mod solutions_page;

use crate::charts::{self, PlaneValues, SolutionChart};
use crate::stop::refuse_stop;
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::analysis::solution_set::{PrincipalPlane, curvatures, outline_rank};
use design::objective::design_problem::Evaluation;
use design::objective::shape::OutlinePoints;
use design::optimise::outer_loop::Ended;
use design::scene::design_run::{Designed, inverse_design};
use design::scene::{Scene, SceneConfig};
use kirigami::ui::processors;
use kirigami::ui::progress::Progress;
use kirigami::ui::{interrupt, picture, run_folder};
use opening_profile::opening_profile;
use plane_contours::losses;
use std::path::PathBuf;
use support::worker_pool::{Reports, work_through};

/// Run one scene from many random starts: families of solutions, and the curvature of the objective
///
/// Every run starts from its own random pattern, once with the free outline corners compared with the target and once
/// with all. Converged runs are grouped into families by their opening; for the best of the largest family the curvature
/// of the loss is computed in all coordinates of the pattern and the opening. Writes solutions.csv, solutions.md and a
/// chart. Example: kirigami-studies solutions configs/scenes/solutions-7x7.toml
#[derive(Args)]
pub struct SolutionStudy {
    /// Scene (TOML) with hinge = "pin"
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Number of runs; their seeds are consecutive, beginning with the scene's
    #[arg(long, value_name = "N", default_value_t = 200)]
    runs: usize,
    /// Number of runs in parallel [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Folder for the table, the chart and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-solutions")]
    out: PathBuf,
}

/// Outline error, relative to the sheet's side, below which a run belongs to a family.
const CONVERGED: f64 = 0.04;
/// Ratio to the largest eigenvalue below which eigenvalues are negligible: a tenth of a per cent of the
/// outline's sensitivity in the stiffest direction.
const NEGLIGIBLE: f64 = 1e-6;
/// Minimum gap of the openings of two families (deg).
const GAP_DEG: f64 = 3.0;

/// One run.
struct Solution {
    seed: u64,
    designed: Designed,
    /// r and tau at the start and at the end.
    start: Vec<f64>,
    end: Vec<f64>,
    opening_deg: f64,
    /// Outline error relative to the sheet's side.
    error: f64,
}

/// The solutions of one point set P.
struct SolutionSet {
    outline: OutlinePoints,
    /// mm
    side: f64,
    solutions: Vec<Solution>,
    /// Indices of the solutions of each family, the largest family first, in order of their outline errors.
    families: Vec<Vec<usize>>,
    plane: PrincipalPlane,
    /// Eigenvalues of the Hessian at the best design of the largest family, relative to the largest.
    spectrum: Vec<f64>,
    /// Number of independent motions of P at this design.
    rank: usize,
    /// Opening (deg) and root of the minimum loss at this opening, relative to the sheet's side.
    profile: Vec<[f64; 2]>,
    losses: PlaneValues,
}

impl SolutionStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.runs > 0, "--runs must be at least 1");
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let _held = run_folder::hold(&self.out)?;
        let mut sets = Vec::new();
        for outline in [OutlinePoints::Free, OutlinePoints::All] {
            let mut config = config.clone();
            config.objective.outline = outline;
            sets.push(self.set(&config)?);
        }
        let page = solutions_page::page(&sets);
        run_folder::write(&self.out, "solutions.md", &page)?;
        run_folder::write(&self.out, "solutions.csv", &solutions_page::csv(&sets))?;
        let rows: Vec<_> = sets.iter().map(SolutionSet::chart).collect();
        picture::save(
            &charts::solutions(&rows)?,
            &self.out.join("solutions"),
            2600,
        )?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn set(&self, config: &SceneConfig) -> Result<SolutionSet> {
        let outline = config.objective.outline;
        let side = side(config);
        let mut solutions = self.solve(config, side)?;
        solutions.sort_by_key(|solution| solution.seed);
        let points: Vec<_> = solutions
            .iter()
            .flat_map(|solution| [solution.start.clone(), solution.end.clone()])
            .collect();
        let plane = PrincipalPlane::new(&points)
            .context("too few runs for a principal plane: increase --runs")?;
        let families = families(&solutions);
        let best = families
            .first()
            .map(|family| &solutions[family[0]])
            .with_context(|| format!("no run has an error below {CONVERGED} of the side"))?;
        let (problem, design) = (&best.designed.problem, &best.designed.design);
        let curvatures = curvatures(problem, design)?;
        let spectrum = curvatures
            .iter()
            .map(|value| value / curvatures[0])
            .collect();
        let places = points.iter().map(|point| plane.place(point));
        Ok(SolutionSet {
            outline,
            side,
            spectrum,
            rank: outline_rank(problem, design)?,
            profile: opening_profile(config, &self.scene, side)?,
            losses: losses(problem, design, &plane, places.collect(), side),
            families,
            plane,
            solutions,
        })
    }

    /// The scene with the seed and the run folder of one run.
    fn scene_of(&self, config: &SceneConfig, seed: u64) -> Result<Scene> {
        let mut config = config.clone();
        config.optimiser.seed = seed;
        let folder = format!(
            "{}-{seed}",
            solutions_page::corners(config.objective.outline)
        );
        config.output = std::path::absolute(&self.out)?.join("runs").join(folder);
        Ok(Scene::new(config, &self.scene)?)
    }

    fn solve(&self, config: &SceneConfig, side: f64) -> Result<Vec<Solution>> {
        let stop = interrupt::stop_flag()?;
        let workers = self.jobs.unwrap_or_else(processors);
        let bar = Progress::new(self.runs, "runs");
        let one = |run: usize| -> Result<Solution> {
            let seed = config.optimiser.seed + run as u64;
            let scene = self.scene_of(config, seed)?;
            let designed = inverse_design(&scene, stop, &mut |_| {})?;
            let opening = designed.problem.opening(&designed.design);
            let opening = opening.context("the scene has no opening angle: set hinge = \"pin\"")?;
            Ok(Solution {
                seed,
                start: scene.start().pattern.values(),
                end: designed.design.pattern.values(),
                opening_deg: opening.to_degrees(),
                error: error(&designed) / side,
                designed,
            })
        };
        let mut solutions = Vec::new();
        let work = |run: usize, reports: &Reports<_>| reports.send(one(run));
        work_through(self.runs, workers, stop, &work, &mut |solution| {
            solutions.push(solution?);
            bar.show(solutions.len(), None, "");
            Ok::<_, anyhow::Error>(())
        })?;
        bar.finish();
        refuse_stop(stop)?;
        Ok(solutions)
    }
}

impl Solution {
    /// Whether no step lowers the loss.
    fn settled(&self) -> bool {
        self.designed.ended == Ended::Settled
    }

    /// Norm of the gradient at the end relative to that at the start.
    fn gradient(&self) -> f64 {
        let norm = |evaluation: &Evaluation| {
            let gradient = evaluation.gradient.to_flat();
            gradient.iter().map(|g| g * g).sum::<f64>().sqrt()
        };
        norm(&self.designed.best) / norm(&self.designed.start)
    }
}

impl SolutionSet {
    fn chart(&self) -> SolutionChart<'_> {
        let places = |of: &dyn Fn(&Solution) -> Vec<f64>, which: &[usize]| -> Vec<[f64; 2]> {
            let points = which.iter().map(|&i| of(&self.solutions[i]));
            points.map(|point| self.plane.place(&point)).collect()
        };
        let all: Vec<usize> = (0..self.solutions.len()).collect();
        let errors = self.families.iter().map(|family| {
            let run = &self.solutions[family[family.len() / 2]];
            let history = run.designed.history.iter();
            history
                .map(|step| 100.0 * step.scores.outline_error / self.side)
                .collect()
        });
        SolutionChart {
            name: solutions_page::corners(self.outline),
            starts: places(&|it| it.start.clone(), &all),
            families: (self.families.iter())
                .map(|family| places(&|it| it.end.clone(), family))
                .collect(),
            losses: &self.losses,
            spectrum: &self.spectrum,
            negligible: NEGLIGIBLE,
            profile: &self.profile,
            errors: errors.collect(),
        }
    }
}

/// Side of a square with the area of the sheet (mm).
fn side(config: &SceneConfig) -> f64 {
    config.sheet.outline().area().sqrt()
}

/// Outline error of the best step (mm).
fn error(designed: &Designed) -> f64 {
    let best = designed
        .history
        .iter()
        .min_by(|x, y| x.scores.loss.total_cmp(&y.scores.loss));
    best.map_or(f64::NAN, |step| step.scores.outline_error)
}

/// Converged runs grouped by opening, the largest family first; each family in order of its outline error.
fn families(solutions: &[Solution]) -> Vec<Vec<usize>> {
    let mut converged: Vec<usize> = (0..solutions.len())
        .filter(|&i| solutions[i].error < CONVERGED)
        .collect();
    let opening = |i: &usize| solutions[*i].opening_deg;
    converged.sort_by(|x, y| opening(x).total_cmp(&opening(y)));
    let mut families: Vec<Vec<usize>> = converged
        .chunk_by(|x, y| opening(y) - opening(x) < GAP_DEG)
        .map(<[usize]>::to_vec)
        .collect();
    for family in &mut families {
        family.sort_by(|x, y| solutions[*x].error.total_cmp(&solutions[*y].error));
    }
    families.sort_by_key(|family| std::cmp::Reverse(family.len()));
    families
}
