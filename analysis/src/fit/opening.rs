//! How far the hinges of a sheet may open.

use hinge::{HingeDeformation, HingeDesign, Regime};
use std::f64::consts::FRAC_PI_2;
use surrogate::Surrogate;

/// The largest D_peak of a ligament that turns freely, at which a sheet is planned.
const SAFE_PEAK: f64 = 0.8;
/// By how much less a hinge opens until it is not above it (rad): 5 degrees.
const LESS: f64 = 0.0873;

/// The largest opening, `most` (rad) or less by steps of 5 degrees, at which a ligament of `w_lig`
/// (mm, in the thickness of the weights) that turns freely is inside the training domain and safe,
/// at the smallest cut angle of the weights and at a right angle; at least 10 degrees.
pub fn safe_opening(surrogate: &Surrogate, regime: Regime, w_lig: f64, most: f64) -> f64 {
    let [least, _] = surrogate.domain().alpha;
    let bears = |theta: f64| {
        [least, FRAC_PI_2].into_iter().all(|alpha| {
            let (design, state) = free_turn(surrogate, regime, w_lig, alpha, theta);
            let damage = surrogate.damage_values(&[design], &[state]);
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
/// thickness of the weights) that turn freely by `theta` (rad) at a right angle.
pub fn damage_of_turn(surrogate: &Surrogate, regime: Regime, w_lig: f64, theta: f64) -> f64 {
    let (design, state) = free_turn(surrogate, regime, w_lig, FRAC_PI_2, theta);
    let damage = surrogate.damage_values(&[design], &[state]);
    damage.iter().map(|damage| (damage.d / surrogate.damage_scale()).powi(2)).sum()
}

fn free_turn(
    surrogate: &Surrogate,
    regime: Regime,
    w_lig: f64,
    alpha: f64,
    theta: f64,
) -> (HingeDesign, HingeDeformation) {
    let [first, second] = regime.free_opening();
    let eta_a = theta * (first + second * theta);
    (
        surrogate.card().hinge.hinge(w_lig, alpha),
        HingeDeformation::from_eta(eta_a, 0.0, theta, w_lig),
    )
}
