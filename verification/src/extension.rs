//! Rays for hinges of a sheet at states that the training data does not cover.

use crate::recorded_path::RecordedPath;
use fe_driver::Ray;
use hinge::{HingeDeformation, TrainingDomain};

/// A ray for every hinge that leaves the training domain on its path. It leads through the
/// outermost such state, to `beyond` times it.
pub fn rays_on_paths(paths: &[RecordedPath], domain: &TrainingDomain, beyond: f64) -> Vec<Ray> {
    let ray = |path: &RecordedPath| {
        let size = |state: &HingeDeformation| {
            let [eta_a, eta_s] = state.eta(path.design.w_lig);
            eta_a * eta_a + eta_s * eta_s + state.theta * state.theta
        };
        let outside = path.states.iter();
        let outside = outside.filter(|state| !domain.contains(&path.design, state));
        let furthest = outside.max_by(|x, y| size(x).total_cmp(&size(y)))?;
        Some(Ray { design: path.design, end: furthest.at(beyond) })
    };
    paths.iter().filter_map(ray).collect()
}
