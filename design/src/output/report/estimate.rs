//! Disagreement of further networks of the same training on the path of a design, an estimate of the error of the
//! learned law.
//!
//! ```text
//! sigma_X = (mean over states of the variance of X over the networks)^(1/2) / (mean of X^2)^(1/2)
//! ```
//!
//! over the states inside the training domain, for X = W, (w_lig F_a, w_lig F_s, M_theta) and D_peak. It does not
//! contain errors that all networks have in common, such as that of the window's mesh.
//! (Lakshminarayanan et al., "Simple and scalable predictive uncertainty estimation", 2017.)

use crate::objective::design_problem::Deployment;
use hinge::HingeDeformation;
use serde::Serialize;
use surrogate::{Order, Surrogate};

/// Standard deviations over an ensemble, relative to the root mean square over the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
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
struct Spread {
    variances: f64,
    squares: f64,
}

impl Estimate {
    /// The estimate for a path computed with the first of `networks`; `None` for a single network, or if no state is
    /// inside the training domain.
    pub fn of(networks: &[&Surrogate], deployment: &Deployment) -> Option<Self> {
        let designs = deployment.sheet.designs();
        let [mut energy, mut forces, mut peak] = [(); 3].map(|()| Spread::default());
        let mut peak_known = true;
        let prepared: Vec<_> = networks.iter().map(|it| it.prepare(&designs)).collect();
        for step in &deployment.path {
            let states: &[HingeDeformation] = &step.deformations;
            let answers: Vec<Vec<[f64; 5]>> = std::iter::zip(networks, &prepared)
                .map(|(network, prepared)| {
                    let energies = network.evaluate(prepared, states, Order::Forces);
                    let damages = network.damage_values(&designs, states);
                    let hinges = std::iter::zip(energies, damages).zip(&designs);
                    hinges
                        .map(|((energy, damage), design)| {
                            let [f_a, f_s, m] = energy.forces;
                            let w = design.w_lig;
                            [
                                energy.w,
                                w * f_a,
                                w * f_s,
                                m,
                                damage.d_peak.unwrap_or(f64::NAN),
                            ]
                        })
                        .collect()
                })
                .collect();
            for h in (0..designs.len()).filter(|&h| step.inside[h]) {
                let of = |i: usize| answers.iter().map(move |network| network[h][i]);
                energy.add(of(0));
                (1..4).for_each(|i| forces.add(of(i)));
                peak_known &= of(4).all(|x| !x.is_nan());
                peak.add(of(4));
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

impl Spread {
    /// Adds one quantity at one state, with its value for each network.
    fn add(&mut self, values: impl Iterator<Item = f64> + Clone) {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        self.variances += squares / (count - 1.0).max(1.0);
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
        let mut spread = Spread::default();
        // Deviations of 0.1 about 1 and of 0.2 about -2.
        spread.add([0.9, 1.0, 1.1].into_iter());
        spread.add([-1.8, -2.0, -2.2].into_iter());
        assert!((spread.relative() - 0.1).abs() < 1e-12);
        assert_eq!(Spread::default().relative(), 0.0);
    }
}
