//! Disagreement of further networks of the same training on the path of a design, an estimate of
//! the error of the learned law.
//!
//! ```text
//! sigma_X = (mean over states of the variance of X over the networks)^(1/2) / (mean of X^2)^(1/2)
//! ```
//!
//! over the states inside the training domain, for X = W, (w_lig F_a, w_lig F_s, M_theta) and
//! D_peak. It does not contain errors that all networks have in common, such as the error of the
//! window's mesh. (Lakshminarayanan et al., "Simple and scalable predictive uncertainty
//! estimation", 2017.)

use design::objective::design_problem::Deployment;
use hinge::HingeDeformation;
use serde::Serialize;
use surrogate::{Order, Surrogate, mean_and_variance};

/// Standard deviations over an ensemble, relative to the root mean square over the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Estimate {
    /// Number of networks.
    pub networks: usize,
    /// Standard deviation of W.
    pub energy: f64,
    /// Standard deviation of (w_lig F_a, w_lig F_s, M_theta).
    pub forces: f64,
    /// Standard deviation of D_peak; `None` if a network does not predict it.
    pub damage_peak: Option<f64>,
}

/// Sums over the states: of the variances, and of the squares of the means.
#[derive(Default)]
struct NetworkSpread {
    variances: f64,
    squares: f64,
}

impl Estimate {
    /// The estimate for a path computed with the first of `networks`; `None` for a single network,
    /// or if no state is inside the training domain.
    pub(super) fn new(networks: &[Surrogate], deployment: &Deployment) -> Option<Self> {
        let [mut energy, mut forces, mut peak] = [(); 3].map(|()| NetworkSpread::default());
        let mut peak_known = true;
        for (step, predictions) in
            std::iter::zip(&deployment.path, predictions(networks, deployment))
        {
            for (_, [w, f_a, f_s, m, d_peak]) in
                std::iter::zip(&step.inside, predictions).filter(|(inside, _)| **inside)
            {
                energy.add(&w);
                [f_a, f_s, m].iter().for_each(|force| forces.add(force));
                peak_known &= d_peak.iter().all(|x| !x.is_nan());
                peak.add(&d_peak);
            }
        }
        (networks.len() > 1 && energy.squares > 0.0).then(|| Self {
            networks: networks.len(),
            energy: energy.relative(),
            forces: forces.relative(),
            damage_peak: peak_known.then(|| peak.relative()),
        })
    }
}

/// sigma of the forces of every hinge at every load step, relative to the root mean square of the
/// forces over the path; NaN outside the training domain. `None` for a single network.
pub(crate) fn force_spreads(
    networks: &[Surrogate],
    deployment: &Deployment,
) -> Option<Vec<Vec<f64>>> {
    if networks.len() < 2 {
        return None;
    }
    let (mut squares, mut count) = (0.0, 0);
    let mut deviations: Vec<Vec<f64>> = Vec::new();
    for (step, predictions) in std::iter::zip(&deployment.path, predictions(networks, deployment)) {
        let of_hinge = |(inside, [_, f_a, f_s, m, _]): (&bool, [Vec<f64>; 5])| {
            let mut forces = NetworkSpread::default();
            [f_a, f_s, m].iter().for_each(|force| forces.add(force));
            if !inside {
                return f64::NAN;
            }
            squares += forces.squares;
            count += 1;
            forces.variances.sqrt()
        };
        deviations.push(std::iter::zip(&step.inside, predictions).map(of_hinge).collect());
    }
    let scale = (squares / f64::from(count.max(1))).sqrt();
    let relative = deviations.iter_mut().flatten();
    relative.for_each(|deviation| *deviation /= scale.max(f64::MIN_POSITIVE));
    Some(deviations)
}

/// Predictions at every load step and hinge: (W, w_lig F_a, w_lig F_s, M_theta, D_peak), each with one value
/// for each network.
fn predictions(
    networks: &[Surrogate],
    deployment: &Deployment,
) -> impl Iterator<Item = Vec<[Vec<f64>; 5]>> {
    let designs = deployment.sheet.designs();
    let prepared: Vec<_> = networks.iter().map(|network| network.prepare(&designs)).collect();
    deployment.path.iter().map(move |step| {
        let states: &[HingeDeformation] = &step.deformations;
        let mut predictions = vec![<[Vec<f64>; 5]>::default(); designs.len()];
        for (network, prepared) in std::iter::zip(networks, &prepared) {
            let energies = network.evaluate(prepared, states, Order::Forces);
            let damages = network.damage(&designs, states, false);
            let hinges = std::iter::zip(energies, damages).zip(&designs);
            for (((energy, damage), design), predictions) in hinges.zip(&mut predictions) {
                let ([f_a, f_s, m], w) = (energy.forces, design.w_lig);
                let peak = damage.d_peak.unwrap_or(f64::NAN);
                let values = [energy.w, w * f_a, w * f_s, m, peak];
                std::iter::zip(predictions, values).for_each(|(all, value)| all.push(value));
            }
        }
        predictions
    })
}

impl NetworkSpread {
    /// Adds one quantity at one state, with its value for each network.
    fn add(&mut self, values: &[f64]) {
        let [mean, variance] = mean_and_variance(values.iter().copied());
        self.variances += variance;
        self.squares += mean * mean;
    }

    fn relative(&self) -> f64 {
        (self.variances / self.squares.max(f64::MIN_POSITIVE)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_spread_is_found() {
        let mut spread = NetworkSpread::default();
        // Deviations of 0.1 about 1 and of 0.2 about -2.
        spread.add(&[0.9, 1.0, 1.1]);
        spread.add(&[-1.8, -2.0, -2.2]);
        assert!((spread.relative() - 0.1).abs() < 1e-12);
        assert_eq!(NetworkSpread::default().relative(), 0.0);
    }
}
