//! The form in which a training domain is stored, and the rules that a stored one must satisfy.

use crate::domain::TrainingDomain;
use crate::domain::directions::{DIRECTION, DIRECTIONS, norm};
use crate::{HingeDeformation, HingeDesign};
use serde::Deserialize;
use std::array::from_fn;
use support::vectors::dot;
use support::{Fault, refuse};

/// The fields of a domain, not checked yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Stored {
    w_lig: [f64; 2],
    alpha: [f64; 2],
    #[serde(default)]
    holes: Option<[f64; 2]>,
    #[serde(default)]
    mean_path: [f64; 2],
    centre: [f64; 3],
    half_range: [f64; 3],
    supports: Vec<[f64; DIRECTIONS]>,
}

impl TryFrom<Stored> for TrainingDomain {
    type Error = Fault;

    fn try_from(stored: Stored) -> Result<Self, Fault> {
        let Stored { w_lig, alpha, holes, mean_path, centre, half_range, supports } = stored;
        let is_interval =
            |[minimum, maximum]: [f64; 2]| minimum <= maximum && (maximum - minimum).is_finite();
        let is_positive = |x: &f64| *x > 0.0 && x.is_finite();
        let rules = [
            ("centre is finite", centre.iter().all(|x| x.is_finite())),
            ("half_range > 0", half_range.iter().all(is_positive)),
            ("supports has at least one row", !supports.is_empty()),
            ("supports > 0", supports.iter().flatten().all(is_positive)),
            ("0 < minimum <= maximum for w_lig", is_interval(w_lig) && w_lig[0] > 0.0),
            ("minimum <= maximum for alpha", is_interval(alpha)),
            (
                "0 <= minimum < maximum < 1 for holes",
                holes.is_none_or(|[least, most]| 0.0 <= least && least < most && most < 1.0),
            ),
            ("mean_path is finite", mean_path.iter().all(|c| c.is_finite())),
        ];
        match rules.into_iter().find(|(_, holds)| !holds) {
            Some((rule, _)) => refuse!("the training domain violates the rule `{rule}`"),
            None => Ok(Self { w_lig, alpha, holes, mean_path, centre, half_range, supports }),
        }
    }
}

// The training domain of given states.

/// Maximum number of widths at which the supports are stored.
pub(super) const MOST_WIDTHS: usize = 5;
/// Number of states per stored width: about a hundred rays.
const STATES_A_WIDTH: usize = 4000;
/// A state contributes to a stored width if their distance is at most this fraction of the step
/// between widths.
const REACH: f64 = 0.75;
/// Minimum support and minimum half-range, so that a domain of one state has a non-zero size.
const LEAST_SIZE: f64 = 0.01;
/// A mean path counts if the range of eta_a about it is at most this fraction of the whole range: a
/// sixth in plates, which turn freely along it. Thin ligaments buckle at any eta_a: about their
/// mean path the domain would be a tenth larger.
const NARROWED: f64 = 0.5;
/// Maximum gamma of the flat state, where W and its gradient vanish for any weights.
const FLAT: f64 = 0.98;

impl TrainingDomain {
    /// The domain of the given states and the flat state; `None` if no state is given.
    ///
    /// The states are passed through several times, and none is kept.
    pub fn covering(
        states: impl IntoIterator<Item = (HingeDesign, HingeDeformation), IntoIter: Clone>,
    ) -> Option<Self> {
        let states = states.into_iter();
        let designs = || states.clone().map(|(design, _)| design);
        let count = designs().count();
        if count == 0 {
            return None;
        }
        let holes = interval(designs().map(|design| design.fillet_ratio));
        let mut domain = Self {
            w_lig: interval(designs().map(|design| design.w_lig)),
            alpha: interval(designs().map(|design| design.alpha)),
            holes: (holes[0] < holes[1]).then_some(holes),
            mean_path: [0.0; 2],
            centre: [0.0; 3],
            half_range: [1.0; 3],
            supports: Vec::new(),
        };
        let coordinates = |domain: &Self| {
            let domain = domain.clone();
            (states.clone()).map(move |(g, x)| (domain.coordinates(&g, &x), g))
        };
        let width = |domain: &Self| {
            let [least, most] = interval(coordinates(domain).map(|(x, _)| x[0]));
            most - least
        };
        let straight = width(&domain);
        domain.mean_path = mean_path(coordinates(&domain).map(|(x, _)| x));
        if width(&domain) > NARROWED * straight {
            domain.mean_path = [0.0; 2];
        }
        let measured = || coordinates(&domain);
        let (centre, half_range) = (
            from_fn(|i| measured().map(|(x, _)| x[i]).sum::<f64>() / count as f64),
            from_fn(|i| {
                let [minimum, maximum] = interval(measured().map(|(x, _)| x[i]));
                (0.5 * (maximum.max(0.0) - minimum.min(0.0))).max(LEAST_SIZE)
            }),
        );
        (domain.centre, domain.half_range) = (centre, half_range);
        let widths = (count / STATES_A_WIDTH).clamp(1, MOST_WIDTHS);
        domain.supports = (0..widths)
            .map(|width| {
                let near = coordinates(&domain)
                    .filter(|(_, g)| (domain.along(g.w_lig, widths) - width as f64).abs() <= REACH)
                    .map(|(x, _)| domain.scaled(x));
                domain.support(near)
            })
            .collect();
        Some(domain)
    }

    /// s(m) of scaled states and of the flat state, which must be inside the domain.
    fn support(&self, states: impl IntoIterator<Item = [f64; 3]>) -> [f64; DIRECTIONS] {
        let flat = self.scaled([0.0; 3]);
        let along = |y: [f64; 3]| -> [f64; DIRECTIONS] { from_fn(|m| dot(&DIRECTION[m], &y)) };
        let minimum = along(flat).map(|s| s.max(LEAST_SIZE));
        let support = states.into_iter().fold(minimum, |support, y| {
            let along = along(y);
            from_fn(|m| along[m].max(support[m]))
        });
        let grown = norm(from_fn(|m| dot(&DIRECTION[m], &flat) / support[m])) / FLAT;
        support.map(|s| grown.max(1.0) * s)
    }
}

/// c_1 and c_2 of the parabola eta_a = c_1 theta + c_2 theta^2 by least squares; zero if the states
/// do not determine it.
fn mean_path(coordinates: impl Iterator<Item = [f64; 3]>) -> [f64; 2] {
    // Sums of theta^2, theta^3, theta^4, eta_a theta and eta_a theta^2.
    let [second, third, fourth, first_moment, second_moment] =
        coordinates.fold([0.0; 5], |sums: [f64; 5], [eta_a, _, theta]| {
            let square = theta * theta;
            let terms = [square, square * theta, square * square, eta_a * theta, eta_a * square];
            from_fn(|i| sums[i] + terms[i])
        });
    let determinant = second * fourth - third * third;
    if determinant <= 1e-9 * second * fourth {
        return [0.0; 2];
    }
    [
        (first_moment * fourth - second_moment * third) / determinant,
        (second_moment * second - first_moment * third) / determinant,
    ]
}

/// The smallest interval that holds every value.
fn interval(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[minimum, maximum], x| {
        [x.min(minimum), x.max(maximum)]
    })
}
