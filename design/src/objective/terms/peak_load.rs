//! The peak of the load: under a prescribed stroke, the maximum of the load along the path over the load at its end, less
//! one,
//!
//! ```text
//! max_i^tau (zeta_i / zeta_N) - 1
//! ```
//!
//! over the load steps under the whole weight. Where it is zero, a dead load of the final size opens the sheet; where it is
//! positive, the sheet needs more on the way. It is infinite if the load at the end acts against the stroke.

use crate::geometry::smooth_extrema::smooth_max;
use crate::objective::term::{Deployed, Term, TermGradient};

/// The peak of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakLoad {
    /// tau, in units of the load at the end.
    pub temperature: f64,
    /// The prescribed stroke, of which the sign counts.
    pub stroke: f64,
}

impl Term for PeakLoad {
    fn name(&self) -> &'static str {
        "peak_load"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let loaded: Vec<usize> = (0..at.path.len())
            .filter(|&i| at.path[i].weight == 1.0)
            .collect();
        let loads: Vec<f64> = loaded.iter().map(|&i| at.path[i].load_factor).collect();
        let (Some(&last), Some(&end)) = (loaded.last(), loads.last()) else {
            return f64::INFINITY;
        };
        if self.stroke * end <= 0.0 {
            return f64::INFINITY;
        }
        let ratios: Vec<f64> = loads.iter().map(|load| load / end).collect();
        let (peak, slopes) = smooth_max(&ratios, self.temperature);
        for ((&i, ratio), slope) in loaded.iter().zip(&ratios).zip(slopes) {
            gradient.by_load_factors[i] += weight * slope / end;
            gradient.by_load_factors[last] -= weight * slope * ratio / end;
        }
        peak - 1.0
    }
}
