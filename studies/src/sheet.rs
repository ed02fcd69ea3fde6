//! `kirigami-studies sheet`: cost and error of the choices for the sheet's equilibrium.

mod sheet_page;

use crate::condensed::condense;
use anyhow::{Context, Result};
use clap::Args;
use design::equilibrium::load_step::Status;
use design::objective::design_problem::{Deployment, DesignProblem, Evaluation, Model};
use design::scene::{HingeModel, PinConfig, Scene, SceneConfig, SurrogateFile};
use design::sheet::cut_sheet::HingePoint;
use design::sheet::kinematics::deployed_corners;
use kirigami::ui::run_folder;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use surrogate::Surrogate;

/// Measure cost and error of the sheet's choices: tolerance, load steps, method, hinge law, hinge point
///
/// Two shipped scenes are deployed from a random start, with one choice varied at a time. Writes sheet.csv,
/// sheet.md, sheet.svg and tradeoff.md. Example: kirigami-studies sheet
#[derive(Args)]
pub struct SheetStudy {
    /// Weights of the learned hinge law, for the material and the process of the scene `a4-polyester`
    #[arg(
        long,
        value_name = "FILE",
        default_value = "data/pet-0.5mm/medium.safetensors"
    )]
    weights: PathBuf,
    /// Folder for the tables and the chart
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-sheet")]
    out: PathBuf,
}

const LEARNED: &str = "configs/scenes/a4-polyester.toml";
const LINEAR: &str = "configs/scenes/linear-7x7.toml";
/// Standard deviation of the random start, in the chart coordinates.
const NOISE: f64 = 0.03;
/// The baseline of the equilibrium solver, in the names of its cases, and its maximum number of iterations per load step.
const LBFGS: &str = "L-BFGS";
const MAX_ITERATIONS: usize = 200_000;
/// A cost is the mean over the repeats within this time, with a minimum number of repeats.
const REPEAT: Duration = Duration::from_millis(500);
const MIN_REPEATS: u32 = 5;

/// A choice with its cost and result.
struct Row {
    scene: &'static str,
    study: &'static str,
    value: String,
    /// Time of the equilibria, and of equilibria with gradient.
    seconds: [f64; 2],
    iterations: usize,
    /// The worst status of any load step.
    status: Status,
    found: Found,
}

/// The compared quantities.
struct Found {
    corners: Vec<[f64; 2]>,
    openings: Vec<f64>,
    /// Gradient in the pattern's coordinates.
    gradient: Vec<f64>,
    /// Size of a panel (mm).
    panel: f64,
}

/// Difference of a choice from its reference.
struct Difference {
    /// Root mean square distance of the panel corners after the best rigid motion, relative to the size of a
    /// panel.
    shape: f64,
    /// Maximum difference of the opening of a hinge (deg).
    opening_deg: f64,
    /// Norm of the difference of the gradients relative to that of the gradient.
    gradient: f64,
}

impl SheetStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let weights = std::path::absolute(&self.weights)?;
        let mut rows = Vec::new();
        for (name, path) in [("A4, learned", LEARNED), ("7 x 7, linear", LINEAR)] {
            let base = base(Path::new(path), &weights)?;
            for (study, value, config) in solver_cases(&base) {
                rows.push(measure(name, study, value, config, Path::new(path))?);
            }
            if path == LEARNED {
                let reference = rows.iter().find(|row| row.study == "hinge law");
                let openings = &reference
                    .context("the hinge law is measured first")?
                    .found
                    .openings;
                let opening = openings.iter().sum::<f64>() / openings.len() as f64;
                for (study, value, config) in law_cases(&base, &weights, opening) {
                    rows.push(measure(name, study, value, config, Path::new(path))?);
                }
            }
        }
        sheet_page::write(&self.out, &rows, &Surrogate::load(&self.weights)?)
    }
}

/// A shipped scene with a random start, the given weights, and an objective that every hinge law supports.
fn base(path: &Path, weights: &Path) -> Result<SceneConfig> {
    let mut config: SceneConfig = support::toml_file::read(path)?;
    config.optimiser.start_noise = NOISE;
    (config.objective.damage, config.objective.domain) = (0.0, 0.0);
    if config.surrogate.is_some() {
        config.surrogate = Some(SurrogateFile {
            weights: weights.to_owned(),
            ensemble: Vec::new(),
        });
    }
    Ok(config)
}

type Case = (&'static str, String, SceneConfig);

/// Tolerances, load steps and methods; the first case of each study is the reference of the others.
fn solver_cases(base: &SceneConfig) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |study, value: String, change: &dyn Fn(&mut SceneConfig)| {
        let mut config = base.clone();
        change(&mut config);
        cases.push((study, value, config));
    };
    for tolerance in [1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-3, 1e-2] {
        let value = format!("{tolerance:.0e}");
        add("tolerance", value, &|config| {
            config.solver.tolerance = tolerance
        });
    }
    for steps in [160, 80, 40, 20, 10, 5, 2, 1] {
        let value = steps.to_string();
        add("load steps", value, &|config| config.load_steps = steps);
    }
    for tolerance in [1e-10, 1e-8, 1e-6, 1e-4, 1e-2] {
        for name in ["Newton", LBFGS] {
            let value = format!("{name}, {tolerance:.0e}");
            add("method", value, &|config| {
                config.solver.tolerance = tolerance
            });
        }
    }
    if base.hinge == HingeModel::Surrogate {
        add("hinge law", "surrogate".into(), &|_| ());
    }
    cases
}

