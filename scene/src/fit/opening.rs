//! How far the hinges of a sheet may open.

use hinge::{HingeDeformation, Regime};
use std::f64::consts::FRAC_PI_2;
use surrogate::Surrogate;

/// The largest D_peak of a ligament that turns freely, at which a sheet is planned.
const SAFE_PEAK: f64 = 0.8;
/// By how much less a hinge opens until it is not above it (rad): 5 degrees.
const LESS: f64 = 0.0873;

/// The largest opening, `most` (rad) or less by steps of 5 degrees, at which a ligament of `w_lig` (mm, in the thickness of the weights)
/// that turns freely is inside the training domain and safe, at the smallest cut angle of the weights and at a right angle; at least 10
/// degrees.
pub fn safe_opening(surrogate: &Surrogate, regime: Regime, w_lig: f64, most: f64) -> f64 {
    let card = surrogate.card();
    let [least, _] = surrogate.domain().alpha;
    let [first, second] = regime.free_opening();
    let bears = |theta: f64| {
        let eta_a = theta * (first + second * theta);
        let state = HingeDeformation::from_eta(eta_a, 0.0, theta, w_lig);
        [least, FRAC_PI_2].into_iter().all(|alpha| {
            let design = card.hinge.hinge(w_lig, alpha);
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
