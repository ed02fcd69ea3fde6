//! Time of one design step: equilibria at ten load factors, and equilibria with the gradient, for several sheet
//! sizes; with the linear law, k_a / k_theta = 1e4, and with a learned hinge law of the paper's network size. One
//! thread, residual 1e-9 of the maximum force.
//!
//! The panel in the middle of the west edge is clamped, the panel in the middle of the east edge is pulled.

use design::equilibrium::load_step::Status;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{DamageMeasure, HingeLaw, LinearLaw, SurrogateLaw};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::Objective;
use design::objective::shape::Shape;
use design::objective::term::Weighted;
use design::objective::terms::{Compression, Damage, Shear};
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{HingePoint, SheetOptions};
use divan::{Bencher, black_box};
use hinge::{HingeConstants, TrainingDomain};
use std::sync::Arc;
use surrogate::{Card, Layer, Layers, Surrogate, Tensor, TestErrors, feature_names};

fn main() {
    divan::main();
}

const SIZES: [(usize, usize); 4] = [(7, 7), (15, 10), (30, 20), (100, 100)];
const LEARNED_SIZES: [(usize, usize); 3] = [(7, 7), (15, 10), (30, 20)];
const STEPS: usize = 10;

/// A sheet with panels of 1 x 1 and the linear law.
fn linear((m, n): (usize, usize)) -> (DesignProblem, DesignVector) {
    let law = LinearLaw::uniform([1e4, 1e4, 1.0], Grid { m, n }.hinge_count());
    problem(Grid { m, n }, 1.0, law, HingePoint::Corner, 3.0 * n as f64)
}

/// A sheet with panels of 100 mm and the learned hinge law.
fn learned((m, n): (usize, usize)) -> (DesignProblem, DesignVector) {
    problem(
        Grid { m, n },
        100.0,
        network(),
        HingePoint::CutTip,
        15.0 * n as f64,
    )
}

fn problem(
    grid: Grid,
    pitch: f64,
    law: impl HingeLaw + 'static,
    hinge_point: HingePoint,
    pull: f64,
) -> (DesignProblem, DesignVector) {
    let west = grid.m * (grid.n / 2);
    let supports = Dof::ALL.map(|dof| Support {
        panel: west,
        dof,
        value: 0.0,
    });
    let load = Load {
        panel: west + grid.m - 1,
        dof: Dof::UX,
        value: pull,
    };
    let settings = SolverSettings {
        tolerance: 1e-9,
        ..SolverSettings::default()
    };
    let outline = Outline::rectangle(pitch * grid.m as f64, pitch * grid.n as f64);
    let target = (0..500).map(|i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 500.0).sin_cos();
        [pitch * grid.m as f64 * cos, pitch * grid.n as f64 * sin]
    });
    let scale = law.damage_scale(DamageMeasure::Mean);
    let problem = DesignProblem {
        grid,
        outline,
        widths: WidthChart {
            w_minus: 0.08 * pitch,
            w_plus: 0.24 * pitch,
        },
        options: SheetOptions {
            hinge_point,
            process: HingeConstants {
                fillet_ratio: 0.16,
                kerf: 0.2,
                r_win: 100.0,
            }
            .into(),
        },
        model: Model::Equilibrium(Box::new(Mechanics {
            law: Arc::new(law),
            release: None,
            contact: None,
            solver: EquilibriumSolver::new(grid, &supports, &[load], STEPS, settings).unwrap(),
        })),
        objective: Objective {
            shape: Shape {
                target: target.collect(),
                coverage_weight: 0.5,
                centred: true,
            },
            functionals: vec![
                Weighted::new(
                    1.0,
                    Damage {
                        measure: DamageMeasure::Mean,
                        scale: scale.unwrap_or(1.0),
                        temperature: 0.1,
                    },
                ),
                Weighted::new(0.1, Compression { temperature: 0.02 }),
                Weighted::new(0.1, Shear { temperature: 0.02 }),
            ],
            penalties: Vec::new(),
        },
    };
    (problem, perturbed(grid))
}

/// The symmetric pattern, whose hinges are all equal, perturbed.
fn perturbed(grid: Grid) -> DesignVector {
    let mut design = DesignVector::uniform(grid);
    let wave = (0..).map(|i: i32| 0.5 * f64::from(i * i).sin());
    design
        .pattern
        .z
        .iter_mut()
        .zip(wave)
        .for_each(|(z, wave)| *z = wave);
    design
}

