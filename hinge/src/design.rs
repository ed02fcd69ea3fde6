//! The hinge design vector g of (7).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use support::{Fault, ensure, refuse};

/// Geometry of the ligament left between the tip of a main cut and a secondary cut; (7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HingeDesign {
    /// Material left between the tip O and the secondary cut (mm).
    pub w_lig: f64,
    /// Angle between the secondary and the main cut, measured into the material (rad), in (0, pi).
    pub alpha: f64,
    /// Radius of the hole drilled about O, as a multiple of `w_lig`; the paper cuts 0.16.
    pub fillet_ratio: f64,
    /// Width the cutting tool removes along the main cut (mm).
    pub kerf: f64,
    /// Radius of the half-disc of sheet assigned to the hinge (mm).
    pub r_win: f64,
}

/// The components of (7) that are the same for all hinges of a sheet: they describe the cutting
/// tool and the window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HingeConstants {
    /// Radius of the hole drilled about O, as a multiple of w_lig, above 0 and below 1; the paper
    /// cuts 0.16.
    pub fillet_ratio: f64,
    /// Width the cutting tool removes along the main cut (mm), above 0 and below 2 fillet_ratio
    /// w_lig. It may differ from the kerf of the weights: from 0.002 to 0.15 w_lig it changes W by
    /// less than 0.5 % and the force by less than 2.5 %.
    pub kerf: f64,
    /// Radius of the half-disc of sheet assigned to the hinge (mm), above 2.5 w_lig. For learned
    /// hinges it is the radius of the weights, times the thickness of the sheet over the thickness
    /// in the training.
    pub r_win: f64,
}

impl HingeConstants {
    /// The constants of the paper's hinge specimens; section 4.1.
    pub const PAPER: Self = Self { fillet_ratio: 0.16, kerf: 0.2, r_win: 100.0 };

    /// The hinge of width `w_lig` (mm) and cut angle `alpha` (rad).
    pub fn hinge(&self, w_lig: f64, alpha: f64) -> HingeDesign {
        HingeDesign {
            w_lig,
            alpha,
            fillet_ratio: self.fillet_ratio,
            kerf: self.kerf,
            r_win: self.r_win,
        }
    }
}

/// A hinge design that cannot be cut, with the inequality it violates.
#[derive(Clone, Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InvalidDesign {
    #[error(
        "kerf = {kerf} mm violates 0 < kerf < 2 fillet_ratio w_lig = {limit} mm \
         (the cut must end in its hole)"
    )]
    Kerf { kerf: f64, limit: f64 },
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// Minimum and maximum ligament width accepted (mm). The limits are far outside the range that is
/// cut by hand or machine; they detect values in metres or in micrometres.
pub const MIN_W_LIG: f64 = 0.5;
const MAX_W_LIG: f64 = 500.0;
/// Minimum window radius over w_lig: the window must contain the tip region that is meshed around
/// O, and part of the panels around it.
const MIN_WINDOW: f64 = 2.5;

/// Widest ligament (mm) that a width in metres is taken for.
const LIKELY: f64 = 100.0;

fn unit_slip(w_lig: f64) -> String {
    if (MIN_W_LIG..=LIKELY).contains(&(1e3 * w_lig)) {
        format!("; did you mean {} mm?", 1e3 * w_lig)
    } else {
        String::new()
    }
}

impl HingeDesign {
    /// The tip O of the main cut in the hinge frame (mm).
    pub fn tip(&self) -> [f64; 2] {
        [0.0, -self.w_lig]
    }

    /// Unit vector along the main cut, from O into the material.
    pub fn main_cut(&self) -> [f64; 2] {
        [self.alpha.cos(), -self.alpha.sin()]
    }

    /// Radius of the hole drilled about O (mm).
    pub fn fillet_radius(&self) -> f64 {
        self.fillet_ratio * self.w_lig
    }

    /// The components that are the same for all hinges of the sheet.
    pub fn constants(&self) -> HingeConstants {
        HingeConstants { fillet_ratio: self.fillet_ratio, kerf: self.kerf, r_win: self.r_win }
    }

