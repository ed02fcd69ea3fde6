//! `kirigami-studies sheet`: cost and error of the choices for the sheet's equilibrium.

use crate::charts::{self, CostPanel};
use crate::choices::{Choice, Choices, Measured};
use anyhow::{Context, Result};
use clap::Args;
use design::objective::design_problem::Model;
use design::scene::{HingeModel, PinConfig, Scene, SceneConfig, SurrogateFile};
use design::sheet::cut_sheet::HingePoint;
use design::sheet::kinematics::deployed_corners;
use kirigami::ui::{picture, run_folder};
use std::path::{Path, PathBuf};
use support::table::{Cell, Table};
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
/// The baseline of the equilibrium solver, in the names of its choices, and its maximum number of iterations per load step.
const LBFGS: &str = "L-BFGS";
const MAX_ITERATIONS: usize = 200_000;

/// The kinds of choices and their definitions.
const KINDS: [(&str, &str); 5] = [
    (
        "tolerance",
        "residual of an equilibrium, relative to the maximum force",
    ),
    (
        "load steps",
        "number N of load steps; the deployed shape does not depend on it, the path functionals do",
    ),
    (
        "method",
        "Newton on the sparse tangent, or L-BFGS as in the paper",
    ),
    ("hinge law", "model of the energy of a ligament"),
    ("hinge point", "point at which the learned law measures (8)"),
];

/// A choice with its cost and its difference from the first choice of its kind and scene.
struct Row {
    scene: &'static str,
    kind: &'static str,
    name: String,
    measured: Measured,
    /// Size of a panel (mm).
    panel: f64,
    difference: Difference,
}

#[derive(Default)]
struct Difference {
    /// Root mean square distance of the panel corners after the best rigid motion, relative to the size of a
    /// panel.
    shape: f64,
    /// Maximum difference of the opening of a hinge (deg).
    opening_deg: f64,
    /// Norm of the difference of the gradients in the pattern relative to that of the gradient.
    gradient: f64,
}

impl SheetStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let weights = std::path::absolute(&self.weights)?;
        let mut rows = Vec::new();
        let base = base(Path::new(LEARNED), &weights)?;
        let mut measure = |scene, path, choices: Vec<Choice>| -> Result<()> {
            for choice in choices {
                let row = Row::new(scene, Path::new(path), choice, &rows)?;
                rows.push(row);
            }
            Ok(())
        };
        measure("A4, learned", LEARNED, solver_choices(&base))?;
        measure("A4, learned", LEARNED, law_choices(&base, &weights)?)?;
        let linear = self::base(Path::new(LINEAR), &weights)?;
        measure("7 x 7, linear", LINEAR, solver_choices(&linear))?;
        self.write(&rows)
    }

    fn write(&self, rows: &[Row]) -> Result<()> {
        let csv = Table::new()
            .column("scene", |row: &Row| Cell::text(row.scene))
            .column("kind", |row| Cell::text(row.kind));
        run_folder::write(&self.out, "sheet.csv", &columns(csv).csv(rows))?;
        let page = page(rows, &Surrogate::load(&self.weights)?);
        run_folder::write(&self.out, "sheet.md", &page)?;
        run_folder::write(&self.out, "tradeoff.md", &tradeoff(rows))?;
        let panels: Vec<CostPanel> = KINDS.iter().map(|(kind, _)| panel(kind, rows)).collect();
        let pictures = picture::save(&charts::costs(&panels)?, &self.out.join("sheet"), 1600)?;
        println!("{} choices; {}", rows.len(), pictures[1].display());
        Ok(())
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
            springback: None,
        });
    }
    Ok(config)
}

/// Tolerances, load steps and methods; the first choice of each kind is the reference of the others.
fn solver_choices(base: &SceneConfig) -> Vec<Choice> {
    let mut choices = Choices::new(base);
    for tolerance in [1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-3, 1e-2] {
        choices.vary("tolerance", format!("{tolerance:.0e}"), |config| {
            config.solver.tolerance = tolerance;
        });
    }
    for steps in [160, 80, 40, 20, 10, 5, 2, 1] {
        choices.vary("load steps", steps.to_string(), |config| {
            config.load_steps = steps;
        });
    }
    for tolerance in [1e-10, 1e-8, 1e-6, 1e-4, 1e-2] {
        for name in ["Newton", LBFGS] {
            choices.vary("method", format!("{name}, {tolerance:.0e}"), |config| {
                config.solver.tolerance = tolerance;
            });
        }
    }
    choices.list
}

