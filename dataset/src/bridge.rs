//! The multiplicative bridge between two fidelities; see [`crate::fidelity_correction`].

use crate::compare::ComparedRay;
use faer::Side;
use faer::linalg::solvers::{Llt, Solve};
use faer::prelude::*;
use fe_driver::SolvedRay;
use hinge::{HingeDesign, HingeSample};
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;
use support::vectors::dot;

/// The terms, as products of two of (w_lig, alpha, eta_a, eta_s, theta, 1).
pub(crate) const TERMS: [[usize; 2]; 13] = [
    [5, 5],
    [0, 5],
    [2, 5],
    [4, 5],
    [0, 0],
    [0, 2],
    [0, 4],
    [2, 2],
    [2, 4],
    [4, 4],
    [1, 1],
    [1, 3],
    [3, 3],
];
/// Fraction of the root mean square that limits the scale of the relative error of small values
/// from below.
const LEAST_SCALE: f64 = 0.3;
/// Weight of the equation of a force, relative to the weight of the equation of W. Where a ligament
/// buckles a second time, forces differ between the meshes as no polynomial does: on 34 rays of the
/// film, corrected by the others, W is off by 2.6 % at the weight 1, by 1.2 % at 0.1 and at 0, F_s
/// by 5.6, 5.5 and 6.4 %.
const FORCE_WEIGHT: f64 = 0.1;
/// Weight of the ridge regularisation, which equals the weight of one state. It determines only the
/// coefficients that the rays do not determine.
const RIDGE: f64 = 1.0;

/// Coefficients of the [`TERMS`].
type Coefficients = [f64; TERMS.len()];

/// Hinge and state of a sample.
type SolvedState<'a> = (&'a HingeDesign, &'a HingeSample);

/// The fitted correction from one mesh to another.
#[derive(Clone, Debug)]
pub(crate) struct Bridge {
    /// Middle and half the range of (w_lig, alpha, eta_a, eta_s, theta).
    ranges: [[f64; 2]; 5],
    /// Coefficients of q of W, of D and of D_peak.
    coefficients: [Coefficients; 3],
}

impl Bridge {
    /// Fits the correction from the mesh of the rays to the mesh of their references.
    pub(crate) fn fit<'a>(rays: &'a [ComparedRay]) -> Self {
        let fitted = rays.iter().filter(|it| it.ray.at_requested_tier());
        let of_ray = |it: &'a ComparedRay| {
            it.pairs().map(|(sample, reference)| ((&it.ray.design, sample), reference))
        };
        let pairs: Vec<(SolvedState, &HingeSample)> = fitted.flat_map(of_ray).collect();
        let unfitted = Self {
            ranges: ranges(pairs.iter().map(|(state, _)| *state)),
            coefficients: Default::default(),
        };
        // A pair with an unknown value is omitted.
        let damage = |value: fn(&HingeSample) -> Option<f64>| {
            let changes = pairs.iter().filter_map(|(state, reference)| {
                let (terms, _) = unfitted.terms(*state);
                Some(Observation::new(terms, value(state.1)?, value(reference)?))
            });
            least_squares([(changes.collect(), 1.0)])
        };
        let changes =
            pairs.iter().map(|(state, reference)| unfitted.energy_changes(*state, reference));
        let changes: Vec<[Observation; 4]> = changes.collect();
        let quantity = |i: usize| {
            let weight = if i == 0 { 1.0 } else { FORCE_WEIGHT };
            (changes.iter().map(|changes| changes[i]).collect(), weight)
        };
        Self {
            coefficients: [
                least_squares([0, 1, 2, 3].map(quantity)),
                damage(|sample| Some(sample.d)),
                damage(|sample| sample.d_peak),
            ],
            ..unfitted
        }
    }

    /// How the coefficients of q change W, F_a, F_s and M of a state.
    fn energy_changes(&self, state: SolvedState, reference: &HingeSample) -> [Observation; 4] {
        let (terms, slopes) = self.terms(state);
        let (_, x) = state;
        let force = |i: usize, value: f64, reference: f64| {
            let by = |k: usize| terms[k] * value + x.w * slopes[k][i];
            Observation { by: from_fn(by), missing: reference - value, reference }
        };
        [
            Observation::new(terms, x.w, reference.w),
            force(0, x.f_a, reference.f_a),
            force(1, x.f_s, reference.f_s),
            force(2, x.m_theta, reference.m_theta),
        ]
    }

    /// The correction of the energy, the damage and D_peak, as far as they are to be `corrected`.
    pub(crate) fn only(mut self, corrected: [bool; 3]) -> Self {
        for (coefficients, _) in
            self.coefficients.iter_mut().zip(corrected).filter(|(_, corrected)| !corrected)
        {
            *coefficients = Coefficients::default();
        }
        self
    }

    /// A sample of a ray, corrected to the finer mesh. Quantities that no surrogate is trained on
    /// are unchanged, including the work of the reaction forces and the energy residual. A ray that
    /// was solved on a finer tier than the requested one is also unchanged.
    pub(crate) fn corrected(&self, ray: &SolvedRay, x: &HingeSample) -> HingeSample {
        if !ray.at_requested_tier() {
            return *x;
        }
        let (terms, slopes) = self.terms((&ray.design, x));
        let [energy, damage, peak] = self.coefficients.map(|c| 1.0 + dot(&c, &terms));
        let slope = |i: usize| dot(&self.coefficients[0], &slopes.map(|term| term[i]));
        HingeSample {
            w: energy * x.w,
            f_a: energy * x.f_a + x.w * slope(0),
            f_s: energy * x.f_s + x.w * slope(1),
            m_theta: energy * x.m_theta + x.w * slope(2),
            d: damage.max(0.0) * x.d,
            d_peak: x.d_peak.map(|value| peak.max(0.0) * value),
            ..*x
        }
    }

    /// The terms at a state, and their gradients with respect to (a, s, theta).
    fn terms(&self, state: SolvedState) -> (Coefficients, [[f64; 3]; TERMS.len()]) {
        let at = coordinates(state);
        let w_lig = state.0.w_lig;
        let units = [1.0, 1.0, w_lig, w_lig, 1.0];
        let (mut x, mut by) = ([1.0; 6], [[0.0; 3]; 6]);
        for (i, [middle, half]) in self.ranges.into_iter().enumerate() {
            let scaled = (at[i] - middle) / half;
            x[i] = scaled.clamp(-1.0, 1.0);
            // The first two coordinates are the geometry, on which the forces do no work.
            if i >= 2 && x[i] == scaled {
                by[i][i - 2] = 1.0 / (half * units[i]);
            }
        }
        (
            TERMS.map(|[i, j]| x[i] * x[j]),
            TERMS.map(|[i, j]| from_fn(|d| by[i][d] * x[j] + x[i] * by[j][d])),
        )
    }
}

