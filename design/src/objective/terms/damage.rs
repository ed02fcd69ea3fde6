//! The damage functional (17): the mean over hinges of (max_i^tau D_ih / D_s)^2. D is the mean or
//! the peak damage. A ligament tears at a peak damage of 1: from 0.9 on it costs (100 (max_i^tau
//! D_ih - 0.9))^2 more.

use crate::{
    geometry::smooth_extrema::smooth_max,
    hinge_law::DamageMeasure,
    objective::{
        hinge_measures::HingeMeasure,
        term::{Deployed, Term, TermGradient},
    },
};

/// Peak damage from which a ligament costs more.
pub const NEARLY_TORN: f64 = 0.9;
/// Factor on its excess.
const TEARING: f64 = 100.0;

/// The damage functional.
#[derive(Clone, Copy, Debug)]
pub struct DamageFunctional {
    /// D or D_peak.
    pub measure: DamageMeasure,
    /// D_s of the measure.
    pub scale: f64,
    /// tau, in units of D_s.
    pub temperature: f64,
}

impl Term for DamageFunctional {
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
            let excess = match self.measure {
                DamageMeasure::Mean => 0.0,
                DamageMeasure::Peak => TEARING * (self.scale * max - NEARLY_TORN).max(0.0),
            };
            let factor = 2.0 * weight * (max / self.scale + TEARING * excess);
            slopes.iter_mut().for_each(|slope| *slope *= factor);
            (max * max + excess * excess, slopes)
        })
    }
}
