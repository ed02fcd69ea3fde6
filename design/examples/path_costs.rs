//! Prints what equilibrium paths cost, for linear sheets of growing size and for the scenes of learned hinges:
//! corrections, factorisations, increments, jumps, CPU seconds of one thread; of linear sheets the exponent with which the
//! time grows from one to the next; of learned ones the number of evaluations of all hinges.
//!
//! ```sh
//! cargo run --release -p design --example path_costs -- 10000      # up to 10 000 panels
//! ```
//!
//! Uniform sheets of m x n panels of 1 mm, r = 0.45, k_a = k_s = 1000 N/mm, k_theta = 0.1 N mm/rad, hinge point at the
//! corner; a pin at the middle of the west edge, a roller at the middle of the east edge, which is pulled in ten load
//! steps. The learned sheets are those of `configs/scenes`, each with three random designs and one near each; a path is
//! followed or corrected from that of the design near it, and the gradient of the objective computed.

use design::equilibrium::hinged_sheet::HingedSheet;
use design::equilibrium::load_step::LoadStep;
use design::equilibrium::nearby_path::KnownPath;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{
    DamageMeasure, HingeDamage, HingeEnergy, HingeLaw, LinearLaw, Order, PreparedLaw,
};
use design::objective::design_problem::Model;
use design::pattern::coordinates::{PatternCoordinates, logit};
use design::pattern::cut_pattern::{CutPattern, Outline};
use design::pattern::design_vector::DesignVector;
use design::pattern::grid::Grid;
use design::scene::{Scene, SceneConfig};
use design::sheet::cut_sheet::{Centroid, HingePoint, Sheet, SheetOptions};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, TrainingDomain};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Columns, rows and load (N).
const SHEETS: [(usize, usize, f64); 6] = [
    (7, 7, 3.0),
    (15, 10, 6.0),
    (30, 20, 12.0),
    (60, 40, 24.0),
    (100, 100, 40.0),
    (300, 300, 120.0),
];
const STEPS: usize = 10;

fn sheet(grid: Grid) -> Sheet {
    let mut coordinates = PatternCoordinates::uniform(grid);
    coordinates.z.fill(logit(0.45));
    let outline = Outline::rectangle(grid.m as f64, grid.n as f64);
    let pattern = CutPattern::new(grid, outline, &coordinates).expect("the pattern is uniform");
    let options = SheetOptions {
        hinge_point: HingePoint::Corner,
        centroid: Centroid::Vertices,
        process: HingeConstants::PAPER,
    };
    let widths = vec![0.1; grid.hinge_count()];
    Sheet::new(&pattern, &widths, options).expect("the sheet is uniform")
}

fn path(grid: Grid, load: f64) -> (Vec<LoadStep>, f64) {
    let sheet = sheet(grid);
    let law = LinearLaw::uniform([1000.0, 1000.0, 0.1], grid.hinge_count());
    let law = law.expect("the constants are positive");
    let [west, east] = [0, grid.m - 1].map(|column| grid.panel(column, grid.n / 2));
    let held = [(west, Dof::UX), (west, Dof::UY), (east, Dof::UY)];
    let supports = held.map(|(panel, dof)| Support {
        panel,
        dof,
        value: 0.0,
    });
    let pull = Load {
        panel: east,
        dof: Dof::UX,
        value: load,
    };
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(grid, &supports, &[pull], STEPS, settings);
    let solver = solver.expect("pin and roller hold the sheet");
    let law = law.prepare(&sheet.designs());
    let hinged = HingedSheet {
        sheet: &sheet,
        law: &*law,
        contact: None,
        damage_gradient: false,
    };
    // CPU times are known to some milliseconds: the paths of small sheets are repeated.
    let repeats = (10_000 / grid.panel_count()).max(1);
    let begin = cpu_seconds();
    (1..repeats).for_each(|_| drop(solver.path(hinged)));
    let path = solver.path(hinged);
    (path, (cpu_seconds() - begin) / repeats as f64)
}

/// CPU time of the threads of this process (s), which other processes of the machine do not lengthen.
fn cpu_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten();
    let times = threads.flatten().filter_map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    1e-9 * times.sum::<f64>()
}

/// The scenes with learned hinges, their designs and the standard deviation of their coordinates.
const SCENES: [&str; 4] = ["pet-3x3", "a4-polyester", "pet-7x7", "pet-bell-16x22"];
const SEEDS: [u64; 3] = [1, 2, 3];
const NOISE: f64 = 0.5;
/// Maximum change of a coordinate to the design near it.
const NEAR: f64 = 0.02;

/// A hinge law that counts the evaluations of all hinges, by their order.
struct Counted {
    law: Arc<dyn HingeLaw>,
    counts: Arc<[AtomicUsize; 4]>,
}

