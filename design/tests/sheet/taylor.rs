//! The whole gradient of L in theta, by its Taylor remainders in each block of the design vector.

use crate::prelude::*;
use design::hinge_law::DamageMeasure;
use design::objective::term::Weighted;
use design::objective::terms::{
    Compression, DamageFunctional, DomainPenalty, PanelShape, Shear, SymmetricDifference,
};
use std::path::Path;
use surrogate::Surrogate;
use testkit::domain_of_box;

pub const GRID: Grid = Grid { m: 3, n: 3 };
/// Side of the sheet (mm).
pub const SIDE: f64 = 300.0;

pub fn tiny() -> SurrogateLaw {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let surrogate = Surrogate::load(&cases.join("chi_tiny.safetensors")).unwrap();
    SurrogateLaw { surrogate }
}

/// Clamped in the middle of the west edge, with a moment at a corner; in the middle of the east
/// edge pulled, moved, or pulled up to a stroke.
pub fn held(law: impl HingeLaw + 'static, moment: f64, east: East) -> Model {
    let mut supports = clamp(3).to_vec();
    let mut loads = vec![load(8, Dof::Phi, moment)];
    match east {
        East::Pulled(force) | East::Driven(force, _) => loads.push(pull(5, force)),
        East::Moved(way) => supports.push(support(5, Dof::UX, way)),
    }
    let mut solver = solver(GRID, &supports, &loads, 4);
    if let East::Driven(_, stroke) = east {
        solver = solver.driven(stroke).unwrap();
    }
    let mut model = mechanics(law, solver);
    mechanics_of(&mut model).contact = Some(Contact::new(10.0, -0.2, 0.0).unwrap());
    model
}

pub const EASTS: [East; 3] = [East::Pulled(12.0), East::Moved(40.0), East::Driven(12.0, 60.0)];

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
    let state = [[-0.02, 0.0], [-0.01, 0.01], [0.0, 0.02]];
    let domain =
        DomainPenalty { domain: law.map(|_| domain_of_box(state, [15.0, 17.0], [1.5, 1.6])) };
    let measure = DamageMeasure::Mean;
    let damage = DamageFunctional {
        measure,
        scale: law.and_then(|law| law.damage_scale(measure)).unwrap_or(1.0),
        temperature: 0.1,
    };
    let shape = PanelShape { min_distance: 200.0 };
    DesignProblem {
        topology: GRID.into(),
        outline: Outline::rectangle(SIDE, SIDE),
        widths: WidthChart { w_minus: 8.0, w_plus: 24.0 },
        options: SheetOptions { hinge_point, ..AT_TIP },
        model,
        objective: Objective {
            shape: ShapeDistance { target: target.collect(), coverage_weight: 0.5, centred: true },
            functionals: vec![
                Weighted::new(300.0, damage),
                Weighted::new(1e4, Compression { temperature: 0.02 }),
                Weighted::new(1e4, Shear { temperature: 0.02 }),
            ],
            penalties: vec![Weighted::new(200.0, shape), Weighted::new(1.0, domain)],
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
        let found = matches!(step.status, Status::Converged | Status::LeftDomain);
        assert!(found && step.residual < 1e-10, "{step:?}");
    }
    assert!(evaluation.adjoint_residual < 1e-14);
    let (x, gradient) = (design.to_flat(), evaluation.gradient.to_flat());
    let z = design.pattern.z.len();
    let ell = design.pattern.ell.iter().flatten().count();
    let hinges = z + ell + design.omega.len();
    let blocks = [
        ("z", 0..z),
        ("ell", z..z + ell),
        ("omega", z + ell..hinges),
        ("opening", hinges..x.len()),
    ];
    for (name, block) in blocks.into_iter().filter(|(_, block)| !block.is_empty()) {
        if gradient[block.clone()].iter().all(|slope| *slope == 0.0) {
            let ideal = matches!(problem.model, Model::Ideal { .. });
            assert!(ideal && name == "omega", "{name} has no gradient");
            continue;
        }
        let mut direction = vec![0.0; x.len()];
        let values = Random::new(13).numbers(block.len(), 1.0);
        direction[block].copy_from_slice(&values);
        let loss = |x: &[f64]| problem.loss(&design.with_flat(x));
        let remainders = TaylorRemainders::new(loss, &x, &gradient, &direction, 1e-3, 4).unwrap();
        remainders.assert_orders(1.95..2.05);
    }
}

#[test]
fn ideal_deployment() {
    let mut design = start();
    design.opening = Some(1.0);
    let model = Model::Ideal { opening: 0.0 };
    assert_order_two(&problem(model, HingePoint::Corner), &design);
}

/// The opening is a design variable, or held; the outline is centred.
#[test]
fn taylor_rate_of_two_with_the_symmetric_difference() {
    let mut problem = problem(Model::Ideal { opening: 0.9 }, HingePoint::Corner);
    problem.objective.shape.centred = true;
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
fn linear_law_pulled_moved_and_driven() {
    for east in EASTS {
        let model = held(springs(), 240.0, east);
        assert_order_two(&problem(model, HingePoint::Corner), &start());
    }
    let at_the_tip = problem(held(springs(), 240.0, EASTS[0]), HingePoint::CutTip);
    assert_order_two(&at_the_tip, &start());
}

#[test]
fn surrogate_law_at_the_tip_pulled_and_driven() {
    for east in [East::Pulled(2.0), East::Driven(2.0, 18.0)] {
        let model = held(tiny(), 40.0, east);
        assert_order_two(&problem(model, HingePoint::CutTip), &start());
    }
}

/// A hole of the same diameter at every hinge: its radius over w_lig depends on the width.
#[test]
fn surrogate_law_with_drilled_holes() {
    let model = held(tiny(), 20.0, East::Pulled(3.0));
    let mut problem = problem(model, HingePoint::CutTip);
    problem.options.process.hole = HoleSize::Diameter(4.0);
    assert_order_two(&problem, &start());
}

/// The same problem for a sheet with a weight, held and pulled at other points than centroids.
pub fn hung(mut model: Model, by_area: [f64; 2]) -> Model {
    let points = vec![
        attached(3, PanelPoint::Middle([3, 0])),
        attached(5, PanelPoint::Fixed([0.95 * SIDE, 0.45 * SIDE])),
        attached(8, PanelPoint::Middle([2, 3])),
    ];
    let mechanics = mechanics_of(&mut model);
    let solver = mechanics.solver.clone().attached_at(points);
    mechanics.solver = solver.with_weight(by_area).unwrap();
    model
}

#[test]
fn hanging_sheets() {
    for east in EASTS {
        let model = hung(held(springs(), 240.0, east), [1e-5, -5e-5]);
        assert_order_two(&problem(model, HingePoint::Corner), &start());
    }
    let learned = hung(held(tiny(), 40.0, East::Driven(2.0, 12.0)), [0.0, -1e-5]);
    assert_order_two(&problem(learned, HingePoint::CutTip), &start());
}

#[test]
fn a_sheet_on_a_nail() {
    let nail = [Dof::UX, Dof::UY].map(|dof| support(6, dof, 0.0));
    let solver = solver(GRID, &nail, &[load(5, Dof::UY, -0.5)], 4);
    let model = hung(mechanics(springs(), solver), [0.0, -5e-5]);
    assert_order_two(&problem(model, HingePoint::Corner), &start());
}
