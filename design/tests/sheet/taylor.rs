//! The whole gradient of L in theta, by its Taylor remainders in each block of the design vector.

use crate::cases::PROCESS;
use crate::derivatives::TaylorRemainders;
use crate::random::Random;
use design::equilibrium::load_step::Status;
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{Contact, DamageMeasure, HingeLaw, LinearLaw, SurrogateLaw};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::Objective;
use design::objective::shape::Shape;
use design::objective::term::Weighted;
use design::objective::terms::{
    Compression, Damage, DomainPenalty, PanelShape, Shear, SymmetricDifference,
};
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{Grip, HingePoint, PanelPoint, SheetOptions};
use design::sheet::cutting_process::Hole;
use hinge::TrainingDomain;
use std::path::Path;
use std::sync::Arc;
use surrogate::Surrogate;

pub const GRID: Grid = Grid { m: 3, n: 3 };
/// Side of the sheet (mm).
pub const SIDE: f64 = 300.0;

pub fn tiny() -> SurrogateLaw {
    let weights = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/cases/chi_tiny.safetensors"
    );
    SurrogateLaw {
        surrogate: Surrogate::load(Path::new(weights)).unwrap(),
    }
}

/// Clamped in the middle of the west edge, with a moment at a corner; in the middle of the east edge
/// pulled, moved, or pulled up to a stroke.
pub fn mechanics(law: impl HingeLaw + 'static, moment: f64, east: East) -> Model {
    let support = |panel, dof, value| Support { panel, dof, value };
    let load = |panel, dof, value| Load { panel, dof, value };
    let mut supports = Dof::ALL.map(|dof| support(3, dof, 0.0)).to_vec();
    let mut loads = vec![load(8, Dof::Phi, moment)];
    match east {
        East::Pulled(force) | East::Driven(force, _) => loads.push(load(5, Dof::UX, force)),
        East::Moved(way) => supports.push(support(5, Dof::UX, way)),
    }
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(GRID, &supports, &loads, 4, settings).unwrap();
    Model::Equilibrium(Box::new(Mechanics {
        law: Arc::new(law),
        release: None,
        contact: Some(Contact::new(10.0, -0.2, 0.0).unwrap()),
        solver: match east {
            East::Driven(_, stroke) => solver.driven(stroke).unwrap(),
            _ => solver,
        },
    }))
}

#[derive(Clone, Copy)]
pub enum East {
    /// N
    Pulled(f64),
    /// N, and the stroke (mm)
    Driven(f64, f64),
    /// mm
    Moved(f64),
}

pub fn problem(model: Model, hinge_point: HingePoint) -> DesignProblem {
    let target = (0..60).map(|i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 60.0).sin_cos();
        [0.6 * SIDE * cos, 0.45 * SIDE * sin]
    });
    // A domain that most states are outside of; for pins there is none.
    let law = match &model {
        Model::Ideal { .. } => None,
        Model::Equilibrium(mechanics) => Some(&mechanics.law),
    };
    let domain = DomainPenalty {
        domain: law.map(|_| {
            TrainingDomain::from_box(
                [[-0.02, 0.0], [-0.01, 0.01], [0.0, 0.02]],
                [15.0, 17.0],
                [1.5, 1.6],
            )
        }),
    };
    let scale = law.and_then(|law| law.damage_scale(DamageMeasure::Mean));
    DesignProblem {
        grid: GRID,
        outline: Outline::rectangle(SIDE, SIDE),
        widths: WidthChart {
            w_minus: 8.0,
            w_plus: 24.0,
        },
        options: SheetOptions {
            hinge_point,
            process: PROCESS,
        },
        model,
        objective: Objective {
            shape: Shape {
                target: target.collect(),
                coverage_weight: 0.5,
                centred: true,
            },
            functionals: vec![
                Weighted::new(
                    300.0,
                    Damage {
                        measure: DamageMeasure::Mean,
                        scale: scale.unwrap_or(1.0),
                        temperature: 0.1,
                    },
                ),
                Weighted::new(1e4, Compression { temperature: 0.02 }),
                Weighted::new(1e4, Shear { temperature: 0.02 }),
            ],
            penalties: vec![
                Weighted::new(
                    200.0,
                    PanelShape {
                        min_distance: 200.0,
                    },
                ),
                Weighted::new(1.0, domain),
            ],
        },
    }
}

pub fn start() -> DesignVector {
    let mut random = Random::new(11);
    DesignVector {
        pattern: PatternCoordinates {
            z: random.numbers(4, 0.5),
            ell: std::array::from_fn(|_| random.numbers(3, 0.3)),
        },
        omega: random.numbers(12, 1.0),
        opening: None,
    }
}

