//! The training domain of given states.

use crate::domain::directions::{DIRECTION, DIRECTIONS, dot, norm};
use crate::domain::{TrainingDomain, measures};
use crate::{HingeConstants, HingeDeformation, HingeDesign};
use std::array::from_fn;

/// Maximum number of widths at which the supports are stored.
pub(super) const MOST_WIDTHS: usize = 5;
/// Number of states per stored width: about a hundred rays.
const STATES_A_WIDTH: usize = 4000;
/// A state contributes to a stored width if their distance is at most this fraction of the step between widths.
const REACH: f64 = 0.75;
/// Minimum support and minimum half-range, so that a domain of one state has a non-zero size.
const LEAST_SIZE: f64 = 0.01;
/// Maximum gamma of the flat state, where W and its gradient vanish for any weights.
const FLAT: f64 = 0.98;

impl TrainingDomain {
    /// The domain of the given states and the flat state; `None` if no state is given. If the hinges have holes of several
    /// radii, it is in the measures of hinges with the paper's hole.
    ///
    /// The states are passed through several times, and none is kept.
    pub fn covering(
        states: impl IntoIterator<Item = (HingeDesign, HingeDeformation), IntoIter: Clone>,
    ) -> Option<Self> {
        let states = states.into_iter();
        let mut holes = states.clone().map(|(design, _)| design.fillet_ratio);
        let first = holes.next();
        let several = holes.any(|hole| Some(hole) != first);
        let hole = several.then_some(HingeConstants::PAPER.fillet_ratio);
        let states =
            states.map(|(design, deformation)| (measures(hole, &design, &deformation), design));
        let states = || states.clone();
        let count = states().count();
        if count == 0 {
            return None;
        }
        let mut domain = Self {
            w_lig: interval(states().map(|(_, design)| design.w_lig)),
            alpha: interval(states().map(|(_, design)| design.alpha)),
            hole,
            centre: from_fn(|i| states().map(|(x, _)| x[i]).sum::<f64>() / count as f64),
            half_range: from_fn(|i| {
                let [minimum, maximum] = interval(states().map(|(x, _)| x[i]));
                (0.5 * (maximum.max(0.0) - minimum.min(0.0))).max(LEAST_SIZE)
            }),
            supports: Vec::new(),
        };
        let widths = (count / STATES_A_WIDTH).clamp(1, MOST_WIDTHS);
        domain.supports = (0..widths)
            .map(|width| {
                let near = states()
                    .filter(|(_, g)| (domain.along(g.w_lig, widths) - width as f64).abs() <= REACH)
                    .map(|(x, _)| domain.scaled(x));
                domain.support(near)
            })
            .collect();
        Some(domain)
    }

    /// The domain of a box of states; an interval may have zero length.
    pub fn from_box(state: [[f64; 2]; 3], w_lig: [f64; 2], alpha: [f64; 2]) -> Self {
        let mut domain = Self {
            w_lig,
            alpha,
            hole: None,
            centre: state.map(|[minimum, maximum]| 0.5 * (minimum + maximum)),
            half_range: state.map(|[minimum, maximum]| (0.5 * (maximum - minimum)).max(LEAST_SIZE)),
            supports: Vec::new(),
        };
        let corners = (0..8).map(|k| from_fn(|i| state[i][(k >> i) & 1]));
        let corners: Vec<[f64; 3]> = corners.map(|corner| domain.scaled(corner)).collect();
        domain.supports = vec![domain.support(corners)];
        domain
    }

    /// s(m) of scaled states and of the flat state, which must be inside the domain.
    fn support(&self, states: impl IntoIterator<Item = [f64; 3]>) -> [f64; DIRECTIONS] {
        let flat = self.scaled([0.0; 3]);
        let along = |y: [f64; 3]| -> [f64; DIRECTIONS] { from_fn(|m| dot(DIRECTION[m], y)) };
        let minimum = along(flat).map(|s| s.max(LEAST_SIZE));
        let support = states.into_iter().fold(minimum, |support, y| {
            let along = along(y);
            from_fn(|m| along[m].max(support[m]))
        });
        let grown = norm(from_fn(|m| dot(DIRECTION[m], flat) / support[m])) / FLAT;
        support.map(|s| grown.max(1.0) * s)
    }
}

/// The smallest interval that holds every value.
fn interval(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[minimum, maximum], x| [x.min(minimum), x.max(maximum)],
    )
}
