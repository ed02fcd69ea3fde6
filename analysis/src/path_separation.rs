//! How far the path of a hinge departs from the ray to its end, along which the hinge law was
//! measured (section 5.2): a straight ray, or one that bends like the free turn of a ligament.

use hinge::HingeDeformation;

/// Maximum distance between the path of a hinge, from the undeformed state through `states`, and
/// the ray to its end, at equal fractions of their lengths, in ligament widths.
///
/// It is Euclidean in (eta_a, eta_s, theta), with eta_a from the bend of the ray, which has the
/// given [curvature](surrogate::Surrogate::ray_curvature): a rotation by one radian moves a point
/// at the distance of one ligament width from O by one ligament width.
pub fn path_separation(w_lig: f64, curvature: f64, states: &[HingeDeformation]) -> f64 {
    let position = |state: &HingeDeformation| {
        let [eta_a, eta_s] = state.eta(w_lig);
        let bend = curvature * state.theta * state.theta.abs();
        [eta_a - bend, eta_s, state.theta]
    };
    let begin = std::iter::once([0.0; 3]);
    let positions: Vec<[f64; 3]> = begin.chain(states.iter().map(position)).collect();
    let mut lengths = vec![0.0];
    for pair in positions.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + distance(pair[0], pair[1]));
    }
    let whole = lengths[lengths.len() - 1].max(f64::MIN_POSITIVE);
    let end = positions[positions.len() - 1];
    let gaps = positions.iter().zip(&lengths).map(|(position, length)| {
        let on_the_ray = end.map(|x| length / whole * x);
        distance(*position, on_the_ray)
    });
    gaps.fold(0.0, f64::max)
}

fn distance(x: [f64; 3], y: [f64; 3]) -> f64 {
    let squares = std::iter::zip(x, y).map(|(x, y)| (x - y).powi(2));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn separation(states: &[[f64; 3]]) -> f64 {
        let states: Vec<_> = states.iter().map(|state| (*state).into()).collect();
        path_separation(10.0, 0.0, &states)
    }

    #[test]
    fn a_straight_path_is_its_ray_at_any_pace() {
        assert!(separation(&[[0.1, 0.2, 0.05], [0.2, 0.4, 0.1], [2.0, 4.0, 1.0]]) < 1e-15);
        assert_eq!(separation(&[]), 0.0);
    }

    #[test]
    fn a_path_that_bends_as_its_ray_does_is_not_separated() {
        let curvature = 0.16;
        // Equal steps of theta are nearly equal lengths of the path.
        let state = |i: u32| {
            let theta = 0.05 * f64::from(i);
            HingeDeformation::from_eta(theta * curvature * theta, 0.0, theta, 10.0)
        };
        let states: Vec<_> = (1..=20).map(state).collect();
        let found = [curvature, 0.0].map(|curvature| path_separation(10.0, curvature, &states));
        assert!(found[0] < 1e-15, "{found:?}");
        assert!((found[1] - 0.04).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn a_right_angle_is_separated_at_its_corner() {
        // Rotation by 0.3, then 0.4 ligament widths: the corner is at 3/7 of the length.
        let found = separation(&[[0.0, 0.0, 0.3], [4.0, 0.0, 0.3]]);
        let fraction = 3.0 / 7.0;
        let gap = distance([0.0, 0.0, 0.3], [fraction * 0.4, 0.0, fraction * 0.3]);
        assert!((found - gap).abs() < 1e-15);
        // 0.3 along, then 0.4 across: at 3/7 of the length.
        let found = separation(&[[3.0, 0.0, 0.0], [3.0, 4.0, 0.0]]);
        let gap = f64::hypot(0.3 - fraction * 0.3, fraction * 0.4);
        assert!((found - gap).abs() < 1e-15);
    }
}