/// Asserts order 2 along a random direction in each block (z, ell, omega, opening).
pub fn assert_order_two(problem: &DesignProblem, design: &DesignVector) {
    let evaluation = problem.evaluate(design).unwrap();
    for step in &evaluation.deployment.path {
        assert!(
            matches!(step.status, Status::Converged | Status::LeftDomain),
            "{step:?}"
        );
        assert!(step.residual < 1e-10, "{}", step.residual);
    }
    assert!(evaluation.adjoint_residual < 1e-14);
    let (x, gradient) = (design.to_flat(), evaluation.gradient.to_flat());
    let (z, ell) = (
        design.pattern.z.len(),
        design.pattern.ell.iter().flatten().count(),
    );
    let blocks = [
        ("z", 0..z),
        ("ell", z..z + ell),
        ("omega", z + ell..z + ell + design.omega.len()),
        ("opening", z + ell + design.omega.len()..x.len()),
    ];
    for (name, block) in blocks.into_iter().filter(|(_, block)| !block.is_empty()) {
        let slope = gradient[block.clone()]
            .iter()
            .map(|g| g.abs())
            .fold(0.0, f64::max);
        if slope == 0.0 {
            let ideal = matches!(problem.model, Model::Ideal { .. });
            assert!(ideal && name == "omega", "{name} has no gradient");
            continue;
        }
        let mut direction = vec![0.0; x.len()];
        let values = Random::new(13).numbers(block.len(), 1.0);
        direction[block].copy_from_slice(&values);
        let loss = |x: &[f64]| problem.loss(&design.with_flat(x));
        let remainders = TaylorRemainders::new(loss, &x, &gradient, &direction, 1e-3, 4).unwrap();
        let orders = remainders.orders();
        assert!(
            orders.iter().all(|order| (1.95..2.05).contains(order)),
            "{name}: {remainders:?} {orders:?}"
        );
    }
}

#[test]
fn ideal_deployment() {
    let design = DesignVector {
        opening: Some(1.0),
        ..start()
    };
    assert_order_two(
        &problem(Model::Ideal { opening: 0.0 }, HingePoint::Corner),
        &design,
    );
}

/// With the opening as a design variable, and held.
#[test]
fn taylor_rate_of_two_with_the_symmetric_difference() {
    let mut problem = problem(Model::Ideal { opening: 0.9 }, HingePoint::Corner);
    let difference = SymmetricDifference::new(problem.objective.shape.clone());
    let difference = Weighted::new(1e5, difference);
    problem.objective.penalties.push(difference);
    for opening in [Some(0.8), None] {
        let design = DesignVector { opening, ..start() };
        let evaluation = problem.evaluate(&design).unwrap();
        assert!(evaluation.terms["symmetric_difference"] > 0.0);
        assert_order_two(&problem, &design);
    }
}

pub fn springs() -> LinearLaw {
    LinearLaw::uniform([20.0, 12.0, 1500.0], GRID.hinge_count())
}

#[test]
fn linear_law_at_the_corner_and_at_the_tip() {
    for hinge_point in [HingePoint::Corner, HingePoint::CutTip] {
        let model = mechanics(springs(), 240.0, East::Pulled(12.0));
        assert_order_two(&problem(model, hinge_point), &start());
    }
}

#[test]
fn linear_law_with_a_moving_support() {
    let model = mechanics(springs(), 240.0, East::Moved(40.0));
    assert_order_two(&problem(model, HingePoint::Corner), &start());
}

#[test]
fn driven_sheets() {
    let linear = mechanics(springs(), 240.0, East::Driven(12.0, 60.0));
    assert_order_two(&problem(linear, HingePoint::Corner), &start());
    let learned = mechanics(tiny(), 40.0, East::Driven(2.0, 18.0));
    assert_order_two(&problem(learned, HingePoint::CutTip), &start());
}

#[test]
fn surrogate_law_at_the_tip() {
    let model = mechanics(tiny(), 40.0, East::Pulled(2.0));
    assert_order_two(&problem(model, HingePoint::CutTip), &start());
}

/// A hole of the same diameter at every hinge: its radius over w_lig depends on the width.
#[test]
fn surrogate_law_with_drilled_holes() {
    let model = mechanics(tiny(), 20.0, East::Pulled(3.0));
    let mut problem = problem(model, HingePoint::CutTip);
    problem.options.process.hole = Hole::Diameter(4.0);
    assert_order_two(&problem, &start());
}

/// The same problem for a sheet with a weight, held and pulled at other points than centroids.
pub fn hung(model: Model, by_area: [f64; 2]) -> Model {
    let Model::Equilibrium(mechanics) = model else {
        panic!("pins have no weight");
    };
    let grip = |panel, point| Grip { panel, point };
    let grips = vec![
        grip(3, PanelPoint::Middle([3, 0])),
        grip(5, PanelPoint::Fixed([0.95 * SIDE, 0.45 * SIDE])),
        grip(8, PanelPoint::Middle([2, 3])),
    ];
    let solver = mechanics.solver.clone().gripping(grips);
    Model::Equilibrium(Box::new(Mechanics {
        solver: solver.with_weight(by_area).unwrap(),
        ..*mechanics
    }))
}

#[test]
fn hanging_sheets() {
    let weight = [1e-5, -5e-5];
    for east in [
        East::Pulled(12.0),
        East::Moved(40.0),
        East::Driven(12.0, 60.0),
    ] {
        let model = hung(mechanics(springs(), 240.0, east), weight);
        assert_order_two(&problem(model, HingePoint::Corner), &start());
    }
    let learned = mechanics(tiny(), 40.0, East::Driven(2.0, 12.0));
    let learned = hung(learned, [0.0, -1e-5]);
    assert_order_two(&problem(learned, HingePoint::CutTip), &start());
}

#[test]
fn a_sheet_on_a_nail() {
    let pin = [Dof::UX, Dof::UY].map(|dof| Support {
        panel: 6,
        dof,
        value: 0.0,
    });
    let load = Load {
        panel: 5,
        dof: Dof::UY,
        value: -0.5,
    };
    let settings = SolverSettings::default();
    let solver = EquilibriumSolver::new(GRID, &pin, &[load], 4, settings).unwrap();
    let model = Model::Equilibrium(Box::new(Mechanics {
        law: Arc::new(springs()),
        release: None,
        contact: None,
        solver,
    }));
    let model = hung(model, [0.0, -5e-5]);
    assert_order_two(&problem(model, HingePoint::Corner), &start());
}
