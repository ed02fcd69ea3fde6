//! The compression functional (18): the mean over hinges of max(0, -min_i^tau eta_a,ih).

use crate::{
    geometry::smooth_extrema::smooth_min,
    objective::{
        hinge_measures::HingeMeasure,
        term::{Deployed, Term, TermGradient},
    },
};

/// The compression functional.
#[derive(Clone, Copy, Debug)]
pub struct Compression {
    /// tau, in units of eta_a.
    pub temperature: f64,
}

impl Term for Compression {
    fn name(&self) -> &'static str {
        "compression"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        HingeMeasure::AxialOpening.mean_over_hinges(at, gradient, |eta| {
            let (min, mut slopes) = smooth_min(eta, self.temperature);
            let factor = if min < 0.0 { -weight } else { 0.0 };
            slopes.iter_mut().for_each(|slope| *slope *= factor);
            ((-min).max(0.0), slopes)
        })
    }
}
