//! The box of hinge states that the database covers.

use crate::{HingeDeformation, HingeDesign};
use serde::{Deserialize, Serialize};

/// Closed intervals [least, greatest] of the states a surrogate was trained on; section 2.4.
///
/// It comes from the data and travels with the weights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingDomain {
    pub eta_a: [f64; 2],
    pub eta_s: [f64; 2],
    /// rad
    pub theta: [f64; 2],
    /// mm
    pub w_lig: [f64; 2],
    /// rad
    pub alpha: [f64; 2],
}

impl TrainingDomain {
    /// Whether the state of one hinge lies in the box.
    pub fn contains(&self, design: &HingeDesign, deformation: &HingeDeformation) -> bool {
        self.sides(design, deformation)
            .iter()
            .all(|([least, greatest], value)| (least..=greatest).contains(&value))
    }

    /// How far the state lies from the nearest side, over the length of that side: 1/2 in the
    /// middle of the box, 0 at its edge, and less than 0 outside, where the side that is farthest
    /// off counts.
    pub fn depth(&self, design: &HingeDesign, deformation: &HingeDeformation) -> f64 {
        let sides = self.sides(design, deformation).into_iter();
        sides
            .map(|([least, greatest], value)| {
                (value - least).min(greatest - value) / (greatest - least)
            })
            .fold(0.5, f64::min)
    }

    /// Each side of the box with the coordinate along it.
    fn sides(&self, design: &HingeDesign, deformation: &HingeDeformation) -> [([f64; 2], f64); 5] {
        let [eta_a, eta_s] = deformation.eta(design.w_lig);
        [
            (self.eta_a, eta_a),
            (self.eta_s, eta_s),
            (self.theta, deformation.theta),
            (self.w_lig, design.w_lig),
            (self.alpha, design.alpha),
        ]
    }

    /// The smallest box that holds every state and the undeformed one, where W and its gradient
    /// vanish for any weights; `None` if there is no state.
    pub fn covering<'a>(
        states: impl IntoIterator<Item = (&'a HingeDesign, &'a HingeDeformation)>,
    ) -> Option<Self> {
        let mut domain: Option<Self> = None;
        for (design, deformation) in states {
            let [eta_a, eta_s] = deformation.eta(design.w_lig);
            let from_zero = |x: f64| [x.min(0.0), x.max(0.0)];
            let ray = Self {
                eta_a: from_zero(eta_a),
                eta_s: from_zero(eta_s),
                theta: from_zero(deformation.theta),
                w_lig: [design.w_lig; 2],
                alpha: [design.alpha; 2],
            };
            domain = Some(domain.map_or(ray, |domain| domain.joined(&ray)));
        }
        domain
    }

    /// The smallest box that holds both.
    fn joined(&self, other: &Self) -> Self {
        let join = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            eta_a: join(self.eta_a, other.eta_a),
            eta_s: join(self.eta_s, other.eta_s),
            theta: join(self.theta, other.theta),
            w_lig: join(self.w_lig, other.w_lig),
            alpha: join(self.alpha, other.alpha),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_covering_box_is_tight_and_holds_its_states() {
        let narrow = HingeDesign {
            w_lig: 5.0,
            alpha: 1.0,
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        };
        let wide = HingeDesign {
            w_lig: 25.0,
            alpha: 2.0,
            ..narrow
        };
        let states = [
            (narrow, HingeDeformation::from_eta(-0.5, 0.1, 0.2, 5.0)),
            (wide, HingeDeformation::from_eta(0.25, -0.3, 1.2, 25.0)),
        ];
        let domain = TrainingDomain::covering(states.iter().map(|(g, e)| (g, e))).unwrap();
        assert_eq!(domain.eta_a, [-0.5, 0.25]);
        assert_eq!(domain.theta, [0.0, 1.2]);
        assert!(states.iter().all(|(g, e)| domain.contains(g, e)));
        let beyond = HingeDeformation::from_eta(0.0, 0.0, 1.26, 25.0);
        assert!(!domain.contains(&wide, &beyond));
        assert!((domain.depth(&wide, &beyond) + 0.05).abs() < 1e-12);
        let middle = HingeDesign {
            w_lig: 15.0,
            alpha: 1.5,
            ..narrow
        };
        let state = HingeDeformation::from_eta(-0.125, -0.1, 0.48, 15.0);
        assert!((domain.depth(&middle, &state) - 0.4).abs() < 1e-12);
        assert!(TrainingDomain::covering([]).is_none());
    }
}
