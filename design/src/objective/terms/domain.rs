//! Penalty on hinge states outside the training domain of the hinge law: the mean over hinges and
//! load steps of
//!
//! ```text
//! (5 max(0, gamma - 0.98))^2 + sum over the intervals of w_lig and alpha of (10 e / l)^2,
//! ```
//!
//! where gamma is the gauge of the domain, l the length of an interval and e the distance of the
//! hinge from it. A state beyond the domain by a tenth of the range costs 1. The penalty begins at
//! 98 % of the domain, because otherwise a minimum would lie just outside.

use crate::{
    hinge_law::HingeGradient,
    objective::term::{Deployed, Term, TermGradient},
};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::iter::zip;

/// Gauge above which a state is penalised.
const EDGE: f64 = 0.98;
/// Factor on the excess of the gauge; a gauge of one is half the range.
const PER_HALF_RANGE: f64 = 5.0;
/// Fraction of an interval at either end that is penalised already.
const MARGIN: f64 = 0.02;
/// Factor on e, relative to the length of an interval.
const PER_INTERVAL: f64 = 10.0;
/// Lower bound of the interval length; shorter intervals (a single training row, say) are widened
/// to it.
const NARROWEST_INTERVAL: f64 = 0.01;

/// The penalty on states outside a training domain.
#[derive(Debug)]
pub struct DomainPenalty {
    /// The training domain of the hinge law; without one the penalty is zero.
    pub domain: Option<TrainingDomain>,
}

impl Term for DomainPenalty {
    fn name(&self) -> &'static str {
        "domain"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let Some(domain) = &self.domain else {
            return 0.0;
        };
        let per_state = 1.0 / (at.sheet.hinges.len() * at.path.len()) as f64;
        let mut value = 0.0;
        let designs = at.sheet.designs();
        let hinges = zip(&designs, &mut gradient.by_states);
        for (h, (design, by_hinge)) in hinges.enumerate() {
            for (step, slopes) in zip(at.path, by_hinge) {
                let state = &step.deformations[h];
                let (excess, by) = excess_of_state(domain, design, state);
                value += per_state * excess;
                *slopes += by * (weight * per_state);
            }
        }
        value
    }
}

/// The contribution of one state, and its gradient.
fn excess_of_state(
    domain: &TrainingDomain,
    design: &HingeDesign,
    state: &HingeDeformation,
) -> (f64, HingeGradient) {
    let width = excess(domain.w_lig, design.w_lig);
    let angle = excess(domain.alpha, design.alpha);
    let mut value = width.0 + angle.0;
    let mut gradient = HingeGradient::from([0.0, 0.0, 0.0, width.1, angle.1, 0.0]);
    if domain.is_beyond(EDGE, &domain.section(design), state) {
        let gauge = domain.gauge_jet(design, state);
        let scaled = PER_HALF_RANGE * (gauge.value - EDGE);
        value += scaled * scaled;
        gradient += HingeGradient::from_jet(gauge.gradient) * (2.0 * PER_HALF_RANGE * scaled);
    }
    (value, gradient)
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
    use hinge::HingeConstants;
    use testkit::derivatives::assert_gradient;

    fn domain() -> TrainingDomain {
        let state = [[-0.8, 0.2], [-0.4, 0.4], [-0.1, 1.3]];
        testkit::domain_of_box(state, [5.0, 25.0], [0.8, 2.3])
    }

    /// x = (a, s, theta, w_lig, alpha, rho_f)
    fn design(x: &[f64]) -> HingeDesign {
        HingeDesign { fillet_ratio: x[5], ..HingeConstants::PAPER.hinge(x[3], x[4]) }
    }

    fn value_in(domain: &TrainingDomain, x: &[f64]) -> f64 {
        let state = [x[0], x[1], x[2]].into();
        excess_of_state(domain, &design(x), &state).0
    }

    fn value(x: &[f64]) -> f64 {
        value_in(&domain(), &[x, &[0.16]].concat())
    }

    /// The domain of a few hinges with holes of several radii.
    fn of_several_holes() -> TrainingDomain {
        let states = (0..40).map(|i| {
            let part = |number: f64| (f64::from(i) * number).fract();
            let (w_lig, alpha) = (5.0 + 20.0 * part(0.618), 0.8 + 1.5 * part(0.414));
            let design = design(&[0.0, 0.0, 0.0, w_lig, alpha, 0.4 * part(0.732)]);
            let eta = [0.8 * part(0.236) - 0.6, 0.8 * part(0.645) - 0.4];
            let theta = 1.3 * part(0.316);
            let state = HingeDeformation::from_eta(eta[0], eta[1], theta, w_lig);
            (design, state)
        });
        TrainingDomain::covering(states.collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_tenth_of_the_range_beyond_its_margin_costs_one() {
        assert_eq!(value(&[-3.0, 1.0, 0.4, 15.0, 1.5]), 0.0);
        assert!((value(&[0.0, 0.0, 0.5, 15.0, 0.8 + (0.02 - 0.1) * 1.5]) - 1.0).abs() < 1e-12);
        // The other half-spaces do not matter in the middle of a face.
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
            [5.0, -9.0, 1.4, 15.0, 2.4, 0.16],
            [-30.0, 12.0, -0.2, 26.0, 0.7, 0.3],
            [1.0, 0.5, 0.3, 4.0, 1.5, 0.05],
        ];
        for domain in [domain(), of_several_holes()] {
            for x in outside {
                let state = [x[0], x[1], x[2]].into();
                let (_, gradient) = excess_of_state(&domain, &design(&x), &state);
                let allowed = |slope: f64| 1e-6 * slope.abs().max(1.0);
                let gradient = gradient.to_array();
                assert_gradient(|x| value_in(&domain, x), &x, &gradient, 1e-6, allowed);
            }
        }
    }
}
