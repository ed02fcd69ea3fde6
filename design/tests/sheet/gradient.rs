//! Objective and gradient against an independent implementation.

use crate::cases::{self, AT_CORNER, case, difference, get};
use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::geometry::chamfer::{Chamfer, Precision};
use design::hinge_law::{DamageMeasure, LinearLaw};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::Objective;
use design::objective::shape::{OutlinePoints, Shape};
use design::objective::term::Weighted;
use design::objective::terms::{Compression, Damage, Shear};
use design::pattern::design_vector::{DesignVector, WidthChart};
use serde_json::Value;
use std::sync::Arc;

fn functionals(case: &Value) -> Vec<Weighted> {
    let weight = |name: &str| get(&case["weights"], name);
    let temperature = |name: &str| get(&case["softmax_temperature"], name);
    let compression = Compression {
        temperature: temperature("comp"),
    };
    let shear = Shear {
        temperature: temperature("shear"),
    };
    vec![
        Weighted::new(
            weight("damage"),
            Damage {
                measure: DamageMeasure::Mean,
                scale: 1.0,
                temperature: 0.1,
            },
        ),
        Weighted::new(weight("comp"), compression),
        Weighted::new(weight("shear"), shear),
    ]
}

#[test]
fn a_pulled_sheet_with_path_functionals() {
    let case = case("g0_3x3_linear_path");
    let theta = &case["theta"];
    let design = DesignVector {
        pattern: cases::coordinates(theta),
        omega: get(theta, "omega"),
        opening: None,
    };
    let [w_minus, w_plus] = get(theta, "w_minus_plus");
    let grid = cases::grid(&case);
    let law = LinearLaw::uniform(get(&case, "k_a_k_s_k_theta"), grid.hinge_count());
    let problem = DesignProblem {
        grid,
        outline: cases::outline(&case),
        widths: WidthChart { w_minus, w_plus },
        options: AT_CORNER,
        model: Model::Equilibrium(Box::new(Mechanics {
            law: Arc::new(law),
            release: None,
            contact: None,
            solver: EquilibriumSolver::new(
                grid,
                &cases::supports(&case),
                &cases::loads(&case),
                get(&case, "nsteps"),
                SolverSettings::default(),
            )
            .unwrap(),
        })),
        objective: Objective {
            shape: Shape {
                target: get(&case, "target"),
                chamfer: Chamfer {
                    coverage_weight: get(&case, "w_cov"),
                    smoothing: 0.0,
                    precision: Precision::Samples,
                },
                outline: OutlinePoints::All,
                centre: None,
            },
            functionals: functionals(&case),
            penalties: Vec::new(),
            cut_sheets: None,
        },
    };
    let evaluation = problem.evaluate(&design).unwrap();

    let sheet = &evaluation.deployment.sheet;
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        assert!((hinge.w_lig - get::<Vec<f64>>(&case, "w_lig")[h]).abs() < 1e-14);
        assert!((hinge.alpha - get::<Vec<f64>>(&case, "alpha")[h]).abs() < 1e-12);
    }
    let configurations: Vec<Vec<[f64; 3]>> = get(&case, "q_path");
    for (step, expected) in std::iter::zip(&evaluation.deployment.path, &configurations) {
        assert!(difference(&step.configuration, expected) < 1e-8);
    }

    let close = |found: f64, expected: f64| (found - expected).abs() <= 1e-6 * expected.abs();
    assert!(close(evaluation.loss, get(&case, "loss")));
    let terms = &case["terms"];
    assert!(close(evaluation.terms["chamfer"], get(terms, "chamfer")));
    assert!(close(evaluation.terms["compression"], get(terms, "comp")));
    assert!(close(evaluation.terms["shear"], get(terms, "shear")));
    assert_eq!(evaluation.terms["damage"], 0.0);

    let expected = DesignVector {
        pattern: cases::coordinates(&case["grad"]),
        omega: get(&case["grad"], "omega"),
        opening: None,
    };
    for (found, expected) in std::iter::zip(evaluation.gradient.to_flat(), expected.to_flat()) {
        assert!(close(found, expected), "{found} {expected}");
    }
    assert!(evaluation.adjoint_residual < 1e-14);
}
