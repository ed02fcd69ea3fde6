//! The condensed hinge energy (14) inside its training domain, and a barrier around it.
//!
//! ```text
//! B = k W_s sum_c e_c^3,   e_c = excess of eta_a, eta_s, theta over the domain's interval / its width
//! ```
//!
//! B is C^2, vanishes inside and grows without bound, so W + B is coercive for any weights.

use super::{HingeDamage, HingeEnergy, HingeLaw, Order, PreparedLaw};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use surrogate::{Prepared, Surrogate};

/// k: at an excess of a tenth of the interval the barrier stores W_s / 10 and pushes back about as
/// hard as a typical hinge resists.
const BARRIER_STIFFNESS: f64 = 100.0;

/// Intervals narrower than this (of one training row, say) count as this wide.
pub(crate) const NARROWEST_INTERVAL: f64 = 0.01;

/// The standardised features (13) are of order one, and so are the units of the layers behind them: a
/// deformation is lost in a few of their last digits.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;

/// The learned hinge law.
#[derive(Clone, Debug)]
pub struct SurrogateLaw {
    surrogate: Surrogate,
}

impl SurrogateLaw {
    pub fn new(surrogate: Surrogate) -> Self {
        Self { surrogate }
    }

    pub fn surrogate(&self) -> &Surrogate {
        &self.surrogate
    }
}

impl HingeLaw for SurrogateLaw {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(PreparedSurrogate {
            surrogate: &self.surrogate,
            prepared: self.surrogate.prepare(designs),
        })
    }

    fn damage_scale(&self) -> Option<f64> {
        Some(self.surrogate.damage_scale())
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        Some(self.surrogate.domain())
    }
}

struct PreparedSurrogate<'a> {
    surrogate: &'a Surrogate,
    prepared: Prepared,
}

impl PreparedLaw for PreparedSurrogate<'_> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        let mut energies = self.surrogate.evaluate(&self.prepared, deformations, order);
        let scale = BARRIER_STIFFNESS * self.surrogate.energy_scale();
        let domain = self.surrogate.domain();
        for ((energy, design), deformation) in energies
            .iter_mut()
            .zip(self.prepared.designs())
            .zip(deformations)
        {
            add_barrier(energy, domain, scale, design.w_lig, deformation);
        }
        energies
    }

    fn damage(&self, deformations: &[HingeDeformation]) -> Vec<HingeDamage> {
        self.surrogate.damage(self.prepared.designs(), deformations)
    }

    fn resolution(&self) -> f64 {
        RESOLUTION
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        std::iter::zip(self.prepared.designs(), deformations)
            .map(|(design, deformation)| self.surrogate.domain().contains(design, deformation))
            .collect()
    }
}

/// Adds B and its derivatives; eta = (a, s) / w_lig makes them depend on w_lig too.
fn add_barrier(
    energy: &mut HingeEnergy,
    domain: &TrainingDomain,
    scale: f64,
    w_lig: f64,
    deformation: &HingeDeformation,
) {
    let [eta_a, eta_s] = deformation.eta(w_lig);
    let directions = [
        (domain.eta_a, eta_a, w_lig),
        (domain.eta_s, eta_s, w_lig),
        (domain.theta, deformation.theta, 1.0),
    ];
    for (c, (interval, value, unit)) in directions.into_iter().enumerate() {
        let [b, first, second] = cubic_excess(interval, value);
        energy.w += scale * b;
        energy.forces[c] += scale * first / unit;
        energy.tangent[c][c] += scale * second / (unit * unit);
        if c < 2 {
            energy.design[0] -= scale * first * value / w_lig;
            energy.mixed[c][0] -= scale * (first + second * value) / (w_lig * w_lig);
        }
    }
}

/// e^3 and its first two derivatives in the value.
fn cubic_excess([least, greatest]: [f64; 2], value: f64) -> [f64; 3] {
    let width = (greatest - least).max(NARROWEST_INTERVAL);
    let signed = (value - greatest).max(0.0) - (least - value).max(0.0);
    let excess = signed.abs() / width;
    [
        excess.powi(3),
        3.0 * excess * excess * signed.signum() / width,
        6.0 * excess / (width * width),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::central_slope;
    use std::path::Path;

    fn tiny() -> SurrogateLaw {
        let weights = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/cases/chi_tiny.safetensors"
        );
        SurrogateLaw::new(Surrogate::load(Path::new(weights)).unwrap())
    }

    /// x = (a, s, theta, w_lig, alpha)
    fn energy(law: &SurrogateLaw, x: &[f64]) -> HingeEnergy {
        let design = HingeDesign {
            w_lig: x[3],
            alpha: x[4],
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        };
        let deformation = HingeDeformation::from([x[0], x[1], x[2]]);
        law.prepare(&[design])
            .energies(&[deformation], Order::Design)[0]
    }

    #[test]
    fn outside_the_domain_every_derivative_agrees_with_differences() {
        let law = tiny();
        for x in [
            [9.0, -11.0, 1.4, 18.0, 1.4],
            [-14.0, 9.5, -0.2, 16.0, 1.9],
            [-3.0, 1.0, 0.6, 16.0, 1.9],
        ] {
            let found = energy(&law, &x);
            let unit = |i: usize| -> Vec<f64> { (0..5).map(|j| f64::from(i == j)).collect() };
            let slope = |part: &dyn Fn(&HingeEnergy) -> f64, i: usize| {
                central_slope(|x| part(&energy(&law, x)), &x, &unit(i), 1e-5)
            };
            let close = |found: f64, expected: f64| {
                let scale = law.surrogate().energy_scale().max(expected.abs());
                assert!(
                    (found - expected).abs() < 1e-7 * scale,
                    "{found} {expected}"
                );
            };
            for i in 0..3 {
                close(found.forces[i], slope(&|e| e.w, i));
                for j in 0..3 {
                    close(found.tangent[i][j], slope(&|e| e.forces[i], j));
                }
                for g in 0..2 {
                    close(found.mixed[i][g], slope(&|e| e.forces[i], 3 + g));
                }
            }
            for g in 0..2 {
                close(found.design[g], slope(&|e| e.w, 3 + g));
            }
        }
    }

    #[test]
    fn the_energy_grows_without_bound_and_the_inside_is_untouched() {
        let law = tiny();
        // Cubic far out, in each direction and sense.
        for c in 0..3 {
            let far = |t: f64| {
                let mut x = [0.0, 0.0, 0.0, 18.0, 1.5];
                x[c] = t;
                energy(&law, &x).w
            };
            for t in [1e4, -1e4] {
                assert!((far(2.0 * t) / far(t) - 8.0).abs() < 0.1, "{c} {t}");
            }
        }
        let state = HingeDeformation::from([1.0, 1.0, 0.5]);
        let design = HingeDesign {
            w_lig: 18.0,
            alpha: 1.5,
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        };
        let surrogate = law.surrogate();
        let bare = surrogate.evaluate(&surrogate.prepare(&[design]), &[state], Order::Design);
        assert_eq!(energy(&law, &[1.0, 1.0, 0.5, 18.0, 1.5]), bare[0]);
        assert_eq!(law.prepare(&[design]).inside(&[state]), [true]);
    }

    #[test]
    fn an_interval_of_no_width_still_gives_a_finite_barrier() {
        let [value, first, second] = cubic_excess([0.3, 0.3], 0.31);
        assert!(value.is_finite() && first > 0.0 && second.is_finite());
        assert_eq!(cubic_excess([0.3, 0.3], 0.3), [0.0; 3]);
    }
}