/// Hinge laws and hinge points of a learned scene; the pins open by the mean opening of the learned hinges.
fn law_choices(base: &SceneConfig, weights: &Path) -> Result<Vec<Choice>> {
    let learned = Scene::new(base.clone(), Path::new(LEARNED))?;
    let deployment = learned.problem()?.deploy(&learned.start())?;
    let openings = deployment.final_step().deformations.iter();
    let opening: f64 = openings.map(|eps| eps.theta).sum::<f64>();
    let opening_deg = (opening / deployment.sheet.hinges.len() as f64).to_degrees();
    let (tip, corner) = (HingePoint::CutTip, HingePoint::Corner);
    let mut choices = Choices::new(base);
    choices.vary("hinge law", "surrogate", |_| ());
    let mut springs = |name, secant_deg, point| {
        choices.springs("hinge law", name, weights, secant_deg, point);
    };
    springs("linear, secant at 20 deg", 20.0, tip);
    springs("linear, Hessian at 0", 0.0, tip);
    springs("linear at the corner, 20 deg", 20.0, corner);
    choices.vary("hinge law", "pin, mean opening", |config| {
        config.hinge = HingeModel::Pin;
        config.surrogate = None;
        config.pin = Some(PinConfig {
            opening_deg,
            held: false,
        });
        (config.supports, config.loads) = (Vec::new(), Vec::new());
        config.drive = None;
    });
    choices.vary("hinge point", "cut-tip", |_| ());
    choices.vary("hinge point", "corner", |config| {
        config.hinge_point = Some(corner);
    });
    Ok(choices.list)
}

impl Row {
    /// `rows`: those before, with the reference of this one unless it is the first of its kind.
    fn new(scene: &'static str, path: &Path, choice: Choice, rows: &[Self]) -> Result<Self> {
        let Choice { kind, name, config } = choice;
        let read = Scene::new(config, path)?;
        let mut problem = read.problem()?;
        if let Model::Equilibrium(mechanics) = &mut problem.model
            && name.starts_with(LBFGS)
        {
            mechanics.solver.lbfgs = Some(MAX_ITERATIONS);
        }
        let measured = Measured::new(&problem, &read.start());
        let measured = measured.with_context(|| format!("{scene}, {kind}, {name}"))?;
        let mut row = Self {
            scene,
            kind,
            name,
            measured,
            panel: (problem.outline.area() / problem.grid.panel_count() as f64).sqrt(),
            difference: Difference::default(),
        };
        let reference = rows
            .iter()
            .find(|other| other.scene == scene && other.kind == kind);
        if let Some(reference) = reference {
            row.difference = row.difference_from(reference);
        }
        Ok(row)
    }

    fn corners(&self) -> Vec<[f64; 2]> {
        let deployment = &self.measured.evaluation.deployment;
        let last = &deployment.final_step().configuration;
        deployed_corners(&deployment.sheet, last).concat()
    }

    fn openings(&self) -> impl Iterator<Item = f64> {
        let last = self.measured.evaluation.deployment.final_step();
        last.deformations.iter().map(|eps| eps.theta)
    }

    fn gradient(&self) -> Vec<f64> {
        let pattern = &self.measured.evaluation.gradient.pattern;
        [pattern.z.as_slice(), &pattern.ell.concat()].concat()
    }

