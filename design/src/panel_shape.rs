//! How badly shaped the panels are: the mean over all panel corners of
//!
//! ```text
//! max(0, rho - 4)^2,      rho = (|e|^2 + |f|^2) / (2 e x f),      e, f: the edges that meet at the corner
//! ```
//!
//! rho is 1 at the corner of a square of any size, 4 at that of a rectangle eight times as long as wide
//! or between two equal edges at 14 degrees, and grows without bound as a panel collapses. Sheets that
//! open far need stretched panels, so that what can be cut well costs nothing.

use crate::plane::{I, add, complex, cross};
use crate::sheet::Panel;

/// rho up to which a corner is well shaped.
const WELL_SHAPED: f64 = 4.0;

/// The value, and its gradient in the corners of every panel (1/mm); infinite if a panel is not convex.
pub fn panel_shape(panels: &[Panel]) -> (f64, Vec<[[f64; 2]; 4]>) {
    let share = 0.25 / panels.len() as f64;
    let (mut value, mut gradient) = (0.0, vec![[[0.0; 2]; 4]; panels.len()]);
    for (panel, gradient) in std::iter::zip(panels, &mut gradient) {
        let corner = |j: usize| complex(panel.corners[j % 4]);
        for j in 0..4 {
            let (e, f) = (corner(j + 1) - corner(j), corner(j + 2) - corner(j + 1));
            let sine = cross(e, f);
            if sine <= 0.0 {
                return (f64::INFINITY, vec![[[0.0; 2]; 4]; panels.len()]);
            }
            let ratio = 0.5 * (e.norm_sqr() + f.norm_sqr()) / sine;
            let excess = f64::max(ratio - WELL_SHAPED, 0.0);
            value += share * excess * excess;
            let weight = 2.0 * share * excess / sine;
            let by_e = (e + I * f * ratio) * weight;
            let by_f = (f - I * e * ratio) * weight;
            add(&mut gradient[j], -by_e);
            add(&mut gradient[(j + 1) % 4], by_e - by_f);
            add(&mut gradient[(j + 2) % 4], by_f);
        }
    }
    (value, gradient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::central_slope;

    fn panel(corners: [[f64; 2]; 4]) -> Panel {
        Panel {
            corners,
            centroid: [0.0; 2],
        }
    }

    #[test]
    fn stretched_panels_cost_from_a_ratio_on_and_dented_ones_everything() {
        let rectangle = |length: f64| panel([[0.0, 0.0], [length, 0.0], [length, 1.0], [0.0, 1.0]]);
        assert_eq!(panel_shape(&[rectangle(1.0), rectangle(7.0)]).0, 0.0);
        let rho = 0.5 * (20.0 + 1.0 / 20.0);
        let (value, _) = panel_shape(&[rectangle(20.0)]);
        assert!((value - (rho - 4.0f64).powi(2)).abs() < 1e-12, "{value}");
        let dented = panel([[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]);
        assert_eq!(panel_shape(&[dented]).0, f64::INFINITY);
    }

    #[test]
    fn gradients_agree_with_differences() {
        let corners = [0.0, 0.1, 20.0, -0.2, 17.0, 1.1, 0.2, 0.9];
        let at = |x: &[f64]| panel(std::array::from_fn(|j| [x[2 * j], x[2 * j + 1]]));
        let other = panel([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let (value, gradient) = panel_shape(&[at(&corners), other]);
        assert!(value > 1.0, "{value}");
        for (i, found) in gradient[0].as_flattened().iter().enumerate() {
            let unit: Vec<f64> = (0..8).map(|j| f64::from(i == j)).collect();
            let slope = central_slope(|x| panel_shape(&[at(x), other]).0, &corners, &unit, 1e-6);
            assert!((found - slope).abs() < 1e-6 * value, "{found} {slope}");
        }
    }
}