struct CountedHinges<'a> {
    law: Box<dyn PreparedLaw + 'a>,
    counts: &'a [AtomicUsize; 4],
}

impl HingeLaw for Counted {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        let (law, counts) = (self.law.prepare(designs), &*self.counts);
        Box::new(CountedHinges { law, counts })
    }

    fn damage_scale(&self, measure: DamageMeasure) -> Option<f64> {
        self.law.damage_scale(measure)
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        self.law.domain()
    }
}

impl PreparedLaw for CountedHinges<'_> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        self.counts[order as usize].fetch_add(1, Relaxed);
        self.law.energies(deformations, order)
    }

    fn damage(&self, deformations: &[HingeDeformation], with_gradient: bool) -> Vec<HingeDamage> {
        self.law.damage(deformations, with_gradient)
    }

    fn resolution(&self) -> f64 {
        self.law.resolution()
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        self.law.inside(deformations)
    }
}

/// Three rows of the table of learned sheets: a random design, and a design near it whose path is followed and corrected
/// from that of the first.
fn learned(name: &str, seed: u64) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let path = scenes.join(name).with_extension("toml");
    let mut config: SceneConfig = support::toml_file::read(&path).expect("the scene is readable");
    config.optimiser.seed = seed;
    config.optimiser.start_noise = NOISE;
    let scene = Scene::new(config, &path).expect("the scene is valid");
    let mut problem = scene.problem().expect("the scene has equilibria");
    let counts = Arc::new([0; 4].map(AtomicUsize::new));
    if let Model::Equilibrium(mechanics) = &mut problem.model {
        mechanics.law = Arc::new(Counted {
            law: mechanics.law.clone(),
            counts: counts.clone(),
        });
    }
    let row = |text: &str, design: &DesignVector, known: Option<&KnownPath>| {
        counts.iter().for_each(|count| count.store(0, Relaxed));
        let begin = cpu_seconds();
        let evaluation = problem.evaluate_near(design, known);
        let seconds = cpu_seconds() - begin;
        let evaluation = evaluation.expect("the design has an equilibrium");
        let path = &evaluation.deployment.path;
        let total = |of: fn(&LoadStep) -> usize| path.iter().map(of).sum::<usize>();
        let [_, forces, tangents, designs] = &*counts;
        let how = match evaluation.deployment.followed {
            true => "followed",
            false => "corrected",
        };
        let row = format!(
            "| {name} | {seed}{text} | {how} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {seconds:.4} | {:.10e} |",
            path.len(),
            total(|step| step.effort.iterations),
            total(|step| step.effort.factorisations),
            total(|step| step.effort.increments),
            total(|step| step.effort.rejected),
            total(|step| step.jumps),
            forces.load(Relaxed),
            tangents.load(Relaxed),
            designs.load(Relaxed),
            evaluation.loss,
        );
        (row, evaluation.deployment.known_path())
    };
    let start = scene.start();
    let (first, known) = row("", &start, None);
    let beside: Vec<f64> = std::iter::zip(start.to_flat(), 0..)
        .map(|(coordinate, i)| coordinate + NEAR * f64::from(i).sin())
        .collect();
    let near = start.with_flat(&beside);
    let (followed, _) = row(", near", &near, None);
    let (corrected, _) = row(", near", &near, Some(&known));
    [first, followed, corrected].join("\n")
}

fn main() {
    let largest = std::env::args().nth(1);
    let largest = largest.map_or(10_000, |text| text.parse().expect("a number of panels"));
    println!(
        "| panels | corrections | factorisations | increments | rejected | jumps | CPU s | exponent | potential, N mm |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut before: Option<(f64, f64)> = None;
    for (m, n, load) in SHEETS.into_iter().filter(|(m, n, _)| m * n <= largest) {
        let (path, seconds) = path(Grid { m, n }, load);
        let total = |of: fn(&LoadStep) -> usize| path.iter().map(of).sum::<usize>();
        let panels = (m * n) as f64;
        let exponent = before.map_or(String::new(), |(smaller, faster)| {
            format!("{:.2}", (seconds / faster).ln() / (panels / smaller).ln())
        });
        println!(
            "| {m} x {n} | {} | {} | {} | {} | {} | {seconds:.4} | {exponent} | {:.8e} |",
            total(|step| step.effort.iterations),
            total(|step| step.effort.factorisations),
            total(|step| step.effort.increments),
            total(|step| step.effort.rejected),
            total(|step| step.jumps),
            path.last().map_or(f64::NAN, |step| step.potential),
        );
        before = Some((panels, seconds));
    }
    println!(
        "\n| scene | design | path | load steps | corrections | factorisations | increments | rejected | jumps | forces | tangents | design gradients | CPU s | loss, mm^2 |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for name in SCENES {
        for seed in SEEDS {
            println!("{}", learned(name, seed));
        }
    }
}