    fn difference_from(&self, other: &Self) -> Difference {
        let openings = std::iter::zip(self.openings(), other.openings());
        let apart = openings.map(|(one, other)| (one - other).abs());
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (gradient, reference) = (self.gradient(), other.gradient());
        let off: Vec<f64> = std::iter::zip(&gradient, &reference)
            .map(|(one, other)| one - other)
            .collect();
        Difference {
            shape: misfit(&self.corners(), &other.corners()) / other.panel,
            opening_deg: apart.fold(0.0, f64::max).to_degrees(),
            gradient: norm(&off) / norm(&reference),
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

/// The table of one kind, after the given first columns.
fn columns<'a>(table: Table<'a, Row>) -> Table<'a, Row> {
    table
        .column("choice", |row| Cell::text(&row.name))
        .column("equilibrium, ms", |row| {
            Cell::fixed(1e3 * row.measured.seconds[0], 2)
        })
        .column("with gradient, ms", |row| {
            Cell::fixed(1e3 * row.measured.seconds[1], 2)
        })
        .column("iterations", |row| Cell::text(row.measured.iterations))
        .column("status", |row| {
            Cell::text(format!("{:?}", row.measured.status))
        })
        .column("shape", |row| Cell::scientific(row.difference.shape, 1))
        .column("opening, deg", |row| {
            Cell::scientific(row.difference.opening_deg, 1)
        })
        .column("gradient", |row| {
            Cell::scientific(row.difference.gradient, 1)
        })
}

fn page(rows: &[Row], weights: &Surrogate) -> String {
    let card = weights.card();
    let mut text = format!(
        "# Cost and error of the sheet's choices\n\n\
         The scenes `a4-polyester` and `linear-7x7`, from a random start and without the damage term. The \
         learned hinges are of the material {}, window tier {}, database {:.12}, error of W {:.1} % \
         (root mean square, test rows). Differences are relative to the first row of each table: of the panel \
         corners (root mean square after the best rigid motion, relative to the size of a panel), of the \
         opening of a hinge (maximum) and of the gradient in the pattern (relative). Costs are \
         CPU time of one thread. The kernels compute in float64 only, so there is \
         no float32 row.\n",
        card.material,
        card.tier,
        card.dataset_hash,
        100.0 * card.test_errors.energy.relative_rmse
    );
    let table = columns(Table::new());
    for (kind, about) in KINDS {
        let of_kind: Vec<&Row> = rows.iter().filter(|row| row.kind == kind).collect();
        for of_scene in of_kind.chunk_by(|one, other| one.scene == other.scene) {
            let table = table.markdown(of_scene.iter().copied());
            let scene = of_scene[0].scene;
            text += &format!("\n## {kind}, {scene}\n\n{about}\n\n{table}");
        }
    }
    text
}

/// One table for both scenes: cost, error, use.
fn tradeoff(rows: &[Row]) -> String {
    let table = Table::new()
        .column("choice", |row: &&Row| {
            Cell::text(format!("{} {}", row.kind, row.name))
        })
        .column("scene", |row| Cell::text(row.scene))
        .column("cost with gradient, ms", |row| {
            Cell::fixed(1e3 * row.measured.seconds[1], 2)
        })
        .column("shape", |row| Cell::scientific(row.difference.shape, 1))
        .column("gradient", |row| {
            Cell::scientific(row.difference.gradient, 1)
        })
        .column("good for", |row| {
            Cell::text(good_for(row.kind, &row.name).unwrap_or_default())
        });
    let shown: Vec<&Row> = rows
        .iter()
        .filter(|row| good_for(row.kind, &row.name).is_some())
        .collect();
    format!(
        "## The sheet's equilibrium\n\n\
         Details: [sheet](results/sheet/sheet.md). Errors are differences from the first row of each kind: of the \
         deployed corners, relative to the size of a panel, and of the gradient.\n\n{}",
        table.markdown(&shown)
    )
}

/// The recommended use of the choices in the short table.
fn good_for(kind: &str, name: &str) -> Option<&'static str> {
    Some(match (kind, name) {
        ("tolerance", "1e-10") => "the default",
        ("tolerance", "1e-4") => "a first look",
        ("load steps", "20") => "path functionals",
        ("load steps", "5") => "shape alone",
        ("method", "Newton, 1e-8") => "every use",
        ("method", "L-BFGS, 1e-8") => "comparison with the paper",
        ("hinge law", "surrogate") => "the final design: folding, yielding, damage",
        ("hinge law", "linear, secant at 20 deg") => "exploring with the weights' stiffness",
        ("hinge law", "pin, mean opening") => "exploring patterns by kinematics",
        ("hinge point", "corner") => "comparison with the paper",
        _ => return None,
    })
}

/// The error of the gradient against the cost.
fn panel(kind: &'static str, rows: &[Row]) -> CostPanel {
    let of_kind = rows.iter().filter(|row| row.kind == kind);
    let points = of_kind.map(|row| {
        let cost = 1e3 * row.measured.seconds[1];
        (row.scene, row.name.clone(), cost, row.difference.gradient)
    });
    CostPanel {
        title: kind,
        points: points.collect(),
    }
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