/// w_lig (mm), alpha - pi/2 (rad), eta_a, eta_s, theta (rad).
fn coordinates((design, sample): SolvedState) -> [f64; 5] {
    let [eta_a, eta_s] = sample.deformation().eta(design.w_lig);
    [design.w_lig, design.alpha - FRAC_PI_2, eta_a, eta_s, sample.theta]
}

/// Middle and half of the range of each coordinate. The middle is 0 except for the width, so
/// the mirror image has the opposite alpha and eta_s. A constant coordinate is not scaled.
fn ranges<'a>(states: impl Iterator<Item = SolvedState<'a>>) -> [[f64; 2]; 5] {
    let mut minimum = [f64::INFINITY; 5];
    let mut maximum = [f64::NEG_INFINITY; 5];
    for state in states {
        for (i, value) in coordinates(state).into_iter().enumerate() {
            minimum[i] = minimum[i].min(value);
            maximum[i] = maximum[i].max(value);
        }
    }
    from_fn(|i| {
        let [middle, half] = match i {
            0 => [0.5 * (minimum[i] + maximum[i]), 0.5 * (maximum[i] - minimum[i])],
            _ => [0.0, maximum[i].abs().max(minimum[i].abs())],
        };
        [middle, if half > 0.0 { half } else { 1.0 }]
    })
}

/// What the coefficients c do to a value: it changes by c . by, and should by `missing`.
#[derive(Clone, Copy)]
struct Observation {
    by: Coefficients,
    missing: f64,
    /// The value on the finer mesh.
    reference: f64,
}

impl Observation {
    /// The change of a value that is multiplied by 1 + c . terms.
    fn new(terms: Coefficients, value: f64, reference: f64) -> Self {
        Self { by: terms.map(|term| term * value), missing: reference - value, reference }
    }
}

/// The c with which c . by = missing, by least squares, each equation scaled by its reference and
/// with the weight of its quantity.
fn least_squares(quantities: impl IntoIterator<Item = (Vec<Observation>, f64)>) -> Coefficients {
    let mut normal = RIDGE * Mat::<f64>::identity(TERMS.len(), TERMS.len());
    let mut right = Mat::<f64>::zeros(TERMS.len(), 1);
    for (changes, weight) in quantities {
        let squares: f64 = changes.iter().map(|change| change.reference.powi(2)).sum();
        if squares == 0.0 {
            continue;
        }
        let minimum = LEAST_SCALE * (squares / changes.len() as f64).sqrt();
        for change in changes {
            let scale = change.reference.hypot(minimum) / weight;
            let row = change.by.map(|by| by / scale);
            for i in 0..TERMS.len() {
                right[(i, 0)] += row[i] * change.missing / scale;
                for j in 0..TERMS.len() {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    let factor =
        Llt::new(normal.as_ref(), Side::Lower).expect("the ridge term makes it positive definite");
    let solution = factor.solve(&right);
    from_fn(|i| solution[(i, 0)])
}
