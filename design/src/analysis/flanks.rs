//! Whether the flanks of the main cut of a hinge overlap in the plane, where windows have no contact.
//!
//! Beside the ligament the flanks move with their panels. At the distance l from the tip O along the cut they are apart,
//! normal to the cut in the mean frame, by
//!
//! ```text
//! gap(l) = w_c + a sin(alpha) + s cos(alpha) + 2 l sin(theta / 2)
//! ```
//!
//! which is least at the hole, l = rho_f w_lig, where the cut opens.

use hinge::{HingeDeformation, HingeDesign};

/// Distance of the two flanks at the hole (mm); negative where they overlap.
pub fn flank_gap(design: &HingeDesign, state: &HingeDeformation) -> f64 {
    let HingeDeformation { a, s, theta } = *state;
    let (sin, cos) = design.alpha.sin_cos();
    let hole = design.fillet_ratio * design.w_lig;
    design.kerf + a * sin + s * cos + 2.0 * hole * (0.5 * theta).sin()
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
            let gap = |state: [f64; 3]| flank_gap(&design(alpha), &state.into());
            assert_eq!(gap([0.0; 3]), kerf);
            // Along the cut the flanks slide.
            assert!((gap([alpha.cos(), -alpha.sin(), 0.0]) - kerf).abs() < 1e-12);
            assert!((gap([-alpha.sin(), -alpha.cos(), 0.0]) - (kerf - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_hinge_that_turns_about_its_tip_opens_its_hole_and_the_mirror_image_has_the_same_gap() {
        let turned = flank_gap(&design(FRAC_PI_2), &[0.0, 0.0, PI].into());
        let hole = 10.0 * HingeConstants::PAPER.fillet_ratio;
        assert!((turned - HingeConstants::PAPER.kerf - 2.0 * hole).abs() < 1e-12);
        let [left, right] = [(0.8, 0.3), (PI - 0.8, -0.3)]
            .map(|(alpha, s)| flank_gap(&design(alpha), &[-0.5, s, 0.4].into()));
        assert!((left - right).abs() < 1e-12);
    }
}
