//! Objective and gradient against an independent implementation with the Chamfer distance of the
//! paper: of all corners on the outline, to the samples of the target.

use crate::cases;
use crate::prelude::*;
use design::hinge_law::DamageMeasure;
use design::objective::response::ResponseCotangent;
use design::objective::term::Weighted;
use design::objective::terms::{Compression, DamageFunctional, Shear};
use serde_json::Value;

/// The Chamfer distance as the paper prints it, and its gradient.
fn sample_chamfer(points: &[[f64; 2]], target: &[[f64; 2]], coverage: f64) -> (f64, Vec<[f64; 2]>) {
    let nearest = |from: [f64; 2], others: &[[f64; 2]]| {
        let squared = |to: &[f64; 2]| (from[0] - to[0]).powi(2) + (from[1] - to[1]).powi(2);
        let distances = others.iter().map(squared).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    };
    let mut gradient = vec![[0.0; 2]; points.len()];
    let mut value = 0.0;
    let mut pair = |k: usize, t: usize, distance: f64, weight: f64| {
        value += weight * distance;
        (0..2).for_each(|axis| {
            gradient[k][axis] += 2.0 * weight * (points[k][axis] - target[t][axis])
        });
    };
    for (k, point) in points.iter().enumerate() {
        let (t, distance) = nearest(*point, target);
        pair(k, t, distance, 1.0 / points.len() as f64);
    }
    for (t, sample) in target.iter().enumerate() {
        let (k, distance) = nearest(*sample, points);
        pair(k, t, distance, coverage / target.len() as f64);
    }
    (value, gradient)
}

fn functionals(case: &Value) -> Vec<Weighted> {
    let weight = |name: &str| get(&case["weights"], name);
    let temperature = |name: &str| get(&case["softmax_temperature"], name);
    let [compression, shear] = ["comp", "shear"].map(temperature);
    let damage = DamageFunctional { measure: DamageMeasure::Mean, scale: 1.0, temperature: 0.1 };
    vec![
        Weighted::new(weight("damage"), damage),
        Weighted::new(weight("comp"), Compression { temperature: compression }),
        Weighted::new(weight("shear"), Shear { temperature: shear }),
    ]
}

/// A design or a gradient of the case.
fn vector(case: &Value, key: &str) -> DesignVector {
    DesignVector {
        pattern: coordinates(&case[key]),
        omega: get(&case[key], "omega"),
        opening: None,
    }
}

#[test]
fn a_pulled_sheet_with_path_functionals() {
    let case = case("g0_3x3_linear_path");
    let design = vector(&case, "theta");
    let [w_minus, w_plus] = get(&case["theta"], "w_minus_plus");
    let grid = cases::grid(&case);
    let law = LinearLaw::uniform(get(&case, "k_a_k_s_k_theta"), grid.hinge_count());
    let (supports, loads) = (cases::supports(&case), cases::loads(&case));
    let problem = DesignProblem {
        topology: grid.into(),
        outline: cases::outline(&case),
        widths: WidthChart { w_minus, w_plus },
        options: AT_CORNER,
        model: mechanics(law, solver(grid, &supports, &loads, get(&case, "nsteps"))),
        objective: Objective {
            shape: ShapeDistance {
                target: get(&case, "target"),
                coverage_weight: get(&case, "w_cov"),
                centred: false,
            },
            functionals: functionals(&case),
            penalties: Vec::new(),
        },
    };
    let evaluation = problem.evaluate(&design).unwrap();

    let sheet = &evaluation.deployment.sheet;
    let [w_lig, alpha]: [Vec<f64>; 2] = ["w_lig", "alpha"].map(|key| get(&case, key));
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        assert_close(hinge.w_lig, w_lig[h], 1e-14);
        assert_close(hinge.alpha, alpha[h], 1e-12);
    }
    let configurations: Vec<Vec<[f64; 3]>> = get(&case, "q_path");
    for (step, expected) in std::iter::zip(&evaluation.deployment.path, &configurations) {
        assert!(difference(&step.configuration, expected) < 1e-8);
    }

    let close = |found: f64, expected: f64| (found - expected).abs() <= 1e-6 * expected.abs();
    let terms = &case["terms"];
    let (target, coverage): (Vec<[f64; 2]>, f64) = (get(&case, "target"), get(&case, "w_cov"));
    let outline = sheet.outline_corners();
    let points = evaluation.deployment.outline(&outline);
    let (chamfer, by_points) = sample_chamfer(&points, &target, coverage);
    assert!(close(chamfer, get(terms, "chamfer")));
    let functionals = evaluation.loss - evaluation.terms["chamfer"];
    assert!(close(chamfer + functionals, get(&case, "loss")));
    assert!(close(evaluation.terms["compression"], get(terms, "comp")));
    assert!(close(evaluation.terms["shear"], get(terms, "shear")));
    assert_eq!(evaluation.terms["damage"], 0.0);

    // The gradient with the shape term exchanged: both go through the same equilibrium.
    let free = sheet.free_outline_corners();
    let ours = evaluation.deployment.outline(&free);
    let (_, by_ours) = problem.objective.shape.distance(&ours);
    let mut by = ResponseCotangent {
        corners: vec![[[0.0; 2]; 4]; sheet.panels.len()],
        reactions: vec![[0.0; 3]; sheet.panels.len()],
        load_factor: 0.0,
    };
    for (sign, corners, gradient) in [(1.0, &outline, &by_points), (-1.0, &free, &by_ours)] {
        for ((panel, corner), slope) in std::iter::zip(corners, gradient) {
            (0..2).for_each(|axis| by.corners[*panel][*corner][axis] += sign * slope[axis]);
        }
    }
    let configuration = &evaluation.deployment.final_step().configuration;
    let response = problem.response_at(&design, configuration).unwrap();
    let exchanged = problem.response_pullback(&design, &response, &by).unwrap();
    let pairs = std::iter::zip(evaluation.gradient.to_flat(), exchanged.design.to_flat());
    let found = pairs.map(|(gradient, change)| gradient + change);

    let expected = vector(&case, "grad");
    for (found, expected) in std::iter::zip(found, expected.to_flat()) {
        assert!(close(found, expected), "{found} {expected}");
    }
    assert!(evaluation.adjoint_residual < 1e-14);
}
