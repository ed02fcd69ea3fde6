//! How far the hinges of a sheet may open.

use hinge::{HingeDeformation, HingeDesign};
use std::f64::consts::FRAC_PI_2;
use surrogate::{Order, Surrogate};

/// The largest D_peak of a ligament that turns freely, at which a sheet is planned.
const SAFE_PEAK: f64 = 0.8;
/// By how much less a hinge opens until it is not above it (rad): 5 degrees.
const LESS: f64 = 0.0873;
/// How far the axial opening of a ligament that turns freely is from the middle of the training
/// domain, over its width, and the number of halvings by which it is found.
const NEAR_PATH: f64 = 0.3;
const HALVINGS: usize = 40;

/// The largest opening, `most` (rad) or less by steps of 5 degrees, at which a ligament of `w_lig`
/// (mm, in the thickness of the law) that turns freely is inside the training domain and safe
/// at some cut angles (rad); at least 10 degrees.
pub fn safe_opening(surrogate: &Surrogate, w_lig: f64, angles: &[f64], most: f64) -> f64 {
    let bears = |theta: f64| {
        angles.iter().all(|&alpha| {
            let (design, state) = free_turn(surrogate, w_lig, alpha, theta);
            let damage = surrogate.damage(&[design], &[state], false);
            let safe = |peak: Option<f64>| peak.is_none_or(|peak| peak <= SAFE_PEAK);
            surrogate.domain().contains(&design, &state)
                && damage.iter().all(|damage| safe(damage.d_peak))
        })
    };
    let mut opening = most;
    while opening > 3.0 * LESS && !bears(opening) {
        opening -= LESS;
    }
    opening
}

/// (D / D_s)^2, the damage term (17) of a sheet of uniform ligaments of `w_lig` (mm, in the
/// thickness of the law) that turn freely by `theta` (rad) at a right angle.
pub fn damage_of_turn(surrogate: &Surrogate, w_lig: f64, theta: f64) -> f64 {
    let (design, state) = free_turn(surrogate, w_lig, FRAC_PI_2, theta);
    let damage = surrogate.damage(&[design], &[state], false);
    damage.iter().map(|damage| (damage.d / surrogate.damage_scale()).powi(2)).sum()
}

/// The axial opening over the width of a ligament of `w_lig` (mm, in the thickness of the law)
/// that turns freely by `theta` (rad) at a right angle.
pub fn free_axial_opening(surrogate: &Surrogate, w_lig: f64, theta: f64) -> f64 {
    free_turn(surrogate, w_lig, FRAC_PI_2, theta).1.a / w_lig
}

/// A ligament of `w_lig` (mm, in the thickness of the law) that turns by `theta` (rad) without an
/// axial force.
fn free_turn(
    surrogate: &Surrogate,
    w_lig: f64,
    alpha: f64,
    theta: f64,
) -> (HingeDesign, HingeDeformation) {
    let design = surrogate.card().hinge.hinge(w_lig, alpha);
    let prepared = surrogate.prepare(&[design]);
    let at = |eta_a: f64| surrogate.domain().state(&design, [eta_a, 0.0, theta]);
    let [mut pushed, mut pulled] = [-NEAR_PATH, NEAR_PATH];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (pushed + pulled);
        let pull = surrogate.evaluate(&prepared, &[at(middle)], Order::Forces)[0].forces[0];
        *(if pull > 0.0 { &mut pulled } else { &mut pushed }) = middle;
    }
    (design, at(0.5 * (pushed + pulled)))
}