    /// The similar design in a sheet of `factor` times the thickness.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            w_lig: factor * self.w_lig,
            kerf: factor * self.kerf,
            r_win: factor * self.r_win,
            ..*self
        }
    }

    /// The design after reflection of x.
    pub fn mirrored(&self) -> Self {
        Self { alpha: PI - self.alpha, ..*self }
    }

    /// Rejects a hinge of a sheet that cannot be cut; the error names the violated inequality.
    pub fn validate(&self) -> Result<(), InvalidDesign> {
        self.validate_window(MIN_WINDOW)
    }

    /// Rejects a coupon that cannot be cut. Its grips may be closer to the ligament than the other
    /// panels of a sheet.
    pub fn validate_coupon(&self) -> Result<(), InvalidDesign> {
        self.validate_window(1.0 + 2.0 * self.fillet_ratio)
    }

    /// Rejects a design that cannot be cut, or whose window is no larger than `minimum` w_lig.
    fn validate_window(&self, minimum: f64) -> Result<(), InvalidDesign> {
        let Self { w_lig, alpha, fillet_ratio, kerf, r_win } = *self;
        let named = ["w_lig", "alpha", "fillet_ratio", "kerf", "r_win"];
        let values = [w_lig, alpha, fillet_ratio, kerf, r_win];
        if let Some((name, value)) = named.iter().zip(values).find(|(_, it)| !it.is_finite()) {
            refuse!("{name} = {value} is not a finite number");
        }
        ensure!(
            (MIN_W_LIG..=MAX_W_LIG).contains(&w_lig),
            "w_lig = {w_lig} mm violates {MIN_W_LIG} <= w_lig <= {MAX_W_LIG}: lengths are in mm{}",
            unit_slip(w_lig)
        );
        if alpha <= 0.0 || alpha >= PI {
            let deg = alpha.to_degrees();
            refuse!("alpha = {deg:.4} deg violates 0 < alpha < 180");
        }
        ensure!(
            fillet_ratio > 0.0 && fillet_ratio < 1.0,
            "fillet_ratio = {fillet_ratio} violates 0 < fillet_ratio < 1 (the hole would cut the ligament)"
        );
        let limit = 2.0 * self.fillet_radius();
        if kerf <= 0.0 || kerf >= limit {
            return Err(InvalidDesign::Kerf { kerf, limit });
        }
        let limit = minimum * w_lig;
        ensure!(r_win > limit, "r_win = {r_win} mm violates r_win > {minimum} w_lig = {limit} mm");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> HingeDesign {
        HingeConstants::PAPER.hinge(18.0, PI / 2.0)
    }

    #[test]
    fn the_papers_hinge_is_accepted_and_mirroring_twice_is_the_identity() {
        paper().validate().unwrap();
        let oblique = HingeDesign { alpha: 1.0, ..paper() };
        assert_eq!(oblique.mirrored().alpha, PI - 1.0);
        assert!((oblique.mirrored().mirrored().alpha - 1.0).abs() < 1e-15);
        assert_eq!(oblique.constants().hinge(18.0, 1.0), oblique);
    }

    #[test]
    fn errors_name_the_violated_inequality() {
        type Change = fn(&mut HingeDesign);
        let cases: [(Change, &str); 6] = [
            (|hinge| hinge.w_lig = 0.018, "did you mean 18 mm"),
            (|hinge| hinge.alpha = 0.0, "0 < alpha"),
            (|hinge| hinge.fillet_ratio = 1.0, "fillet_ratio < 1"),
            (|hinge| hinge.kerf = 6.0, "kerf < 2 fillet_ratio"),
            (|hinge| hinge.r_win = 40.0, "r_win > 2.5 w_lig"),
            (|hinge| hinge.r_win = f64::NAN, "finite"),
        ];
        for (change, expected) in cases {
            let mut design = paper();
            change(&mut design);
            let message = design.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
