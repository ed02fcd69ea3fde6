//! Penalty on badly shaped panels: the mean over all panel corners of
//!
//! ```text
//! max(0, rho - 4)^2,      rho = (|e|^2 + |f|^2) / (2 e x f),      e, f: the edges that meet at the corner
//! ```
//!
//! and the mean over all pairs of corners of a panel of
//!
//! ```text
//! max(0, l_min/l - 1)^2,  l: their distance
//! ```
//!
//! rho is 1 at the corner of a square of any size. It is 4 at the corner of a rectangle eight times
//! as long as wide, or between two equal edges at 14 degrees, and grows without bound as a panel
//! collapses. Sheets that open far need stretched panels, so shapes that can be cut well cost
//! nothing. Corners closer than l_min leave no room for the windows of their hinges.

use crate::{
    geometry::plane::{I, complex, cross},
    objective::term::{Deployed, Term, TermGradient, over_panels},
};
use faer::c64;
use support::Point;

/// Largest rho that is not penalised.
const WELL_SHAPED: f64 = 4.0;
/// All pairs of corners of a panel.
const PAIRS: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];

/// The panel shape penalty.
#[derive(Clone, Copy, Debug)]
pub struct PanelShape {
    /// l_min (mm): 0 does not limit the distances.
    pub min_distance: f64,
}

impl Term for PanelShape {
    fn name(&self) -> &'static str {
        "panel_shape"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let scale = 1.0 / at.sheet.panels.len() as f64;
        over_panels(at, weight, scale, gradient, |corners, value, gradient| {
            *value += stretched(corners, gradient) + crowded(corners, self.min_distance, gradient);
        })
    }
}

/// The mean over the corners of one panel; its gradient is added to `gradient`.
fn stretched(corners: &[Point; 4], gradient: &mut [c64; 4]) -> f64 {
    let corner = |j: usize| complex(corners[j % 4]);
    let mut value = 0.0;
    for j in 0..4 {
        let (e, f) = (corner(j + 1) - corner(j), corner(j + 2) - corner(j + 1));
        let sine = cross(e, f);
        if sine <= 0.0 {
            return f64::INFINITY;
        }
        let ratio = 0.5 * (e.norm_sqr() + f.norm_sqr()) / sine;
        let excess = f64::max(ratio - WELL_SHAPED, 0.0);
        value += 0.25 * excess * excess;
        let weight = 0.5 * excess / sine;
        let by_e = (e + I * f * ratio) * weight;
        let by_f = (f - I * e * ratio) * weight;
        gradient[j] -= by_e;
        gradient[(j + 1) % 4] += by_e - by_f;
        gradient[(j + 2) % 4] += by_f;
    }
    value
}

/// The mean over the pairs of corners of one panel; its gradient is added to `gradient`.
fn crowded(corners: &[Point; 4], min_distance: f64, gradient: &mut [c64; 4]) -> f64 {
    let weight = 1.0 / PAIRS.len() as f64;
    let mut value = 0.0;
    for [i, j] in PAIRS {
        let apart = complex(corners[j]) - complex(corners[i]);
        let distance = apart.norm();
        let lacking = f64::max(min_distance / distance - 1.0, 0.0);
        value += weight * lacking * lacking;
        let slope = -2.0 * weight * lacking * min_distance / distance.powi(2);
        let by_corner = apart * (slope / distance);
        gradient[j] += by_corner;
        gradient[i] -= by_corner;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::term::on_panels;
    use testkit::derivatives::assert_gradient;

    fn rectangle(length: f64, width: f64) -> [[f64; 2]; 4] {
        [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]]
    }

    #[test]
    fn stretched_panels_cost_above_a_ratio_and_concave_ones_are_infinite() {
        let value = |panels: &[_]| on_panels(&PanelShape { min_distance: 0.0 }, panels).0;
        assert_eq!(value(&[rectangle(1.0, 1.0), rectangle(7.0, 1.0)]), 0.0);
        let rho: f64 = 0.5 * (20.0 + 1.0 / 20.0);
        let stretched = value(&[rectangle(20.0, 1.0)]);
        assert!((stretched - (rho - 4.0).powi(2)).abs() < 1e-12);
        let dented = [[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]];
        assert_eq!(value(&[dented]), f64::INFINITY);
    }

    #[test]
    fn corners_at_half_the_minimum_distance_cost_one() {
        let term = PanelShape { min_distance: 100.0 };
        let (value, _) = on_panels(&term, &[rectangle(200.0, 50.0)]);
        assert!((value - 2.0 / 6.0).abs() < 1e-12, "{value}");
        let (value, _) = on_panels(&term, &[rectangle(200.0, 100.0)]);
        assert_eq!(value, 0.0);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let corners = [0.0, 0.1, 20.0, -0.2, 17.0, 1.1, 0.2, 0.9];
        let at = |x: &[f64]| std::array::from_fn(|j| [x[2 * j], x[2 * j + 1]]);
        let all = |x: &[f64]| {
            on_panels(&PanelShape { min_distance: 30.0 }, &[at(x), rectangle(1.0, 1.0)])
        };
        let (value, gradient) = all(&corners);
        assert!(value > 1.0, "{value}");
        let found = gradient[0].as_flattened();
        assert_gradient(|x| all(x).0, &corners, found, 1e-6, |_| 1e-6 * value);
    }
}
