//! The linear law (11) with constants condensed from the learned energy for each hinge, by prescribing
//! one deformation measure at a time:
//!
//! ```text
//! k_c(g) = (F_c(+h e_c; g) - F_c(-h e_c; g)) / 2h        h -> 0: the diagonal of the Hessian at zero
//! k_theta(g) = M_theta(theta_0; g) / theta_0             or the secant at an angle theta_0
//! ```
//!
//! The constants depend on the design, so that the gradient in w_lig and alpha is exact.

use crate::hinge_law::law::{HingeEnergy, HingeLaw, Order, PreparedLaw};
use crate::hinge_law::linear::spring;
use hinge::{HingeDeformation, HingeDesign};
use surrogate::Surrogate;

/// h of a and s (mm) and of theta (rad); the Hessian is accurate to 8 digits, and so are the forces.
const SMALL: [f64; 3] = [1e-3, 1e-3, 1e-4];

/// The linear law of a learned energy.
#[derive(Clone, Debug)]
pub struct CondensedLaw {
    /// The learned energy that the constants are condensed from.
    pub surrogate: Surrogate,
    /// Angle of the rotational secant (rad); 0 for the Hessian at zero.
    pub secant: f64,
}

impl CondensedLaw {
    /// (k_a, k_s, k_theta) of each design (N/mm, N/mm, N mm) with their gradients in (w_lig, alpha, rho_f).
    pub fn constants(&self, designs: &[HingeDesign]) -> Vec<[Constant; 3]> {
        let prepared = self.surrogate.prepare(designs);
        let mut constants = vec![[Constant::default(); 3]; designs.len()];
        for c in 0..3 {
            let states = match self.secant {
                secant if c == 2 && secant != 0.0 => vec![secant],
                _ => vec![SMALL[c], -SMALL[c]],
            };
            for &size in &states {
                let mut state = [0.0; 3];
                state[c] = size;
                let driven = vec![HingeDeformation::from(state); designs.len()];
                let energies = self.surrogate.evaluate(&prepared, &driven, Order::Design);
                let weight = 1.0 / (states.len() as f64 * size);
                for (constants, energy) in std::iter::zip(&mut constants, energies) {
                    constants[c].value += weight * energy.forces[c];
                    (0..3).for_each(|g| constants[c].gradient[g] += weight * energy.mixed[c][g]);
                }
            }
        }
        constants
    }
}

/// A spring constant and its gradient in (w_lig, alpha, rho_f).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constant {
    /// k_a or k_s (N/mm), or k_theta (N mm).
    pub value: f64,
    /// Gradient of `value` in w_lig (per mm), alpha (per rad) and rho_f.
    pub gradient: [f64; 3],
}

impl HingeLaw for CondensedLaw {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        Box::new(Prepared(self.constants(designs)))
    }
}

struct Prepared(Vec<[Constant; 3]>);

impl PreparedLaw for Prepared {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let energy = |(deformation, constants): (&HingeDeformation, &[Constant; 3])| {
            let eps = deformation.to_array();
            let mut energy = spring(eps, &constants.map(|constant| constant.value));
            for (c, constant) in constants.iter().enumerate() {
                for (g, slope) in constant.gradient.into_iter().enumerate() {
                    energy.design[g] += 0.5 * slope * eps[c] * eps[c];
                    energy.mixed[c][g] = slope * eps[c];
                }
            }
            energy
        };
        std::iter::zip(deformations, &self.0).map(energy).collect()
    }

    fn has_constants(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;
    use std::path::Path;

    fn design(x: &[f64]) -> HingeDesign {
        HingeDesign {
            w_lig: x[0],
            alpha: x[1],
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        }
    }

    fn tiny(secant: f64) -> CondensedLaw {
        let weights = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/cases/chi_tiny.safetensors"
        );
        CondensedLaw {
            surrogate: Surrogate::load(Path::new(weights)).unwrap(),
            secant,
        }
    }

    #[test]
    fn the_constants_are_the_diagonal_of_the_hessian_or_the_secant() {
        let (law, secant) = (tiny(0.0), 20.0_f64.to_radians());
        let designs = [design(&[18.0, 1.4])];
        let prepared = law.surrogate.prepare(&designs);
        let at = |state| law.surrogate.evaluate(&prepared, &[state], Order::Tangent)[0];
        let flat = at(HingeDeformation::default());
        let [found] = law.constants(&designs)[..] else {
            panic!("one hinge");
        };
        for (c, found) in found.iter().enumerate() {
            let expected = flat.tangent[c][c];
            assert!(
                (found.value / expected - 1.0).abs() < 1e-6,
                "{found:?} {expected}"
            );
        }
        let turned = at(HingeDeformation::from([0.0, 0.0, secant]));
        let found = tiny(secant).constants(&designs)[0][2].value;
        assert!((found / (turned.forces[2] / secant) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_constants_have_exact_derivatives_in_the_design() {
        let at = [18.0, 1.4];
        for law in [tiny(0.0), tiny(0.35)] {
            for c in 0..3 {
                let found = law.constants(&[design(&at)])[0][c];
                let value = |x: &[f64]| law.constants(&[design(x)])[0][c].value;
                for (g, unit) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                    let slope = central_slope(value, &at, &unit, 1e-4);
                    let error = (found.gradient[g] - slope).abs();
                    assert!(
                        error < 1e-6 * found.value.abs(),
                        "{c} {g}: {found:?} {slope}"
                    );
                }
            }
        }
    }
}
