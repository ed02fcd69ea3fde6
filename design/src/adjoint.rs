//! The adjoint of the equilibria; (20). With g_i the gradient of the objective in q_i,
//!
//! ```text
//! H_i lambda_i = g_i,     dL/dp -= sum_i sum_h d/dp [ grad W(eps_h(q_i, p); p) . D eps_h(q_i, p)[lambda_i] ]
//! ```
//!
//! local to each hinge in p = (attachment point, centroids, angle of e_sec, w_lig, alpha). Each load
//! step reuses the factors of its own tangent, refined against the tangent itself.

use crate::equilibrium::{EquilibriumSolver, HingedSheet, LoadStep};
use crate::gradient::DesignError;
use crate::hinge_law::Order;
use crate::kinematics::{HingeGeometryGradient, HingeMotion};
use crate::panel_vectors::{add_at_hinge, at_hinge, gather, spread};
use crate::plane::{add, complex};
use crate::sheet::SheetGradient;
use crate::tangent::{Factor, TangentPattern};

/// Rounds of iterative refinement.
const REFINEMENTS: usize = 5;

/// The gradient of a function of the path in the sheet, through the hinge states it reads directly
/// and through the equilibria.
///
/// `by_path[h][i]` is its gradient in (a, s, theta, w_lig, alpha) of hinge h at load step i and
/// `by_last` in the last configuration. The gradient is added to `by_sheet`; returned is the greatest
/// componentwise backward error of the adjoint solves.
pub(crate) fn adjoint(
    solver: &EquilibriumSolver,
    sheet: HingedSheet,
    path: &[LoadStep],
    by_path: &[Vec<[f64; 5]>],
    by_last: Vec<[f64; 3]>,
    by_sheet: &mut SheetGradient,
) -> Result<f64, DesignError> {
    let mut by_configurations = vec![vec![[0.0; 3]; by_last.len()]; path.len()];
    by_configurations[path.len() - 1] = by_last;
    let mut greatest = 0.0_f64;
    for (i, (step, mut by_q)) in std::iter::zip(path, by_configurations).enumerate() {
        let hinges = || sheet.sheet.hinges.iter().enumerate();
        let motions: Vec<HingeMotion> = hinges()
            .map(|(h, _)| HingeMotion::new(sheet.sheet, h, &step.configuration))
            .collect();
        for (h, hinge) in hinges() {
            let [a, s, theta, ..] = by_path[h][i];
            add_at_hinge(&mut by_q, hinge, motions[h].forces([a, s, theta]));
        }
        let (tangent, factor) = (step.tangent.as_ref()).ok_or(DesignError::SingularTangent {
            load_factor: step.load_factor,
        })?;
        let rhs = gather(solver.free(), &by_q);
        let (lambda, error) = refined_solve(solver.pattern(), tangent, factor, &rhs);
        greatest = greatest.max(error);
        let lambda = spread(solver.free(), &lambda);
        let energies = sheet.energies(&step.deformations, Order::Design);
        for (h, hinge) in hinges() {
            let virtual_motion = at_hinge(hinge, &lambda);
            let (energy, rates) = (&energies[h], motions[h].rates(virtual_motion));
            let against = |row: [f64; 3]| -> f64 {
                std::iter::zip(row, rates)
                    .map(|(entry, rate)| entry * rate)
                    .sum()
            };
            let by_state = by_path[h][i];
            let weights = std::array::from_fn(|c| by_state[c] - against(energy.tangent[c]));
            let turning = motions[h].rates_geometry_gradient(energy.forces, virtual_motion);
            let stretching = motions[h].geometry_gradient(weights);
            let panels = [hinge.panel_a(), hinge.panel_b()];
            add_geometry(by_sheet, h, panels, &stretching, 1.0);
            add_geometry(by_sheet, h, panels, &turning, -1.0);
            by_sheet.widths[h] += by_state[3] - against(energy.mixed.map(|row| row[0]));
            by_sheet.alphas[h] += by_state[4] - against(energy.mixed.map(|row| row[1]));
        }
    }
    Ok(greatest)
}

fn add_geometry(
    by_sheet: &mut SheetGradient,
    hinge: usize,
    [a, b]: [usize; 2],
    gradient: &HingeGeometryGradient,
    sign: f64,
) {
    let add_point = |sum: &mut [f64; 2], point| add(sum, sign * complex(point));
    add_point(&mut by_sheet.attachments[hinge], gradient.attachment);
    add_point(&mut by_sheet.centroids[a], gradient.centroid_a);
    add_point(&mut by_sheet.centroids[b], gradient.centroid_b);
    by_sheet.frame_angles[hinge] += sign * gradient.frame_angle;
}

/// The solution of H x = rhs and its componentwise backward error.
fn refined_solve(
    pattern: &TangentPattern,
    tangent: &[f64],
    factor: &Factor,
    rhs: &[f64],
) -> (Vec<f64>, f64) {
    let mut solution = vec![0.0; rhs.len()];
    let mut remainder = rhs.to_vec();
    let mut error = f64::INFINITY;
    for _ in 0..=REFINEMENTS {
        pattern.solve(factor, &mut remainder);
        let refined: Vec<f64> = std::iter::zip(&solution, &remainder)
            .map(|(x, d)| x + d)
            .collect();
        let (product, bound) = pattern.product(tangent, &refined);
        remainder = std::iter::zip(rhs, product).map(|(b, p)| b - p).collect();
        let refined_error = backward_error(&remainder, &bound, rhs);
        if refined_error >= 0.5 * error {
            break;
        }
        (solution, error) = (refined, refined_error);
    }
    (solution, error)
}

/// Greatest |b - H x| over |H| |x| + |b|.
fn backward_error(remainder: &[f64], bound: &[f64], rhs: &[f64]) -> f64 {
    (remainder.iter().zip(bound).zip(rhs))
        .filter(|((remainder, _), _)| **remainder != 0.0)
        .map(|((remainder, bound), rhs)| remainder.abs() / (bound + rhs.abs()))
        .fold(0.0, f64::max)
}
