//! Contact of panel edges: a barrier on the two void angles at a hinge, theta at the main cut and
//! pi - theta at the neighbouring corner of the void; text of (11).
//!
//! ```text
//! E(phi) = -k (phi - phi_cut)^2 ln((phi - phi_min) / (phi_cut - phi_min))   for phi_min < phi <
//! phi_cut
//! ```
//!
//! It is zero above phi_cut, infinite at and below phi_min, and C^2 in between and at phi_cut.

use crate::hinge_law::law::HingeEnergy;
use hinge::HingeDeformation;
use std::f64::consts::PI;
use support::{Fault, refuse};

/// The constants of the barrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// N mm
    stiffness: f64,
    /// Void angle at which the barrier becomes infinite (rad).
    phi_min: f64,
    /// Void angle at which contact begins (rad).
    phi_cut: f64,
}

impl Contact {
    /// A barrier with the given stiffness (N mm) between `phi_cut`, where it begins, and `phi_min`
    /// (rad).
    pub fn new(stiffness: f64, phi_min: f64, phi_cut: f64) -> Result<Self, Fault> {
        let valid = stiffness > 0.0
            && stiffness.is_finite()
            && -PI < phi_min
            && phi_min < phi_cut
            && phi_cut <= 0.0;
        if !valid {
            refuse!(
                "contact with stiffness = {stiffness} N mm, phi_min = {phi_min} rad, phi_cut = {phi_cut} rad \
                 violates stiffness > 0 and -pi < phi_min < phi_cut <= 0 (the closed sheet has phi = 0)"
            );
        }
        Ok(Self { stiffness, phi_min, phi_cut })
    }

    /// Adds the barrier of both void angles to the energies of the hinges.
    pub fn add(&self, energies: &mut [HingeEnergy], deformations: &[HingeDeformation]) {
        for (energy, deformation) in std::iter::zip(energies, deformations) {
            for (phi, sign) in [(deformation.theta, 1.0), (PI - deformation.theta, -1.0)] {
                let [value, first, second] = self.barrier(phi);
                energy.w += value;
                energy.forces[2] += sign * first;
                energy.tangent[2][2] += second;
            }
        }
    }

    /// E(phi) and its first two derivatives.
    fn barrier(&self, phi: f64) -> [f64; 3] {
        if phi >= self.phi_cut {
            return [0.0; 3];
        }
        if phi <= self.phi_min {
            return [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY];
        }
        let (depth, gap) = (phi - self.phi_cut, phi - self.phi_min);
        let log = (gap / (self.phi_cut - self.phi_min)).ln();
        [
            -depth * depth * log,
            -2.0 * depth * log - depth * depth / gap,
            -2.0 * log - 4.0 * depth / gap + (depth / gap).powi(2),
        ]
        .map(|term| self.stiffness * term)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::derivatives::assert_gradient;

    fn contact() -> Contact {
        Contact::new(2.0, -0.3, -0.05).unwrap()
    }

    fn energy(theta: f64) -> HingeEnergy {
        let mut energies = [HingeEnergy::default()];
        contact().add(&mut energies, &[HingeDeformation::from([0.0, 0.0, theta])]);
        energies[0]
    }

    #[test]
    fn forces_and_stiffness_agree_with_differences_on_both_sides() {
        for theta in [-0.29, -0.2, -0.0501, 0.4, PI + 0.06, PI + 0.28] {
            let found = energy(theta);
            let allowed = |slope: f64| 1e-6 * (1.0 + slope.abs());
            let (force, stiffness) = ([found.forces[2]], [found.tangent[2][2]]);
            assert_gradient(|x| energy(x[0]).w, &[theta], &force, 1e-6, allowed);
            assert_gradient(|x| energy(x[0]).forces[2], &[theta], &stiffness, 1e-6, allowed);
        }
    }

    #[test]
    fn the_barrier_is_zero_when_open_twice_differentiable_at_phi_cut_and_infinite_at_phi_min() {
        assert_eq!(energy(0.0), HingeEnergy::default());
        assert!(energy(-0.05 - 1e-9).tangent[2][2] < 1e-6);
        assert_eq!(energy(-0.3).w, f64::INFINITY);
        assert_eq!(energy(-0.4).w, f64::INFINITY);
        assert_eq!(energy(PI + 0.4).w, f64::INFINITY);
        assert!(energy(-0.3 + 1e-12).w.is_finite());
    }

    #[test]
    fn a_barrier_that_stresses_the_flat_sheet_is_refused() {
        assert!(Contact::new(1.0, -0.1, 0.1).is_err());
        assert!(Contact::new(1.0, -0.1, -0.2).is_err());
        assert!(Contact::new(f64::NAN, -0.1, 0.0).is_err());
    }
}
