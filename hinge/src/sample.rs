//! One converged increment of a window solve.

use crate::{HingeDeformation, HingeForces};
use serde::{Deserialize, Serialize};

/// What one converged increment says: (eps, g) -> (W, grad W, D); section 2.4.
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
    /// Work of the reactions along the ray by the trapezoidal rule (N mm).
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
    /// `plastic_integral` over eps_f and the ligament's half-disc volume (pi/2) w_lig^2 t.
    pub d: f64,
    /// (12) as printed: `plastic_integral` over eps_f and the window's volume.
    pub d_window: f64,
    /// Volume-weighted 99.9th percentile of the plastic strain over eps_f: where it tears.
    pub d_peak: f64,
    /// Largest out-of-plane displacement (mm).
    pub uz_max: f64,
    /// |w - w_work| over the largest w of the ray.
    ///
    /// Not over the row's own w: the trapezoidal work of the first increment, in which the
    /// ligament buckles, is off by a quarter of an energy that hardly counts.
    pub energy_residual: f64,
}

impl HingeSample {
    pub fn deformation(&self) -> HingeDeformation {
        HingeDeformation {
            a: self.a,
            s: self.s,
            theta: self.theta,
        }
    }

    pub fn forces(&self) -> HingeForces {
        HingeForces {
            f_a: self.f_a,
            f_s: self.f_s,
            m_theta: self.m_theta,
        }
    }

    /// The sample of the mirrored design; see [`HingeDeformation::mirrored`].
    pub fn mirrored(&self) -> Self {
        Self {
            s: -self.s,
            f_s: -self.f_s,
            ..*self
        }
    }
}