/// Hinge laws besides the learned one, and hinge points; `opening` (rad) is the opening angle of the pins.
fn law_cases(base: &SceneConfig, weights: &Path, opening: f64) -> Vec<Case> {
    let condensed = |secant_deg: f64, hinge_point| {
        let mut config = base.clone();
        condense(&mut config, weights, secant_deg);
        config.hinge_point = Some(hinge_point);
        config
    };
    let mut pinned = base.clone();
    pinned.hinge = HingeModel::Pin;
    pinned.surrogate = None;
    let opening_deg = opening.to_degrees();
    pinned.pin = Some(PinConfig { opening_deg });
    (pinned.supports, pinned.loads) = (Vec::new(), Vec::new());
    pinned.drive = None;
    let mut at_corner = base.clone();
    at_corner.hinge_point = Some(HingePoint::Corner);
    let (tip, corner) = (HingePoint::CutTip, HingePoint::Corner);
    vec![
        (
            "hinge law",
            "linear, secant at 20 deg".into(),
            condensed(20.0, tip),
        ),
        (
            "hinge law",
            "linear, Hessian at 0".into(),
            condensed(0.0, tip),
        ),
        (
            "hinge law",
            "linear at the corner, 20 deg".into(),
            condensed(20.0, corner),
        ),
        ("hinge law", "pin, mean opening".into(), pinned),
        ("hinge point", "cut-tip".into(), base.clone()),
        ("hinge point", "corner".into(), at_corner),
    ]
}

fn measure(
    scene: &'static str,
    study: &'static str,
    value: String,
    config: SceneConfig,
    path: &Path,
) -> Result<Row> {
    let read = Scene::new(config, path)?;
    let (mut problem, design) = (read.problem()?, read.start());
    if let Model::Equilibrium(mechanics) = &mut problem.model
        && value.starts_with(LBFGS)
    {
        mechanics.solver.use_lbfgs(MAX_ITERATIONS);
    }
    let failed = || format!("{scene}, {study}, {value}");
    let evaluation = problem.evaluate(&design).with_context(failed)?;
    let equilibria = cost(|| problem.deploy(&design).map(drop))?;
    let gradient = cost(|| problem.evaluate(&design).map(drop))?;
    let path = &evaluation.deployment.path;
    let rank = |status: &Status| match status {
        Status::Converged => 0,
        Status::LeftDomain => 1,
        Status::Almost => 2,
        Status::LimitPoint => 3,
        Status::Diverged => 4,
    };
    let statuses = path.iter().map(|step| step.status);
    Ok(Row {
        scene,
        study,
        value,
        seconds: [equilibria, gradient],
        iterations: path.iter().map(|step| step.iterations).sum(),
        status: statuses
            .max_by_key(rank)
            .context("a path has at least one step")?,
        found: Found::of(&problem, &evaluation),
    })
}

/// Seconds per repeat: CPU time of this thread if the system reports it, otherwise wall time.
fn cost<E>(mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let (begin, busy, mut repeats) = (Instant::now(), thread_seconds(), 0);
    while begin.elapsed() < REPEAT || repeats < MIN_REPEATS {
        work()?;
        repeats += 1;
    }
    let spent = match (busy, thread_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => begin.elapsed().as_secs_f64(),
    };
    Ok(spent / f64::from(repeats))
}

/// CPU time of this thread from the kernel (s), which counts in ticks of a few milliseconds.
fn thread_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

impl Found {
    fn of(problem: &DesignProblem, evaluation: &Evaluation) -> Self {
        let Deployment { sheet, .. } = &evaluation.deployment;
        let last = evaluation.deployment.final_step();
        let pattern = &evaluation.gradient.pattern;
        Self {
            corners: deployed_corners(sheet, &last.configuration).concat(),
            openings: last.deformations.iter().map(|eps| eps.theta).collect(),
            gradient: [pattern.z.as_slice(), &pattern.ell.concat()].concat(),
            panel: (problem.outline.area() / problem.grid.panel_count() as f64).sqrt(),
        }
    }

    fn difference(&self, other: &Self) -> Difference {
        let openings = std::iter::zip(&self.openings, &other.openings);
        let apart = openings.map(|(one, other)| (one - other).abs());
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
        let gradients = std::iter::zip(&self.gradient, &other.gradient);
        let off = norm(&mut gradients.map(|(one, other)| one - other));
        Difference {
            shape: misfit(&self.corners, &other.corners) / other.panel,
            opening_deg: apart.fold(0.0, f64::max).to_degrees(),
            gradient: off / norm(&mut other.gradient.iter().copied()),
        }
    }
}

/// Root mean square distance of two sets of points after the best rigid motion.
fn misfit(one: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    let centred = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let n = points.len() as f64;
        let mean = [0, 1].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / n);
        points
            .iter()
            .map(|p| [p[0] - mean[0], p[1] - mean[1]])
            .collect()
    };
    let (one, other) = (centred(one), centred(other));
    let (mut along, mut across) = (0.0, 0.0);
    for ([x, y], [u, v]) in std::iter::zip(&one, &other) {
        along += x * u + y * v;
        across += x * v - y * u;
    }
    let (sin, cos) = across.atan2(along).sin_cos();
    let squares = std::iter::zip(&one, &other)
        .map(|([x, y], [u, v])| (cos * x - sin * y - u).powi(2) + (sin * x + cos * y - v).powi(2));
    (squares.sum::<f64>() / one.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_motion_is_no_misfit() {
        let one = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.3, 1.5]];
        let (sin, cos) = 0.7_f64.sin_cos();
        let moved = one.map(|[x, y]| [cos * x - sin * y + 3.0, sin * x + cos * y - 8.0]);
        assert!(misfit(&one, &moved) < 1e-14);
        let stretched = one.map(|[x, y]| [1.1 * x, y]);
        assert!(misfit(&one, &stretched) > 0.05);
    }
}
