//! How far the hinges leave the box that their law was learned in: the mean over hinges and load steps
//! of
//!
//! ```text
//! sum over the sides of (10 e / l)^2,     l: length of a side,   e: how far the state is beyond it
//! ```
//!
//! so that a tenth of a side costs 1. It begins 2 % of a side inside the box, but at the flat state, or a
//! minimum would lie just outside.

use crate::equilibrium::LoadStep;
use crate::hinge_law::NARROWEST_INTERVAL;
use crate::sheet::Sheet;
use hinge::{HingeDeformation, TrainingDomain};

/// Share of a side at either end that already counts as outside.
const MARGIN: f64 = 0.02;
/// Units of e in the length of a side.
const PER_SIDE: f64 = 10.0;

/// The box, and what it costs to leave it.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainPenalty {
    pub domain: TrainingDomain,
    /// mm^2
    pub weight: f64,
}

impl DomainPenalty {
    /// The value along a path; the gradient of `weight` times it, in (a, s, theta, w_lig, alpha) of each
    /// hinge and load step, is added to `by_path`.
    pub fn evaluate(&self, sheet: &Sheet, path: &[LoadStep], by_path: &mut [Vec<[f64; 5]>]) -> f64 {
        let share = 1.0 / (sheet.hinges.len() * path.len()) as f64;
        let mut value = 0.0;
        for (h, (hinge, by_hinge)) in std::iter::zip(&sheet.hinges, by_path).enumerate() {
            for (step, slopes) in std::iter::zip(path, by_hinge) {
                let (excess, by) = self.of_state(hinge.w_lig, hinge.alpha, &step.deformations[h]);
                value += share * excess;
                for (slope, by) in std::iter::zip(slopes, by) {
                    *slope += self.weight * share * by;
                }
            }
        }
        value
    }

    /// The summand of one state, and its gradient in (a, s, theta, w_lig, alpha).
    fn of_state(&self, w_lig: f64, alpha: f64, state: &HingeDeformation) -> (f64, [f64; 5]) {
        let [eta_a, eta_s] = state.eta(w_lig);
        let domain = &self.domain;
        let [by_eta_a, by_eta_s, theta, width, angle] = [
            excess(domain.eta_a, eta_a),
            excess(domain.eta_s, eta_s),
            excess(domain.theta, state.theta),
            excess(domain.w_lig, w_lig),
            excess(domain.alpha, alpha),
        ];
        let value = by_eta_a.0 + by_eta_s.0 + theta.0 + width.0 + angle.0;
        let by_width = width.1 - (by_eta_a.1 * eta_a + by_eta_s.1 * eta_s) / w_lig;
        let gradient = [
            by_eta_a.1 / w_lig,
            by_eta_s.1 / w_lig,
            theta.1,
            by_width,
            angle.1,
        ];
        (value, gradient)
    }
}

/// (10 e / l)^2 of one side, and its slope.
fn excess([least, greatest]: [f64; 2], at: f64) -> (f64, f64) {
    let length = (greatest - least).max(NARROWEST_INTERVAL);
    // Every path begins at 0, and a law may be learned on one side of it alone.
    let margin = |end: f64| if end == 0.0 { 0.0 } else { MARGIN * length };
    let beyond =
        (at - greatest + margin(greatest)).max(0.0) - (least + margin(least) - at).max(0.0);
    let scaled = PER_SIDE * beyond / length;
    (scaled * scaled, 2.0 * PER_SIDE * scaled / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::central_slope;

    const PENALTY: DomainPenalty = DomainPenalty {
        domain: TrainingDomain {
            eta_a: [-0.8, 0.2],
            eta_s: [-0.4, 0.4],
            theta: [0.0, 1.3],
            w_lig: [5.0, 25.0],
            alpha: [0.8, 2.3],
        },
        weight: 1.0,
    };

    fn value(x: &[f64]) -> f64 {
        let state = [x[0], x[1], x[2]].into();
        PENALTY.of_state(x[3], x[4], &state).0
    }

    #[test]
    fn a_tenth_of_a_side_beyond_its_margin_costs_one() {
        assert_eq!(value(&[0.5, 1.0, 0.4, 15.0, 1.5]), 0.0);
        assert!((value(&[0.0, 0.0, 0.5, 15.0, 0.8 + (0.02 - 0.1) * 1.5]) - 1.0).abs() < 1e-12);
        assert!((value(&[0.28 * 15.0, 0.0, 0.5, 15.0, 1.5]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_law_of_one_width_may_be_used_at_that_width_only() {
        assert_eq!(excess([0.0, 1.0], 0.0).0, 0.0);
        assert!(excess([18.0; 2], 19.0).0.is_finite());
        assert!(excess([18.0; 2], 19.0).0 > excess([18.0; 2], 18.0).0);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let outside = [
            [5.0, -9.0, 1.4, 15.0, 2.4],
            [-30.0, 12.0, -0.1, 26.0, 0.7],
            [1.0, 0.5, 0.3, 4.0, 1.5],
        ];
        for x in outside {
            let (_, gradient) = PENALTY.of_state(x[3], x[4], &[x[0], x[1], x[2]].into());
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
