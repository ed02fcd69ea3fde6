//! One converged increment of a window solve.

use crate::HingeDeformation;
use serde::{Deserialize, Serialize};

/// The state at one converged increment: (eps, g) -> (W, grad W, D); section 2.4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HingeSample {
    /// Fraction of the ray, in (0, 1].
    pub lambda: f64,
    /// mm
    pub a: f64,
    /// mm
    pub s: f64,
    /// rad
    pub theta: f64,
    /// Internal work, stored plus dissipated: the potential of the measured forces (N mm).
    pub w: f64,
    /// Work of the reaction forces along the ray, by the trapezoidal rule (N mm).
    pub w_work: f64,
    /// Elastic part of `w` (N mm).
    pub w_elastic: f64,
    /// N
    pub f_a: f64,
    /// N
    pub f_s: f64,
    /// N mm
    pub m_theta: f64,
    /// Equivalent plastic strain integrated over the window (mm^3).
    pub plastic_integral: f64,
    /// `plastic_integral` divided by eps_f and by the ligament's half-disc volume (pi/2) w_lig^2 t.
    pub d: f64,
    /// Mean plastic strain of the most strained 1 % of the ligament's half-disc volume, divided by
    /// eps_f. The ligament tears at 1. `None` in samples for which it was not evaluated.
    pub d_peak: Option<f64>,
    /// Maximum out-of-plane displacement (mm).
    pub uz_max: f64,
    /// |w - w_work| divided by the maximum w of the ray.
    ///
    /// It is not divided by the w of the row: in the first increment, in which the ligament
    /// buckles, the trapezoidal work has an error of a quarter of w, but this energy is negligible.
    pub energy_residual: f64,
}

impl HingeSample {
    /// The state of a ray at `lambda`, interpolated linearly between its samples, which must be in
    /// order of lambda, and between the undeformed state and the first sample. `None` beyond the
    /// last sample.
    pub fn at(ray: &[Self], lambda: f64) -> Option<Self> {
        let after = ray.partition_point(|x| x.lambda < lambda);
        let next = ray.get(after)?;
        let before = after.checked_sub(1).map_or(Self::default(), |i| ray[i]);
        let share = (lambda - before.lambda) / (next.lambda - before.lambda);
        let mix = |of: fn(&Self) -> f64| of(&before) + share * (of(next) - of(&before));
        // The undeformed state has no plastic strain.
        let mix_known = |of: fn(&Self) -> Option<f64>| {
            let from = if after == 0 { Some(0.0) } else { of(&before) };
            Some(from? + share * (of(next)? - from?))
        };
        Some(Self {
            lambda,
            a: mix(|x| x.a),
            s: mix(|x| x.s),
            theta: mix(|x| x.theta),
            w: mix(|x| x.w),
            w_work: mix(|x| x.w_work),
            w_elastic: mix(|x| x.w_elastic),
            f_a: mix(|x| x.f_a),
            f_s: mix(|x| x.f_s),
            m_theta: mix(|x| x.m_theta),
            plastic_integral: mix(|x| x.plastic_integral),
            d: mix(|x| x.d),
            d_peak: mix_known(|x| x.d_peak),
            uz_max: mix(|x| x.uz_max),
            energy_residual: mix(|x| x.energy_residual),
        })
    }

    /// The hinge deformation (a, s, theta).
    pub fn deformation(&self) -> HingeDeformation {
        HingeDeformation { a: self.a, s: self.s, theta: self.theta }
    }

    /// The generalised forces (F_a, F_s, M_theta) (N, N, N mm): the gradient of the stored energy in
    /// (a, s, theta).
    pub fn forces(&self) -> [f64; 3] {
        [self.f_a, self.f_s, self.m_theta]
    }

    /// The sample of the mirrored design; see [`HingeDeformation::mirrored`].
    pub fn mirrored(&self) -> Self {
        Self { s: -self.s, f_s: -self.f_s, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_interpolated_linearly_from_the_undeformed_state() {
        let sample = |lambda: f64| HingeSample {
            lambda,
            theta: lambda,
            w: 8.0 * lambda * lambda,
            ..HingeSample::default()
        };
        let ray = [0.25, 0.5, 1.0].map(sample);
        let w = |lambda| HingeSample::at(&ray, lambda).map(|x| x.w);
        assert_eq!(w(0.125), Some(0.25));
        assert_eq!(w(0.5), Some(2.0));
        assert_eq!(w(0.75), Some(5.0));
        assert_eq!(w(1.0), Some(8.0));
        assert_eq!(w(1.1), None);
        assert_eq!(HingeSample::at(&ray, 0.3).map(|x| x.theta), Some(0.3));
        assert_eq!(HingeSample::at(&[], 0.3), None);
    }
}
