//! Training domains for tests.

use hinge::{HingeConstants, HingeDeformation, TrainingDomain};

/// The domain that covers the corners of a box of (eta_a, eta_s, theta), for ranges of w_lig (mm)
/// and alpha (rad).
pub fn domain_of_box(state: [[f64; 2]; 3], w_lig: [f64; 2], alpha: [f64; 2]) -> TrainingDomain {
    TrainingDomain::covering((0..32_usize).map(|k| {
        let end = |range: [f64; 2], bit: usize| range[k >> bit & 1];
        let [eta_a, eta_s, theta] = [0, 1, 2].map(|i| end(state[i], i));
        let design = HingeConstants::PAPER.hinge(end(w_lig, 3), end(alpha, 4));
        (design, HingeDeformation::from_eta(eta_a, eta_s, theta, design.w_lig))
    }))
    .expect("a box has corners")
}
