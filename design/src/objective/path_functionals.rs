//! Functionals of the deformation path of the hinges; (17)-(19):
//!
//! ```text
//! damage       1/|H| sum_h (max_i^tau D_ih / D_s)^2
//! compression  1/|H| sum_h max(0, -min_i^tau eta_a,ih)
//! shear        1/|H| sum_h max_i^tau |eta_s,ih|
//! ```
//!
//! i runs over the load steps, without the flat state. D is the mean or the peak damage.

use crate::geometry::smooth_extrema::{smooth_max, smooth_min};
use crate::hinge_law::{DamageMeasure, HingeDamage};
use hinge::HingeDeformation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One number per functional: a value, a weight or a temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerFunctional {
    /// Of the damage functional (17).
    pub damage: f64,
    /// Of the compression functional (18).
    pub compression: f64,
    /// Of the shear functional (19).
    pub shear: f64,
}

/// The path of one hinge, one entry per load step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HingePath {
    /// mm
    pub w_lig: f64,
    pub deformations: Vec<HingeDeformation>,
    /// Empty if no damage is predicted.
    pub damage: Vec<HingeDamage>,
}

/// The weights w_j and temperatures tau of the functionals, and D_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathFunctionals {
    pub weights: PerFunctional,
    /// In the units of the quantities whose extrema are taken; all dimensionless.
    pub temperatures: PerFunctional,
    pub measure: DamageMeasure,
    /// D_s of the measure.
    pub damage_scale: f64,
}

/// Gradient in (a, s, theta, w_lig, alpha) per load step.
type PathGradient = Vec<[f64; 5]>;

impl PathFunctionals {
    /// The functionals, and the gradient of their sum weighted by `weights`, in
    /// (a, s, theta, w_lig, alpha) per hinge and load step.
    pub fn evaluate(&self, hinges: &[HingePath]) -> (PerFunctional, Vec<PathGradient>) {
        let per_hinge = 1.0 / hinges.len() as f64;
        let mut means = PerFunctional::default();
        let gradients = hinges.iter().map(|hinge| {
            let (summands, mut gradient) = self.of_hinge(hinge);
            means.damage += per_hinge * summands.damage;
            means.compression += per_hinge * summands.compression;
            means.shear += per_hinge * summands.shear;
            let slopes = gradient.as_flattened_mut();
            slopes.iter_mut().for_each(|slope| *slope *= per_hinge);
            gradient
        });
        let gradients = gradients.collect();
        (means, gradients)
    }

    /// The weighted sum of the functionals.
    pub fn weighted(&self, values: &PerFunctional) -> f64 {
        self.weights.damage * values.damage
            + self.weights.compression * values.compression
            + self.weights.shear * values.shear
    }

