//! Disagreement of further networks of the same training on the path of a design, an estimate of
//! the error of the learned law.
//!
//! It does not contain errors that all networks have in common, such as the error of the window's
//! mesh. (Lakshminarayanan et al., "Simple and scalable predictive uncertainty estimation", 2017.)

use design::objective::design_problem::Deployment;
use hinge::HingeDeformation;
use surrogate::{Order, Surrogate, mean_and_variance};

/// Standard deviation of (w_lig F_a, w_lig F_s, M_theta) over the networks, for every hinge at every
/// load step, relative to the root mean square of the forces over the path; NaN outside the training
/// domain. `None` for a single network.
pub(crate) fn force_spreads(
    networks: &[Surrogate],
    deployment: &Deployment,
) -> Option<Vec<Vec<f64>>> {
    if networks.len() < 2 {
        return None;
    }
    let designs = deployment.sheet.designs();
    let prepared: Vec<_> = networks.iter().map(|network| network.prepare(&designs)).collect();
    let (mut squares, mut count) = (0.0, 0);
    let mut deviations: Vec<Vec<f64>> = Vec::new();
    for step in &deployment.path {
        let states: &[HingeDeformation] = &step.deformations;
        let energies: Vec<_> = std::iter::zip(networks, &prepared)
            .map(|(network, prepared)| network.evaluate(prepared, states, Order::Forces))
            .collect();
        let of_hinge = |(hinge, inside): (usize, &bool)| {
            if !inside {
                return f64::NAN;
            }
            let w = designs[hinge].w_lig;
            let spreads = [w, w, 1.0].into_iter().enumerate().map(|(i, scale)| {
                let values = energies.iter().map(|all| scale * all[hinge].forces[i]);
                mean_and_variance(values)
            });
            let variance = spreads.fold(0.0, |sum, [mean, variance]| {
                squares += mean * mean;
                sum + variance
            });
            count += 1;
            variance.sqrt()
        };
        deviations.push(step.inside.iter().enumerate().map(of_hinge).collect());
    }
    let scale = (squares / f64::from(count.max(1))).sqrt();
    let relative = deviations.iter_mut().flatten();
    relative.for_each(|deviation| *deviation /= scale.max(f64::MIN_POSITIVE));
    Some(deviations)
}
