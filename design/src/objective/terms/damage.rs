//! The damage functional (17): the mean over hinges of (max_i^tau D_ih / D_s)^2. D is the mean or the peak damage.

use crate::geometry::smooth_extrema::smooth_max;
use crate::hinge_law::DamageMeasure;
use crate::objective::hinge_measures::HingeMeasure;
use crate::objective::term::{Deployed, Term, TermGradient};

/// The damage functional.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damage {
    /// D or D_peak.
    pub measure: DamageMeasure,
    /// D_s of the measure.
    pub scale: f64,
    /// tau, in units of D_s.
    pub temperature: f64,
}

impl Term for Damage {
    fn name(&self) -> &'static str {
        "damage"
    }

    fn needs_damage_gradient(&self) -> bool {
        true
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let measure = HingeMeasure::Damage(self.measure);
        measure.mean_over_hinges(at, gradient, |damage| {
            let scaled: Vec<f64> = damage.iter().map(|d| d / self.scale).collect();
            let (max, mut slopes) = smooth_max(&scaled, self.temperature);
            let factor = 2.0 * max * weight / self.scale;
            slopes.iter_mut().for_each(|slope| *slope *= factor);
            (max * max, slopes)
        })
    }
}
