//! Whether the flanks of the main cut of a hinge are pushed into each other, where windows have no
//! contact.
//!
//! Flanks of rigid panels are apart, normal to the cut in the mean frame, at the distance l from
//! the tip O along the cut, by
//!
//! ```text
//! gap(l) = w_c + a sin(alpha) + s cos(alpha) + 2 l sin(theta / 2)
//! ```
//!
//! Flanks of a plate stay in the plane: the least gap counts, at the hole or at the rim of the
//! window. The panels of a film tilt out of the plane as the ligament folds, which draws the flanks
//! apart at the hole: in solved windows they touch only where they do at the rim, which moves with
//! the rigid panel (docs/TRIED.md).

use hinge::{HingeDeformation, HingeDesign, Regime};

/// Distance of the flanks where they come nearest (mm); negative where they are pushed into each
/// other.
pub fn flank_gap(design: &HingeDesign, state: &HingeDeformation, regime: Regime) -> f64 {
    let rim = gap_at_rim(design, state);
    match regime {
        Regime::Film => rim,
        Regime::Plate => rim.min(gap_at_hole(design, state)),
    }
}

/// Distance of the flanks of rigid panels at the hole (mm).
fn gap_at_hole(design: &HingeDesign, state: &HingeDeformation) -> f64 {
    gap(design, state, design.fillet_radius())
}

/// Distance of the flanks of rigid panels at the rim of the window (mm).
fn gap_at_rim(design: &HingeDesign, state: &HingeDeformation) -> f64 {
    // The rim is a circle about the ligament's edge, which is at the distance w_lig from O.
    let (sin, cos) = design.alpha.sin_cos();
    let across = (design.r_win.powi(2) - (design.w_lig * cos).powi(2)).sqrt();
    gap(design, state, across - design.w_lig * sin)
}

fn gap(design: &HingeDesign, state: &HingeDeformation, from_tip: f64) -> f64 {
    let HingeDeformation { a, s, theta } = *state;
    let (sin, cos) = design.alpha.sin_cos();
    design.kerf + a * sin + s * cos + 2.0 * from_tip * (0.5 * theta).sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn design(alpha: f64) -> HingeDesign {
        HingeConstants::PAPER.hinge(10.0, alpha)
    }

    #[test]
    fn flanks_of_an_undeformed_hinge_are_a_kerf_apart_and_close_by_its_shortening() {
        let kerf = HingeConstants::PAPER.kerf;
        for alpha in [0.7, FRAC_PI_2, 2.0] {
            for gap in [gap_at_hole, gap_at_rim] {
                let gap = |state: [f64; 3]| gap(&design(alpha), &state.into());
                assert_eq!(gap([0.0; 3]), kerf);
                // The flanks slide along the cut.
                assert!((gap([alpha.cos(), -alpha.sin(), 0.0]) - kerf).abs() < 1e-12);
                assert!((gap([-alpha.sin(), -alpha.cos(), 0.0]) - (kerf - 1.0)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_hinge_that_turns_about_its_tip_opens_its_hole_and_the_mirror_image_has_the_same_gap() {
        let turned = gap_at_hole(&design(FRAC_PI_2), &[0.0, 0.0, PI].into());
        let HingeConstants { kerf, fillet_ratio, .. } = HingeConstants::PAPER;
        assert!((turned - kerf - 2.0 * 10.0 * fillet_ratio).abs() < 1e-12);
        let [left, right] = [(0.8, 0.3), (PI - 0.8, -0.3)]
            .map(|(alpha, s)| gap_at_hole(&design(alpha), &[-0.5, s, 0.4].into()));
        assert!((left - right).abs() < 1e-12);
    }

    /// A cut of 100 - 10 mm whose hinge is shortened by 1 mm and opens by 0.1.
    #[test]
    fn a_compressed_hinge_that_opens_is_closed_in_a_plate_and_open_in_a_film() {
        let state = [-1.0, 0.0, 0.1].into();
        let gap = |regime| flank_gap(&design(FRAC_PI_2), &state, regime);
        let opened = |from_tip: f64| 0.2 - 1.0 + 2.0 * from_tip * 0.05_f64.sin();
        assert!((gap(Regime::Film) - opened(90.0)).abs() < 1e-12);
        assert!((gap(Regime::Plate) - opened(1.6)).abs() < 1e-12);
        assert!(gap(Regime::Film) > 0.0 && gap(Regime::Plate) < 0.0);
    }
}