    /// The contribution of one hinge and the gradient of its weighted sum.
    fn of_hinge(&self, path: &HingePath) -> (PerFunctional, PathGradient) {
        let w_lig = path.w_lig;
        let eta = |component: usize| -> Vec<f64> {
            let etas = path.deformations.iter().map(|state| state.eta(w_lig));
            etas.map(|eta| eta[component]).collect()
        };
        let (eta_a, eta_s) = (eta(0), eta(1));
        let (min, by_min) = smooth_min(&eta_a, self.temperatures.compression);
        let shears: Vec<f64> = eta_s.iter().map(|eta| eta.abs()).collect();
        let (shear, by_shear) = smooth_max(&shears, self.temperatures.shear);
        let measured: Vec<_> = (path.damage.iter()).map(|x| self.measure.of(x)).collect();
        let scaled = measured.iter().map(|(d, _)| d / self.damage_scale);
        let (damage, by_damage) =
            smooth_max(&scaled.collect::<Vec<f64>>(), self.temperatures.damage);
        let summands = PerFunctional {
            damage: damage * damage,
            compression: (-min).max(0.0),
            shear,
        };
        let compressed = if min < 0.0 {
            -self.weights.compression
        } else {
            0.0
        };
        let damaged = 2.0 * damage * self.weights.damage / self.damage_scale;
        let gradient = (0..path.deformations.len()).map(|i| {
            let by_eta_a = compressed * by_min[i];
            let by_eta_s = self.weights.shear * by_shear[i] * eta_s[i].signum();
            let by_width = -(by_eta_a * eta_a[i] + by_eta_s * eta_s[i]) / w_lig;
            let mut slopes = [by_eta_a / w_lig, by_eta_s / w_lig, 0.0, by_width, 0.0];
            if let Some((_, gradient)) = measured.get(i) {
                for (slope, by_state) in std::iter::zip(&mut slopes, gradient) {
                    *slope += damaged * by_damage[i] * by_state;
                }
            }
            slopes
        });
        (summands, gradient.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;

    const FUNCTIONALS: PathFunctionals = PathFunctionals {
        weights: PerFunctional {
            damage: 0.7,
            compression: 0.3,
            shear: 0.2,
        },
        temperatures: PerFunctional {
            damage: 0.1,
            compression: 0.01,
            shear: 0.02,
        },
        measure: DamageMeasure::Mean,
        damage_scale: 0.5,
    };
    /// Two hinges: w_lig, then (a, s, theta) per load step.
    const PATHS: [f64; 20] = [
        2.0, 0.02, 0.05, 0.1, -0.05, 0.08, 0.2, -0.1, 0.04, 0.4, // first hinge
        3.0, 0.1, -0.02, 0.1, 0.2, -0.01, 0.3, 0.3, 0.03, 0.5, // second hinge
    ];

    /// D = w_lig theta^2 (1 + a)
    fn damage(w_lig: f64, deformation: &HingeDeformation) -> HingeDamage {
        let HingeDeformation { a, theta, .. } = *deformation;
        let per_width = theta * theta * (1.0 + a);
        let gradient = [
            w_lig * theta * theta,
            0.0,
            2.0 * w_lig * theta * (1.0 + a),
            per_width,
            0.0,
        ];
        HingeDamage {
            d: w_lig * per_width,
            gradient,
            d_peak: Some(3.0 * w_lig * per_width),
            peak_gradient: gradient.map(|slope| 3.0 * slope),
        }
    }

    fn evaluate(paths: &[f64]) -> (PerFunctional, Vec<PathGradient>) {
        measured(DamageMeasure::Mean, paths)
    }

    fn measured(measure: DamageMeasure, paths: &[f64]) -> (PerFunctional, Vec<PathGradient>) {
        let hinges: Vec<HingePath> = paths
            .chunks(10)
            .map(|numbers| {
                let w_lig = numbers[0];
                let states = numbers[1..].chunks(3).map(|eps| [eps[0], eps[1], eps[2]]);
                let deformations: Vec<HingeDeformation> = states.map(Into::into).collect();
                HingePath {
                    w_lig,
                    damage: deformations
                        .iter()
                        .map(|state| damage(w_lig, state))
                        .collect(),
                    deformations,
                }
            })
            .collect();
        PathFunctionals {
            measure,
            ..FUNCTIONALS
        }
        .evaluate(&hinges)
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        for measure in [DamageMeasure::Mean, DamageMeasure::Peak] {
            check_gradient(measure);
        }
        let [mean, peak] = [DamageMeasure::Mean, DamageMeasure::Peak]
            .map(|measure| measured(measure, &PATHS).0.damage);
        assert!(peak > 2.0 * mean, "{mean} {peak}");
    }

    fn check_gradient(measure: DamageMeasure) {
        let (_, gradient) = measured(measure, &PATHS);
        for i in 0..PATHS.len() {
            let (hinge, entry) = (&gradient[i / 10], i % 10);
            let found = match entry {
                0 => hinge.iter().map(|slopes| slopes[3]).sum(),
                _ => hinge[(entry - 1) / 3][(entry - 1) % 3],
            };
            let unit: Vec<f64> = (0..PATHS.len()).map(|j| f64::from(i == j)).collect();
            let value = |x: &[f64]| FUNCTIONALS.weighted(&measured(measure, x).0);
            let slope = central_slope(value, &PATHS, &unit, 1e-6);
            assert!((found - slope).abs() < 1e-7, "{i}: {found} {slope}");
        }
    }

    #[test]
    fn a_path_without_compression_has_no_compression_cost() {
        let mut paths = PATHS;
        paths[4] = 0.05;
        paths[7] = 0.1;
        let (values, _) = evaluate(&paths);
        assert_eq!(values.compression, 0.0);
        assert!(values.shear > 0.0 && values.damage > 0.0);
    }
}
