//! Penalty on cut angles that the weights do not know: the mean over the hinges of max(0, alpha_min
//! / alpha' - 1)^2, with alpha' the smaller one of alpha and pi - alpha.

use crate::objective::term::{Deployed, Term, TermGradient};
use std::f64::consts::{FRAC_PI_2, PI};

/// The penalty on small cut angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutAngles {
    /// alpha_min (rad).
    pub minimum: f64,
}

impl Term for CutAngles {
    fn name(&self) -> &'static str {
        "cut_angles"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let per_hinge = 1.0 / at.sheet.hinges.len() as f64;
        let mut value = 0.0;
        for (hinge, by_angle) in std::iter::zip(&at.sheet.hinges, &mut gradient.by_sheet.alphas) {
            let (acute, sign) =
                if hinge.alpha > FRAC_PI_2 { (PI - hinge.alpha, -1.0) } else { (hinge.alpha, 1.0) };
            let excess = (self.minimum / acute - 1.0).max(0.0);
            value += per_hinge * excess * excess;
            *by_angle -= weight * per_hinge * sign * 2.0 * excess * self.minimum / (acute * acute);
        }
        value
    }
}