/// The paper's network with weights of the magnitude that training starts from.
fn network() -> SurrogateLaw {
    let layers = |widths: &[usize]| -> Vec<Layer> {
        let pairs = widths.windows(2);
        pairs
            .map(|pair| {
                let (inputs, outputs) = (pair[0], pair[1]);
                let size = (2.0 / inputs as f64).sqrt();
                let wave = |i: usize| size * ((i * i) as f64).sin();
                Layer {
                    weight: Tensor {
                        shape: vec![outputs, inputs],
                        values: (0..outputs * inputs).map(wave).collect(),
                    },
                    bias: Tensor {
                        shape: vec![outputs],
                        values: vec![0.1; outputs],
                    },
                }
            })
            .collect()
    };
    let card = Card {
        format_version: surrogate::FORMAT_VERSION,
        weights_hash: None,
        units: surrogate::UNITS.into(),
        features: feature_names(false)
            .iter()
            .map(ToString::to_string)
            .collect(),
        standardisation: surrogate::Standardisation {
            mean: [0.0, 0.0, 0.6, 18.0_f64.ln(), 1.57].to_vec(),
            std: [0.2, 0.2, 0.4, 0.45, 0.45].to_vec(),
        },
        energy_scale: 85.0,
        damage_scale: 0.01,
        peak_scale: None,
        damage_sharpness: 8.0,
        domain: TrainingDomain::from_box(
            [[-0.5, 0.5], [-0.5, 0.5], [-0.2, 1.4]],
            [5.0, 25.0],
            [0.5, 2.6],
        ),
        hinge: HingeConstants {
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        },
        material: "none".into(),
        material_hash: None,
        settings_hash: None,
        tier: "none".into(),
        dataset_hash: "none".into(),
        fine_tuned_from: None,
        distillation: None,
        split_hash: "none".into(),
        training: Default::default(),
        training_rays: None,
        training_s: None,
        test_errors: TestErrors::default(),
        error_bins: Vec::new(),
        spot_check: None,
    };
    let networks = Layers {
        chi: layers(&[5, 256, 256, 256, 128]),
        chi_d: layers(&[5, 256, 256, 1]),
        chi_p: None,
    };
    SurrogateLaw {
        surrogate: Surrogate::from_parts(networks, card).unwrap(),
    }
}

fn assert_equilibria(problem: &DesignProblem, design: &DesignVector) {
    let deployment = problem.deploy(design).unwrap();
    let iterations: usize = deployment
        .path
        .iter()
        .map(|step| step.effort.iterations)
        .sum();
    let last = deployment.final_step();
    let open = last
        .deformations
        .iter()
        .map(|d| d.theta.abs())
        .fold(0.0, f64::max);
    eprintln!(
        "{} x {}: {iterations} Newton iterations, opening {open:.2} rad, inside {:.2}, {:?}",
        problem.grid.m,
        problem.grid.n,
        deployment.share_inside(),
        last.status
    );
    assert_ne!(last.status, Status::Diverged);
}

#[divan::bench(args = SIZES, sample_count = 20, max_time = 10)]
fn equilibria_linear(bencher: Bencher, size: (usize, usize)) {
    let (problem, design) = linear(size);
    assert_equilibria(&problem, &design);
    bencher.bench(|| problem.deploy(black_box(&design)).unwrap());
}

#[divan::bench(args = SIZES, sample_count = 20, max_time = 10)]
fn equilibria_and_gradient_linear(bencher: Bencher, size: (usize, usize)) {
    let (problem, design) = linear(size);
    bencher.bench(|| problem.evaluate(black_box(&design)).unwrap());
}

#[divan::bench(args = LEARNED_SIZES, sample_count = 10, max_time = 10)]
fn equilibria_learned(bencher: Bencher, size: (usize, usize)) {
    let (problem, design) = learned(size);
    assert_equilibria(&problem, &design);
    bencher.bench(|| problem.deploy(black_box(&design)).unwrap());
}

#[divan::bench(args = LEARNED_SIZES, sample_count = 10, max_time = 10)]
fn equilibria_and_gradient_learned(bencher: Bencher, size: (usize, usize)) {
    let (problem, design) = learned(size);
    bencher.bench(|| problem.evaluate(black_box(&design)).unwrap());
}

/// The equilibrium at full load of a sheet whose ligaments are wider than those of a known path, as in the studio.
#[divan::bench(args = LEARNED_SIZES, sample_count = 10, max_time = 10)]
fn draft_learned(bencher: Bencher, size: (usize, usize)) {
    let (problem, design) = learned(size);
    let known = problem.deploy(&design).unwrap().known_path();
    let mut wider = design;
    wider.omega.iter_mut().for_each(|omega| *omega += 0.02);
    bencher.bench(|| problem.draft(black_box(&wider), Some(&known)).unwrap());
}
