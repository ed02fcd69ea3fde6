//! Penalty on hinge states outside the training domain of the hinge law: the mean over hinges and load
//! steps of
//!
//! ```text
//! (5 max(0, gamma - 0.98))^2 + sum over the intervals of w_lig and alpha of (10 e / l)^2,
//! ```
//!
//! where gamma is the gauge of the domain, l the length of an interval and e the distance of the hinge from it.
//! A state beyond the domain by a tenth of the range costs 1. The penalty begins at 98 % of the domain, because
//! otherwise a minimum would lie just outside.

use crate::equilibrium::load_step::LoadStep;
use crate::sheet::cut_sheet::Sheet;
use hinge::{HingeDeformation, TrainingDomain};

/// Gauge above which a state is penalised.
const EDGE: f64 = 0.98;
/// Factor on the excess of the gauge; a gauge of one is half the range.
const PER_HALF_RANGE: f64 = 5.0;
/// Fraction of an interval at either end that is penalised already.
const MARGIN: f64 = 0.02;
/// Factor on e, relative to the length of an interval.
const PER_INTERVAL: f64 = 10.0;
/// Lower bound of the interval length; shorter intervals (a single training row, say) are widened to it.
const NARROWEST_INTERVAL: f64 = 0.01;

/// The training domain and the weight of the penalty.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainPenalty {
    /// The training domain of the hinge law.
    pub domain: TrainingDomain,
    /// mm^2
    pub weight: f64,
}

impl DomainPenalty {
    /// The penalty along a path. The gradient of `weight` times the penalty, in (a, s, theta, w_lig, alpha) of
    /// each hinge and load step, is added to `by_path`.
    pub fn evaluate(&self, sheet: &Sheet, path: &[LoadStep], by_path: &mut [Vec<[f64; 5]>]) -> f64 {
        let per_state = 1.0 / (sheet.hinges.len() * path.len()) as f64;
        let mut value = 0.0;
        for (h, (hinge, by_hinge)) in std::iter::zip(&sheet.hinges, by_path).enumerate() {
            for (step, slopes) in std::iter::zip(path, by_hinge) {
                let (excess, by) = self.of_state(hinge.w_lig, hinge.alpha, &step.deformations[h]);
                value += per_state * excess;
                for (slope, by) in std::iter::zip(slopes, by) {
                    *slope += self.weight * per_state * by;
                }
            }
        }
        value
    }

    /// The contribution of one state, and its gradient in (a, s, theta, w_lig, alpha).
    fn of_state(&self, w_lig: f64, alpha: f64, state: &HingeDeformation) -> (f64, [f64; 5]) {
        let width = excess(self.domain.w_lig, w_lig);
        let angle = excess(self.domain.alpha, alpha);
        let mut value = width.0 + angle.0;
        let mut gradient = [0.0, 0.0, 0.0, width.1, angle.1];
        if self.domain.gauge(w_lig, state) > EDGE {
            let gauge = self.domain.gauge_jet(w_lig, state);
            let scaled = PER_HALF_RANGE * (gauge.value - EDGE);
            value += scaled * scaled;
            for (by, slope) in std::iter::zip(&mut gradient, gauge.gradient) {
                *by += 2.0 * PER_HALF_RANGE * scaled * slope;
            }
        }
        (value, gradient)
    }
}

/// (10 e / l)^2 of one interval, and its derivative.
fn excess([minimum, maximum]: [f64; 2], at: f64) -> (f64, f64) {
    let length = (maximum - minimum).max(NARROWEST_INTERVAL);
    let margin = MARGIN * length;
    let beyond = (at - maximum + margin).max(0.0) - (minimum + margin - at).max(0.0);
    let scaled = PER_INTERVAL * beyond / length;
    (scaled * scaled, 2.0 * PER_INTERVAL * scaled / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::taylor::central_slope;

    fn penalty() -> DomainPenalty {
        let state = [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]];
        DomainPenalty {
            domain: TrainingDomain::of_box(state, [5.0, 25.0], [0.8, 2.3]),
            weight: 1.0,
        }
    }

    fn value(x: &[f64]) -> f64 {
        let state = [x[0], x[1], x[2]].into();
        penalty().of_state(x[3], x[4], &state).0
    }

    #[test]
    fn a_tenth_of_the_range_beyond_its_margin_costs_one() {
        assert_eq!(value(&[-3.0, 1.0, 0.4, 15.0, 1.5]), 0.0);
        assert!((value(&[0.0, 0.0, 0.5, 15.0, 0.8 + (0.02 - 0.1) * 1.5]) - 1.0).abs() < 1e-12);
        // In the middle of a face the other half-spaces do not matter.
        let beyond = value(&[(-0.3 + 0.5 * 1.18) * 15.0, 0.0, 0.6, 15.0, 1.5]);
        assert!((beyond - 1.0).abs() < 1e-3, "{beyond}");
    }

    #[test]
    fn a_law_of_one_width_may_be_used_at_that_width_only() {
        assert!(excess([18.0; 2], 19.0).0.is_finite());
        assert!(excess([18.0; 2], 19.0).0 > excess([18.0; 2], 18.0).0);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let outside = [
            [5.0, -9.0, 1.4, 15.0, 2.4],
            [-30.0, 12.0, -0.2, 26.0, 0.7],
            [1.0, 0.5, 0.3, 4.0, 1.5],
        ];
        for x in outside {
            let (_, gradient) = penalty().of_state(x[3], x[4], &[x[0], x[1], x[2]].into());
            for (i, found) in gradient.into_iter().enumerate() {
                let unit: Vec<f64> = (0..5).map(|j| f64::from(i == j)).collect();
                let slope = central_slope(value, &x, &unit, 1e-6);
                assert!(
                    (found - slope).abs() < 1e-6 * slope.abs().max(1.0),
                    "{i}: {found} {slope}"
                );
            }
        }
    }
}
