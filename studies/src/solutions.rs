//! `kirigami-studies solutions`: how many designs reach one shape; section 3.1.

use crate::charts::{self, SolutionChart};
use anyhow::{Context, Result, ensure};
use clap::Args;
use design::analysis::solution_set::{PrincipalPlane, curvatures};
use design::scene::design_run::{Designed, inverse_design};
use design::scene::{Scene, SceneConfig};
use kirigami::ui::processors;
use kirigami::ui::progress::Progress;
use kirigami::ui::{interrupt, picture, run_folder};
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use support::worker_pool::{Reports, work_through};

/// Run one scene from many random starts: families of solutions, and the curvature of the objective
///
/// Every run starts from its own random pattern. Converged runs are grouped into families by their
/// opening; for the best of them the curvature of the shape term is computed in all coordinates of
/// the pattern and the opening. Writes solutions.csv, solutions.md and a chart. Example:
/// kirigami-studies solutions configs/scenes/solutions-7x7.toml
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

/// Outline error, relative to the sheet's side, below which a run counts as converged.
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

impl SolutionStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.runs > 0, "--runs must be at least 1");
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let _held = run_folder::hold(&self.out)?;
        let side = side(&config);
        let mut solutions = self.solve(&config, side)?;
        solutions.sort_by_key(|solution| solution.seed);
        let points: Vec<_> = solutions
            .iter()
            .flat_map(|solution| [solution.start.clone(), solution.end.clone()])
            .collect();
        let plane = PrincipalPlane::of(&points)
            .context("too few runs for a principal plane: increase --runs")?;
        let families = families(&solutions);
        let best = solutions
            .iter()
            .min_by(|x, y| x.error.total_cmp(&y.error))
            .context("no run has a result")?;
        let problem = self.scene_of(&config, best.seed)?.problem()?;
        let curvatures = curvatures(&problem, &best.designed.design)?;
        let shares: Vec<f64> = curvatures
            .iter()
            .map(|value| value / curvatures[0])
            .collect();
        let page = page(&solutions, &families, &plane, &shares, best)?;
        run_folder::write(&self.out, "solutions.md", &page)?;
        run_folder::write(
            &self.out,
            "solutions.csv",
            &csv(&solutions, &families, &plane)?,
        )?;
        let place = |points: &[usize]| -> Vec<_> {
            points
                .iter()
                .map(|&i| plane.place(&solutions[i].end))
                .collect()
        };
        let errors: Vec<Vec<f64>> = families
            .iter()
            .map(|family| {
                let history = &solutions[family[family.len() / 2]].designed.history;
                history
                    .iter()
                    .map(|step| 100.0 * step.scores.outline_error / side)
                    .collect()
            })
            .collect();
        let chart = SolutionChart {
            starts: &solutions
                .iter()
                .map(|it| plane.place(&it.start))
                .collect::<Vec<_>>(),
            families: &families
                .iter()
                .map(|family| place(family))
                .collect::<Vec<_>>(),
            curvatures: &shares,
            negligible: NEGLIGIBLE,
            errors: &errors,
        };
        picture::save(
            &charts::solutions(&chart)?,
            &self.out.join("solutions"),
            2000,
        )?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    /// The scene with the seed and the run folder of one run.
    fn scene_of(&self, config: &SceneConfig, seed: u64) -> Result<Scene> {
        let mut config = config.clone();
        config.optimiser.seed = seed;
        config.output = std::path::absolute(&self.out)?
            .join("runs")
            .join(seed.to_string());
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
            let opening = designed
                .design
                .opening
                .context("the scene has no opening angle: set hinge = \"pin\"")?;
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
        ensure!(
            !stop.load(Ordering::Relaxed),
            "stopped; run the same command again to continue"
        );
        Ok(solutions)
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

fn page(
    solutions: &[Solution],
    families: &[Vec<usize>],
    plane: &PrincipalPlane,
    shares: &[f64],
    best: &Solution,
) -> Result<String> {
    let converged: usize = families.iter().map(Vec::len).sum();
    let mut text = format!(
        "# The solution set\n\n\
         {} runs from random patterns, {converged} of them with an outline error below {:.0} % of the side. The \
         smallest error is {:.3} %. The plane of the chart contains {:.0} % of the variance of starts and solutions \
         in (r, tau). `kirigami-studies solutions`.\n\n\
         | family | runs | opening, deg | from | to | median error, % | minimum |\n|---|---|---|---|---|---|---|\n",
        solutions.len(),
        100.0 * CONVERGED,
        100.0 * best.error,
        100.0 * (plane.shares[0] + plane.shares[1]),
    );
    for (k, family) in families.iter().enumerate() {
        let openings = || family.iter().map(|&i| solutions[i].opening_deg);
        let percent = |i: usize| 100.0 * solutions[family[i]].error;
        writeln!(
            text,
            "| {} | {} | {:.1} | {:.1} | {:.1} | {:.3} | {:.3} |",
            k + 1,
            family.len(),
            openings().sum::<f64>() / family.len() as f64,
            openings().fold(f64::INFINITY, f64::min),
            openings().fold(f64::NEG_INFINITY, f64::max),
            percent(family.len() / 2),
            percent(0),
        )?;
    }
    if let [first, second, ..] = families {
        let [within, between] = distances(solutions, first, second);
        write!(
            text,
            "\nThe mean distance of two designs from different ones of the two largest families is {:.2} times that \
             of two designs of the same family, in (r, tau) (paper: 9.40).\n",
            between / within
        )?;
    }
    let flat = |limit: f64| shares.iter().filter(|share| share.abs() < limit).count();
    write!(
        text,
        "\nOf the {} eigenvalues of the Hessian of the loss at the best design, in the chart coordinates of the \
         pattern and the opening, {} are below 1e-4 of the largest, {} below {NEGLIGIBLE:.0e} and {} below 1e-8.\n",
        shares.len(),
        flat(1e-4),
        flat(NEGLIGIBLE),
        flat(1e-8),
    )?;
    Ok(text)
}

/// Mean distance of two designs of the same family, and of two designs of different families.
fn distances(solutions: &[Solution], first: &[usize], second: &[usize]) -> [f64; 2] {
    let apart = |i: usize, j: usize| -> f64 {
        let squares =
            std::iter::zip(&solutions[i].end, &solutions[j].end).map(|(x, y)| (x - y).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let mean = |pairs: Vec<f64>| pairs.iter().sum::<f64>() / pairs.len().max(1) as f64;
    let mut within = Vec::new();
    for family in [first, second] {
        for (k, &i) in family.iter().enumerate() {
            within.extend(family[k + 1..].iter().map(|&j| apart(i, j)));
        }
    }
    let between = first
        .iter()
        .flat_map(|&i| second.iter().map(move |&j| (i, j)));
    [
        mean(within),
        mean(between.map(|(i, j)| apart(i, j)).collect()),
    ]
}

/// One row per run.
fn csv(solutions: &[Solution], families: &[Vec<usize>], plane: &PrincipalPlane) -> Result<String> {
    let mut text = "seed,error_over_side,opening_deg,family,component_1,component_2\n".to_owned();
    for (i, solution) in solutions.iter().enumerate() {
        let family = families.iter().position(|family| family.contains(&i));
        let [x, y] = plane.place(&solution.end);
        writeln!(
            text,
            "{},{:.6},{:.4},{},{x:.6},{y:.6}",
            solution.seed,
            solution.error,
            solution.opening_deg,
            family.map_or(0, |family| family + 1),
        )?;
    }
    Ok(text)
}
