//! The shear functional (19): the mean over hinges of max_i^tau |eta_s,ih|.

use crate::{
    geometry::smooth_extrema::smooth_max,
    objective::{
        hinge_measures::HingeMeasure,
        term::{Deployed, Term, TermGradient},
    },
};

/// The shear functional.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// tau, in units of eta_s.
    pub temperature: f64,
}

impl Term for Shear {
    fn name(&self) -> &'static str {
        "shear"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        HingeMeasure::Shear.mean_over_hinges(at, gradient, |eta| {
            let sizes: Vec<f64> = eta.iter().map(|eta| eta.abs()).collect();
            let (max, mut slopes) = smooth_max(&sizes, self.temperature);
            for (slope, eta) in std::iter::zip(&mut slopes, eta) {
                *slope *= weight * eta.signum();
            }
            (max, slopes)
        })
    }
}
